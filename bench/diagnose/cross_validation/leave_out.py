"""Leave out: every fold predicted by a model that was fitted to the others, without simulating anything again.

The slopes of a fit are taken as good over the small step that leaving out a run makes. In whitened space, with
residual r at the optimum, slopes T (nuisances, then unknowns) and precision P of the priors, that step is

    d = -H^-1 b,   H = P + T^T T over the runs that stay,   b = T^T r over those that are left out,

and what is left out is normal around its prediction, with covariance I + T H^-1 T^T. The optimum is that of the slopes:
a fit ends a little beside it, where a simulation fell by less than they promise, and whatever pull is left there would
send a parameter that the remaining runs do not tell as far as its prior allows. A parameter at its bound stays there.
"""

from collections.abc import Hashable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve
from scipy.optimize import lsq_linear

from bench.diagnose.cross_validation.floor import measured
from bench.diagnose.cross_validation.folds import Folds
from bench.diagnose.extend.fit import Fit
from bench.diagnose.extend.objective import bounds_of
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.other_noise import with_play
from bench.record.campaign import Array

REACH = 4.0  # declared: standard deviations by which a figure may be off before it makes another model; one in 16000 is
# assumed: times its standard deviation, beyond which a stated figure is compared no more: data that know it so much
# worse do not tell it, and where it is off by more, something is wrong, whatever it is
FAR = 30.0
ROUNDING = 1e-9  # rounding: of a value; nearer to a bound it is at it


@dataclass(frozen=True, eq=False)
class Tangent:
    """A fit in the linearised model; m whitened readings, p nuisances, k unknowns.

    Attributes:
        jacobian: Shape (m, p + k), whitened.
        white: Shape (m,), whitened residual at its optimum.
        precision: Shape (p + k, p + k), of all parameters given all data.
        log_determinants: Shape (m,), of whitening.
        free: Shape (q,), indices of the parameters that are not at a bound.
        step: Shape (p + k,), from the fit to the optimum.
        known: What was left out of it so far, by the key of the folds.
    """

    jacobian: Array
    white: Array
    precision: Array
    log_determinants: Array
    free: NDArray[np.int64]
    step: Array
    known: dict[Hashable, "LeftOut"] = field(default_factory=dict, init=False)

    @property
    def free_precision(self) -> Array:
        """Shape (q, q), of the parameters that are not at a bound."""
        return self.precision[np.ix_(self.free, self.free)]

    def left_out(self, linear: LinearisedModel, folds: Folds) -> "LeftOut":
        """Return what comes of leaving out each of some folds, worked out once for all that leave out the same."""
        if folds.key not in self.known:
            self.known[folds.key] = _left_out(linear, self, folds)
        return self.known[folds.key]


@dataclass(frozen=True, eq=False)
class LeftOut:
    """A fit to all folds but one, for each of K.

    Attributes:
        steps: Shape (K, q), of the free parameters.
        log_probability: Shape (K,), of the readings of that fold [nats].
    """

    steps: Array
    log_probability: Array


def tangent_of(linear: LinearisedModel, fit: Fit) -> Tangent:
    """Return a fit in the linearised model.

    Args:
        linear: The campaign.
        fit: To all of it.
    """
    linear = with_play(linear, fit.play)
    jacobian = linear.tangent(fit.jacobian, fit.renewed)
    prior = _prior(fit)
    precision = jacobian.T @ jacobian + np.diag(prior)
    low, high = bounds_of(linear.nuisances, fit.unknowns)
    values = np.concatenate([fit.nuisances, fit.values])
    free = np.flatnonzero(np.minimum(np.abs(values - low), np.abs(values - high)) > ROUNDING * np.abs(values))
    white = linear.whiten(fit.residual)
    here = Tangent(jacobian, white, precision, linear.log_determinants, free, np.zeros(len(prior)))
    pull = jacobian.T @ white - prior * _from_stated(fit)
    step = here.step.copy()
    step[free] = cho_solve(cho_factor(here.free_precision), pull[free])
    return replace(here, white=white - jacobian @ step, step=step)


def _prior(fit: Fit) -> Array:
    """Return the precision of each parameter before any data, shape (p + k,)."""
    return np.concatenate([np.ones(len(fit.nuisances)), [1 / unknown.sigma**2 for unknown in fit.unknowns]])


def _from_stated(fit: Fit) -> Array:
    """Return how far each parameter is from what is stated, or from none, shape (p + k,)."""
    return np.concatenate([fit.nuisances, fit.off])


def log_probability_of_folds(linear: LinearisedModel, tangent: Tangent, folds: Folds) -> Array:
    """Return the log probability of the readings of each fold given the others, shape (K,) [nats].

    An extension that is sure of what it does not know loses here; one that only says it does not know, hardly.
    """
    return tangent.left_out(linear, folds).log_probability


def log_probability_of_figures(fit: Fit, tangent: Tangent, count: int | None = None) -> float:
    """Return the log probability of the stated figures, each predicted by all runs and all other figures [nats].

    A stated figure is a measurement too: someone weighed, somebody calibrated. Without it, nuisance i is normal with
    mean x_i / (1 - v_i) and variance v_i / (1 - v_i), if x_i and v_i are its value and variance with it; what was
    stated is 0 with a standard deviation of 1. One that is off by more than `FAR` counts as off by that: beyond, it
    says that something is wrong, not what.

    Args:
        fit: Of the model.
        tangent: The same in the linearised model.
        count: Of the nuisances, the first, that are stated figures; None: all.
    """
    stated = (fit.nuisances + tangent.step[: len(fit.nuisances)])[:count]
    rest = np.maximum(1 - np.diag(np.linalg.inv(tangent.precision))[: len(stated)], FAR**-2)
    return float(0.5 * np.sum(np.log(rest) - np.minimum(stated**2 / rest, FAR**2)))


def errors_of_folds(
    linear: LinearisedModel,
    fit: Fit,
    tangent: Tangent,
    folds: Folds,
    unknown: NDArray[np.bool_] | None = None,
) -> Array:
    """Return measured less predicted, shape (T, c), each reading while its fold was held out; nan where not measured.

    What belongs to one recording (the zero of an encoder, a payload) no other one knows. Where recordings are held out,
    it is fitted to the one that is predicted; what is the machine's is not.

    Figures of the model stay within `REACH` standard deviations of what is stated. Without that, a robot that lost a
    tenth of its gas would be predicted well by a nominal one with a gas constant ten sigmas off.

    Args:
        linear: The campaign.
        fit: To all of it.
        tangent: The same in the linearised model.
        folds: What is held out at a time.
        unknown: Shape (p,), nuisances that are fitted, but of which a prediction has none; None: it has all.
    """
    p, away = len(fit.nuisances), _from_stated(fit) + tangent.step
    row_fold, row_gap = folds.of_rows(linear)
    if np.all(np.abs(away[:p]) <= REACH):
        clamp, free, steps = np.zeros_like(away), tangent.free, tangent.left_out(linear, folds).steps
    else:
        clamp, free = _clamped(away[:p], tangent)
        jacobian, white = tangent.jacobian[:, free], tangent.white - tangent.jacobian @ clamp
        precision = tangent.precision[np.ix_(free, free)]
        absent = ((row_fold == f) | row_gap[:, f] for f in range(len(folds)))
        steps = np.stack([step_without(jacobian[gone], white[gone], precision)[0] for gone in absent])
    error = np.where(measured(linear), fit.residual, np.nan)
    for f in range(len(folds)):
        moved = clamp.copy()
        moved[free] += steps[f]
        if folds.recordings:
            mine = np.intersect1d(_of_recording(linear, fit, folds.recordings[f]), tangent.free)
            moved[mine] = _fitted_to(tangent, _prior(fit), away, row_fold == f, moved, mine)
        if unknown is not None:
            moved[:p][unknown] = -away[:p][unknown]
        moved += tangent.step
        at = folds.of_instants == f
        error[at] -= fit.change(linear, moved[:p], at) + fit.jacobian[at] @ moved[p:]
    return error


def _left_out(linear: LinearisedModel, tangent: Tangent, folds: Folds) -> LeftOut:
    """Return what comes of leaving out each fold with its gap.

    What is left out is normal around its prediction with the covariance I + T R^-1 T^T, where R is the precision of
    what stays. By Sylvester's theorem its determinant is that of R + T^T T over that of R; without a gap R + T^T T is
    the precision given all readings, the same for all folds.
    """
    row_fold, row_gap = folds.of_rows(linear)
    jacobian, precision = tangent.jacobian[:, tangent.free], tangent.free_precision
    whole = cho_factor(precision)
    steps, found = np.empty((len(folds), len(precision))), np.empty(len(folds))
    for f in range(len(folds)):
        mine, gap = row_fold == f, row_gap[:, f]
        own, absent = jacobian[mine], mine | gap
        steps[f], rest = step_without(jacobian[absent] if gap.any() else own, tangent.white[absent], precision)
        beside = jacobian[gap & ~mine]
        given = cho_factor(precision - beside.T @ beside) if len(beside) else whole
        error = tangent.white[mine] - own @ steps[f]
        pull = own.T @ error
        square = float(error @ error) - float(pull @ cho_solve(given, pull))
        determinant = _log_determinant(given) - _log_determinant(rest)
        volume = float(np.sum(tangent.log_determinants[mine]))
        found[f] = volume - 0.5 * (square + determinant + len(error) * float(np.log(2 * np.pi)))
    return LeftOut(steps, found)


def step_without(gone: Array, white: Array, precision: Array) -> tuple[Array, tuple[Array, bool]]:
    """Return the step of free parameters without some readings, shape (q,), and the factor of the precision that stays.

    Args:
        gone: Shape (r, q), changes of what is left out.
        white: Shape (r,), residual of it at the optimum.
        precision: Shape (q, q), given all readings.
    """
    rest = cho_factor(precision - gone.T @ gone)
    return -cho_solve(rest, gone.T @ white), rest


def _log_determinant(factor: tuple[Array, bool]) -> float:
    """Return the logarithm of the determinant of what was factored."""
    return 2 * float(np.sum(np.log(np.diag(factor[0]))))


def _of_recording(linear: LinearisedModel, fit: Fit, recording: str) -> NDArray[np.int64]:
    """Return the indices of the parameters that belong to one recording alone."""
    whose = [nuisance.recording for nuisance in linear.nuisances]
    whose += [unknown.cause.place.recording for unknown in fit.unknowns]
    return np.array([i for i, name in enumerate(whose) if name == recording], dtype=np.int64)


def _fitted_to(
    tangent: Tangent, prior: Array, away: Array, rows: NDArray[np.bool_], moved: Array, which: NDArray[np.int64]
) -> Array:
    """Return the steps of some parameters that suit some readings best, shape (q,), while the others moved.

    Args:
        tangent: The fit.
        prior: Shape (p + k,), precision of each parameter.
        away: Shape (p + k,), how far each is from what is stated.
        rows: Shape (m,), the readings.
        moved: Shape (p + k,), steps of all parameters from the optimum.
        which: Shape (q,), parameters.
    """
    others = moved.copy()
    others[which] = 0.0
    own = tangent.jacobian[rows][:, which]
    pull = own.T @ (tangent.white[rows] - tangent.jacobian[rows] @ others) - prior[which] * away[which]
    return np.asarray(np.linalg.solve(own.T @ own + np.diag(prior[which]), pull), dtype=np.float64)


def _clamped(figures: Array, tangent: Tangent) -> tuple[Array, NDArray[np.int64]]:
    """Return the step from the optimum to the best fit within `REACH`, shape (p + k,), and what stays free of it.

    Args:
        figures: Shape (p,), how far each is from what is stated at the optimum.
        tangent: The fit.
    """
    p, step, free = len(figures), np.zeros(len(tangent.precision)), tangent.free
    low, high = np.full(len(step), -np.inf), np.full(len(step), np.inf)
    low[:p], high[:p] = -REACH - figures, REACH - figures
    root = np.linalg.cholesky(tangent.free_precision).T
    found = lsq_linear(root, np.zeros(len(free)), (low[free], high[free]), method="bvls")
    step[free] = found.x
    return step, free[found.active_mask == 0]
