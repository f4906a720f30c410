"""Scoring: a right answer is right, and every way of being wrong is noticed."""

from dataclasses import replace

import pytest

from bench.diagnose.verdict import Explanation, NamedCause, ParameterValue, Unlisted, Verdict
from bench.study.outcome import Answer, FoundGroup, Name, Outcome, answer_of
from bench.study.score import marks_of, twin_is_right
from tests.study.answers import COULOMB, LOSS, WARM, explanation, outcome, single, truth


def verdict(effect: str, place: str = "robot", low: float = 0.08, high: float = 0.12) -> Verdict:
    value = ParameterValue("size", (low + high) / 2, low, high, "")
    named = Explanation((NamedCause(effect, "a title", place, (value,)),), 0.97, 20.0, 0.97, 16.0)
    return Verdict("cause", 0.01, 5.0, 1.0, (named,), (), None, {}, ())


def scored(found: Verdict) -> Outcome:
    return outcome("single", truth(LOSS), answer_of(found))


def test_right_verdict() -> None:
    marks = marks_of(scored(verdict("gas_loss")))
    assert marks.found
    assert marks.first
    assert marks.in_set
    assert marks.probability == 0.97
    assert marks.covered == (("gas_loss.size", True),)


@pytest.mark.parametrize(("effect", "place"), [("gas_temperature", "robot"), ("gas_loss", "joint 2")])
def test_planted_wrong_name_is_noticed(effect: str, place: str) -> None:
    marks = marks_of(scored(verdict(effect, place)))
    assert marks.found
    assert not marks.first
    assert not marks.in_set
    assert not marks.all_there
    assert marks.covered == ()


def test_interval_beside_the_truth_is_noticed() -> None:
    assert marks_of(scored(verdict("gas_loss", low=0.102, high=0.13))).covered == (("gas_loss.size", False),)


def test_what_is_said_of_a_quotient_is_no_interval_of_its_own() -> None:
    (one,) = verdict("gas_loss").explanations
    centre = ParameterValue("x", 0.01, 0.0, 0.02, "m")
    cause = replace(one.causes[0], parameters=(*one.causes[0].parameters, centre))
    found = replace(verdict("gas_loss"), explanations=(replace(one, causes=(cause,)),))
    assert marks_of(scored(found)).covered == (("gas_loss.size", True),)


def test_interval_of_95_percent_becomes_one_of_90() -> None:
    """The truth, 0.1, lies at 1.8 standard deviations: within the 95 % interval, outside of that of 90 %."""
    sigma = 0.01
    centre = 0.1 + 1.8 * sigma
    found = verdict("gas_loss", low=centre - 1.959964 * sigma, high=centre + 1.959964 * sigma)
    assert found.explanations[0].causes[0].parameters[0].low < 0.1
    assert marks_of(scored(found)).covered == (("gas_loss.size", False),)


def test_second_in_a_set_is_in_the_set_but_not_first() -> None:
    marks = marks_of(single(explanation(WARM, probability=0.6), explanation(LOSS, probability=0.4)))
    assert not marks.first
    assert marks.in_set
    assert marks.probability == 0.6


def test_spurious_companion_is_not_right() -> None:
    marks = marks_of(single(explanation(LOSS, COULOMB)))
    assert not marks.first
    assert not marks.in_set
    assert marks.all_there


def messy(*findings: tuple[Name, ...]) -> Outcome:
    """Return a messy arm in which the gas leaks and joint 2 has a friction of its own."""
    groups = tuple(FoundGroup(tuple((name, 1 / len(names)) for name in names), 1.0) for names in findings)
    named = explanation(*(names[0] for names in findings))
    one = outcome("single", truth(LOSS), Answer("several causes", (named,), findings=groups))
    return replace(one, others=truth(COULOMB))


OFFSET: Name = ("torque_offset", "joint 2")


def test_a_finding_may_leave_its_name_open() -> None:
    marks = marks_of(messy((LOSS,), (OFFSET, COULOMB)))
    assert marks.first
    assert marks.in_set
    assert not marks.false
    assert marks.names == ((1.0, True), (0.5, False), (0.5, True))


def test_a_finding_of_nothing_that_acts_is_wrong() -> None:
    marks = marks_of(messy((LOSS,), (OFFSET,)))
    assert not marks.first
    assert not marks.in_set
    assert marks.false


def test_the_hidden_cause_among_the_names_of_the_first_finding_is_in_the_set() -> None:
    marks = marks_of(messy((WARM, LOSS), (COULOMB,)))
    assert not marks.first
    assert marks.in_set


def test_listed_effect_called_unlisted_is_not_right() -> None:
    called = replace(verdict("gas_loss"), kind="unlisted cause", unlisted=Unlisted("joint 4", "gear angle", "load"))
    marks = marks_of(scored(called))
    assert marks.unlisted
    assert marks.found
    assert not marks.first
    assert marks.probability is None


def test_failure_finds_nothing() -> None:
    marks = marks_of(outcome("single", truth(LOSS), Answer("failed", failure="no balance")))
    assert not marks.found
    assert not marks.in_set


@pytest.mark.parametrize(
    ("effect", "place", "said", "is_right"),
    [
        ("detent", "joint 3", "joint 3", True),
        ("cubic_current", "joint 3", "drive 3", True),
        ("detent", "joint 3", "joint 2", False),
        ("creeping_bracket", "robot", "reflector 1", True),
        ("creeping_bracket", "robot", "joint 2", False),
    ],
)
def test_place_of_what_is_not_listed(effect: str, place: str, said: str, is_right: bool | None) -> None:
    marks = marks_of(outcome("unlisted", truth((effect, place)), Answer("unlisted cause", unlisted=said)))
    assert marks.unlisted
    assert marks.place is is_right


def test_blaming_a_listed_cause_for_what_is_not_listed_is_noticed() -> None:
    marks = marks_of(outcome("unlisted", truth(("detent", "joint 3")), Answer("cause", (explanation(LOSS),))))
    assert not marks.unlisted
    assert not marks.first


def test_pair_needs_both_in_one_explanation() -> None:
    both = truth(LOSS, COULOMB)
    together = Answer("several causes", (explanation(LOSS, COULOMB),))
    apart = Answer("cause", (explanation(LOSS), explanation(COULOMB)))
    assert marks_of(outcome("pair", both, together)).all_there
    assert not marks_of(outcome("pair", both, apart)).all_there


def test_twins_together_or_apart() -> None:
    together = Answer("cause", (explanation(WARM), explanation(LOSS)))
    apart = Answer("cause", (explanation(LOSS),))
    wrong = Answer("cause", (explanation(WARM),))

    def is_right(answer: Answer, is_split: bool) -> bool:
        return twin_is_right(outcome("twin", truth(LOSS), answer, WARM, is_split))

    assert is_right(together, is_split=False)
    assert is_right(apart, is_split=True)
    assert not is_right(together, is_split=True)
    assert not is_right(apart, is_split=False)
    assert not is_right(wrong, is_split=True)


def test_twins_are_together_where_they_are_names_of_one_finding() -> None:
    names = ((LOSS, 0.9), (WARM, 0.1))
    answer = Answer("cause", (explanation(LOSS),), findings=(FoundGroup(names, 1.0),))
    assert twin_is_right(outcome("twin", truth(LOSS), answer, WARM, is_split=False))
    assert not twin_is_right(outcome("twin", truth(LOSS), answer, WARM, is_split=True))


def test_outcome_goes_to_a_line_and_back() -> None:
    one = single(explanation(LOSS))
    line = one.as_json()
    assert "\n" not in line
    assert Outcome.from_json(line) == one
    with pytest.raises(ValueError, match="EOF"):
        Outcome.from_json(line[: len(line) // 2])
