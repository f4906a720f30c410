"""Robots drawn from the posterior of a diagnosis: domain randomisation that was measured.

A diagnosis leaves the robot as fitted and what its data say of all figures and findings together (`posterior.json`).
What is drawn here are deviations from that robot, with the covariance that these data leave of them: figures that were
measured closely hardly vary, those that trade against each other vary together.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.replay.fitted import figures_with
from bench.diagnose.replay.given import Given, Posterior, given_by
from bench.diagnose.replay.nuisances import Nuisance, nuisances_of
from bench.diagnose.replay.quantities import AXES, Quantity
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot
from bench.simulate.env import Drawn
from bench.simulate.fitted_errors import fitted_errors


class PosteriorDraws:
    """Draws robots from a posterior.

    Args:
        posterior: Of the diagnosis.
        compiled: The robot that it handed over.

    Attributes:
        names: What is drawn.
        held: Findings that are left as they were found, for they cannot be varied in the model.
        covariance: Shape (d, d), of what is drawn, in standard deviations of the priors (`sigmas`, shape (d,)).
    """

    def __init__(self, posterior: Posterior, compiled: CompiledRobot) -> None:
        self._compiled = compiled
        given = given_by(posterior, nuisances_of(compiled, _all_quantities(compiled)), compiled)
        known = [one for one in given.nuisances if one.said_before]
        acts = np.array([one.edit is not None or one.on_reading is not None for one in known], dtype=bool)
        self._drawn = tuple(one for one, used in zip(known, acts, strict=True) if used)
        self.names, self.held = tuple(one.name for one in self._drawn), given.held
        self.sigmas: Array = np.array([one.sigma for one in self._drawn])
        self.covariance: Array = _covariance(given)[np.ix_(acts, acts)]
        self._root = np.linalg.cholesky(self.covariance)
        self._is_drawn = self._fields_that_change()

    def __call__(self, rng: np.random.Generator) -> Drawn:
        """Draw a robot."""
        values = self.sigmas * (self._root @ rng.standard_normal(len(self.names)))
        deviations = dict(zip(self._drawn, values.tolist(), strict=True))
        shown = self._errors(deviations)
        return Drawn(
            edits=tuple(one.edit(value) for one, value in deviations.items() if one.edit),
            errors={name: (which, shown[name]) for name, which in self._is_drawn.items()},
            parameters={one.name: one.off_by(value / one.sigma) for one, value in deviations.items()},
        )

    def _errors(self, deviations: Mapping[Nuisance, float]) -> dict[str, Array]:
        """Return systematic errors of the instruments, those that the robot's figures hold included."""
        readings = {one: value for one, value in deviations.items() if one.on_reading}
        found, _, _ = figures_with(self._compiled, readings)
        figures = self._compiled.robot.figures
        fitted = figures.fitted.model_copy(update={"readings": found})
        return {k: np.asarray(x) for k, x in fitted_errors(figures.model_copy(update={"fitted": fitted})).items()}

    def _fields_that_change(self) -> dict[str, NDArray[np.bool_]]:
        """Return the systematic errors that readings among what is drawn make, and which of their entries."""
        own = self._errors({})
        changed = {name: np.zeros(np.shape(value), dtype=bool) for name, value in own.items()}
        for one in self._drawn:
            for name, value in self._errors({one: one.sigma}).items():
                changed[name] |= value != own[name]
        return {name: which for name, which in changed.items() if np.any(which)}


def _covariance(given: Given) -> Array:
    """Return what an earlier diagnosis leaves of what it says, shape (k, k), in standard deviations of the priors.

    `given_by` has its data as readings R of deviations in those standard deviations: the precision is I + R^T R.
    """
    known = [one for one in given.nuisances if one.said_before]
    rows = np.array([np.array(one.said_before) * one.sigma for one in known]).T.reshape(-1, len(known))
    covariance: Array = np.linalg.inv(np.eye(len(known)) + rows.T @ rows)
    return (covariance + covariance.T) / 2


def _all_quantities(compiled: CompiledRobot) -> tuple[Quantity, ...]:
    """Return what the instruments of a robot could measure whose errors a diagnosis may know."""
    figures, found = compiled.robot.figures, []
    instruments = figures.instruments
    for j in range(compiled.n_joints):
        if instruments.current:
            found.append(Quantity(f"current_{j + 1}_a", "current", "A", j))
        elif instruments.torque:
            found.append(Quantity(f"tau_motor_{j + 1}_nm", "tau_motor", "Nm", j))
    if instruments.tracker:
        found += [Quantity(f"reflector_{k + 1}_x_m", "reflector", "m", k) for k in range(len(figures.reflectors))]
    if instruments.force:
        found.append(Quantity(f"force_{AXES[0]}_n", "force", "N"))
    return tuple(found)
