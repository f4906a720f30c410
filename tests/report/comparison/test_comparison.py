"""What a comparison prints and writes."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.compare.comparison import ChangedFinding, Comparison, Explanation, LeftBefore, PossibleName
from bench.report.comparison.page import lines_of, page_of
from bench.report.comparison.words import MOST_TOLD, headline, words_of
from bench.report.comparison.write import COMPARISON, REPORT, write_comparison
from bench.report.diagnosis.headline import MOST
from tests.report.comparison.examples import (
    COLD,
    FRICTION,
    GAS,
    MORE,
    NOTHING,
    ONE,
    OTHER,
    SET,
    THREE,
    TWO,
    UNLISTED,
    finding,
)


@pytest.mark.parametrize(
    ("comparison", "words"),
    [
        (NOTHING, "Nothing changed that these recordings would show."),
        (ONE, "Changed: loss of gas +1.24 % (90 % interval 1.12 to 1.36), probability 99.3 %."),
        (
            SET,
            "Changed: either loss of gas or gas warmer or colder than nominal, which these data cannot tell apart.",
        ),
        (
            MORE,
            "Changed: gas warmer or colder than nominal, loss of gas or 1 other, which these data cannot tell apart.",
        ),
        (
            TWO,
            "Changed: friction of joint 0, long name 0 or 4 others and loss of gas or 1 other, which these data cannot "
            "tell apart.",
        ),
        (
            OTHER,
            "Changed: loss of gas or 1 other, or another explanation, which these data cannot tell apart.",
        ),
        (UNLISTED, "Changed, not listed: a torque on the link of joint 2 that depends on angle."),
        (THREE, "Changed: loss of gas +0.600 % (90 % interval 0.550 to 0.650) a week, probability 95 %."),
    ],
)
def test_headlines(comparison: Comparison, words: str) -> None:
    assert headline(comparison) == words


def test_a_headline_names_the_sure_ones_first() -> None:
    """It began with the one of five that had another name, at 92 %: "or 1 other and others, or another explanation"."""

    def names(joint: int, *probabilities: float) -> ChangedFinding:
        place, effects = f"joint {joint}", ("Coulomb level", "rolling friction")
        several = zip(effects, probabilities, strict=False)
        return ChangedFinding(tuple(PossibleName(one, f"{one} ({place})", place, p) for one, p in several), 0.99)

    sure = (names(6, 0.92, 0.082), names(4, 0.993), names(3, 0.98, 0.019), names(5, 0.97), names(1, 0.94))
    said = headline(replace(OTHER, findings=sure))
    assert said == "Changed: Coulomb level (joints 1, 3, 4, 5, 6) (each 92 % or more)."
    for least, words in ((0.9995, "> 99.9 %"), (1.0, "100 %")):  # "each > 99.9 % or more", it said
        said = headline(replace(OTHER, findings=(names(1, 1.0), names(2, least))))
        assert said == f"Changed: Coulomb level (joints 1, 2) (each {words})."
    said = headline(replace(SET, findings=(names(2, 0.6, 0.39), *sure[:2])))
    assert said.startswith("Changed: Coulomb level (joints 4, 6) (each 92 % or more); ")
    many = tuple(names(k, 0.6, 0.39) for k in (2, 3, 5))
    said = headline(replace(SET, findings=(*many, sure[0])))
    assert said.startswith("Changed: Coulomb level (joint 6) (92 %)")
    assert len(said) <= MOST


def test_nothing_found_says_what_would_have_been_found() -> None:
    lines = list(words_of(NOTHING))
    assert any("loss of gas, lost 0.30 %" in line for line in lines)
    assert lines[-1].startswith("1 change would not have been found")


def test_a_robot_that_is_far_from_what_was_recorded_before_is_said_near_the_top() -> None:
    """A heavier tool was a link's mass at 99 %, about a robot with a link of 0.1 kg, and nothing said so."""
    assert not any("--robot" in line for line in words_of(ONE))
    missed = (LeftBefore("current_2_a", 26.4), LeftBefore("current_1_a", 3.0), LeftBefore("current_3_a", 2.1))
    far = replace(ONE, left_before=missed)
    said = list(words_of(far))[1]
    assert said.startswith("The robot as it was leaves 26 times as much of motor current 2 in")
    assert ", and other channels of it too (3 in all), so names of what changed may be wrong: " in said
    assert "too" not in list(words_of(replace(far, left_before=missed[:1])))[1]
    assert f"diagnose {far.recordings[0].name} first" in said
    page = page_of(far, "HH-150", "")
    assert said in page
    assert page.index(said) < page.index("In full")
    told = list(words_of(replace(far, robot="handed over")))[1]
    assert "compare with --robot" not in told, "that was done already"
    assert "that robot is of a diagnosis" in told
    assert far.as_json()["left_before"][0] == {"column": "current_2_a", "times": 26.4}


def test_terminal_gives_every_explanation_with_its_size() -> None:
    words = "\n".join(words_of(SET))
    assert "lost +1.24 % (90 % interval 1.12 to 1.36)   share" in words, "a percentage says of what it is one"
    assert "offset -3.60 K (90 % interval -4.00 to -3.20)" in words
    assert "lost +1.24 % (90 % interval 1.12 to 1.36) (share)" in page_of(SET, "HH-150", "")


def test_what_the_catalogue_states_as_a_range_for_others_is_not_told() -> None:
    """A moment of a payload had "range for a largest mass of 1 kg, whose weight has the rated moment" behind it."""
    sizes = tuple(replace(size, words=f"{size.words}; range for a largest mass of 1 kg") for size in GAS.sizes)
    one = replace(ONE, explanations=(replace(ONE.explanations[0], changes=(replace(GAS, sizes=sizes),)),))
    words = "\n".join(words_of(one))
    assert "   share" in words
    assert "range for" not in words


def test_a_terminal_is_not_flooded_with_explanations() -> None:
    """Of a stranger's arm it gave 44 of them, in 2384 lines."""
    each = SET.explanations[0]
    many = replace(SET, explanations=tuple(replace(each, probability=0.5 / 2**i) for i in range(40)))
    lines = list(words_of(many))
    assert sum(": probability" in line for line in lines) == MOST_TOLD
    assert "34 more explanations (0.78 % or less each) stand in compare.json and the page, with -o." in lines
    assert not any("more explanations" in line for line in words_of(SET))


def test_what_holds_from_a_run_on_is_no_change_of_the_machine() -> None:
    words = "not there in the whole recording"
    assert words in "\n".join(words_of(MORE))
    assert words in page_of(MORE, "HH-150", "")
    assert words not in page_of(SET, "HH-150", "")


def test_several_changes_are_told_one_by_one() -> None:
    words = "\n".join(words_of(TWO))
    gas = "loss of gas, +1.24 % (90 % interval 1.12 to 1.36) (45 %)"
    cold = "gas warmer or colder than nominal, -3.60 K (90 % interval -4.00 to -3.20) (45 %)"
    assert f"Change 2: {gas} or {cold}" in words
    lines = list(words_of(TWO))
    sizes = [i for i, line in enumerate(lines) if line.startswith("    ") and "90 % interval" in line]
    assert sizes, "of several changes each size stands under its own"
    assert all(lines[i - 1].startswith("  ") for i in sizes)


def test_one_explanation_of_many_changes_is_told_once() -> None:
    """Of friction that fell in seven joints each size stood there twice, and a title had seven times "with"."""
    of_joints = tuple(replace(one, title=f"friction ({one.place})") for one in FRICTION[:3])
    alone = replace(NOTHING, explanations=(Explanation(of_joints, 0.99, 40.0),), findings=(*map(finding, of_joints),))
    lines = list(words_of(alone))
    assert "Friction (joints 0, 1, 2): probability 99 %" in lines
    assert not [line for line in lines if line.startswith("Change ")]
    assert sum("+1.24 %" in line for line in lines) == len(of_joints)
    assert "<h3>Friction (joints 0, 1, 2) <small>" in page_of(alone, "HH-150", "")


def test_a_comparison_that_had_to_diagnose_says_so() -> None:
    """Only a line of progress said it, and each comparison with the same recordings took the minutes again."""
    said = "To compare with may again, bench diagnose it once, and give --robot the folder of that."
    for origin in ("fitted", "diagnosed", "handed over"):
        told = replace(ONE, robot=origin)
        assert any(said in line for line in words_of(told)) == (origin == "diagnosed")
        assert (said in page_of(told, "HH-150", "")) == (origin == "diagnosed")


def test_a_page_begins_with_each_change_how_large_and_since_when() -> None:
    """Sizes stood below, under explanations of all changes together, each repeated in each of these."""
    top = page_of(TWO, "HH-150", "").split("</header>")[0]
    assert "<td>Friction of joint 0, long name 0</td>" in top
    assert "<td>or friction of joint 1, long name 1</td>" in top
    assert top.count("+1.24 % (90 % interval 1.12 to 1.36)") == 1 + len(FRICTION)
    assert "or gas warmer or colder than nominal" in top
    assert "<th>When</th>" not in top, "one recording after"
    top = page_of(THREE, "HH-150", "").split("</header>")[0]
    assert "+2.40 % (90 % interval 2.20 to 2.60), +0.600 % (90 % interval 0.550 to 0.650) a week" in top
    assert "growing from june on" in top
    top = page_of(NOTHING, "HH-150", "").split("</header>")[0]
    assert "<table" not in top
    assert "Of 2, 1 would not have been found at any plausible size" in top


def test_an_interval_says_what_else_it_allows_for() -> None:
    change = replace(GAS, along=("viscous friction", "Stribeck effect"))
    comparison = replace(ONE, explanations=(Explanation((change,), 0.99, 40.0),))
    words = "allows for as large a change beside it of: viscous friction; Stribeck effect"
    assert words in "\n".join(words_of(comparison))
    assert words in page_of(comparison, "HH-150", "")
    assert "allows for" not in page_of(ONE, "HH-150", "")


def test_page_has_a_line_for_each_component() -> None:
    page = page_of(ONE, "HH-150", "bench compare may june -o out")
    assert page.count("<svg") == len(ONE.components)
    assert headline(ONE).split(",")[0] in page
    assert "bench compare may june -o out" in page
    assert "1 of which no plausible change" in page


def test_charts_stand_in_time_and_rise_with_the_value() -> None:
    line = lines_of(THREE)[0]
    x, y = ([getattr(dot, name) for dot in line.dots] for name in "xy")
    assert len(x) == 5
    np.testing.assert_allclose(np.diff(x), np.diff(x)[0])
    assert np.all(np.diff(y) < 0), "upwards in a picture"
    assert line.dots[0].y == pytest.approx(line.zero)


def test_files(tmp_path: Path) -> None:
    write_comparison(THREE, tmp_path, "HH-150")
    content = json.loads((tmp_path / COMPARISON).read_text())
    assert content["format"] == 1
    assert content["has_changed"] is True
    assert content["explanations"][0]["changes"][0]["sizes"][0]["per_week"]["value"] == 0.006
    assert (tmp_path / REPORT).exists()


def test_alternatives_of_one_change_are_not_all_called_changed() -> None:
    def marks(*explanations: Explanation) -> dict[str, str]:
        named = replace(TWO.components[0], is_named=True)
        components = tuple(
            replace(named, effect=one.effect, title=one.title, place=one.place) for one in (GAS, COLD, FRICTION[0])
        )
        return {
            line.name: line.mark for line in lines_of(replace(TWO, explanations=explanations, components=components))
        }

    both = marks(Explanation((GAS, FRICTION[0]), 0.6, 40.0), Explanation((COLD, FRICTION[0]), 0.4, 39.0))
    assert both[FRICTION[0].title] == "changed"
    assert both[GAS.title] == both[COLD.title] == "one of these changed"
