"""An extension as a function of its parameters: what it leaves of the readings, how far from probable, derivatives."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.extend.fit import Unknown, unknowns_of, world_of
from bench.diagnose.extend.steps import HALVINGS, broyden
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.first_order import FirstOrder
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.replay.nuisances import Nuisance
from bench.diagnose.replay.world import World, moves
from bench.errors import NOT_SIMULATED
from bench.executor.contract import Progress, ignore
from bench.record.campaign import Array

STEP_OF_NUISANCE = 0.5  # rounding: of its standard deviation, for its derivative about an extension
TELLS = 1.0  # rounding: what readings tell of a nuisance, times what was known of it before, from where it matters


@dataclass(frozen=True, eq=False)
class State:
    """Parameters of an extension, and what was simulated with them; p nuisances, k unknowns, m whitened readings.

    Attributes:
        nuisances: Shape (p,), in standard deviations of their priors.
        values: Shape (k,), of the unknowns.
        residual: Shape (T, c), measured less simulated.
        white: Shape (m,), the same whitened.
        objective: Chi-square plus penalties of the priors.
    """

    nuisances: Array
    values: Array
    residual: Array
    white: Array
    objective: float


@dataclass(frozen=True, eq=False)
class Derivatives:
    """What an extension does to the readings with each parameter, to first order.

    Attributes:
        at: Where those of the unknowns were taken; None: by another fit, near by.
        jacobian: Shape (T, c, k), change of the readings with each unknown.
        tangent: Shape (m, p + k), change of whitened readings with each parameter, nuisances first.
        precision: Shape (p + k, p + k), of the parameters, their priors included.
        renewed: Derivatives of nuisances that are not those of the design, each by its index, shape (T, c).
        renewed_at: Where these were taken in this fit; None: they were not.
        all_at: Where those of all nuisances were.
        is_doubtful: Whether they may promise nothing where a fit could go on: they are bent to what steps showed, or
            those of nuisances are of elsewhere although they failed there, or of a robot without its play.
    """

    at: State | None
    jacobian: Array
    tangent: Array
    precision: Array
    renewed: Mapping[int, Array]
    renewed_at: State | None = None
    all_at: State | None = None
    is_doubtful: bool = False


class Objective:
    """An extension of the nominal model, held against a campaign.

    Args:
        linear: The campaign; the scatter in it knows the play of the extended model.
        causes: What is added to the nominal model.
        progress: Called before every simulation; what it raises ends the fit.
        errors: Shape (k,), standard errors of the unknowns by a fit near by, for steps; None: not known.
    """

    def __init__(
        self,
        linear: LinearisedModel,
        causes: tuple[Cause, ...],
        progress: Progress = ignore,
        errors: Array | None = None,
    ) -> None:
        self._progress = progress
        self.linear, self.causes, self.unknowns = linear, causes, unknowns_of(causes)
        self.sigma = np.array([unknown.sigma for unknown in self.unknowns])
        self.origin = np.array([unknown.parameter.null for unknown in self.unknowns])
        self._errors = np.full(len(self.unknowns), np.inf) if errors is None else errors
        self.low, self.high = bounds_of(linear.nuisances, self.unknowns)
        self.units = np.concatenate([np.ones(len(linear.nuisances)), self.sigma])
        at_work = {"", *(cause.effect.name for cause in causes)}
        nothing = np.zeros(linear.sensitivities.shape[:2])
        self._idle = {i: nothing for i, nuisance in enumerate(linear.nuisances) if nuisance.beside not in at_work}
        self._by_sensitivity = [i for i, nuisance in enumerate(linear.nuisances) if not nuisance.is_simulated]
        self._sensitivities = np.ascontiguousarray(linear.sensitivities[:, :, self._by_sensitivity])
        self._observed = linear.observed

    def at(self, nuisances: Array, values: Array, residual: Array | None = None) -> State:
        """Return where these parameters lead.

        Args:
            nuisances: Shape (p,).
            values: Shape (k,).
            residual: Shape (T, c), where it is known; None: it is simulated.

        Raises:
            ConvergenceError, RobotError: The extended model cannot be simulated there.
        """
        if residual is None:
            residual = self._left(nuisances, values)
        white = self.linear.whiten(residual)
        pull = (values - self.origin) / self.sigma
        return State(
            nuisances, values, residual, white, float(white @ white + nuisances @ nuisances) + float(pull @ pull)
        )

    def near(self, nuisances: Array, values: Array) -> State:
        """Return where these values lead, or lesser ones that can be simulated; linearised models promise too much.

        Raises:
            ConvergenceError, RobotError: The nominal model with these nuisances cannot be simulated either.
        """
        for _ in range(HALVINGS - 1):
            try:
                return self.at(nuisances, values)
            except NOT_SIMULATED:
                values = self.origin + (values - self.origin) / 2
        return self.at(nuisances, values)

    def after(self, state: State, step: Array) -> State:
        """Return where a step leads, shape (p + k,), within bounds.

        Raises:
            ConvergenceError, RobotError: The extended model cannot be simulated there.
        """
        here = np.concatenate([state.nuisances, state.values])
        return self.at(*np.split(np.clip(here + step, self.low, self.high), [len(state.nuisances)]))

    def limits(self, state: State) -> tuple[Array, Array]:
        """Return the least and the largest steps from a state, shape (p + k,) each."""
        here = np.concatenate([state.nuisances, state.values])
        return self.low - here, self.high - here

    def descent(self, state: State, derivatives: Derivatives) -> Array:
        """Return half the downhill gradient of the objective, shape (p + k,)."""
        pull = np.concatenate([state.nuisances, (state.values - self.origin) / self.sigma**2])
        return np.asarray(derivatives.tangent.T @ state.white - pull)

    def derivatives(
        self, state: State, known: Mapping[int, Array] | None = None, nuisances: Mapping[int, Array] | None = None
    ) -> Derivatives:
        """Return the derivatives at a state, those of the unknowns by simulation.

        Args:
            state: Where.
            known: Derivatives with some unknowns as another fit had them, each by its index, shape (T, c).
            nuisances: Derivatives of nuisances that are not those of the design, each by its index, shape (T, c).

        Raises:
            ConvergenceError, RobotError: There is no balance to either side of some value.
        """
        columns = dict(known or {})
        columns = self._of_torques(state, columns) | columns
        # what only reads differently comes first: the replay still has the motion that the residual was simulated along
        order = sorted(range(len(self.unknowns)), key=lambda i: moves(self.unknowns[i].cause.effect))
        wanted = [i for i in order if i not in columns]
        if wanted:  # simulated here too: at the end of a fit, what it leaves is linearised
            here = self._left(state.nuisances, state.values)
            columns |= {i: self._difference(state, here, i) for i in wanted}
        jacobian = np.zeros((*state.residual.shape, 0))
        if columns:
            jacobian = np.stack([columns[i] for i in range(len(self.unknowns))], axis=2)
        renewed = {**(nuisances or {}), **self._idle}
        tangent = self.linear.tangent(jacobian, renewed)
        precision = np.asarray(tangent.T @ tangent + np.diag(1 / self.units**2))
        return Derivatives(None if known else state, jacobian, tangent, precision, renewed)

    def all_derivatives(
        self, state: State, which: NDArray[np.bool_] | None = None, known: Derivatives | None = None
    ) -> Derivatives:
        """Return the derivatives at a state, those of nuisances that the readings tell of by simulation as well.

        Args:
            state: Where.
            which: Shape (p,), nuisances whose derivatives are taken; others stay as they are known. None: all.
            known: Derivatives so far.

        Raises:
            ConvergenceError, RobotError: There is no balance to either side of some value.
        """
        wanted = np.linalg.norm(self.linear.jacobian, axis=0) > TELLS
        if which is not None:
            wanted &= which
        found = self.of_nuisances(state.nuisances, state.values, np.flatnonzero(wanted).tolist())
        so_far = known.renewed if known else {}
        about = self.derivatives(state, nuisances={**so_far, **found})
        return replace(about, renewed_at=state, all_at=state if which is None else None, is_doubtful=which is not None)

    def of_nuisances(self, nuisances: Array, values: Array, which: Iterable[int]) -> dict[int, Array]:
        """Return the derivatives with some nuisances by simulation, each by its index, shape (T, c).

        Those that act by their changes alone are left out: these do not change.

        Args:
            nuisances: Shape (p,), where.
            values: Shape (k,), of the unknowns.
            which: Indices of nuisances.

        Raises:
            ConvergenceError, RobotError: There is no balance there, or beside some value.
        """

        def simulated(nuisances: Array) -> Array:
            return self._simulated(nuisances, values)

        here = simulated(nuisances)
        return {
            i: (simulated(_moved(nuisances, i, STEP_OF_NUISANCE)) - here) / STEP_OF_NUISANCE
            for i in which
            if self.linear.nuisances[i].is_simulated and i not in self._idle
        }

    def corrected(self, derivatives: Derivatives, before: State, after: State) -> Derivatives:
        """Return derivatives that are right along a step that was simulated."""
        step = np.concatenate([after.nuisances - before.nuisances, after.values - before.values])
        known = derivatives.tangent, derivatives.precision
        tangent, precision = broyden(*known, before.white - after.white, step, self.units)
        return replace(derivatives, tangent=tangent, precision=precision, is_doubtful=True)

    def _world(self, nuisances: Array, values: Array) -> World:
        return world_of(self.linear, self.causes, self.unknowns, values, nuisances)

    def _simulated(self, nuisances: Array, values: Array) -> Array:
        self._progress(0.0)
        return self.linear.replay.predict(self._world(nuisances, values))

    def _left(self, nuisances: Array, values: Array) -> Array:
        """Return measured less simulated, shape (T, c)."""
        simulated = self._simulated(nuisances, values)
        return np.asarray(self._observed - simulated - self._sensitivities @ nuisances[self._by_sensitivity])

    def _of_torques(self, state: State, known: Mapping[int, Array]) -> dict[int, Array]:
        """Return the change of the readings with each unknown that is not known and adds a torque, shape (T, c)."""
        which = [i for i, one in enumerate(self.unknowns) if i not in known and one.cause.effect.is_additive]
        if not which:
            return {}
        here = self._world(state.nuisances, state.values)
        about = FirstOrder(self.linear.replay, here)
        found: dict[int, Array] = {}
        for i in which:
            step = self.unknowns[i].step_from(float(state.values[i]), float(self._errors[i]))
            there = self._world(state.nuisances, _moved(state.values, i, step))
            number = self.causes.index(self.unknowns[i].cause)
            now, then = (about.change(world.acting[number]) for world in (here, there))
            if now is not None and then is not None:
                found[i] = (then - now) / step
        return found

    def _difference(self, state: State, here: Array, i: int) -> Array:
        """Return the change of the readings with an unknown by a difference of simulations, shape (T, c).

        Args:
            state: Where.
            here: What is left there, shape (T, c).
            i: Which unknown.
        """
        step = self.unknowns[i].step_from(float(state.values[i]), float(self._errors[i]))
        try:
            there = self._left(state.nuisances, _moved(state.values, i, step))
        except NOT_SIMULATED:  # no balance there; the other side is as good
            step = -step
            there = self._left(state.nuisances, _moved(state.values, i, step))
        return np.asarray((here - there) / step)


def bounds_of(nuisances: Sequence[Nuisance], unknowns: Sequence[Unknown]) -> tuple[Array, Array]:
    """Return the least and the largest values of nuisances, in standard deviations, then unknowns, shape (p + k,)."""
    bounds = [(n.least / n.sigma, np.inf) for n in nuisances] + [u.bounds for u in unknowns]
    low, high = np.array(bounds).reshape(-1, 2).T
    return low, high


def _moved(values: Array, i: int, step: float) -> Array:
    moved = values.copy()
    moved[i] += step
    return moved
