"""Physical effects that the catalogue does not hold and cannot express, for tests of the verdict "unlisted cause"."""

from dataclasses import replace

import mujoco
import numpy as np

from bench.actuators.laws import TorqueTable
from bench.effects.conditions import Conditions
from bench.effects.effect import WHOLE, Array, Effect, Parameter, Place, Values
from bench.effects.gear_kinematics import table_range
from bench.effects.places import OnDrive, drive_of, drives, hinges
from bench.effects.plugin_actuators import add_torque_table
from bench.robot.compiled import CompiledRobot, SpecEdit
from bench.robot.folder import Robot
from bench.simulate.instruments import Reading
from bench.simulate.trace import Trace

ASSUMED = "assumed, for tests"
KNOTS = 2001
LOADED = 200.0  # [N], load at which a bracket has given by 63 % of its play


class _OverAngle(OnDrive):
    """A torque over the angle of one link, as a table."""

    family = "own"

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        return hinges(compiled)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        if not values["torque"]:
            return None

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            joint = drive_of(robot, place).joint
            law = TorqueTable.of(lambda x: self.torque(values, x), *table_range(spec, joint), KNOTS)
            add_torque_table(spec, f"{self.name} {joint}", law, joint=joint)

        return change

    def torque(self, values: Values, angle: Array) -> Array:
        """Return the torque on the link over its angle [Nm]."""
        raise NotImplementedError


class Detent(_OverAngle):
    """A damaged tooth or a dent in the bearing ring."""

    name = "detent"
    title = "detent at one angle"
    physics = "At one angle the joint sinks into a dent: torque = -T u exp((1 - u^2)/2) with u = (theta - theta_0)/w."
    source = ASSUMED
    parameters = (
        Parameter("torque", "Nm", 0.0, 50.0, 800.0, "T, greatest; range for a drive of 10 kNm"),
        Parameter("angle", "rad", 0.3, -1.0, 1.0, "theta_0", is_shape=True),
        Parameter("width", "rad", 0.08, 0.03, 0.2, "w", is_shape=True),
    )

    def torque(self, values: Values, angle: Array) -> Array:
        u = (angle - values["angle"]) / values["width"]
        with np.errstate(under="ignore"):
            return -values["torque"] * u * np.exp((1 - u * u) / 2)


class SnappingCable(_OverAngle):
    """A cable that hangs on an edge and snaps over it."""

    name = "snapping_cable"
    title = "cable that snaps at one angle"
    physics = "A cable pulls on the link with -T until the joint has passed theta_0, and not at all beyond."
    source = ASSUMED
    parameters = (
        Parameter("torque", "Nm", 0.0, 20.0, 400.0, "T; range for a drive of 10 kNm"),
        Parameter("angle", "rad", 0.2, -1.0, 1.0, "theta_0", is_shape=True),
    )

    def torque(self, values: Values, angle: Array) -> Array:
        return np.where(angle < values["angle"], -values["torque"], 0.0)


class QuadraticDrag(OnDrive):
    """Churning oil at high speed."""

    name = "quadratic_drag"
    family = "own"
    title = "drag that grows with the square of speed"
    physics = "Churning of a full gearbox opposes motion with c v |v| on the motor side."
    source = ASSUMED
    parameters = (Parameter("coefficient", "Nm s^2/rad^2", 0.0, 50.0, 1000.0, "c; range for a drive of 10 kNm"),)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        coefficient = values["coefficient"]

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            joint = spec.joint(drive_of(robot, place).rotor)
            joint.damping = np.asarray(joint.damping) + np.array([0, coefficient, 0])

        return change if coefficient else None


class CreepingBracket(Effect):
    """The bracket of a reflector settles under the load."""

    name = "creeping_bracket"
    family = "own"
    title = "bracket of the first reflector settles under load"
    physics = "The first reflector drops by d (1 - exp(-|F|/200 N)) where a load F pulls, the others do not."
    source = ASSUMED
    parameters = (Parameter("drop", "m", 0.0, 5e-5, 5e-4, "d"),)

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        """Return the robot if a tracker looks at it."""
        return (WHOLE,) if compiled.robot.figures.instruments.tracker else ()

    def distort(self, place: Place, values: Values, reading: Reading, trace: Trace, conditions: Conditions) -> Reading:
        load = np.linalg.norm(trace.wrench[:, :3], axis=1)
        reflectors = reading.reflectors.copy()
        reflectors[:, 0, 2] -= values["drop"] * -np.expm1(-load / LOADED)
        return replace(reading, reflectors=reflectors)


class _OfCurrent(OnDrive):
    family = "own"

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        return drives(compiled) if compiled.robot.figures.instruments.current else ()


class CubicCurrent(_OfCurrent):
    """A current sensor that is not linear."""

    name = "cubic_current"
    title = "current sensor with a cubic error"
    physics = "The sensor reads I (1 - a + c I^2): right at 0 and at one current, too low between and too high beyond."
    source = ASSUMED
    parameters = (
        Parameter("error", "", 0.0, 0.02, 0.1, "a, relative error of small currents"),
        Parameter("right_at", "A", 15.0, 5.0, 40.0, "current that is read right, sqrt(a/c)", is_shape=True),
    )

    def distort(self, place: Place, values: Values, reading: Reading, trace: Trace, conditions: Conditions) -> Reading:
        current = reading.current.copy()
        seen = current[:, place.index]
        current[:, place.index] = seen * (1 + values["error"] * ((seen / values["right_at"]) ** 2 - 1))
        return replace(reading, current=current)


class CurrentDeadBand(_OfCurrent):
    """A drive that reports small currents as zero."""

    name = "current_dead_band"
    title = "dead band of the reported current"
    physics = "The drive reports sign(I) max(|I| - w, 0)."
    source = ASSUMED
    parameters = (Parameter("width", "A", 0.0, 0.1, 2.0, "w"),)

    def distort(self, place: Place, values: Values, reading: Reading, trace: Trace, conditions: Conditions) -> Reading:
        current = reading.current.copy()
        seen = current[:, place.index]
        current[:, place.index] = np.sign(seen) * np.maximum(np.abs(seen) - values["width"], 0)
        return replace(reading, current=current)


UNLISTED: tuple[type[Effect], ...] = (
    Detent,
    SnappingCable,
    QuadraticDrag,
    CreepingBracket,
    CubicCurrent,
    CurrentDeadBand,
)


def unlisted() -> dict[str, Effect]:
    """Return these effects by name."""
    return {kind.name: kind() for kind in UNLISTED}
