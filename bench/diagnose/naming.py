"""Name: from evidence to a cause, a set of causes, several causes, or the word that it is none that is listed.

A climb from the nominal model: at each step the causes that promise most are fitted by simulation, the best one is
added if its evidence passes the threshold and if it pays on what was held out, and all that was tried is weighed anew
against the model that has it. At the end every cause has to stand against its own rivals beside the others.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Literal, Protocol

import numpy as np

from bench.diagnose.candidates import Cause
from bench.diagnose.design import Design
from bench.diagnose.generic import Block
from bench.diagnose.measure import HeldOut, held_out
from bench.diagnose.refit import Fit, Key, fit_without, polished, pseudo_residual, refit
from bench.diagnose.screening import Entry, Screening, rescreen
from bench.effects.own import EffectError
from bench.errors import BenchError
from bench.record.campaign import Array

Kind = Literal["nothing found", "cause", "several causes", "unlisted cause"]


class Renew(Protocol):
    """Returns the linear picture about a fit with everything that can be tried there, weighed anew."""

    def __call__(
        self, design: Design, fit: Fit, known: Screening, *, is_last: bool = False
    ) -> tuple[Design, Screening]:
        """Return design and screening; `is_last`: nothing will be added, what is missed now is noise."""


FINALISTS = 6  # causes that are fitted by simulation
RIVALS = 4  # causes that are tried in the place of each
PAIRED = 40  # causes whose pairs are all tried in the linear picture
PAIR_FINALISTS = 3
MOST_CAUSES = 30
MOST_REFUSED = 8
IN_REACH = 12.0  # log evidence behind the best, from where on a cause is not worth a simulation
IMPRECISE = 0.15  # of its evidence, by which the linear picture may be wrong about a strong effect
IN_SET = 6.0  # log evidence behind the best, up to where a cause is not told apart from it (odds of 400)
NEARLY = 3.0  # beyond the set, up to where derivatives are taken anew before it is decided
PROMISING = 0.5  # of the evidence that is asked for, in the linear picture
# What a fitted effect may leave unexplained of what it explains: effects are not simulated better than that.
UNEXPLAINED = 0.02
CERTAIN = 4.6  # log evidence beyond the threshold (100 to 1) that is asked for a free shape alone


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """One explanation that was fitted by simulation.

    Attributes:
        fit: With its parameters.
        log_evidence: Against the nominal model.
        probability: Among all explanations that were fitted with as many causes, and nothing else.
    """

    fit: Fit
    log_evidence: float
    probability: float = 1.0

    @property
    def causes(self) -> tuple[Cause, ...]:
        """Its causes."""
        return self.fit.causes

    @property
    def keys(self) -> frozenset[tuple[str, str]]:
        """What tells it from others."""
        return frozenset(cause.key for cause in self.causes)


@dataclass(frozen=True, eq=False)
class Rung:
    """One step of the climb, taken or refused.

    Attributes:
        added: What was added to the model before.
        replaced: It took the place of the model before, which has other causes.
        fit: With it.
        log_evidence: By how much the logarithm of the evidence rose.
        held_out: What it is worth on what was held out.
        is_taken: Whether the model keeps it.
    """

    added: tuple[Cause, ...]
    replaced: bool
    fit: Fit
    log_evidence: float
    held_out: HeldOut
    is_taken: bool


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
        rungs: The climb.
        design: The linear picture about the best explanation.
    """

    kind: Kind
    hypotheses: tuple[Hypothesis, ...]
    unlisted: Block | None
    null: Fit
    screening: Screening
    leftover: Screening
    rungs: tuple[Rung, ...]
    design: Design

    @property
    def alternatives(self) -> tuple[Hypothesis, ...]:
        """Explanations that these data cannot tell from the best, the best first."""
        if not self.hypotheses:
            return ()
        best = self.hypotheses[0].log_evidence
        return tuple(h for h in self.hypotheses if h.log_evidence > best - IN_SET)


@dataclass(frozen=True, eq=False)
class _Stage:
    """Where the climb stands: the linear picture about a model, everything weighed against it, and the model.

    `tried` are the explanations with as many causes that were fitted on the way.
    """

    design: Design
    screening: Screening
    best: Hypothesis
    tried: tuple[Hypothesis, ...] = ()

    @property
    def fit(self) -> Fit:
        return self.best.fit


def name_cause(
    design: Design,
    screening: Screening,
    renew: Renew,
    progress: Callable[[str], None] = lambda words: None,
) -> Naming:
    """Name what is wrong with the nominal model.

    Args:
        design: The campaign.
        screening: Everything that was tried in the linear picture.
        renew: Weighs everything anew about an extended model.
        progress: Called with what is done next.
    """
    null = refit(design, (), {})
    threshold = screening.threshold
    stage = _Stage(design, screening, Hypothesis(null, 0.0))
    rungs: list[Rung] = []
    refused: set[tuple[str, str]] = set()
    if screening.top <= threshold:
        return Naming("nothing found", (), None, null, screening, screening, (), design)
    while len(stage.best.causes) < MOST_CAUSES and len(refused) < MOST_REFUSED:
        limit = max(threshold, UNEXPLAINED * stage.best.log_evidence)
        if stage.screening.top <= limit:
            break
        count = len(stage.best.causes) + 1
        progress("single causes" if count == 1 else f"{count} causes")
        fits = _one_more(stage, screening, refused, limit)
        found = max(fits, key=lambda h: h.log_evidence, default=None)
        if found is None or found.log_evidence <= stage.best.log_evidence + limit:
            break
        before = stage.best.keys
        is_other = not before <= found.keys
        worth = held_out(stage.design, 1.0, null if is_other else stage.fit, found.fit)
        added = tuple(cause for cause in found.causes if is_other or cause.key not in before)
        rise = found.log_evidence - (0.0 if is_other else stage.best.log_evidence)
        rungs.append(Rung(added, is_other, found.fit, rise, worth, worth.pays))
        if not worth.pays:
            refused |= {cause.key for cause in added if cause.key not in before}
            continue
        others = tuple(h for h in fits if h is not found and len(h.causes) == len(found.causes))
        stage = _climbed(stage, found, others, renew, progress)
        refused.clear()  # what did not pay before may pay beside this
        if len(stage.best.causes) > 1 and _explains_more(stage):
            break
    block, is_alone = _unlisted(stage, threshold)
    stage = _settled(stage, renew)
    hypotheses = _among_rivals(stage, progress) if stage.best.causes else ()
    if hypotheses and hypotheses[0].keys != stage.best.keys:
        stage = _weighed(stage.design, stage.screening, hypotheses[0])
    if block is not None:
        kept = () if is_alone else hypotheses
        return Naming("unlisted cause", kept, block, null, screening, stage.screening, tuple(rungs), stage.design)
    if not hypotheses:  # what the linear picture promised, the simulation did not keep
        return Naming("nothing found", (), None, null, screening, screening, tuple(rungs), design)
    kind: Kind = "cause" if len(stage.best.causes) == 1 else "several causes"
    return Naming(kind, hypotheses, None, null, screening, stage.screening, tuple(rungs), stage.design)


def _climbed(
    stage: _Stage,
    found: Hypothesis,
    others: tuple[Hypothesis, ...],
    renew: Renew,
    progress: Callable[[str], None],
) -> _Stage:
    """Return the stage with another model: derivatives about it, and everything weighed against it."""
    progress("what the extended model makes possible")
    design, fit = polished(stage.design, found.fit)
    value = found.log_evidence + fit.log_evidence - found.fit.log_evidence
    about, screening = renew(design, fit, stage.screening)
    if about is design:
        return _weighed(design, screening, Hypothesis(fit, value), others)
    return _weighed(about, screening, Hypothesis(refit(about, fit.causes, fit.start, fit.nuisances), value))


def _settled(stage: _Stage, renew: Renew) -> _Stage:
    """Return the stage with all that its model misses taken for noise: intervals and sets are to be honest."""
    if not stage.best.causes:
        return stage
    design, screening = renew(stage.design, stage.fit, stage.screening, is_last=True)
    if design is stage.design:
        return stage
    fit = refit(design, stage.fit.causes, stage.fit.start, stage.fit.nuisances)
    null = refit(design, (), {})
    return _weighed(design, screening, Hypothesis(fit, fit.log_evidence - null.log_evidence))


def _weighed(design: Design, screening: Screening, best: Hypothesis, tried: tuple[Hypothesis, ...] = ()) -> _Stage:
    sigma = np.array([unknown.sigma for unknown in best.fit.unknowns])
    pseudo, slopes = pseudo_residual(design, best.fit), design.whiten(best.fit.slopes)
    against = rescreen(design, screening, pseudo, slopes, sigma, best.keys)
    return _Stage(design, against, best, tried)


def _reach(evidence: float) -> float:
    """Return how far behind the best, in the linear picture, a cause may be and still turn out the best."""
    return max(IN_REACH, IMPRECISE * evidence)


def _one_more(stage: _Stage, first: Screening, refused: set[tuple[str, str]], limit: float) -> list[Hypothesis]:
    """Return explanations with one cause more, or with two that hide each other; for two causes, of all pairs."""
    open_ = [e for e in stage.screening.listed if e.cause and e.cause.key not in refused]
    worth = [e for e in open_ if e.log_evidence > PROMISING * limit][:FINALISTS]
    single = worth[0].log_evidence if worth else 0.0
    trials = [_Trial.extending(stage, e) for e in worth if e.log_evidence > single - _reach(single)]
    trials += _hiding(stage, open_, single + limit)
    if len(stage.best.causes) == 1:
        trials += _pairs(stage, first, refused)[:PAIR_FINALISTS]
    unique = {trial.keys: trial for trial in sorted(trials, key=lambda trial: trial.promise)}
    ranked = sorted(unique.values(), key=lambda trial: -trial.promise)
    return _fitted(stage, ranked[: FINALISTS + PAIR_FINALISTS])


@dataclass(frozen=True)
class _Trial:
    """Causes that are to be fitted together, where to start, and what the linear picture promises of them."""

    causes: tuple[Cause, ...]
    start: dict[Key, float]
    nuisances: Array | None
    promise: float

    @property
    def keys(self) -> frozenset[tuple[str, str]]:
        return frozenset(cause.key for cause in self.causes)

    @classmethod
    def extending(cls, stage: _Stage, *entries: Entry, evidence: float | None = None) -> "_Trial":
        start = dict(stage.fit.start)
        for entry in entries:
            start |= stage.screening.sizes_of(entry)
        promise = stage.best.log_evidence + (entries[0].log_evidence if evidence is None else evidence)
        added = tuple(entry.cause for entry in entries if entry.cause)
        # the nominal model's figures are bent by what is missing: no place to start from
        nuisances = stage.fit.nuisances if stage.best.causes else None
        return cls((*stage.best.causes, *added), start, nuisances, promise)


def _hiding(stage: _Stage, open_: Sequence[Entry], least: float) -> list[_Trial]:
    """Return pairs that explain together what neither does alone, as a payload and missing gas hide each other."""
    found = []
    for pair in combinations(open_[:PAIRED], 2):
        alone = sum(max(entry.log_evidence, 0.0) for entry in pair)
        evidence = _joint_evidence(stage.screening, pair)
        if evidence > alone + least:
            found.append(_Trial.extending(stage, *pair, evidence=evidence))
    return sorted(found, key=lambda trial: -trial.promise)[:PAIR_FINALISTS]


def _joint_evidence(screening: Screening, pair: Sequence[Entry]) -> float:
    columns = np.concatenate([entry.columns for entry in pair])
    prior = np.concatenate([entry.prior for entry in pair])
    return screening.marginal.log_evidence(columns, prior)


def _pairs(stage: _Stage, first: Screening, refused: set[tuple[str, str]]) -> list[_Trial]:
    """Return all pairs of promising causes in the linear picture about the nominal model, the most promising first."""
    best = {entry.cause.key: entry for entry in first.listed if entry.cause}
    beside = [e.cause.key for e in stage.screening.listed[:PAIRED] if e.cause]
    promising = [*first.listed[:PAIRED], *(best[key] for key in beside if key in best)]
    unique = {entry.cause.key: entry for entry in promising if entry.cause and entry.cause.key not in refused}
    trials = []
    for pair in combinations(unique.values(), 2):
        causes = tuple(entry.cause for entry in pair if entry.cause)
        start = first.sizes_of(pair[0]) | first.sizes_of(pair[1])
        trials.append(_Trial(causes, start, None, _joint_evidence(first, pair)))
    return sorted(trials, key=lambda trial: -trial.promise)


def _fitted(stage: _Stage, trials: Sequence[_Trial]) -> list[Hypothesis]:
    found = []
    for trial in trials:
        try:
            fit = refit(stage.design, trial.causes, trial.start, trial.nuisances)
        except EffectError:
            raise  # an effect of the user's own that fails must not lose in silence
        except BenchError:
            continue  # this model finds no balance along the measured motion
        found.append(Hypothesis(fit, stage.best.log_evidence + fit.log_evidence - stage.fit.log_evidence))
    return found


def _among_rivals(stage: _Stage, progress: Callable[[str], None]) -> tuple[Hypothesis, ...]:
    """Return the best explanation and those in which one of its causes is another, by falling evidence.

    A rival that fits better but predicts what was held out worse is none.
    """
    progress("rivals")
    known = {h.keys for h in stage.tried}
    fits = [stage.best, *stage.tried, *_fitted(stage, [trial for trial in _swaps(stage) if trial.keys not in known])]
    top = max(h.log_evidence for h in fits)
    settled = []
    for hypothesis in fits:
        if hypothesis is not stage.best and hypothesis.log_evidence > top - IN_SET - NEARLY:
            _, fit = polished(stage.design, hypothesis.fit)
            value = hypothesis.log_evidence + fit.log_evidence - hypothesis.fit.log_evidence
            hypothesis = Hypothesis(fit, value)
        settled.append(hypothesis)
    best = stage.best
    settled = [
        h
        for h in settled
        if h is best or h.log_evidence <= best.log_evidence or held_out(stage.design, 1.0, best.fit, h.fit).nats > 0
    ]
    weights = np.exp(np.array([h.log_evidence for h in settled]) - max(h.log_evidence for h in settled))
    shares = weights / weights.sum()
    ranked = [replace(h, probability=float(p)) for h, p in zip(settled, shares, strict=True)]
    return tuple(sorted(ranked, key=lambda h: -h.log_evidence))


def _swaps(stage: _Stage) -> list[_Trial]:
    """Return the explanations in which one cause of the best is replaced by another that may do as well."""
    design, fit = stage.design, stage.fit
    slopes = design.whiten(fit.slopes)
    sigma = np.array([unknown.sigma for unknown in fit.unknowns])
    trials: list[_Trial] = []
    for cause in fit.causes:
        mine = np.array([unknown.cause is cause for unknown in fit.unknowns])
        others = tuple(other for other in fit.causes if other is not cause)
        try:
            white = pseudo_residual(design, fit_without(design, fit, cause))
        except EffectError:
            raise  # an effect of the user's own that fails must not lose in silence
        except BenchError:
            continue  # without it the model finds no balance along the measured motion
        taken = frozenset(other.key for other in others)
        against = rescreen(design, stage.screening, white, slopes[:, ~mine], sigma[~mine], taken)
        own = [e.log_evidence for e in against.listed if e.cause and e.cause.key == cause.key]
        top = max([*own, against.listed[0].log_evidence]) if against.listed else 0.0
        start = {key: value for key, value in fit.start.items() if key[:2] != cause.key}
        for entry in against.listed[:RIVALS]:
            if entry.cause and entry.cause.key != cause.key and entry.log_evidence > top - _reach(top):
                promise = stage.best.log_evidence + entry.log_evidence - top
                causes = (*others, entry.cause)
                trials.append(_Trial(causes, start | against.sizes_of(entry), fit.nuisances, promise))
    return trials


def _explains_more(stage: _Stage) -> bool:
    """Whether one free shape explains more than all listed causes that were found, with the same errors counted."""
    free = _alone(stage)
    if not free:
        return False
    null = refit(stage.design, (), {})
    return free[0].log_evidence > stage.fit.log_evidence - null.log_evidence + stage.screening.threshold


def _alone(stage: _Stage) -> tuple[Entry, ...]:
    """Return the free shapes against the nominal model, by falling evidence."""
    design = stage.design
    nothing: Array = np.zeros((len(design.white), 0))
    return rescreen(design, stage.screening, design.white, nothing, np.zeros(0)).free


def _unlisted(stage: _Stage, threshold: float) -> tuple[Block | None, bool]:
    """Return the free shape that is needed, or None where listed causes are enough; and whether it stands alone.

    One that explains alone more than several listed causes together is preferred to them.
    """
    left = stage.screening.free
    needed = left and left[0].log_evidence > max(threshold, UNEXPLAINED * stage.best.log_evidence)
    if not stage.best.causes:  # nothing but its evidence speaks for it: no rival that was ruled out, no held-out run
        needed = left and left[0].log_evidence > threshold + CERTAIN
    if not needed and len(stage.best.causes) <= 1:
        return None, False
    if _explains_more(stage):
        what, is_alone = _alone(stage)[0].what, True
    elif needed:
        what, is_alone = left[0].what, False
    else:
        return None, False
    assert isinstance(what, Block)
    return what, is_alone
