"""Hold one answer against the truth: was anything found, is it the right cause, and what else is right about it."""

from dataclasses import dataclass

from bench.effects.effect import WHOLE
from bench.study.outcome import Named, Outcome

NORMAL_90 = 1.644854
NOTHING = "nothing found"
AT = {"creeping_bracket": "reflector 1"}  # unlisted effects of the whole robot: where they are to be found


@dataclass(frozen=True)
class Marks:
    """What is right about one answer.

    Attributes:
        found: Something was found, whatever it was.
        first: The likeliest explanation is the truth, nothing more and nothing less, and nothing is called unlisted.
        in_set: So is one of those that cannot be told apart.
        all_there: Every true cause is among those of one explanation, whatever stands beside.
        unlisted: The answer is that the cause is not listed.
        place: An unlisted cause was found where it acts; None where it acts at no place or was not found.
        probability: Given to the likeliest explanation; None where none was given or something is unlisted beside it.
        covered: (parameter, whether its 90 % interval has the truth) where the truth is in the set.
    """

    found: bool
    first: bool
    in_set: bool
    all_there: bool
    unlisted: bool
    place: bool | None
    probability: float | None
    covered: tuple[tuple[str, bool], ...]


def marks_of(outcome: Outcome) -> Marks:
    """Return the marks of an answer."""
    answer, truth = outcome.answer, frozenset(cause.name for cause in outcome.truth)
    is_listed = answer.unlisted is None and answer.kind in ("cause", "several causes")
    named = answer.explanations if is_listed else ()
    right = [explanation for explanation in named if explanation.names == truth]
    return Marks(
        found=answer.kind not in (NOTHING, "failed"),
        first=bool(right) and named[0] is right[0],
        in_set=bool(right),
        all_there=any(truth <= explanation.names for explanation in answer.explanations),
        unlisted=answer.unlisted is not None,
        place=_is_place_right(outcome),
        probability=named[0].probability if named else None,
        covered=tuple(_covered(outcome, right[0])) if right else (),
    )


def twin_is_right(outcome: Outcome) -> bool:
    """Whether a twin came back as a set with its like, or, where it can be told apart, without it."""
    assert outcome.twin is not None
    sets = [explanation.names for explanation in outcome.answer.explanations]
    truth, other = frozenset(cause.name for cause in outcome.truth), frozenset([outcome.twin])
    return outcome.answer.unlisted is None and truth in sets and (other in sets) != outcome.is_split


def _is_place_right(outcome: Outcome) -> bool | None:
    """Whether an unlisted cause was found where it acts; its place may be a joint, a drive or a reflector."""
    if outcome.kind != "unlisted" or outcome.answer.unlisted is None:
        return None
    (cause,) = outcome.truth
    if cause.effect in AT:
        return outcome.answer.unlisted == AT[cause.effect]
    if cause.place == str(WHOLE):
        return None
    return outcome.answer.unlisted in (cause.place, cause.place.replace("joint", "drive"))


def _covered(outcome: Outcome, explanation: Named) -> list[tuple[str, bool]]:
    """Return for every fitted parameter whether the truth lies in its 90 % interval."""
    true = {cause.name: cause.values for cause in outcome.truth}
    return [
        (f"{cause.effect}.{name}", abs(true[cause.name][name] - found.value) <= NORMAL_90 * found.sigma)
        for cause in explanation.causes
        for name, found in cause.values.items()
    ]
