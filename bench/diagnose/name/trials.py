"""What is tried at each step of the climb: causes beside those found so far, pairs that hide each other, and rivals.

Trials are chosen in the linear picture, where they are cheap, and fitted by simulation.
"""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from bench.diagnose.extend.fit import Fit, Key, fit_without, pseudo_residual, unknowns_of
from bench.diagnose.extend.refit import refit
from bench.diagnose.picture.candidates import Cause
from bench.diagnose.picture.design import Design, with_play
from bench.diagnose.picture.screening import Entry, Screening, rescreen, rewhitened
from bench.diagnose.replay.segments import Index
from bench.errors import NOT_SIMULATED
from bench.executor.contract import Executor, Progress, in_order
from bench.executor.serial import SERIAL
from bench.record.campaign import Array

FINALISTS = 6  # causes that are fitted by simulation
RIVALS = 4  # causes that are tried in the place of each
MOST_SWAPS = 12  # of them all; a model of many causes would be tried for minutes
PAIRED = 40  # causes whose pairs are all tried in the linear picture
PAIR_FINALISTS = 3
IN_REACH = 12.0  # log evidence behind the best, from where on a cause is not worth a simulation
IMPRECISE = 0.15  # of its evidence, by which the linear picture may be wrong about a strong effect
NARROW = 1.5  # ratio of neighbouring shapes below which an effect is lost between two of them
SCATTERED = 0.25  # of the evidence of the best cause, which something has where a cause that scatters is worth a trial
PROMISING = 0.5  # of the evidence that is asked for, in the linear picture


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
class Stage:
    """Where the climb stands: the linear picture about a model, everything weighed against it, and the model.

    `tried` are the explanations with as many causes that were fitted on the way; `fits` remembers what was fitted at
    this stage, None where a model finds no balance or does not need a cause.
    """

    design: Design
    screening: Screening
    best: Hypothesis
    tried: tuple[Hypothesis, ...] = ()
    fits: dict[frozenset[tuple[str, str]], Hypothesis | None] = field(default_factory=dict)

    @property
    def fit(self) -> Fit:
        """The model."""
        return self.best.fit


@dataclass(frozen=True)
class Trial:
    """Causes that are to be fitted together, where to start, and what the linear picture promises of them."""

    causes: tuple[Cause, ...]
    start: dict[Key, float]
    nuisances: Array | None
    promise: float

    @property
    def keys(self) -> frozenset[tuple[str, str]]:
        """What tells it from others."""
        return frozenset(cause.key for cause in self.causes)

    @classmethod
    def extending(cls, stage: Stage, *entries: Entry, evidence: float | None = None) -> "Trial":
        """Return the trial that adds entries to a stage; `evidence` of them together, if not of the first."""
        start = dict(stage.fit.start)
        for entry in entries:
            start |= _first_sizes(stage.screening, entry)
        promise = stage.best.log_evidence + (entries[0].log_evidence if evidence is None else evidence)
        added = tuple(entry.cause for entry in entries if entry.cause)
        # the nominal model's figures are bent by what is missing: no place to start from
        nuisances = stage.fit.nuisances if stage.best.causes else None
        return cls((*stage.best.causes, *added), start, nuisances, promise)


def one_more(
    stage: Stage, first: Screening, refused: set[tuple[str, str]], limit: float, executor: Executor = SERIAL
) -> list[Hypothesis]:
    """Return explanations with one cause more, or with two that hide each other; for two causes, of all pairs."""
    open_ = [e for e in stage.screening.listed if e.cause and e.cause.key not in refused]
    worth = [e for e in open_ if e.log_evidence > PROMISING * limit][:FINALISTS]
    single = worth[0].log_evidence if worth else 0.0
    trials = [Trial.extending(stage, e) for e in worth if e.log_evidence > single - _reach(single)]
    trials += _scattering(stage, open_, single, PROMISING * limit)
    trials += _hiding(stage, open_, single + limit)
    if len(stage.best.causes) == 1:
        trials += _pairs(stage, first, refused)
    unique = {trial.keys: trial for trial in sorted(trials, key=lambda trial: trial.promise)}
    ranked = sorted(unique.values(), key=lambda trial: -trial.promise)
    return fitted(stage, ranked[: FINALISTS + PAIR_FINALISTS], executor)


def swaps(stage: Stage) -> list[Trial]:
    """Return the explanations in which one cause of the best is replaced by another that may do as well."""
    design, fit = stage.design, stage.fit
    sigma = np.array([unknown.sigma for unknown in fit.unknowns])
    trials: list[Trial] = []
    for cause in fit.causes:
        mine = np.array([unknown.cause is cause for unknown in fit.unknowns])
        others = tuple(other for other in fit.causes if other is not cause)
        try:
            without = fit_without(design, fit, cause)
        except NOT_SIMULATED:
            continue  # without it the model finds no balance along the measured motion
        about = with_play(design, without.play)
        slopes, white = about.whiten(fit.slopes[:, :, ~mine]), pseudo_residual(about, without)
        taken = frozenset(other.key for other in others)
        against = rescreen(about, rewhitened(stage.screening, design, about), white, slopes, sigma[~mine], taken)
        own = [e.log_evidence for e in against.listed if e.cause and e.cause.key == cause.key]
        top = max([*own, against.listed[0].log_evidence]) if against.listed else 0.0
        start = {key: value for key, value in fit.start.items() if key[:2] != cause.key}
        for i, entry in enumerate(against.listed):
            if not entry.cause or entry.cause.key == cause.key:
                continue
            scatters = entry.cause.effect.scatters and entry.cause.place == cause.place
            if scatters or (i < RIVALS and entry.log_evidence > top - _reach(top)):
                promise = stage.best.log_evidence + (0.0 if scatters else entry.log_evidence - top)
                first = start | _first_sizes(against, entry)
                trials.append(Trial((*others, entry.cause), first, fit.nuisances, promise))
    return sorted(trials, key=lambda trial: -trial.promise)[:MOST_SWAPS]


def fitted(stage: Stage, trials: Sequence[Trial], executor: Executor = SERIAL) -> list[Hypothesis]:
    """Return the trials as fitted by simulation, without those whose model finds no balance, or does not need a cause.

    Raises:
        EffectError: An effect of the user's own fails.
    """
    new = list({trial.keys: trial for trial in trials if trial.keys not in stage.fits}.values())
    for trial, fit in zip(new, in_order(executor, partial(_fit, stage), new), strict=True):
        if fit is None:
            stage.fits[trial.keys] = None
            continue
        fit = replace(fit, causes=trial.causes, unknowns=unknowns_of(trial.causes))
        if not all(fit.acts(cause) for cause in trial.causes if cause.key not in stage.best.keys):
            stage.fits[trial.keys] = None  # what it gains, the model before has not yet found
            continue
        evidence = stage.best.log_evidence + fit.log_evidence - stage.fit.log_evidence
        stage.fits[trial.keys] = Hypothesis(fit, evidence)
    found = (stage.fits[trial.keys] for trial in trials)
    return [hypothesis for hypothesis in found if hypothesis is not None]


def _fit(stage: Stage, trial: Trial, _: Progress) -> Fit | None:
    """Return the best fit without its causes, which come from a user's file and do not pass between processes.

    None where the model finds no balance along the measured motion.
    """
    found: Fit | None = None
    for start in _starts(stage, trial):
        found = _better(stage, trial, start, found)
    for cause in trial.causes:
        if cause.key not in stage.best.keys and cause.effect.scatters and _is_near(stage, found, cause):
            found = _better(stage, trial, trial.start | {(*cause.key, s.name): s.high for s in cause.sizes}, found)
    return found and replace(found, causes=(), unknowns=())


def _better(stage: Stage, trial: Trial, start: dict[Key, float], found: Fit | None) -> Fit | None:
    """Return the better of a fit and the one from another start."""
    with suppress(*NOT_SIMULATED):
        fit = refit(stage.design, trial.causes, start, trial.nuisances, stage.fit)
        if found is None or fit.log_evidence > found.log_evidence:
            return fit
    return found


def _is_near(stage: Stage, found: Fit | None, cause: Cause) -> bool:
    """Whether a cause that scatters is worth a second start, at its largest.

    What scatters explains as well with less of it and more noise, so a fit may stay at the smaller of two sizes; where
    it is of no use at all, it is of none at either.
    """
    return found is None or (found.acts(cause) and found.log_evidence > stage.fit.log_evidence - IN_REACH)


def _starts(stage: Stage, trial: Trial) -> Iterator[dict[Key, float]]:
    """Yield where to start: as the linear picture says, and between the shapes tried where those lie far apart."""
    yield trial.start
    for cause in trial.causes:
        for shape in cause.shapes:
            if cause.key not in stage.best.keys and shape.ratio < NARROW:
                key = (*cause.key, shape.name)
                for side in (-1, 1):
                    yield trial.start | {key: trial.start.get(key, shape.null) * shape.ratio ** (side / 3)}


def _scattering(stage: Stage, open_: Sequence[Entry], single: float, least: float) -> list[Trial]:
    """Return causes that scatter, where anything at their place comes near the best cause: it may be their doing."""
    near = max(least, min(SCATTERED * single, single - IN_REACH))
    seen = [entry for entry in stage.screening.entries if entry.log_evidence > near]
    trials = []
    for entry in open_:
        if entry.cause and entry.cause.effect.scatters:
            evidence = max([other.log_evidence for other in seen if other.drive == entry.drive], default=None)
            if evidence is not None:
                trials.append(Trial.extending(stage, entry, evidence=evidence))
    return trials


def _first_sizes(screening: Screening, entry: Entry) -> dict[Key, float]:
    """Return where to start: as the linear picture says, but where chance acts, which it does not know."""
    sizes = screening.sizes_of(entry)
    if entry.cause and entry.cause.effect.scatters:
        typical = {(*entry.cause.key, size.name): size.typical for size in entry.cause.sizes}
        sizes |= {key: max(value, typical[key]) for key, value in sizes.items() if key in typical}
    return sizes


def _hiding(stage: Stage, open_: Sequence[Entry], least: float) -> list[Trial]:
    """Return pairs that explain together what neither does alone, as a payload and missing gas hide each other."""
    near = open_[:PAIRED]
    alone = np.array([max(entry.log_evidence, 0.0) for entry in near])
    one, two = np.triu_indices(len(near), 1)
    evidence = _joint_evidences(stage.screening, near, one, two)
    hiding = np.flatnonzero(evidence > alone[one] + alone[two] + least)
    best = hiding[np.argsort(-evidence[hiding], kind="stable")][:PAIR_FINALISTS]
    return [Trial.extending(stage, near[one[i]], near[two[i]], evidence=float(evidence[i])) for i in best]


def _pairs(stage: Stage, first: Screening, refused: set[tuple[str, str]]) -> list[Trial]:
    """Return the most promising pairs of causes in the linear picture about the nominal model."""
    best = {entry.cause.key: entry for entry in first.listed if entry.cause}
    beside = [e.cause.key for e in stage.screening.listed[:PAIRED] if e.cause]
    promising = [*first.listed[:PAIRED], *(best[key] for key in beside if key in best)]
    unique = {entry.cause.key: entry for entry in promising if entry.cause and entry.cause.key not in refused}
    entries = list(unique.values())
    one, two = np.triu_indices(len(entries), 1)
    evidence = _joint_evidences(first, entries, one, two)
    trials = []
    for i in np.argsort(-evidence, kind="stable")[:PAIR_FINALISTS]:
        pair = entries[one[i]], entries[two[i]]
        causes = tuple(entry.cause for entry in pair if entry.cause)
        start = first.sizes_of(pair[0]) | first.sizes_of(pair[1])
        trials.append(Trial(causes, start, None, float(evidence[i])))
    return trials


def _joint_evidences(screening: Screening, entries: Sequence[Entry], one: Index, two: Index) -> Array:
    """Return the log evidence for pairs of entries together, shape (E,), for indices of shape (E,) each."""
    if not len(one):
        return np.empty(0)
    marginal = screening.marginal.only(np.concatenate([entry.columns for entry in entries]))
    sizes = np.array([len(entry.columns) for entry in entries])
    first = np.cumsum(sizes) - sizes
    prior = np.concatenate([entry.prior for entry in entries])
    found = np.empty(len(one))
    for k, n in {(int(a), int(b)) for a, b in zip(sizes[one], sizes[two], strict=True)}:
        alike = np.flatnonzero((sizes[one] == k) & (sizes[two] == n))
        columns = np.concatenate(
            [first[one[alike], None] + np.arange(k), first[two[alike], None] + np.arange(n)], axis=1
        )
        found[alike] = marginal.log_evidences(columns, prior[columns])
    return found


def _reach(evidence: float) -> float:
    """Return how far behind the best, in the linear picture, a cause may be and still turn out the best."""
    return max(IN_REACH, IMPRECISE * evidence)
