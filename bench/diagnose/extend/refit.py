"""The last word on an extension: its parameters and all nuisances together, fitted by simulating the extended model."""

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field

import numpy as np

from bench.diagnose.extend.fit import Fit, Key, Unknown, is_simulated, play_of, unknowns_of, world_of
from bench.diagnose.extend.steps import HALVINGS, bounded_step, corrected, ever_shorter
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.first_order import FirstOrder
from bench.diagnose.linearise.linearised_model import LinearisedModel, scatters_alike, with_play
from bench.diagnose.replay.world import World, moves
from bench.errors import NOT_SIMULATED
from bench.record.campaign import Array

MOST_ITERATIONS = 6  # effort: steps of a fit
ENOUGH = 0.2  # effort: fall of the objective, promised or found, below which a fit has converged
MOST_PLAYS = 4  # effort: fits in turn, each with the scatter that the play of the one before makes
FAITHFUL = 0.7  # effort: of the promised fall; derivatives that keep less are taken anew, or corrected


@dataclass(frozen=True, eq=False)
class _Point:
    """Where a fit starts, and what is known there.

    Attributes:
        values: Shape (k,), of the unknowns.
        nuisances: Shape (p,).
        residual: Shape (T, c); None: to be simulated.
        jacobian: Unknown, by its index -> shape (T, c); others are to be simulated.
    """

    values: Array
    nuisances: Array
    residual: Array | None = None
    jacobian: Mapping[int, Array] = field(default_factory=dict)


def refit(
    linear: LinearisedModel,
    causes: tuple[Cause, ...],
    start: Mapping[Key, float],
    nuisances: Array | None = None,
    known: Fit | None = None,
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

    Raises:
        ConvergenceError, RobotError: The extended model cannot be simulated at all.
    """
    unknowns = unknowns_of(causes)
    low, high = _bounds(unknowns)
    values = np.array([start.get((*u.cause.key, u.parameter.name), u.parameter.null) for u in unknowns])
    x = np.zeros(len(linear.nuisances)) if nuisances is None else nuisances.copy()
    jacobian = known.slopes_of(unknowns) if known else {}
    return _with_its_play(linear, causes, _Point(np.clip(values, low, high), x, None, jacobian))


def refitted(linear: LinearisedModel, fit: Fit) -> Fit:
    """Fit an extension again to a design that weighs its readings otherwise; it starts with what was simulated.

    Args:
        linear: The campaign.
        fit: Of the extension.

    Raises:
        ConvergenceError, RobotError: As `refit`.
    """
    return _with_its_play(linear, fit.causes, _point_of(fit))


def _point_of(fit: Fit) -> _Point:
    return _Point(fit.values, fit.nuisances, fit.residual, fit.slopes_of(fit.unknowns))


def _bounds(unknowns: tuple[Unknown, ...]) -> tuple[Array, Array]:
    low, high = np.array([u.bounds for u in unknowns]).reshape(-1, 2).T
    return low, high


def _with_its_play(linear: LinearisedModel, causes: tuple[Cause, ...], point: _Point) -> Fit:
    """Fit an extension until the play that its scatter belongs to is the play that it finds."""
    unknowns = unknowns_of(causes)
    play = play_of(linear, causes, unknowns, point.values)
    for _ in range(MOST_PLAYS):
        fit = _fitted(with_play(linear, play), causes, point)
        found = play_of(linear, causes, unknowns, fit.values)
        if scatters_alike(found, play):
            break
        play, point = found, _point_of(fit)
    return fit


def _fitted(linear: LinearisedModel, causes: tuple[Cause, ...], point: _Point) -> Fit:
    """Fit an extension to a design that knows its play."""
    unknowns = unknowns_of(causes)
    sigma = np.array([u.sigma for u in unknowns])
    origin = np.array([u.parameter.null for u in unknowns])
    low, high = _bounds(unknowns)
    by_sensitivity = [i for i, nuisance in enumerate(linear.nuisances) if not is_simulated(nuisance)]
    observed = np.concatenate([segment.observed for segment in linear.segments])

    def left(values: Array, x: Array) -> Array:
        simulated = linear.replay.predict(world_of(linear, causes, unknowns, values, x))
        residual: Array = observed - simulated - linear.sensitivities[:, :, by_sensitivity] @ x[by_sensitivity]
        return residual

    def objective(white: Array, values: Array, x: Array) -> float:
        penalty = float(np.sum(((values - origin) / sigma) ** 2)) if len(values) else 0.0
        return float(white @ white) + float(x @ x) + penalty

    values, x, residual = point.values, point.nuisances, point.residual
    if residual is None:
        values, residual = _first(left, values, x, origin)
    white = linear.whiten(residual)
    best = objective(white, values, x)
    p = len(x)
    units = np.concatenate([np.ones(p), sigma])
    prior = np.diag(1 / units**2)

    def slopes_at(values: Array, x: Array, residual: Array, known: Mapping[int, Array]) -> Array:
        def world_at(values: Array) -> World:
            return world_of(linear, causes, unknowns, values, x)

        known = {**_of_torques(linear, world_at, causes, unknowns, values, known), **known}
        return _slopes(left, residual, values, x, unknowns, known)

    def tangent_of(jacobian: Array) -> tuple[Array, Array]:
        tangent = np.concatenate([linear.jacobian, linear.whiten(jacobian)], axis=1)
        return tangent, tangent.T @ tangent + prior

    jacobian = slopes_at(values, x, residual, point.jacobian)
    borrowed, is_anew, is_here = bool(point.jacobian), False, not point.jacobian  # what the derivatives are
    is_corrected, last = False, np.zeros_like(units)
    tangent, curvature = tangent_of(jacobian)
    fell = np.inf
    for iteration in range(MOST_ITERATIONS + 1):
        gradient = tangent.T @ white - np.concatenate([x, (values - origin) / sigma**2])
        limits = low - values, high - values
        step = bounded_step(curvature, gradient, p, *limits)
        promised = float(2 * gradient @ step - step @ (curvature @ step))
        if promised < ENOUGH:  # not worth a simulation; but who leaves runs out takes a fit to be at its optimum
            last, best = step, best - promised
            break
        if fell < ENOUGH or iteration == MOST_ITERATIONS:
            break
        fell = 0.0
        for part in ever_shorter(step, curvature, gradient, p, *limits):
            new_x, new_values = x + part[:p], np.clip(values + part[p:], low, high)
            try:
                new_residual = left(new_values, new_x)
            except NOT_SIMULATED:
                continue
            new_white = linear.whiten(new_residual)
            new = objective(new_white, new_values, new_x)
            if new < best:
                taken = np.concatenate([new_x - x, new_values - values])
                fell, missed = best - new, white - new_white - tangent @ taken
                x, values, residual, white, best = new_x, new_values, new_residual, new_white, new
                break
        is_here = is_here and fell == 0
        if fell >= FAITHFUL * promised or (0 < fell < ENOUGH and not borrowed):
            continue
        if is_anew and fell:  # new derivatives of the causes do no better: those of the nuisances are as wrong
            tangent = corrected(tangent, missed, taken, units)
            curvature, is_corrected = tangent.T @ tangent + prior, True
            continue
        if is_here:
            break
        try:
            jacobian = slopes_at(values, x, residual, {})
        except NOT_SIMULATED:  # no balance to either side: the derivatives so far have to do
            break
        tangent, curvature = tangent_of(jacobian)
        borrowed, is_anew, is_here, is_corrected, fell = False, True, True, False, np.inf
    if is_corrected:  # corrections lead to the optimum; what is stated there rests on derivatives
        with suppress(*NOT_SIMULATED):
            jacobian = slopes_at(values, x, residual, {})
        _, curvature = tangent_of(jacobian)
    x, values = x + last[:p], values + last[p:]
    residual = residual - linear.sensitivities @ last[:p] - jacobian @ last[p:]
    covariance = np.asarray(np.linalg.inv(curvature)[p:, p:], dtype=np.float64)
    _, determinant = np.linalg.slogdet(curvature)
    evidence = -0.5 * best - 0.5 * float(determinant) - float(np.sum(np.log(sigma)))
    evidence += float(np.sum(linear.log_determinants))
    return Fit(causes, unknowns, values, covariance, x, best, evidence, residual, jacobian, linear.scatter.play)


def _first(left, values, x, origin) -> tuple[Array, Array]:  # type: ignore[no-untyped-def]
    """Return first values that can be simulated, and what they leave; the linearised model may promise too much."""
    for halving in range(HALVINGS):
        try:
            return values, left(values, x)
        except NOT_SIMULATED:
            values = origin + (values - origin) / 2 if halving < HALVINGS - 1 else values
    return values, left(values, x)


def _of_torques(
    linear: LinearisedModel,
    world_at: Callable[[Array], World],
    causes: tuple[Cause, ...],
    unknowns: tuple[Unknown, ...],
    values: Array,
    known: Mapping[int, Array],
) -> dict[int, Array]:
    """Return the change of the readings with each unknown that is not known and adds a torque, shape (T, c)."""
    which = [i for i, one in enumerate(unknowns) if i not in known and one.cause.effect.is_additive]
    if not which:
        return {}
    here = world_at(values)
    about = FirstOrder(linear.replay, here)
    found: dict[int, Array] = {}
    for i in which:
        step, moved = unknowns[i].step_from(float(values[i])), values.copy()
        moved[i] += step
        number = causes.index(unknowns[i].cause)
        now, then = (about.change(world.acting[number]) for world in (here, world_at(moved)))
        if now is not None and then is not None:
            found[i] = (then - now) / step
    return found


def _slopes(left, residual, values, x, unknowns, known) -> Array:  # type: ignore[no-untyped-def]
    """Return the change of the readings with each unknown, shape (T, c, k), by differences of simulations."""
    columns = dict(known)
    # what only reads differently comes first: the replay still has the motion that the residual was simulated along
    for i in sorted(range(len(unknowns)), key=lambda i: moves(unknowns[i].cause.effect)):
        if i in columns:
            continue
        step = unknowns[i].step_from(float(values[i]))
        try:
            columns[i] = (residual - _moved(left, values, x, i, step)) / step
        except NOT_SIMULATED:  # no balance there; the other side is as good
            columns[i] = (_moved(left, values, x, i, -step) - residual) / step
    if not columns:
        return np.zeros((*residual.shape, 0))
    return np.stack([columns[i] for i in range(len(unknowns))], axis=2)


def _moved(left, values, x, i, step) -> Array:  # type: ignore[no-untyped-def]
    moved = values.copy()
    moved[i] += step
    residual: Array = left(moved, x)
    return residual
