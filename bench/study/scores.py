"""The numbers of a whole study, each beside its goal and with its interval."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

from bench.study.calibration import Margin, Ranks, margin_of, ranks_of
from bench.study.goals import Bin, Goal, Marked, bins_of, goals_of, of_kind
from bench.study.outcome import Outcome
from bench.study.score import Marks, marks_of, twin_is_right
from bench.study.shares import Share


@dataclass(frozen=True)
class OfEffect:
    """How one single effect fared; `taken_for` counts other answers, the most frequent first."""

    effect: str
    found: Share
    first: Share
    in_set: Share
    taken_for: tuple[tuple[str, int], ...]


@dataclass(frozen=True)
class Scores:
    """Everything that a study says.

    Attributes:
        goals: Of all campaigns.
        bins: Of the probabilities that verdicts give.
        effects: One by one.
        misses: Wrong answers: campaign, and truth and answer in words.
        worlds: The goals of each world, where there are several.
        ranks: Of the truth among what verdicts say, all together and by effect.
        margin: Of evidence, within which an explanation has to be named; None where nothing can be learned.
    """

    goals: tuple[Goal, ...]
    bins: tuple[Bin, ...]
    effects: tuple[OfEffect, ...]
    misses: tuple[tuple[str, str], ...]
    worlds: tuple[tuple[str, tuple[Goal, ...]], ...]
    ranks: tuple[Ranks, ...]
    margin: Margin | None


def scores_of(outcomes: Iterable[Outcome]) -> Scores:
    """Return the numbers of a study."""
    marked = [(outcome, marks_of(outcome)) for outcome in outcomes]
    goals = tuple(goals_of(marked))
    singles = of_kind(marked, "single")
    names = dict.fromkeys(o.truth[0].effect for o, _ in singles)
    effects = tuple(_of_effect(name, [(o, m) for o, m in singles if o.truth[0].effect == name]) for name in names)
    misses = tuple((o.name, words_of(o)) for o, m in marked if is_miss(o, m))
    names_of_worlds = list(dict.fromkeys(o.world for o, _ in marked))
    worlds = tuple((name, tuple(goals_of([(o, m) for o, m in marked if o.world == name]))) for name in names_of_worlds)
    return Scores(
        goals,
        bins_of(marked),
        effects,
        misses,
        worlds if len(worlds) > 1 else (),
        ranks_of(marked),
        margin_of(marked),
    )


def is_miss(outcome: Outcome, marks: Marks) -> bool:
    """Whether an answer is wrong; an effect that is below its detection limit may be missed."""
    match outcome.kind:
        case "null":
            return marks.false or outcome.answer.kind == "failed"
        case "single":
            return not marks.in_set and (marks.found or is_visible(outcome))
        case "unlisted":
            return not marks.unlisted or marks.place is False
        case "pair":
            return not marks.all_there
        case "twin":
            return not twin_is_right(outcome)


def is_visible(outcome: Outcome) -> bool:
    """Whether every effect is as large as its detection limit."""
    return all(cause.limit is not None and cause.size >= cause.limit for cause in outcome.truth)


def words_of(outcome: Outcome) -> str:
    """Return truth and answer of a campaign in a line."""
    true = " with ".join(f"{c.effect} ({c.place}), {_size(c.size, c.limit)}" for c in outcome.truth) or "nothing"
    return f"{true}: {answer_words(outcome)}"


def answer_words(outcome: Outcome) -> str:
    """Return an answer in a few words."""
    answer = outcome.answer
    if answer.kind == "failed":
        return f"no verdict: {answer.failure}"
    sets = [" with ".join(f"{c.effect} ({c.place})" for c in e.causes) for e in answer.explanations]
    beside = f"unlisted at {answer.unlisted}" if answer.unlisted else ""
    return ", beside ".join(part for part in (beside, " or ".join(sets)) if part) or answer.kind


def _size(size: float, limit: float | None) -> str:
    share = f"{100 * size:.2g} % of the largest plausible size"
    return f"{share}, {size / limit:.2g} detection limits" if limit else share


def _of_effect(name: str, marked: Marked) -> OfEffect:
    found = [(o, m) for o, m in marked if m.found]
    others = Counter(_taken_for(o) for o, m in marked if not m.first)
    return OfEffect(
        name,
        Share(len(found), len(marked)),
        Share(sum(m.first for _, m in found), len(found)),
        Share(sum(m.in_set for _, m in found), len(found)),
        tuple(others.most_common(3)),
    )


def _taken_for(outcome: Outcome) -> str:
    answer = outcome.answer
    if not answer.explanations:
        return "unlisted" if answer.unlisted else answer.kind
    names = " with ".join(cause.effect for cause in answer.explanations[0].causes)
    return f"{names}, beside something unlisted" if answer.unlisted else names
