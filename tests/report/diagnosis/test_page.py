"""The page of every verdict: self-contained, every number in verdict.json, nothing executed that a lab wrote."""

import re
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from html.parser import HTMLParser

import numpy as np
import pytest

from bench.diagnose.verdict import FittedFigure, Verdict
from bench.report.diagnosis.numbers import WORKSHOP
from bench.report.diagnosis.page import Pictures, page_of
from bench.report.diagnosis.pictures import learned_picture
from bench.report.jsonable import to_jsonable
from tests.report.diagnosis.made import (
    CURVE,
    GAS,
    HOSTILE,
    MASS,
    SEVERAL,
    VERDICTS,
    WARM,
    ZERO,
    explanation,
    facts_for,
    finding,
    has_shape,
)

LEVELS = {95.0, 90.0, 1.0}  # of intervals, and the unit of residuals: said in words, of no campaign
SCALES = (1.0, 100.0, *(scale for _, scale in WORKSHOP.values()))  # units of a workshop, and percent
DIFFERENCE = "--- a.xml\n+++ b.xml\n-<a x='<script>'/>\n+<b/>\n"
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.])")


class Page(HTMLParser):
    """What a reader sees, and what a browser would load."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.words: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self._open: list[str] = []
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag in ("style", "pre", "code"):
            self._open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if self._open and self._open[-1] == tag:
            self._open.pop()

    def handle_data(self, data: str) -> None:
        if not self._open:
            self.words.append(data)

    @property
    def text(self) -> str:
        return re.sub(r"\s+", " ", " ".join(self.words))


def test_figures_that_moved_are_named_and_escaped() -> None:
    verdict = VERDICTS["cause"]
    pictures, made = Pictures(worst=()), {"verdict.json": "all numbers of this page"}
    known = (verdict, facts_for(verdict), pictures, made, "")
    assert "Figures that moved" not in page_of(*known)
    page = page_of(*known, [f"stiffness of {HOSTILE}: +9.0 % (7.0 to 11.0)"])
    assert "Figures that moved" in page
    assert "Stiffness of &lt;script&gt;" in page


def test_what_changed_and_what_is_not_told_is_on_the_page() -> None:
    friction = FittedFigure(
        f"viscous friction of {HOSTILE}", "figure", "", 0.0, -0.12, -0.14, -0.1, 0.2, -0.6, "", np.nan, True, 0.0, True
    )
    untold = replace(GAS.parameters[0], is_told=False)
    group = finding(replace(GAS, parameters=(untold,)))
    verdict = replace(VERDICTS["cause"], changed=(friction,), findings=(group,))
    page = page_of(verdict, facts_for(verdict), Pictures(worst=()), {}, "")
    assert "Changed since the earlier diagnosis</h2>" in page
    assert "Viscous friction: &lt;script&gt;" in page
    assert "these data do not tell it" in page
    same = page_of(VERDICTS["cause"], facts_for(verdict), Pictures(worst=()), {}, "")
    assert "earlier diagnosis" not in same
    assert "do not tell it" not in same


def test_explanations_say_why_more_evidence_is_no_more_probable() -> None:
    best, more = explanation((GAS,), 0.73, 80.8), explanation((GAS, MASS), 0.0, 82.8)
    verdict = replace(
        VERDICTS["cause"],
        explanations=(best,),
        rivals=(more, explanation((WARM,), 0.27, 79.8), explanation((MASS,), 0.0, -900.0)),
    )
    assert verdict.counts_for(more) is best
    assert verdict.counts_for(best) is None
    text = Page(html_of(verdict)).text
    assert "Loss of gas 80.8 76.8 73 %" in text
    assert "82.8 74.8 counted for a likelier one" in text
    assert "-900 -904 < 0.1 %" in text  # no probability is none


def test_evidence_of_millions_has_groups_and_no_tenths() -> None:
    """It stood there as 55648585.3."""
    verdict = replace(VERDICTS["cause"], explanations=(explanation((GAS,), 0.6, 55648585.3),), rivals=())
    text = Page(html_of(verdict)).text
    assert "55 648 585 " in text
    assert "combinations of causes that were weighed but not simulated 40 %" in text


def test_of_several_findings_the_rest_is_other_combinations_of_their_names() -> None:
    """It said "the nominal model, and combinations ... 78 %" beside findings at 100 %."""
    verdict = replace(VERDICTS["several"], explanations=(explanation((GAS,), 0.04, 80.8),), rivals=())
    text = Page(html_of(verdict)).text
    assert "Other combinations of causes, the names of one finding with those of another," in text
    assert "The nominal model, and combinations" not in text


def test_table_of_findings_says_which_are_not_confirmed() -> None:
    """With four findings and more, only the chapters below said so."""
    cause = VERDICTS["cause"]
    group = cause.findings[0]
    several = replace(cause, findings=(*(group,) * 3, replace(group, is_confirmed=False)))
    assert "Loss of gas not confirmed 100 % lost" in Page(html_of(several)).text


def test_step_that_is_not_confirmed_says_why_beside_kept() -> None:
    cause = VERDICTS["cause"]
    text = Page(html_of(replace(cause, steps=(replace(cause.steps[0], repeats=0.2),)))).text
    assert "not confirmed: only 20 % of the searches without a part of the runs find it" in text


@cache
def html_of_kind(kind: str) -> str:
    return html_of(VERDICTS[kind])


def html_of(verdict: Verdict) -> str:
    learned = (learned_picture(CURVE, "motor torque"),) if has_shape(verdict) else ()
    pictures = Pictures(worst=(("motor current 2", learned),), learned=learned)
    made = {"verdict.json": "all numbers of this page"}
    return page_of(verdict, facts_for(verdict), pictures, made, DIFFERENCE)


@pytest.fixture(params=VERDICTS)
def kind(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture
def verdict(kind: str) -> Verdict:
    return VERDICTS[kind]


@pytest.fixture
def page(kind: str) -> Page:
    return Page(html_of_kind(kind))


def test_it_loads_nothing(page: Page) -> None:
    assert not {"script", "link", "iframe", "object", "base"} & {tag for tag, _ in page.tags}
    for tag, attributes in page.tags:
        assert not any(name.startswith("on") for name in attributes)
        for name in ("src", "srcset", "data", "action", "xlink:href"):
            assert (attributes.get(name) or "data:").startswith("data:image/svg+xml;base64,") or name not in attributes
        if tag == "a":
            assert attributes["href"] == "verdict.json"
        assert "http" not in (attributes.get("style") or "")
    assert "url(" not in html_of_kind("cause")
    assert "@import" not in html_of_kind("cause")


def test_what_a_lab_wrote_is_text(page: Page, kind: str) -> None:
    assert "<script" not in html_of_kind(kind)
    assert HOSTILE in page.text
    assert "nan" not in page.text.split()


def leaves(value: object) -> Iterator[object]:
    match value:
        case dict():
            for entry in value.values():
                yield from leaves(entry)
        case list():
            yield len(value)
            for entry in value:
                yield from leaves(entry)
        case _:
            yield value


def is_known(text: str, numbers: list[float]) -> bool:
    shown = float(text)
    digits = text.lstrip("+-").partition("e")[0].partition(".")[2]
    power = int(text.partition("e")[2] or 0)
    half = 0.5000001 * 10.0 ** (power - len(digits))
    small = 0.5001 * 10.0 ** (np.floor(np.log10(abs(shown))) - 2) if shown else 0.0  # of three or more digits
    return any(abs(number * scale - shown) <= max(half, small) for number in numbers for scale in SCALES)


def test_every_number_is_in_the_file(page: Page, verdict: Verdict) -> None:
    content = to_jsonable(verdict.as_json() | facts_for(verdict).as_json())
    known = list(leaves(content))
    numbers = [float(leaf) for leaf in known if isinstance(leaf, int | float)]
    numbers += [-number for number in numbers]
    words = " ".join(leaf for leaf in known if isinstance(leaf, str))
    in_words = set(NUMBER.findall(words.replace("_", " ")))
    shown = NUMBER.findall(re.sub(r"[<>] -?(0\.1|99\.9) %", "", page.text))
    assert shown
    for text in shown:
        assert text in in_words or float(text) in LEVELS or is_known(text, numbers), text


def test_sections_are_those_with_something_to_say(page: Page, verdict: Verdict) -> None:
    for words, content in (
        ("What it is worth on data that were not fitted", verdict.gain),
        ("How causes were selected", verdict.steps),
        ("The next experiment", verdict.next),
        ("What would have been found", verdict.detectable),
        ("Evidence and competing explanations", verdict.explanations),
        ("The learned shape", has_shape(verdict)),
        ("Beside least squares", verdict.baseline),
        ("Drive 4: the first pass predicts 0.901 Nm", verdict.baseline and verdict.baseline.missed),
    ):
        assert (words in page.text) == bool(content), words


def test_a_set_is_called_one() -> None:
    text = Page(html_of_kind("set")).text
    assert "apart where several are named (1 of 2 findings have several)" in text
    assert "Zero of a joint (joint 2) and either loss of gas or gas warmer or colder" in text


def test_missing_channels_are_said_once_each() -> None:
    text = Page(html_of_kind("nothing")).text
    assert "Missing: gear temperature so these were not looked for: friction falls with gear temperature" in text
    assert "backlash: the model found no balance" in text


def test_a_refused_step_says_why() -> None:
    assert "refused Held-out runs do not become more probable" in Page(html_of_kind("cause")).text


def test_what_to_expect_is_in_the_unit_that_stands_beside_it() -> None:
    text = Page(html_of_kind("cause")).text
    assert "link angle 1 0.0109 0.0063 to 0.0189 deg" in text  # 1.9e-4 rad
    assert "motor force 1 4.48 N" in text


def test_no_limit_is_beyond_what_is_plausible() -> None:
    text = Page(html_of_kind("nothing")).text
    assert "18391" not in text
    assert (
        "Not detectable at a plausible size: length of a link (upper arm): length; Stribeck effect (joints 1, 2): "
        "rise of some shapes." in text
    )


def test_a_limit_of_several_shapes_is_not_that_of_the_luckiest() -> None:
    assert "sin 0.0018 to 0.0054, by its shape deg" in Page(html_of_kind("nothing")).text


def test_a_gain_stands_beside_what_was_measured_and_the_nominal_model_as_it_is() -> None:
    assert "motor current 2 2.310 0.405 0.612 0.081 0.074 A 80 % 74 % to 86 %" in Page(html_of_kind("cause")).text


def test_a_shape_that_is_nothing_is_not_drawn() -> None:
    text = Page(html_of_kind("a remainder")).text
    assert "Something is left that is too small to give a shape" in text
    assert "unlisted" not in text.lower()


def test_small_findings_come_last_and_are_called_so() -> None:
    text = Page(html_of_kind("messy")).text
    found = [
        text.index(name) for name in ("Mass of a link (upper arm) (1", "Zero of a joint (joint 2) (1", "Loss of gas (")
    ]
    assert found == sorted(found)
    assert "Loss of gas (100 %; small: 11 % of the largest plausible size)" in text


def test_the_same_verdict_gives_the_same_page() -> None:
    assert html_of(VERDICTS["unlisted"]) == html_of(VERDICTS["unlisted"])


def test_many_findings_are_listed_first_and_physics_is_told_once() -> None:
    names = [f"a cause with quite a long name that no other has, number {number}" for number in range(1, 6)]
    many = tuple(finding(replace(ZERO, title=name, physics="It reads x more.")) for name in names)
    for count, lists in ((2, False), (5, True)):
        verdict = replace(SEVERAL, findings=many[:count])
        page = page_of(verdict, facts_for(verdict), Pictures(worst=()), {}, "")
        assert ("Size (95 % interval)" in page) == lists
        assert page.count("It reads x more.") == 1
