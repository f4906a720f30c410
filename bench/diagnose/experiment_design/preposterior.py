"""Preposterior analysis: what experiments would show if one or the other explanation is true.

Every explanation predicts by simulation. What remains unknown after today's data (nuisances and sizes, with their joint
posterior covariance) and what a new instrument brings along is integrated out in the linearised model.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np
from scipy.linalg import solve_triangular

from bench.diagnose.cross_validation.leave_out import tangent_of
from bench.diagnose.experiment_design.experiments import Experiment
from bench.diagnose.extend.fit import Fit
from bench.diagnose.linearise.each_weight import each_weight
from bench.diagnose.linearise.held_friction import held_friction
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.noise_covariance import whitening_of
from bench.diagnose.linearise.torque_response import torque_response
from bench.diagnose.replay.instants import recordings_of
from bench.diagnose.replay.levels import with_recordings
from bench.diagnose.replay.nuisances import nuisances_of
from bench.diagnose.replay.quantities import Quantity
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import Segment
from bench.diagnose.replay.simulations import simulate_all, sound
from bench.diagnose.replay.world import NOMINAL, World
from bench.errors import BenchError
from bench.executor.contract import Executor
from bench.executor.serial import SERIAL
from bench.record.campaign import Array

# assumed: relative error of every slope: nuisances are differentiated at the nominal robot, sizes at the explanation.
# Where two of them act alike, and only their sum is known, an experiment must not seem to tell them apart by that
# difference.
SLOPE_ERROR = 0.02


@dataclass(frozen=True, eq=False)
class Expectation:
    """What one explanation expects of an experiment; m whitened readings, z parameters that are not known exactly.

    Attributes:
        mean: Shape (m,).
        jacobian: Shape (m, z).
        covariance: Shape (z, z), of the parameters today.
    """

    mean: Array
    jacobian: Array
    covariance: Array

    @property
    def predictive(self) -> Array:
        """Covariance of the readings, shape (m, m)."""
        blurred = self.covariance + SLOPE_ERROR**2 * np.diag(np.diag(self.covariance))
        predictive: Array = np.eye(len(self.mean)) + self.jacobian @ blurred @ self.jacobian.T
        return predictive


def expected_log_bayes_factor(one: Expectation, two: Expectation) -> float:
    """Return the expected log Bayes factor for the true one of two explanations, whichever it is: the smaller one.

    If `one` is true, it is the Kullback-Leibler divergence of its predictive distribution from that of `two`,
    (tr(S2^-1 S1) - m + d^T S2^-1 d + log det S2 - log det S1) / 2.
    """
    first, second = (np.asarray(np.linalg.cholesky(e.predictive), dtype=np.float64) for e in (one, two))
    difference = one.mean - two.mean
    return min(_divergence(first, second, difference), _divergence(second, first, difference))


def _divergence(true: Array, other: Array, difference: Array) -> float:
    """Return the divergence from Cholesky factors of both covariances, shape (m, m)."""
    both = solve_triangular(other, np.column_stack([true, difference]), lower=True)
    determinants = float(np.sum(np.log(np.diag(other))) - np.sum(np.log(np.diag(true))))
    return 0.5 * (float(np.sum(both**2)) - len(true)) + determinants


def narrowing(expectation: Expectation, parameter: int) -> float:
    """Return by which factor an experiment shrinks the standard deviation of one parameter, at most 1."""
    column = expectation.jacobian @ expectation.covariance[:, parameter]
    fall = float(column @ np.linalg.solve(expectation.predictive, column))
    return float(np.sqrt(max(1 - fall / expectation.covariance[parameter, parameter], 0.0)))


class Preposterior:
    """Several explanations, several experiments.

    Args:
        linear: Today's campaign.
        fits: Explanations.
        experiments: To be simulated.
        quantities: Of the experiments.
        is_quick: Leave out the deviations of the model itself, which need a simulation each; what is expected is then
            too much, but sorts out what is hopeless.
        executor: Where to simulate.

    Raises:
        ConvergenceError, RobotError: An explanation cannot be simulated in one of the experiments.
    """

    def __init__(
        self,
        linear: LinearisedModel,
        fits: Sequence[Fit],
        experiments: Sequence[Experiment],
        quantities: tuple[Quantity, ...],
        is_quick: bool,
        executor: Executor = SERIAL,
    ) -> None:
        self.fits = fits
        self._scatter = linear.scatter
        self._index: dict[int, int] = {}
        unique: list[Segment] = []
        for segment in (s for experiment in experiments for s in experiment.segments):
            if id(segment.motion) not in self._index:
                self._index[id(segment.motion)] = len(unique)
                unique.append(segment)
        self._replay = Replay(linear.replay.compiled, tuple(unique), quantities)
        traces = self._replay.traces(NOMINAL)
        self.trace = traces[0]
        self._responses = [torque_response(self._replay.compiled, trace, quantities) for trace in traces]
        held, held_changes = held_friction(self._replay, traces, tuple(self._responses), linear.scatter.levels)
        nuisances = with_recordings(
            nuisances_of(self._replay.compiled, quantities), self._replay.compiled, recordings_of(linear.segments)
        )
        simulated = [n for n in nuisances if not (is_quick and n.moves_robot)]
        beside = [one for fit in fits for one in fit.worlds_beside(linear)]
        worlds = [NOMINAL, *(fit.world(linear) for fit in fits), *(world for world, _ in beside)]
        found = simulate_all(self._replay, worlds + [World({n: n.sigma}) for n in simulated], executor)
        nominal, means = sound(found[0]), [sound(f) for f in found[1 : len(fits) + 1]]
        there = [sound(f) for f in found[len(fits) + 1 : len(worlds)]]
        moved = iter([(one, step) for one, (_, step) in zip(there, beside, strict=True)])
        deviations = [
            np.zeros_like(nominal) if isinstance(f, BenchError) else f - nominal for f in found[len(worlds) :]
        ]
        by_name = {str(n): change for n, change in zip(simulated, deviations, strict=True)}
        weights, their_changes = each_weight(unique, simulated, np.stack([nominal, *deviations], axis=2)[:, :, 1:])
        first_order = (*held, *weights)
        changes = np.concatenate([held_changes, their_changes], axis=2)
        by_name |= {str(n): changes[:, :, i] for i, n in enumerate(first_order)}
        today = [str(n) for n in linear.nuisances]
        fresh = [name for name in by_name if name not in today]
        nothing = np.zeros_like(nominal)
        sensitivities = np.stack([by_name.get(name, nothing) for name in (*today, *fresh)], axis=2)
        self._split = np.cumsum([len(segment) for segment in unique])[:-1]
        self._means, self._slopes, self._covariances = [], [], []
        names = [str(n) for n in first_order]
        for fit, mean in zip(fits, means, strict=True):
            settled = sum((by_name[n] * fit.nuisances[today.index(n)] for n in names if n in today), nothing)
            own = [(one - mean) / step for one, step in islice(moved, len(fit.unknowns))]
            self._means.append(np.split(mean + settled, self._split))
            jacobian = np.concatenate([sensitivities, np.stack(own, axis=2)], axis=2) if own else sensitivities
            self._slopes.append(np.split(jacobian, self._split))
            self._covariances.append(_covariance(linear, fit, len(fresh)))

    def expect(self, experiment: Experiment) -> list[Expectation]:
        """Return what each explanation expects of an experiment; parameters are nuisances, then sizes."""
        compiled, quantities = self._replay.compiled, self._replay.quantities
        where = [self._index[id(segment.motion)] for segment in experiment.segments]
        maps = [
            whitening_of(compiled, segment, self._responses[i], quantities, self._scatter)
            for segment, i in zip(experiment.segments, where, strict=True)
        ]
        found = []
        for means, jacobian, covariance in zip(self._means, self._slopes, self._covariances, strict=True):
            mean = np.concatenate([w(means[i]) for w, i in zip(maps, where, strict=True)])
            slope = np.concatenate([w(jacobian[i]) for w, i in zip(maps, where, strict=True)])
            found.append(Expectation(mean, slope, covariance))
        return found


def _covariance(linear: LinearisedModel, fit: Fit, fresh: int) -> Array:
    """Return the covariance of nuisances of today, fresh ones (prior one), and unknowns."""
    today = np.linalg.inv(tangent_of(linear, fit).precision)
    p, k = len(fit.nuisances), len(fit.unknowns)
    covariance = np.eye(p + fresh + k)
    old = np.concatenate([np.arange(p), p + fresh + np.arange(k)])
    covariance[np.ix_(old, old)] = today
    return covariance
