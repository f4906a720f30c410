"""Name: from evidence to a cause, a set of causes, several causes, or the word that it is none that is listed."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from typing import Literal

import numpy as np

from bench.diagnose.candidates import Cause
from bench.diagnose.design import Design
from bench.diagnose.generic import Block
from bench.diagnose.refit import Fit, pseudo_residual, refit
from bench.diagnose.screening import Entry, Screening, rescreen
from bench.errors import BenchError

Kind = Literal["nothing found", "cause", "several causes", "unlisted cause"]
FINALISTS = 6  # causes that are fitted by simulation
PAIRED = 40  # causes whose pairs are all tried in the linear picture
PAIR_FINALISTS = 4
MOST_CAUSES = 6
IN_REACH = 12.0  # log evidence behind the best, from where on a cause is not worth a simulation
IN_SET = 6.0  # log evidence behind the best, up to where a cause is not told apart from it (odds of 400)
# What a fitted effect may leave unexplained of what it explains: effects are not simulated better than that.
UNEXPLAINED = 0.02


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """One explanation that was fitted by simulation.

    Attributes:
        fit: With its parameters.
        log_evidence: Against the nominal model.
        probability: Among all explanations of as many causes, and nothing else.
    """

    fit: Fit
    log_evidence: float
    probability: float

    @property
    def causes(self) -> tuple[Cause, ...]:
        """Its causes."""
        return self.fit.causes


@dataclass(frozen=True, eq=False)
class Naming:
    """What the data say.

    Attributes:
        kind: In a word.
        hypotheses: Fitted explanations by falling evidence; empty for nothing found.
        unlisted: The free shape that explains what no listed cause can, or None.
        null: Fit of the nominal model.
        screening: Everything that was tried against the nominal model.
        leftover: Everything that was tried against the best explanation.
        not_simulated: Causes whose model found no balance.
    """

    kind: Kind
    hypotheses: tuple[Hypothesis, ...]
    unlisted: Block | None
    null: Fit
    screening: Screening
    leftover: Screening
    not_simulated: tuple[str, ...] = field(default=())

    @property
    def alternatives(self) -> tuple[Hypothesis, ...]:
        """Explanations that these data cannot tell from the best, the best first."""
        if not self.hypotheses:
            return ()
        best = self.hypotheses[0].log_evidence
        return tuple(h for h in self.hypotheses if h.log_evidence > best - IN_SET)


def name_cause(design: Design, screening: Screening, progress: Callable[[str], None] = lambda words: None) -> Naming:
    """Name what is wrong with the nominal model.

    Args:
        design: The campaign.
        screening: Everything that was tried in the linear picture.
        progress: Called with what is done next.
    """
    null = refit(design, (), {}, screening.marginal.scale)
    if screening.entries[0].log_evidence <= screening.threshold:
        return Naming("nothing found", (), None, null, screening, screening)
    progress("single causes")
    current = _singles(design, screening, null)
    leftover = _leftover(design, screening, current[0].fit) if current else screening
    found = max([h.log_evidence for h in current[:1]] + [entry.log_evidence for entry in screening.free[:1]])
    if found <= screening.threshold:  # what the linear picture promised, the simulation did not keep
        return Naming("nothing found", (), None, null, screening, screening)
    n_causes = 1
    while current and not _is_enough(leftover, screening, current[0].log_evidence) and n_causes < MOST_CAUSES:
        progress(f"{n_causes + 1} causes")
        more = _with_one_more(design, screening, null, current, leftover, n_causes)
        if not more or more[0].log_evidence < current[0].log_evidence + screening.threshold:
            break
        current, n_causes = more, n_causes + 1
        leftover = _leftover(design, screening, current[0].fit)
    unlisted = _unlisted(screening, leftover, current)
    if unlisted is not None:
        block, kept = unlisted
        return Naming("unlisted cause", kept, block, null, screening, leftover)
    kind: Kind = "cause" if n_causes == 1 else "several causes"
    return Naming(kind, current, None, null, screening, leftover)


def _singles(design: Design, screening: Screening, null: Fit) -> tuple[Hypothesis, ...]:
    listed = screening.listed
    if not listed or listed[0].log_evidence <= screening.threshold / 2:
        return ()
    chosen = [e for e in listed[:FINALISTS] if e.log_evidence > listed[0].log_evidence - IN_REACH]
    return _fitted(design, screening, null, [(entry,) for entry in chosen], [e.log_evidence for e in chosen])


def _with_one_more(
    design: Design,
    screening: Screening,
    null: Fit,
    current: Sequence[Hypothesis],
    leftover: Screening,
    n_causes: int,
) -> tuple[Hypothesis, ...]:
    """Return explanations with one cause more: for a pair all pairs are tried, beyond that the best is extended."""
    best = {entry.cause.key: entry for entry in screening.listed if entry.cause}
    trials: dict[frozenset[tuple[str, str]], tuple[tuple[Entry, ...], float]] = {}
    if n_causes == 1:
        promising = list(screening.listed[:PAIRED])
        promising += [best[e.cause.key] for e in leftover.listed[:PAIRED] if e.cause and e.cause.key in best]
        unique = list({entry.cause.key: entry for entry in promising if entry.cause}.values())
        for pair in combinations(unique, 2):
            columns = np.concatenate([entry.columns for entry in pair])
            prior = np.concatenate([entry.prior for entry in pair])
            keys = frozenset(entry.cause.key for entry in pair if entry.cause)
            trials[keys] = (pair, screening.marginal.log_evidence(columns, prior))
    for hypothesis in current[:2]:
        base = [best[cause.key] for cause in hypothesis.causes]
        for entry in leftover.listed[:PAIR_FINALISTS]:
            assert entry.cause
            keys = frozenset([cause.key for cause in hypothesis.causes] + [entry.cause.key])
            if len(keys) == n_causes + 1 and hypothesis is current[0]:
                worth = hypothesis.log_evidence + entry.log_evidence
                trials[keys] = ((*base, entry), max(worth, trials.get(keys, ((), -np.inf))[1]))
    ranked = sorted(trials.values(), key=lambda trial: -trial[1])
    ranked = [trial for trial in ranked if trial[1] > ranked[0][1] - IN_REACH][:PAIR_FINALISTS]
    return _fitted(design, screening, null, [trial[0] for trial in ranked], [trial[1] for trial in ranked])


def _fitted(
    design: Design,
    screening: Screening,
    null: Fit,
    trials: Sequence[tuple[Entry, ...]],
    linear: Sequence[float],
) -> tuple[Hypothesis, ...]:
    fits: list[Fit] = []
    for entries in trials:
        causes = tuple(entry.cause for entry in entries if entry.cause)
        start: dict[tuple[str, str, str], float] = {}
        for entry in entries:
            start |= screening.sizes_of(entry)
        try:
            fits.append(refit(design, causes, start, screening.marginal.scale))
        except BenchError:
            continue
    evidence = [fit.log_evidence - null.log_evidence for fit in fits]
    weights = np.exp(np.array(evidence) - max(evidence)) if evidence else np.array([])
    found = [
        Hypothesis(fit, value, float(weight / weights.sum()))
        for fit, value, weight in zip(fits, evidence, weights, strict=True)
    ]
    return tuple(sorted(found, key=lambda h: -h.log_evidence))


def _leftover(design: Design, screening: Screening, fit: Fit) -> Screening:
    sigma = np.array([unknown.sigma for unknown in fit.unknowns])
    return rescreen(design, screening, pseudo_residual(design, fit), design.whiten(fit.slopes), sigma)


def _is_enough(leftover: Screening, screening: Screening, explained: float) -> bool:
    """Whether an explanation leaves nothing that chance and imperfect simulation of it would not leave."""
    limit = max(screening.threshold, UNEXPLAINED * explained)
    return leftover.entries[0].log_evidence <= limit


def _unlisted(
    screening: Screening, leftover: Screening, current: Sequence[Hypothesis]
) -> tuple[Block, tuple[Hypothesis, ...]] | None:
    """Return the free shape that is needed, and the listed causes that are still needed beside it."""
    explained = current[0].log_evidence if current else 0.0
    free = leftover.free
    limit = max(screening.threshold, UNEXPLAINED * explained)
    if current and (not free or free[0].log_evidence <= limit):
        return None
    alone = screening.free[0]
    assert isinstance(alone.what, Block)
    if not current or alone.log_evidence >= explained:
        # the free shape explains all that the listed causes did
        return alone.what, ()
    assert isinstance(free[0].what, Block)
    return free[0].what, tuple(current)
