"""Whether what verdicts state of their certainty is true: ranks of the truth, and a set of explanations that holds."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, inf

import numpy as np
from scipy.stats import chisquare, norm

from bench.study.outcome import Named, Outcome
from bench.study.score import Marks, is_right
from bench.study.shares import Share

BINS = 10  # of ranks, issue 15
HELD = 0.99  # of the sets are to have the truth, issue 15

Marked = Sequence[tuple[Outcome, Marks]]


@dataclass(frozen=True)
class Ranks:
    """Where the truth ranks among what verdicts state (simulation-based calibration, Talts et al., 2018).

    The rank is the probability that the stated normal distribution gives to values below the truth; if what is stated
    is right, ranks are uniform.

    Attributes:
        effect: Of which parameters; "all".
        counts: Ranks in ten equal bins, from 0 to 1.
        p: Probability of counts that are less even, by Pearson's chi-square: of few values a rough one.
    """

    effect: str
    counts: tuple[int, ...]
    p: float


def ranks_of(marked: Marked) -> tuple[Ranks, ...]:
    """Return the ranks of all parameters of true causes that were named, all together first, then by effect."""
    found: dict[str, list[float]] = defaultdict(list)
    for _, marks in marked:
        for name, deviation in marks.deviations:
            found["all"].append(deviation)
            found[name.split(".")[0]].append(deviation)
    return tuple(_ranks(name, deviations) for name, deviations in found.items())


def _ranks(effect: str, deviations: list[float]) -> Ranks:
    counts, _ = np.histogram(norm.cdf(deviations), BINS, (0.0, 1.0))
    return Ranks(effect, tuple(int(count) for count in counts), float(chisquare(counts).pvalue))


@dataclass(frozen=True)
class Margin:
    """How much less evidence than the best an explanation may have and still has to be named.

    It is the least margin with which the sets of one half of the campaigns have the truth in 99 % of the cases, by the
    rule of conformal prediction (Vovk, Gammerman and Shafer, 2005), and is tried on the other half.

    Attributes:
        nats: The margin; of fewer than 99 campaigns the largest that any asks for. inf: the truth was not even weighed.
        learned_from: Campaigns in the first half.
        held: How many sets of the second half have the truth with it.
        size: Mean number of explanations in these.
        given: How many sets of the second half have the truth as they were given.
    """

    nats: float
    learned_from: int
    held: Share
    size: float
    given: Share


def margin_of(marked: Marked) -> Margin | None:
    """Return the margin of listed effects that were found; None where there are fewer than two.

    Args:
        marked: Campaigns; every other one is learned from.
    """
    rows = [(o, m) for o, m in marked if o.kind in ("single", "pair") and _weighed(o)]
    first, second = rows[::2], rows[1::2]
    if not second:
        return None
    behind = sorted(_shortfall(o) for o, _ in first)
    rank = ceil((len(behind) + 1) * HELD)
    nats = behind[rank - 1] if rank <= len(behind) else behind[-1]
    sizes = [sum(_best(o) - evidence <= nats for evidence, _ in _weighed(o)) for o, _ in second]
    held = Share(sum(_shortfall(o) <= nats < inf for o, _ in second), len(second))
    return Margin(nats, len(first), held, float(np.mean(sizes)), Share(sum(m.in_set for _, m in second), len(second)))


def _weighed(outcome: Outcome) -> list[tuple[float, Named]]:
    """Return every explanation whose evidence is known, with it."""
    every = (*outcome.answer.explanations, *outcome.answer.rivals)
    return [(one.log_evidence, one) for one in every if one.log_evidence is not None]


def _best(outcome: Outcome) -> float:
    return max(evidence for evidence, _ in _weighed(outcome))


def _shortfall(outcome: Outcome) -> float:
    """Return by how much the truth has less evidence than the best explanation; inf where it was not weighed."""
    true = [evidence for evidence, one in _weighed(outcome) if is_right(outcome, one)]
    return _best(outcome) - max(true) if true else inf
