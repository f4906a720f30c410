"""What the catalogue does not hold and the first plant does not have: friction of angle and load at once."""

from math import pi

import mujoco
import numpy as np

from bench.effects.effect import Effect, Parameter, Place
from bench.effects.places import OnDrive, drives
from bench.robot.compiled import CompiledRobot

UPRIGHT = 0.999  # rounding: cosine between an axis and gravity, from where gravity never loads its gear


class AngleLoadFriction(OnDrive):
    """A gear that rubs under load where it runs out."""

    name = "angle_load_friction"
    family = "own"
    title = "friction that depends on load and angle at once"
    physics = "The motor-side level rises by mu |tau| (1 + sin(2 pi q/p)) with the torque tau of the elastic element."
    source = "assumed, for tests; range: that of load_friction"
    parameters = (
        Parameter("coefficient", "", 0.0, 0.01, 0.06, "mu, mean level per transmitted torque"),
        Parameter("period", "rad", pi / 3, pi / 12, 2 * pi, "p", is_shape=True),
    )

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        """Return the drives that gravity loads; elsewhere a gear transmits little but friction."""
        model, data = compiled.model, mujoco.MjData(compiled.model)
        mujoco.mj_kinematics(model, data)
        down = model.opt.gravity / np.linalg.norm(model.opt.gravity)
        is_loaded = np.abs(data.xaxis[compiled.at.joint] @ down) < UPRIGHT
        return tuple(place for place in drives(compiled) if is_loaded[place.index])


def second_unlisted() -> dict[str, Effect]:
    """Return these effects by name."""
    return {kind.name: kind() for kind in (AngleLoadFriction,)}
