"""Three effects, one for each way in which an effect can act, and one that is slow."""

from collections.abc import Mapping
from dataclasses import replace

import mujoco
import numpy as np

from bench.effects.conditions import REFERENCE_K, Conditions
from bench.effects.effect import Acting, Effect, Parameter, Place, Values
from bench.robot.compiled import CompiledRobot, SpecEdit
from bench.robot.folder import Robot
from bench.robot.plugins import configure, number_of
from bench.simulate.instruments import Reading
from bench.simulate.trace import Array, Trace


class OfJoint(Effect):
    family = "own"
    physics = source = "none"

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        joints = (drive.joint for drive in compiled.robot.figures.drives)
        return tuple(Place("joint", index, name) for index, name in enumerate(joints))


class Level(OfJoint):
    name, title = "level", "more friction on the motor side"
    parameters = (
        Parameter("rise", "", 0.0, 0.1, 0.9, "relative", signed=True),
        Parameter("heat", "1/K", 0.0, 0.01, 0.04, "relative, per kelvin of the gear"),
    )

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        warm = conditions.gear_k[place.index] - REFERENCE_K
        factor = 1 + values["rise"] + values["heat"] * warm

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            actuator = robot.figures.drives[place.index].motor_friction
            configure(spec, actuator, coulomb=factor * number_of(spec, actuator, "coulomb"))

        return change


class Eccentric(OfJoint):
    name, title = "eccentric", "encoder out of centre"
    parameters = (Parameter("size", "rad", 0.0, 1e-4, 1e-3, "amplitude over a turn"),)

    def encoder_error(self, place: Place, values: Values, q: Array, velocity: Array) -> Array:
        error = np.zeros_like(q)
        error[:, place.index] = values["size"] * np.cos(q[:, place.index])
        return error


class Warmth(Effect):
    name, title, family = "warmth", "currents that grow with the windings' temperature", "own"
    physics = source = "none"
    parameters = (Parameter("rate", "1/K", 0.0, 0.001, 0.01, "relative"),)

    def distort(self, place: Place, values: Values, reading: Reading, trace: Trace, conditions: Conditions) -> Reading:
        return replace(reading, current=reading.current * (1 + values["rate"] * (conditions.winding_k - REFERENCE_K)))


CATALOGUE: Mapping[str, Effect] = {effect.name: effect for effect in (Level(), Eccentric(), Warmth())}


def acting(name: str, joint: int | None = None, **values: float) -> Acting:
    """Return an effect that acts, on a joint (from 1) of the two-joint robot or as a whole."""
    place = Place("robot") if joint is None else Place("joint", joint - 1, f"hinge_{'ab'[joint - 1]}")
    return Acting(CATALOGUE[name], place, values)
