"""The goals of the diagnosis, each beside what a study measured."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import nan

import numpy as np

from bench.effects.catalogue import catalogue
from bench.study.outcome import Outcome
from bench.study.score import Marks, twin_is_right
from bench.study.shares import TAIL, Mean, Share

EDGES = (0.0, 0.5, 0.7, 0.9, 0.97, 1.0)  # of the bins of probabilities
SURE = 0.97  # probability from which on a verdict may be trusted; issue 15
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
    """Names of similar probability.

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


Marked = Sequence[tuple[Outcome, Marks]]
THREE = 2.99  # detection limits: three, but for rounding


def _both(outcome: Outcome, marks: Marks) -> bool:
    return marks.all_there


def goals_of(marked: Marked) -> Iterable[Goal]:
    """Yield the goals of a study, each with what was measured."""
    nulls, singles = of_kind(marked, "null"), of_kind(marked, "single")
    at_limit = [(o, m) for o, m in singles if _times_limit(o) > THREE and o.size == AT_THREE_LIMITS]
    found = [(o, m) for o, m in singles if m.found]
    unlisted, pairs, twins = (of_kind(marked, kind) for kind in ("unlisted", "pair", "twin"))
    together, apart = ([pair for pair in twins if pair[0].is_split is split] for split in (False, True))
    placed = [(o, m) for o, m in unlisted if m.place is not None]
    covered = [is_in for _, m in marked for _, is_in in m.covered]
    errors = [o.answer.held_out for o, m in singles if m.in_set and o.answer.held_out is not None]
    seconds = [o.diagnose_s for o, _ in marked]
    bins = bins_of(marked)
    calibrated = Share(sum(b.is_calibrated for b in bins), len(bins))
    yield _share("false alarms on null data", nulls, lambda o, m: m.false, at_most=0.01)
    yield _share("effect found at three times its detection limit", at_limit, lambda o, m: m.found, at_least=0.95)
    yield _share("right cause first, of single effects found", found, lambda o, m: m.first, at_least=0.92)
    yield _share("right cause in the named set, of single effects found", found, lambda o, m: m.in_set, at_least=0.99)
    sure = [(o, m) for o, m in marked if m.probability is not None and m.probability >= SURE and o.kind != "twin"]
    yield _share("right, of verdicts that give 0.97 or more", sure, lambda o, m: m.first, at_least=0.97)
    names = [right for o, m in marked if o.kind != "twin" for share, right in m.names if share >= SURE]
    surely = Share(sum(names), len(names))
    words = "names given 0.97 or more that are of something that acts"
    yield Goal(words, ">= 97 %", surely, surely.value >= 0.97 if names else None)
    yield _share("unlisted cause called unlisted", unlisted, lambda o, m: m.unlisted, at_least=0.95)
    yield _share("its place right, where it has one", placed, lambda o, m: bool(m.place), at_least=0.90)
    clear = [(o, m) for o, m in pairs if all(c.limit is None or c.size > THREE * c.limit for c in o.truth)]
    yield _share("both of two effects, each at three limits or more, named together", clear, _both, at_least=0.85)
    coverage = Share(sum(covered), len(covered))
    yield Goal(
        "90 % intervals that have the truth, of all true causes named",
        "85 to 95 %",
        coverage,
        0.85 <= coverage.value <= 0.95 if covered else None,
    )
    yield Goal(
        "bins of probabilities that came true", "all", calibrated, calibrated.hits == calibrated.of if bins else None
    )
    error = Mean.over(errors)
    time = replace(Mean.over(seconds), interval=(nan, nan))  # the longest counts; one of a mean would begin below zero
    yield Goal(
        "held-out error over noise floor, of right causes",
        f"<= {NOISE_FLOORS:g}",
        error,
        error.value <= NOISE_FLOORS if errors else None,
    )
    yield Goal(
        "seconds for the longest diagnosis, on one core",
        f"<= {CORES * SECONDS:g}, as {SECONDS:g} on {CORES} cores",
        time,
        time.largest <= CORES * SECONDS if seconds else None,
    )
    recorded = [(o, m) for o, m in marked if is_of_recording(o)]
    yield _share("errors of the recording named as such", recorded, lambda o, m: m.first, at_least=0.90)
    yield _share("of them, taken for something else at 0.97 or more", recorded, _is_silently_wrong, at_most=0.0)
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


def bins_of(marked: Marked) -> tuple[Bin, ...]:
    """Return how the probabilities of the names of findings came true, over all campaigns."""
    given = [name for _, m in marked for name in m.names]
    found = []
    for low, high in pairwise(EDGES):
        here = [(p, right) for p, right in given if low < p <= high]
        if here:
            said = float(np.mean([p for p, _ in here]))
            found.append(Bin(low, high, said, Share(sum(right for _, right in here), len(here))))
    return tuple(found)


def of_kind(marked: Marked, kind: str) -> Marked:
    """Return the campaigns of a kind."""
    return [(outcome, marks) for outcome, marks in marked if outcome.kind == kind]


def is_of_recording(outcome: Outcome) -> bool:
    """Whether what was hidden is an error of the recording, not of the machine."""
    known = catalogue()
    hidden = [known[cause.effect] for cause in outcome.truth if cause.effect in known]
    return any(getattr(effect, "level", "machine") != "machine" for effect in hidden)


def _is_silently_wrong(outcome: Outcome, marks: Marks) -> bool:
    return not marks.first and marks.probability is not None and marks.probability >= SURE
