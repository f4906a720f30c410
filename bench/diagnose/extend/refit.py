"""The last word on an extension: its parameters and all nuisances together, fitted by simulating the extended model."""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from math import inf

import numpy as np

from bench.diagnose.extend.fit import Fit, Key, play_of, unknowns_of
from bench.diagnose.extend.objective import Derivatives, Objective, State, bounds_of
from bench.diagnose.extend.steps import bounded_step, ever_shorter
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.noise_covariance import scatters_alike
from bench.diagnose.linearise.other_noise import with_play
from bench.errors import NOT_SIMULATED
from bench.executor.contract import Progress, ignore
from bench.record.campaign import Array

MOST_ITERATIONS = 6  # effort: steps of a fit
MOST_TO_SETTLE = 16  # effort: steps of one that is to settle
ENOUGH = 0.2  # effort: fall of the objective, promised or found, below which a fit has converged
MOST_PLAYS = 4  # effort: fits in turn, each with the scatter that the play of the one before makes
MATTERS = 2.0  # effort: what a step falls short of its promise by, from where derivatives of nuisances are taken too
POOR = 0.3  # effort: of the promised fall; corrected derivatives that keep less are taken anew
MOVED = 0.1  # effort: of its standard deviation; a step that moves a nuisance less did not fail for its derivative
HOPELESS = 30.0  # effort: [nats], beyond twice what the next step promises, by which a fit may be behind and go on
FAR = 1000.0  # effort: [nats] by which a fit may be behind after a step that has not made half of the way
FAITHFUL = 0.7  # effort: of the promised fall; derivatives that keep less are taken anew, or corrected


@dataclass(frozen=True, eq=False)
class _Point:
    """Where a fit starts, and what is known there.

    Attributes:
        values: Shape (k,), of the unknowns.
        nuisances: Shape (p,).
        residual: Shape (T, c); None: to be simulated.
        jacobian: Unknown, by its index -> shape (T, c); others are to be simulated.
        renewed: As of a fit.
        is_settled: Whether the fit that ended there was.
        errors: Shape (k,), standard errors of the unknowns as of a fit; None: not known.
    """

    values: Array
    nuisances: Array
    residual: Array | None = None
    jacobian: Mapping[int, Array] = field(default_factory=dict)
    renewed: Mapping[int, Array] = field(default_factory=dict)
    is_settled: bool = True
    errors: Array | None = None


@dataclass(frozen=True)
class _How:
    """How far a fit goes; `settles`, `renews` and `least` as of `refit`."""

    settles: bool = True
    renews: bool = True
    least: float = -inf


def refit(
    linear: LinearisedModel,
    causes: tuple[Cause, ...],
    start: Mapping[Key, float],
    nuisances: Array | None = None,
    known: Fit | None = None,
    *,
    errors: Array | None = None,
    settles: bool = True,
    renews: bool = True,
    least: float = -inf,
    progress: Progress = ignore,
) -> Fit:
    """Fit an extension by Gauss-Newton, with a simulation for every residual and every derivative of its parameters.

    Nuisances are simulated too; their derivatives are those of the design, corrected by what steps show where they do
    not keep what they promise. Gears that have play in the extended model
    scatter their links in it; where the fit changes the play, it is repeated with the new scatter.

    Args:
        linear: The campaign.
        causes: What to add to the nominal model.
        start: (effect, place, parameter) -> first value; null where nothing is given.
        nuisances: Shape (p,), first values; None: zeros.
        known: A fit near the start, whose derivatives will do as long as they promise what comes true.
        errors: Shape (k,), standard errors of the unknowns by a fit near the start, over which derivatives are taken;
            None: not known.
        settles: Whether a fit whose derivatives are doubtful at its end ends with those of all nuisances
            about itself, which takes a simulation for each. `refitted` does that later.
        renews: Whether derivatives that do not keep what they promise are taken anew; else steps alone correct them.
        least: Log evidence that another model has. A fit that is far behind, and has no step that leads there or makes
            half of the way, ends.
        progress: Called before every simulation; what it raises ends the fit.

    Raises:
        ConvergenceError, RobotError: The extended model cannot be simulated at all.
    """
    unknowns = unknowns_of(causes)
    low, high = bounds_of((), unknowns)
    values = np.array([start.get(unknown.key, unknown.parameter.null) for unknown in unknowns])
    x = np.zeros(len(linear.nuisances)) if nuisances is None else nuisances.copy()
    slopes, renewed = (known.slopes_of(unknowns), known.renewed) if known else ({}, {})
    point = _Point(np.clip(values, low, high), x, jacobian=slopes, renewed=renewed, errors=errors)
    return _with_its_play(linear, causes, point, progress, _How(settles, renews, least))


def refitted(linear: LinearisedModel, fit: Fit, progress: Progress = ignore) -> Fit:
    """Fit an extension again to a design that weighs its readings otherwise; it starts with what was simulated.

    Args:
        linear: The campaign.
        fit: Of the extension.
        progress: As of `refit`.

    Raises:
        ConvergenceError, RobotError: As `refit`.
    """
    return _with_its_play(linear, fit.causes, _point_of(fit), progress, _How())


def _point_of(fit: Fit) -> _Point:
    slopes = fit.slopes_of(fit.unknowns)
    return _Point(fit.values, fit.nuisances, fit.residual, slopes, fit.renewed, fit.is_settled, fit.sigma)


def _with_its_play(
    linear: LinearisedModel,
    causes: tuple[Cause, ...],
    point: _Point,
    progress: Progress,
    how: _How,
) -> Fit:
    """Fit an extension until the play that its scatter belongs to is the play that it finds."""
    unknowns = unknowns_of(causes)
    play = play_of(linear, causes, unknowns, point.values)
    for _ in range(MOST_PLAYS):
        objective = Objective(with_play(linear, play), causes, progress, point.errors)
        fit = _fitted(objective, point, how)
        found = play_of(linear, causes, unknowns, fit.values)
        if scatters_alike(found, play):
            break
        play, point = found, _point_of(fit)
    return fit


def _fitted(objective: Objective, point: _Point, how: _How) -> Fit:
    """Fit an extension to a design that knows its play."""
    if point.residual is None:
        first = objective.near(point.nuisances, point.values)
    else:
        first = objective.at(point.nuisances, point.values, point.residual)
    slopes = objective.derivatives(first, point.jacobian, point.renewed)
    linear = objective.linear
    has_new_play = bool(np.any(linear.scatter.play > linear.replay.compiled.play))
    is_doubtful = not point.is_settled or (has_new_play and not slopes.renewed)
    state, slopes, is_hopeless = _least(objective, first, replace(slopes, is_doubtful=is_doubtful), how)
    has_all = slopes.all_at is not None
    is_settled = not slopes.is_doubtful or has_all
    is_stated = how.renews and not is_hopeless  # what is stated of the end rests on derivatives
    if is_stated and (slopes.is_doubtful or has_all) and slopes.at is not state:
        with suppress(*NOT_SIMULATED):
            slopes = objective.derivatives(state, nuisances=slopes.renewed)
    return _fit(objective, state, slopes, is_settled=is_settled and not is_hopeless)


def _least(objective: Objective, state: State, slopes: Derivatives, how: _How) -> tuple[State, Derivatives, bool]:
    """Return where the objective is least, derivatives that lead no further, and whether it was given up.

    Derivatives serve as long as steps fall as far as they promise. Else those of the unknowns are taken anew, where
    they are another fit's; then all are corrected by what the steps show. Where that does not help either, those of
    the nuisances that the step moves are taken anew too. What steps have corrected leads towards the optimum, but does
    not tell whether it is reached: a fit that is to settle takes all anew there, and goes on.
    """
    for _ in range(MOST_TO_SETTLE if how.settles else MOST_ITERATIONS):
        step, promised = _step(objective, state, slopes)
        behind = how.least - _log_evidence(objective, state.objective, slopes)
        if behind - promised > HOPELESS:
            return state, slopes, True
        before = state
        if promised >= ENOUGH:
            state = _downhill(objective, state, slopes, step)
            if behind - (before.objective - state.objective) / 2 > max(FAR, behind / 2):
                return state, slopes, True
            if before.objective - state.objective >= FAITHFUL * promised:
                continue
        try:
            better = _better(objective, slopes, before, state, step, promised, how)
        except NOT_SIMULATED:  # no balance to either side: the derivatives so far have to do
            break
        if better is None:
            break
        slopes = better
    return state, slopes, _log_evidence(objective, state.objective, slopes) < how.least - HOPELESS


def _better(
    objective: Objective,
    slopes: Derivatives,
    before: State,
    state: State,
    step: Array,
    promised: float,
    how: _How,
) -> Derivatives | None:
    """Return better derivatives at a state than those that promised a step to it, or None where none are worth it."""
    fell = before.objective - state.objective
    matters = promised - fell > MATTERS
    if not how.renews:
        return objective.corrected(slopes, before, state) if min(promised, fell) >= ENOUGH else None
    if promised >= ENOUGH:
        if slopes.at is None:
            own = objective.derivatives(state, nuisances=slopes.renewed)
            return replace(own, is_doubtful=slopes.is_doubtful)
        if fell >= ENOUGH and (fell >= POOR * promised or not matters):
            return objective.corrected(slopes, before, state)
        if matters and slopes.renewed_at is not state:
            moved = np.abs(step[: len(state.nuisances)]) > MOVED
            return objective.all_derivatives(state, moved, slopes)
    if how.settles and slopes.all_at is not state and (matters or (slopes.is_doubtful and slopes.all_at is None)):
        return objective.all_derivatives(state)
    return None


def _log_evidence(objective: Objective, least: float, slopes: Derivatives) -> float:
    """Return the logarithm of the marginal likelihood about a least value of the objective, as of a fit."""
    _, determinant = np.linalg.slogdet(slopes.precision)
    evidence = -0.5 * (least + float(determinant)) - float(np.sum(np.log(objective.sigma)))
    return evidence + float(np.sum(objective.linear.log_determinants))


def _step(objective: Objective, state: State, slopes: Derivatives) -> tuple[Array, float]:
    """Return the step to the least objective as derivatives have it, shape (p + k,), and how far that falls."""
    downhill = objective.descent(state, slopes)
    step = bounded_step(slopes.precision, downhill, *objective.limits(state))
    return step, float(2 * downhill @ step - step @ (slopes.precision @ step))


def _downhill(objective: Objective, state: State, slopes: Derivatives, step: Array) -> State:
    """Return a better state along a step, or the same where there is none."""
    downhill = objective.descent(state, slopes)
    for part in ever_shorter(step, slopes.precision, downhill, *objective.limits(state)):
        with suppress(*NOT_SIMULATED):
            new = objective.after(state, part)
            if new.objective < state.objective:
                return new
    return state


def _balances(objective: Objective, state: State, step: Array) -> bool:
    """Whether a model can be simulated after a small step; asked for with play alone, at whose flanks it may not."""
    if not np.any(objective.linear.scatter.play):
        return True
    try:
        objective.after(state, step)
    except NOT_SIMULATED:
        return False
    return True


def _fit(objective: Objective, state: State, slopes: Derivatives, *, is_settled: bool) -> Fit:
    """Return what a fit found, taken to its optimum by what is not worth a simulation.

    Who leaves runs out takes a fit to be at its optimum.
    """
    linear, p = objective.linear, len(state.nuisances)
    step, promised = _step(objective, state, slopes)
    is_settled &= promised < ENOUGH
    if promised >= ENOUGH or not _balances(objective, state, step):
        step, promised = np.zeros_like(step), 0.0
    least = state.objective - promised
    found = Fit(
        causes=objective.causes,
        unknowns=objective.unknowns,
        values=state.values + step[p:],
        covariance=np.asarray(np.linalg.inv(slopes.precision)[p:, p:], dtype=np.float64),
        nuisances=state.nuisances + step[:p],
        objective=least,
        log_evidence=_log_evidence(objective, least, slopes),
        residual=state.residual,
        jacobian=slopes.jacobian,
        play=linear.scatter.play,
        renewed=slopes.renewed,
        is_settled=is_settled,
    )
    moved = found.change(linear, step[:p]) + slopes.jacobian @ step[p:]
    return replace(found, residual=state.residual - moved)
