"""Background errors: what is a little wrong in everything that a diagnosis takes for nominal."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Self

import mujoco
import numpy as np

from bench.effects.conditions import REFERENCE_K
from bench.effects.gas import amount_scaled
from bench.effects.nominal import nominal_parameters
from bench.robot.compiled import CompiledRobot, SpecEdit
from bench.robot.folder import Robot
from bench.simulate.pulls import Array, pulled


@dataclass(frozen=True)
class Background:
    """One draw of background errors.

    Attributes:
        deviations: Name of a nominal parameter -> its deviation.
        hung: Relative error of the weights that are hung on.
        bolted: Relative error of the weights that are bolted on.
        pulled: Relative error of loads that are pulled aside, beside that of all that hangs.
        pull_turn: Shape (3,) [rad], by which they are turned about the world's axes.
        air_k: [K], by how much the air of the day, and the gas with it, is warmer than `REFERENCE_K`.
    """

    deviations: Mapping[str, float]
    hung: float = 0.0
    bolted: float = 0.0
    pulled: float = 0.0
    pull_turn: tuple[float, ...] = (0.0, 0.0, 0.0)
    air_k: float = 0.0

    @classmethod
    def draw(cls, compiled: CompiledRobot, rng: np.random.Generator) -> Self:
        """Draw every nominal parameter from a normal distribution with its own standard deviation."""
        deviations = {
            parameter.name: parameter.sigma * float(rng.standard_normal()) for parameter in nominal_parameters(compiled)
        }
        hung, bolted = (compiled.robot.figures.uncertainty.load * rng.standard_normal(2)).tolist()
        known = compiled.robot.figures.uncertainty
        if not (known.pull or known.pull_rad):  # draws of other robots stay what they were
            return cls(deviations, hung, bolted)
        more, *turn = rng.standard_normal(4).tolist()
        return cls(deviations, hung, bolted, known.pull * more, tuple(known.pull_rad * angle for angle in turn))

    def loads(self, nominal: Array) -> Array:
        """Return true loads on the load point, shape (T, 6) [N, Nm] in world axes."""
        return (1 + self.hung) * pulled(nominal, self.pulled, np.array(self.pull_turn))

    def off_by(self, compiled: CompiledRobot) -> dict[str, float]:
        """Return by how much each figure is off, in its unit; of what is known to a factor, as a share of it."""
        known = {one.name: one for one in nominal_parameters(compiled)}
        return {name: known[name].off_by(deviation) for name, deviation in self.deviations.items()}

    def edits(self, compiled: CompiledRobot) -> tuple[SpecEdit, ...]:
        """Return the changes of the model, bolted weights among them; to be applied after a payload was bolted on."""
        known = nominal_parameters(compiled)
        changes = [one.edit(self.deviations[one.name]) for one in known if one.name in self.deviations]
        warmer = amount_scaled(1 + self.air_k / REFERENCE_K) if compiled.counterbalance else None
        return (_heavier(self.bolted), *changes, *filter(None, [warmer]))


def _heavier(share: float) -> SpecEdit:
    def edit(spec: mujoco.MjSpec, robot: Robot) -> None:
        load = spec.body(robot.figures.load_body)
        load.mass = load.mass * (1 + share)

    return edit
