"""The numbers of a whole study, each beside its goal and with its interval."""

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from bench.study.outcome import Outcome
from bench.study.score import Marks, marks_of, twin_is_right
from bench.study.shares import TAIL, Mean, Share

EDGES = (0.0, 0.5, 0.7, 0.9, 0.97, 1.0)  # of the bins of probabilities
NOISE_FLOORS = 1.2
SECONDS = 60.0
CORES = 2  # on which the goal for a diagnosis is stated
AT_THREE_LIMITS = "three limits"


@dataclass(frozen=True)
class Goal:
    """One line of the table of goals.

    Attributes:
        name: What is counted.
        goal: In words.
        measured: A share or a mean.
        met: Whether the measured value reaches the goal; None where nothing was measured.
    """

    name: str
    goal: str
    measured: Share | Mean
    met: bool | None


@dataclass(frozen=True)
class Bin:
    """Verdicts of similar probability.

    Attributes:
        low, high: Probabilities from above `low` to `high`.
        said: Their mean probability.
        right: How many were.
    """

    low: float
    high: float
    said: float
    right: Share

    @property
    def is_calibrated(self) -> bool:
        """Whether what was said fits how many were right; chance spoils it for some bin in 1 of 20 studies."""
        low, high = self.right.interval_at(TAIL / (len(EDGES) - 1))
        return low <= self.said <= high


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
    """Everything that a study says."""

    goals: tuple[Goal, ...]
    bins: tuple[Bin, ...]
    effects: tuple[OfEffect, ...]
    misses: tuple[tuple[str, str], ...]


Marked = Sequence[tuple[Outcome, Marks]]


def scores_of(outcomes: Iterable[Outcome]) -> Scores:
    """Return the numbers of a study."""
    marked = [(outcome, marks_of(outcome)) for outcome in outcomes]
    goals = tuple(_goals(marked))
    singles = _of_kind(marked, "single")
    names = dict.fromkeys(o.truth[0].effect for o, _ in singles)
    effects = tuple(_of_effect(name, [(o, m) for o, m in singles if o.truth[0].effect == name]) for name in names)
    misses = tuple((o.name, words_of(o)) for o, m in marked if is_miss(o, m))
    return Scores(goals, bins_of(marked), effects, misses)


def is_miss(outcome: Outcome, marks: Marks) -> bool:
    """Whether an answer is wrong; an effect that is below its detection limit may be missed."""
    match outcome.kind:
        case "null":
            return marks.found or outcome.answer.kind == "failed"
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


def bins_of(marked: Marked) -> tuple[Bin, ...]:
    """Return how probabilities of named causes came true, over all campaigns that were given one."""
    given = [(m.probability, m.first) for _, m in marked if m.probability is not None]
    found = []
    for low, high in pairwise(EDGES):
        here = [(p, right) for p, right in given if low < p <= high]
        if here:
            said = float(np.mean([p for p, _ in here]))
            found.append(Bin(low, high, said, Share(sum(right for _, right in here), len(here))))
    return tuple(found)


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


def _goals(marked: Marked) -> Iterable[Goal]:
    nulls, singles = _of_kind(marked, "null"), _of_kind(marked, "single")
    at_limit = [(o, m) for o, m in singles if _times_limit(o) > 2.99 and o.size == AT_THREE_LIMITS]
    found = [(o, m) for o, m in singles if m.found]
    unlisted, pairs, twins = (_of_kind(marked, kind) for kind in ("unlisted", "pair", "twin"))
    together, apart = ([pair for pair in twins if pair[0].is_split is split] for split in (False, True))
    placed = [(o, m) for o, m in unlisted if m.place is not None]
    covered = [is_in for _, m in singles for _, is_in in m.covered]
    errors = [o.answer.held_out for o, m in singles if m.in_set and o.answer.held_out is not None]
    seconds = [o.diagnose_s for o, _ in marked]
    bins = bins_of(marked)
    calibrated = Share(sum(b.is_calibrated for b in bins), len(bins))
    yield _share("false alarms on null data", nulls, lambda o, m: m.found, at_most=0.01)
    yield _share("effect found at three times its detection limit", at_limit, lambda o, m: m.found, at_least=0.95)
    yield _share("right cause first, of single effects found", found, lambda o, m: m.first, at_least=0.90)
    yield _share("right cause in the named set, of single effects found", found, lambda o, m: m.in_set, at_least=0.99)
    yield _share("unlisted cause called unlisted", unlisted, lambda o, m: m.unlisted, at_least=0.95)
    yield _share("its place right, where it has one", placed, lambda o, m: bool(m.place), at_least=0.90)
    yield _share("both of two effects named together", pairs, lambda o, m: m.all_there, at_least=0.80)
    coverage = Share(sum(covered), len(covered))
    yield Goal(
        "90 % intervals that have the truth",
        "85 to 95 %",
        coverage,
        0.85 <= coverage.value <= 0.95 if covered else None,
    )
    yield Goal(
        "bins of probabilities that came true", "all", calibrated, calibrated.hits == calibrated.of if bins else None
    )
    error, time = Mean.over(errors), Mean.over(seconds)
    yield Goal(
        "held-out error over noise floor, of right causes",
        f"<= {NOISE_FLOORS:g}",
        error,
        error.value <= NOISE_FLOORS if errors else None,
    )
    yield Goal(
        "seconds for a diagnosis, on one core, signatures known",
        f"<= {SECONDS:g} on {CORES}",
        time,
        time.largest <= CORES * SECONDS if seconds else None,
    )
    yield _share("twins named together in an ordinary session", together, lambda o, m: twin_is_right(o), at_least=1.0)
    yield _share("twins told apart with what splits them", apart, lambda o, m: twin_is_right(o), at_least=1.0)


def _times_limit(outcome: Outcome) -> float:
    return min((c.size / c.limit if c.limit else 0.0 for c in outcome.truth), default=0.0)


def _share(
    name: str,
    marked: Marked,
    is_hit: Callable[[Outcome, Marks], bool],
    at_least: float | None = None,
    at_most: float | None = None,
) -> Goal:
    share = Share(sum(is_hit(o, m) for o, m in marked), len(marked))
    if at_most is not None:
        return Goal(name, f"<= {100 * at_most:g} %", share, share.value <= at_most if share.of else None)
    assert at_least is not None
    return Goal(name, f">= {100 * at_least:g} %", share, share.value >= at_least if share.of else None)


def _of_kind(marked: Marked, kind: str) -> Marked:
    return [(outcome, marks) for outcome, marks in marked if outcome.kind == kind]


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
