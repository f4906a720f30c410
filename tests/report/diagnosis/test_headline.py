"""The headline of a verdict, and what stands beside it."""

from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.named_causes import ParameterValue
from bench.diagnose.verdict import FittedFigure, NamedCause, Unfinished, Unlisted
from bench.report.diagnosis.headline import MOST, headline
from bench.report.diagnosis.sentences import unfinished_sentence
from bench.report.diagnosis.words import words_of
from tests.report.diagnosis.made import BESIDE, GAS, MASS, NOTHING, STEP_GAIN, VERDICTS, WARM, ZERO, finding

NOTHING_FOUND = (
    "Nothing found: the nominal model, with its figures fitted, explains this campaign; what moved far is listed."
)
OIL = replace(MASS, place="forearm")


@pytest.mark.parametrize(
    ("kind", "first"),
    [
        ("nothing", NOTHING_FOUND),
        ("cause", "Loss of gas: lost 0.133 (95 % interval 0.113 to 0.152)."),
        ("several", "2 causes act together: loss of gas and zero of a joint (joint 2)."),
        (
            "unlisted",
            "An unlisted cause: a torque on the motor of joint 2 that depends on angle and direction.",
        ),
        (
            "unlisted beside a listed one",
            "Loss of gas; and an unlisted error of the readings of tracker that depends on place.",
        ),
        (
            "a part of the unlisted one",
            "An unlisted cause: a torque on the motor of joint 2 that depends on angle and direction.",
        ),
        (
            "a remainder",
            "Loss of gas: lost 0.133 (95 % interval 0.113 to 0.152). "
            "Left: something at joint 2 too small to have a shape.",
        ),
        ("small", "Only small findings: loss of gas."),
        (
            "missing",
            "Loss of gas: lost 0.133 (95 % interval 0.113 to 0.152). "
            "Drive 4: the first pass predicts 0.901 Nm, the named causes 3.93: something is missing here.",
        ),
        ("as good as least squares", NOTHING_FOUND),
        (
            "messy",
            "2 large causes act together: mass of a link (upper arm) and zero of a joint (joint 2); and 1 small one.",
        ),
    ],
)
def test_the_first_line_is_the_verdict(kind: str, first: str) -> None:
    assert next(words_of(VERDICTS[kind])) == first


def test_least_squares_stands_beside_the_diagnosed_model() -> None:
    text = "\n".join(words_of(VERDICTS["missing"]))
    table = text.partition("each run predicted by fits without it:\n")[2]
    rows = [line.split() for line in table.splitlines()[:6]]
    assert rows == [
        ["drive", "2", "drive", "4"],
        ["torque", "itself", "1316", "88.1"],
        ["nominal", "model", "65.5", "13.4"],
        ["plain", "least", "squares", "4.22", "1.22"],
        ["first", "pass", "8.60", "0.901"],
        ["diagnosed", "model", "3.71", "3.93"],
    ]


def test_what_is_left_is_told_with_its_size() -> None:
    """A verdict that was sure of a name said only below that a channel was missed by three times its floor."""
    shape = tuple(ParameterValue(f"at_{i}", x, x - 3, x + 3, "Nm") for i, x in enumerate((-2.0, 1.5)))
    little = Unlisted("joint 2", "motor torque", "speed", shape, stands_out=False)
    far = replace(STEP_GAIN, after=0.23)
    words = headline(replace(VERDICTS["cause"], unlisted=little, gain=(STEP_GAIN, far, replace(far, after=0.1))))
    assert words == (
        "Loss of gas: lost 0.133 (95 % interval 0.113 to 0.152). Left: something at joint 2 too small to have a shape "
        "(at most 5.0 Nm); motor current 2 errs by 0.230 A, 3.1 times what the noise of the instruments explains, and "
        "1 more such channel."
    )


def test_where_least_squares_is_better_nothing_is_not_explained() -> None:
    missed = replace(NOTHING, baseline=VERDICTS["missing"].baseline)
    words = headline(missed)
    assert words.startswith("Nothing found, but the nominal model does not explain this campaign. Drive 4: ")
    assert "the model 3.93" in words


@pytest.mark.parametrize("count", [1, 3, 20])
@pytest.mark.parametrize("names", [1, 2, 6])
@pytest.mark.parametrize("unlisted", [None, Unlisted("joint 2", "motor torque", "angle and direction")])
def test_a_headline_has_two_lines_at_most(count: int, names: int, unlisted: Unlisted | None) -> None:
    long = "friction of the seal of the counterbalance that the model leaves out"
    causes = tuple(replace(ZERO, title=f"{long} {i}", share=0.5, sigmas=5.0 + i) for i in range(count))
    open_names = finding(*(replace(GAS, title=f"{long}, {i}") for i in range(names)))
    found = (*map(finding, causes), open_names)
    words = headline(replace(VERDICTS["several"], findings=found, unlisted=unlisted))
    assert len(words) <= MOST
    assert "nan" not in words


def test_the_surest_stand_in_a_long_headline() -> None:
    causes = [replace(ZERO, place=f"link {i}", share=0.5, sigmas=float(i)) for i in range(19, -1, -1)]
    words = headline(replace(VERDICTS["several"], findings=tuple(map(finding, causes))))
    assert words.startswith("20 causes act together: zero of a joint (link 19), zero of a joint (link 18)")
    assert words.endswith("and others.")


def test_a_shape_makes_room_for_the_name_of_a_cause() -> None:
    causes = tuple(replace(ZERO, title=f"Coulomb friction that the model leaves out, {i}", share=0.5) for i in range(2))
    one = replace(BESIDE, findings=tuple(map(finding, causes)))
    first = "Coulomb friction that the model leaves out, 0 (joint 2)"
    assert headline(one) == f"2 causes: {first} and others; and something unlisted at tracker."


def test_a_finding_that_may_be_large_is_large() -> None:
    open_names = finding(replace(ZERO, share=0.5), replace(GAS, share=0.1))
    words = headline(replace(VERDICTS["several"], findings=(finding(MASS), open_names)))
    assert words.startswith("Mass of a link (upper arm) and either zero of a joint (joint 2) or loss of gas, which")


def test_what_is_surely_larger_than_one_that_may_be_large_stands_with_it() -> None:
    """The headline of a messy arm told a small torque that may be a large offset, and not the cause that was hidden."""
    hidden = finding(replace(MASS, share=0.17, sigmas=45.0))
    open_names = finding(replace(ZERO, share=0.4), replace(GAS, share=0.04))
    tiny = finding(replace(OIL, share=0.02))
    words = headline(replace(VERDICTS["several"], findings=(hidden, open_names, tiny)))
    assert words == "Mass of a link (upper arm) and zero of a joint (joint 2) or 1 other; and 1 small one."


def test_a_cause_that_was_not_fitted_makes_no_small_finding_large() -> None:
    open_names = finding(replace(GAS, share=0.1), replace(WARM, parameters=()))
    assert headline(replace(VERDICTS["set"], findings=(open_names,))).startswith(
        "Only small findings: loss of gas or 1"
    )


def test_small_findings_that_are_open_are_no_either_or_of_the_headline() -> None:
    small = finding(replace(MASS, share=0.1), replace(OIL, share=0.1))
    assert headline(replace(VERDICTS["several"], findings=(finding(GAS), small))).startswith("Loss of gas: lost 0.133")


def test_small_findings_are_counted_in_the_headline() -> None:
    """Seven findings stood below a headline of three causes."""
    small = [replace(ZERO, place=f"joint {i}", share=0.1) for i in range(1, 5)]
    found = tuple(map(finding, (GAS, MASS, *small)))
    assert headline(replace(VERDICTS["several"], findings=found)) == (
        "2 large causes act together: loss of gas and mass of a link (upper arm); and 4 small ones."
    )


def test_what_is_not_confirmed_is_counted_and_leads_no_headline() -> None:
    """A friction that no search without a part of the runs found stood beside two causes that were certain."""
    unsure = replace(finding(ZERO), is_confirmed=False)
    small = finding(replace(MASS, share=0.1))
    assert headline(replace(VERDICTS["several"], findings=(finding(GAS), finding(MASS), unsure))) == (
        "2 causes act together: loss of gas and mass of a link (upper arm); and 1 not confirmed."
    )
    words = headline(replace(VERDICTS["several"], findings=(finding(GAS), unsure, small)))
    assert words.endswith("; and 1 small one and 1 not confirmed.")
    alone = "Only findings that are not confirmed: zero of a joint (joint 2)."
    assert headline(replace(VERDICTS["several"], findings=(unsure,))) == alone
    assert headline(replace(VERDICTS["several"], findings=(unsure, small))).startswith(
        "Only findings that are small or not confirmed: zero of a joint (joint 2)"
    )


def test_what_was_not_held_against_other_data_yet_has_not_failed() -> None:
    """A diagnosis that was stopped said "not confirmed" of thirteen findings at 100 %, all of which were right."""
    unsure = replace(finding(ZERO), is_confirmed=False)
    stopped = replace(VERDICTS["several"], findings=(unsure,), unfinished=Unfinished("interrupted", "naming"))
    assert headline(stopped).startswith(
        "Unfinished (interrupted, during: naming). So far: not yet checked on other data: "
    )
    withdrawn = "which withdraw many findings"  # of seventeen of a KR300, each at 100 %, two stayed
    assert withdrawn in unfinished_sentence(stopped)
    assert withdrawn not in unfinished_sentence(replace(stopped, findings=(replace(unsure, is_confirmed=True),)))
    assert unfinished_sentence(replace(stopped, unfinished=None)) == ""


def test_findings_with_several_names_have_one_each_in_a_long_headline() -> None:
    found = (finding(GAS, WARM), finding(replace(MASS, share=0.4), OIL), finding(ZERO))
    assert headline(replace(VERDICTS["several"], findings=found)) == (
        "Loss of gas or 1 other, mass of a link (upper arm) or 1 other and zero of a joint (joint 2)."
    )


def test_findings_that_have_no_room_are_counted_and_so_are_those_with_several_names() -> None:
    """Of twelve findings, two of which had a second name, "which these data cannot tell apart" was said."""
    many = [finding(replace(ZERO, place=f"link {i}", share=0.5, sigmas=30.0 - i)) for i in range(12)]
    found = (*many, finding(replace(GAS, share=0.3), WARM))
    one = replace(VERDICTS["several"], findings=found)
    assert headline(one).startswith("13 findings: zero of a joint (link 0), zero of a joint (link 1)")
    assert headline(one).endswith("and others.")
    shape = Unlisted("joint 2", "motor torque", "angle and direction")
    words = headline(replace(one, unlisted=replace(shape, stands_out=True)))
    long = tuple(
        finding(*(replace(c, title=f"{c.title} {'that a drawing leaves out' * 5}") for c in (ZERO, GAS)[: 1 + (i < 2)]))
        for i in range(12)
    )
    assert words.startswith("13 findings")
    assert headline(replace(one, findings=long)) == "12 findings, of 2 of which these data cannot tell the cause."


def test_where_least_squares_leaves_less_by_chance_it_is_said_below_the_table() -> None:
    """On a SCARA plain least squares was 8 and 10 % better on two joints, over four runs, and no word said so."""
    sound = VERDICTS["as good as least squares"]
    assert sound.baseline
    behind, *others = sound.baseline.drives
    for rivals, name in (((6.55, 1.74), "The first pass"), ((1.74, 6.55), "Plain least squares")):  # rows of the table
        plain, first = rivals
        worse = replace(behind, plain_least_squares=plain, first_pass=first, diagnosed=1.2 * min(rivals))
        verdict = replace(sound, baseline=replace(sound.baseline, drives=(worse, *others)))
        text = "\n".join(words_of(verdict))
        assert (
            f"{name} leaves less on drive {worse.drive} (by 20 %); over {sound.baseline.folds} {sound.baseline.by}s"
            in text
        )
        assert "chance may bring" not in text, "a factor of 2.5 over three recordings was put down to it"
    assert "leaves less" not in "\n".join(words_of(VERDICTS["missing"]))


def test_the_headline_shows_a_size_that_is_told() -> None:
    """A tracker that leaned by 1 mrad/h had "x -0.000023 m/h" in its headline."""
    sizes = (ParameterValue("x", -2e-5, -1e-4, 6e-5, "m/h"), ParameterValue("ry", 1.03e-3, 9.7e-4, 1.09e-3, "rad/h"))
    creep = NamedCause("tracker_creep", "creep", "tracker", sizes)
    words = headline(replace(VERDICTS["cause"], findings=(finding(creep),)))
    assert words.startswith("Creep (tracker): ry 0.001030 rad/h")


def figure(name: str, unit: str, earlier: float, found: float, half: float, sigmas: float) -> FittedFigure:
    values = (0.0, found, found - half, found + half, half, sigmas)
    return FittedFigure(name, "figure", unit, *values, "", np.nan, True, earlier, has_changed=True)


def test_what_has_changed_since_the_earlier_diagnosis_is_said() -> None:
    """A day on which friction was 12 % lower had a verdict that named a payload alone."""
    changed = (
        figure("viscous friction of J2", "", 0.0, -0.128, 0.03, -0.6),
        figure("viscous friction of J1", "", 0.0, -0.124, 0.02, -0.6),
        figure("rotor inertia of J1", "", 0.25, 0.375, 0.05, 2.3),
        figure("loss of gas: lost, as found before", "", 0.1, 0.2, 0.01, 9.0),
        figure("current offset of J1", "A", 0.051, -0.0053, 0.0014, -2.2),
    )
    lines = list(words_of(replace(VERDICTS["cause"], changed=changed)))
    assert lines[0] == (
        "Loss of gas: lost 0.133 (95 % interval 0.113 to 0.152). Changed since the earlier diagnosis: viscous friction "
        "(J1, J2), rotor inertia (J1), loss of gas: lost, current offset (J1)."
    ).replace("lost, current", "lost and current")
    said = [line for line in lines[1:] if line.startswith("Changed since the earlier diagnosis: ")]
    assert [line.removeprefix("Changed since the earlier diagnosis: ") for line in said] == [
        "viscous friction: J1 -12.4 % (-14.4 to -10.4; 0.6 times what was to be expected); "
        "J2 -12.8 % (-15.8 to -9.8; 0.6 times what was to be expected)",
        "rotor inertia: J1 +10.0 % (6.0 to 14.0; 2.3 times what was to be expected)",
        "loss of gas: lost: 0.200 (0.190 to 0.210; 9.0 times what was to be expected) instead of 0.100",
        "current offset: J1 -0.0053 A (-0.0067 to -0.0039; 2.2 times what was to be expected) instead of 0.0510",
    ]


def test_there_is_room_for_all_that_has_changed_below_the_headline() -> None:
    changed = tuple(figure(f"figure number {i} of J1", "", 0.0, 0.1, 0.01, 3.0) for i in range(20))
    first, *lines = words_of(replace(VERDICTS["cause"], changed=changed))
    assert first.endswith(" and others.")
    assert sum(line.startswith("Changed since") for line in lines) == 20
