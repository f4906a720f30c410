"""The numbers of a study of several recordings, each beside its goal."""

from collections.abc import Sequence
from dataclasses import dataclass

from bench.study.several import JointAnswer, SeveralOutcome
from bench.study.shares import Share

NARROW, WIDE = 0.85, 0.95  # declared: of 90 % intervals, as many hold (issue 16, and that of single diagnoses)


@dataclass(frozen=True)
class SeveralGoal:
    """One number of the study.

    Attributes:
        name: In words.
        goal: In words; "" where none is set.
        share: As measured.
        is_met: Whether the share itself is on the right side of the goal; None without one.
    """

    name: str
    goal: str
    share: Share
    is_met: bool | None


def several_goals(outcomes: Sequence[SeveralOutcome]) -> tuple[SeveralGoal, ...]:
    """Return every number of a study of several recordings (issue 16)."""
    joint = [(one.kind, one.joint) for one in outcomes if one.joint]
    of_machine = [answer for kind, answer in joint if kind == "machine"]
    in_one = [answer for kind, answer in joint if kind == "one"]
    answers = [answer for _, answer in joint]
    findings = [finding for answer in answers for finding in answer.findings]
    promised = sum(answer.promised for answer in answers)
    broken = sum(answer.more + answer.less for answer in answers)
    changed = [one.change for one in outcomes if one.kind == "changed" and one.change]
    unchanged = [one.change for one in outcomes if one.kind == "unchanged" and one.change]
    seen = [one for one in changed if one.times >= 1]
    visible = [one for one in changed if one.is_visible]
    return (
        _at_least("causes of the machine named as the machine's", 0.9, [one.is_right for one in of_machine]),
        _at_least(
            "of these, confirmed by two recordings at least",
            0.9,
            [_confirmed(one) >= 2 for one in of_machine if one.is_right],
        ),
        _none("causes of one recording called the machine's", [one.is_called_machines for one in in_one]),
        _measured("causes of one recording named in that recording", [one.is_right for one in in_one]),
        _at_most("findings of nothing that acts", 0.03, [not one.acts for one in findings]),
        _covers("promised 90 % intervals of the last recording that hold", promised - broken, promised),
        _at_most("unchanged machines with a change named", 0.01, [one.is_named for one in unchanged]),
        _at_least(
            "changes at a quarter of the absolute limit: right first", 0.9, [one.is_among_first for one in changed]
        ),
        _measured("of these, visible to one who knows effect, place and size", [one.is_visible for one in changed]),
        _at_least("of visible ones: right first", 0.9, [one.is_among_first for one in visible]),
        _measured("of visible ones: right cause in the set", [one.is_in_set for one in visible]),
        _at_least(
            "of those that the comparison says it would find: right first",
            0.9,
            [one.is_among_first for one in seen],
        ),
        _measured("of those that it says it would find: right cause in the set", [one.is_in_set for one in seen]),
        _none("without an answer", [bool(one.failure) for one in outcomes]),
    )


def _confirmed(answer: JointAnswer) -> int:
    assert answer.cause
    return max(finding.confirmed_by for finding in answer.findings if answer.cause in finding.names)


def _at_least(name: str, goal: float, hits: Sequence[bool]) -> SeveralGoal:
    share = Share(sum(hits), len(hits))
    return SeveralGoal(name, f"at least {100 * goal:.0f} %", share, share.value >= goal if hits else None)


def _covers(name: str, hits: int, of: int) -> SeveralGoal:
    """Return the coverage of 90 % intervals: too many that hold are intervals too wide."""
    share = Share(hits, of)
    return SeveralGoal(
        name, f"{100 * NARROW:.0f} to {100 * WIDE:.0f} %", share, NARROW <= share.value <= WIDE if of else None
    )


def _at_most(name: str, goal: float, hits: Sequence[bool]) -> SeveralGoal:
    share = Share(sum(hits), len(hits))
    return SeveralGoal(name, f"at most {100 * goal:.0f} %", share, share.value <= goal if hits else None)


def _none(name: str, hits: Sequence[bool]) -> SeveralGoal:
    return SeveralGoal(name, "none", Share(sum(hits), len(hits)), not any(hits) if hits else None)


def _measured(name: str, hits: Sequence[bool]) -> SeveralGoal:
    return SeveralGoal(name, "", Share(sum(hits), len(hits)), None)
