"""Hold one answer against the truth: was anything found, is it the right cause, and what else is right about it."""

from collections.abc import Iterator
from dataclasses import dataclass

from bench.effects.effect import WHOLE
from bench.study.outcome import Name, Named, Outcome

NORMAL_90 = 1.644854
NOTHING = "nothing found"
AT = {"creeping_bracket": "reflector 1"}  # unlisted effects of the whole robot: where they are to be found


@dataclass(frozen=True)
class Marks:
    """What is right about one answer.

    An explanation is right if what was hidden stands first in it and every other finding is of something that acts: its
    name, or one of those that are given as open. Where nothing acts beside it, that is the truth, nothing more and
    nothing less.

    Attributes:
        found: Something was found, whatever it was.
        false: A finding is of nothing that acts, or called unlisted; counted where nothing was hidden.
        first: The likeliest explanation is right, and nothing is called unlisted.
        in_set: So is one of those that cannot be told apart.
        all_there: Every true cause is among those of one explanation, whatever stands beside.
        unlisted: The answer is that the cause is not listed.
        place: An unlisted cause was found where it acts; None where it acts at no place or was not found.
        probability: Given to the likeliest explanation; None where none was given or something is unlisted beside it.
        names: (probability, whether it acts) of every name of every finding.
        deviations: (parameter, truth less value over sigma) of every true cause, of the likeliest explanation with it.
    """

    found: bool
    false: bool
    first: bool
    in_set: bool
    all_there: bool
    unlisted: bool
    place: bool | None
    probability: float | None
    names: tuple[tuple[float, bool], ...]
    deviations: tuple[tuple[str, float], ...]

    @property
    def covered(self) -> tuple[tuple[str, bool], ...]:
        """(parameter, whether its 90 % interval has the truth)."""
        return tuple((name, abs(x) <= NORMAL_90) for name, x in self.deviations)


def marks_of(outcome: Outcome) -> Marks:
    """Return the marks of an answer."""
    answer, truth = outcome.answer, frozenset(cause.name for cause in outcome.truth)
    there = truth | {cause.name for cause in outcome.others}
    is_listed = answer.unlisted is None and answer.kind in ("cause", "several causes")
    named = answer.explanations if is_listed else ()
    found = answer.kind not in (NOTHING, "failed")
    return Marks(
        found=found,
        false=found and not (named and named[0].names <= there | _open(outcome)),
        first=bool(named) and is_right(outcome, named[0]),
        in_set=any(is_right(outcome, explanation) for explanation in named) or (is_listed and _is_among(outcome)),
        all_there=any(truth <= explanation.names for explanation in answer.explanations),
        unlisted=answer.unlisted is not None,
        place=_is_place_right(outcome),
        probability=named[0].probability if named else None,
        names=tuple((share, name in there) for group in answer.findings for name, share in group.names),
        deviations=tuple(_deviations(outcome)),
    )


def is_right(outcome: Outcome, explanation: Named) -> bool:
    """Whether what was hidden stands first in an explanation, and every other finding is of something that acts."""
    truth = frozenset(cause.name for cause in outcome.truth)
    first = frozenset(cause.name for cause in explanation.causes[: len(truth)])
    acting = truth | {cause.name for cause in outcome.others}
    return first == truth and explanation.names <= acting | _open(outcome)


def _open(outcome: Outcome) -> frozenset[Name]:
    """Return the names of findings that give a name of something that acts as well."""
    acting = {cause.name for cause in (*outcome.truth, *outcome.others)}
    groups = [frozenset(name for name, _ in group.names) for group in outcome.answer.findings]
    return frozenset(name for names in groups if names & acting for name in names)


def _is_among(outcome: Outcome) -> bool:
    """Whether every true cause is a name of a finding, and every finding has a name of something that acts."""
    acting = {cause.name for cause in (*outcome.truth, *outcome.others)}
    groups = [frozenset(name for name, _ in group.names) for group in outcome.answer.findings]
    hidden = all(any(cause.name in names for names in groups) for cause in outcome.truth)
    return bool(groups) and hidden and all(names & acting for names in groups)


def twin_is_right(outcome: Outcome) -> bool:
    """Whether a twin came back as a set with its like, or, where it can be told apart, without it."""
    assert outcome.twin is not None
    (truth,) = (cause.name for cause in outcome.truth)
    sets = [frozenset(name for name, _ in group.names) for group in outcome.answer.findings]
    sets.append(frozenset(e.causes[0].name for e in outcome.answer.explanations if len(e.causes) == 1))
    mine = [names for names in sets if truth in names]
    is_together = any(outcome.twin in names for names in mine)
    return outcome.answer.unlisted is None and bool(mine) and is_together != outcome.is_split


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


def _deviations(outcome: Outcome) -> Iterator[tuple[str, float]]:
    """Yield for every fitted parameter of a true cause how far the truth is from it, in its standard deviations.

    A cause that several explanations name counts once, as the likeliest of them has it. Quotients of
    parameters do not count beside these.
    """
    true = {cause.name: cause.values for cause in (*outcome.truth, *outcome.others)}
    seen: set[tuple[str, str]] = set()
    for explanation in outcome.answer.explanations:
        for cause in explanation.causes:
            if cause.name in true and cause.name not in seen:
                seen.add(cause.name)
                for name, found in cause.values.items():
                    if found.sigma > 0 and name in true[cause.name]:
                        yield f"{cause.effect}.{name}", (true[cause.name][name] - found.value) / found.sigma
