"""Gears that do not turn the link by exactly what the motor turned."""

from math import pi

import mujoco
import numpy as np

from bench.actuators.laws import TorqueTable
from bench.effects.conditions import Conditions
from bench.effects.effect import WHOLE, Array, Effect, Parameter, Place, Values
from bench.effects.followed import Followed, Torques
from bench.effects.places import OnDrive, drive_of, hinges
from bench.effects.plugin_actuators import add_torque_table
from bench.robot.compiled import CompiledRobot, SpecEdit
from bench.robot.folder import Robot

KNOTS_PER_CYCLE = 24  # rounding: linear in between is right to 1 % of the amplitude
SAME_POINT = 1e-3  # rounding: [m]; axes of a wrist meet within this
PARALLEL = 0.99  # rounding: cosine; axes of wrists are 30 degrees and more apart


class TransmissionError(OnDrive):
    """The link lags and leads by a little, periodically."""

    name = "transmission_error"
    family = "transmission"
    title = "transmission error of the gear"
    physics = (
        "Pitch and run-out errors turn the link by e = s sin(N theta) + c cos(N theta) too far: the elastic element "
        "carries k (q + e - theta). Two torque tables, +k e on the link and -k e on the rotor."
    )
    source = (
        "Nye and Kraml, Harmonic drive gear error: characterization and compensation, 1991; Tuttle and Seering, 1996; "
        "range: design of this project, 10 to 60 arcsec"
    )
    is_additive = True
    parameters = (
        Parameter("sin", "rad", 0.0, 4.8e-5, 2.9e-4, "s; 10 to 60 arcsec", signed=True),
        Parameter("cos", "rad", 0.0, 4.8e-5, 2.9e-4, "c", signed=True),
        Parameter("cycles", "", 2.0, 1.0, 120.0, "N, cycles per turn of the joint", is_shape=True, ratio=1.15),
    )

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        """Return the drives that turn a hinge."""
        return hinges(compiled)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        sine, cosine, cycles = values["sin"], values["cos"], values["cycles"]

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            drive = drive_of(robot, place)
            stiffness = float(np.asarray(spec.tendon(drive.element).stiffness)[0])
            low, high = table_range(spec, drive.joint)
            count = max(64, int(np.ceil(KNOTS_PER_CYCLE * cycles * (high - low) / (2 * pi)))) + 1

            def lead(x: Array) -> Array:
                return stiffness * (sine * np.sin(cycles * x) + cosine * np.cos(cycles * x))

            law = TorqueTable.of(lead, low, high, count)
            add_torque_table(spec, f"transmission error {drive.joint}", law, joint=drive.joint)
            law = TorqueTable.of(lambda x: -lead(x), low, high, count)
            add_torque_table(spec, f"transmission error {drive.rotor}", law, joint=drive.rotor)

        return change if sine or cosine else None

    def torques(self, place: Place, values: Values, followed: Followed) -> Torques | None:
        def lead(x: Array) -> Array:
            phase = values["cycles"] * x[:, place.index]
            turn: Array = values["sin"] * np.sin(phase) + values["cos"] * np.cos(phase)
            return float(followed.compiled.stiffness[place.index]) * turn

        return Torques(motor=-lead(followed.trace.q), link=lead(followed.trace.theta))


class WristCoupling(Effect):
    """Motors of the wrist turn each other's links."""

    name = "wrist_coupling"
    family = "transmission"
    title = "coupling between the axes of the wrist"
    physics = (
        "Hollow shafts run through the wrist, so turning an outer axis turns the gears of the inner ones: elements "
        "carry k5 (q5 + c54 q4 - theta5) and k6 (q6 + c64 q4 + c65 q5 - theta6); what the controller leaves "
        "uncorrected."
    )
    source = "geometry of hollow-shaft wrists; range: ratio error that the controller leaves, assumed"
    parameters = (
        Parameter("c54", "", 0.0, 2e-4, 2e-2, "of the fifth link on the fourth motor", signed=True),
        Parameter("c64", "", 0.0, 2e-4, 2e-2, "of the sixth link on the fourth motor", signed=True),
        Parameter("c65", "", 0.0, 2e-4, 2e-2, "of the sixth link on the fifth motor", signed=True),
    )

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        """Return the robot if its last three axes meet in a point."""
        return (WHOLE,) if _has_wrist(compiled) else ()

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        c54, c64, c65 = values["c54"], values["c64"], values["c65"]

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            fourth, fifth, sixth = robot.figures.drives[-3:]
            for element, rotor, coefficient in (
                (fifth.element, fourth.rotor, c54),
                (sixth.element, fourth.rotor, c64),
                (sixth.element, fifth.rotor, c65),
            ):
                if coefficient:
                    spec.tendon(element).wrap_joint(rotor, coefficient)

        return change if c54 or c64 or c65 else None


class AxisCoupling(OnDrive):
    """The motor before turns this link, too."""

    name = "axis_coupling"
    family = "transmission"
    title = "coupling to the parallel axis before"
    physics = (
        "Where belts or a parallelogram run along a parallel axis, turning that axis turns the gear of this one: its "
        "element carries k (q + c q_before - theta); what the controller leaves uncorrected."
    )
    source = "geometry of parallelogram linkages and of belts through an arm; range: as of wrist_coupling, assumed"
    parameters = (
        Parameter("ratio", "", 0.0, 2e-4, 2e-2, "c, of this link on the motor of the axis before", signed=True),
    )

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        """Return the drives whose hinge is parallel to the one before."""
        data = mujoco.MjData(compiled.model)
        mujoco.mj_kinematics(compiled.model, data)
        axes = data.xaxis[compiled.at.joint]
        turning = {place.index for place in hinges(compiled)}
        return tuple(
            place
            for place in hinges(compiled)
            if place.index - 1 in turning and abs(axes[place.index] @ axes[place.index - 1]) > PARALLEL
        )

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        ratio = values["ratio"]

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            before = robot.figures.drives[place.index - 1]
            spec.tendon(drive_of(robot, place).element).wrap_joint(before.rotor, ratio)

        return change if ratio else None


def table_range(spec: mujoco.MjSpec, joint: str) -> tuple[float, float]:
    """Return the range of a joint that a table has to cover, a little wider than its limits [rad] or [m]."""
    low, high = (float(end) for end in spec.joint(joint).range)
    if low >= high:
        return -2 * pi, 2 * pi
    margin = 0.02 * (high - low)
    return low - margin, high + margin


def _has_wrist(compiled: CompiledRobot) -> bool:
    if compiled.n_joints < 3:
        return False
    model = compiled.model
    joints = compiled.at.joint[-3:]
    if np.any(model.jnt_type[joints] != mujoco.mjtJoint.mjJNT_HINGE):
        return False
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    axes, anchors = data.xaxis[joints], data.xanchor[joints]
    if abs(axes[0] @ axes[1]) > PARALLEL or abs(axes[1] @ axes[2]) > PARALLEL:
        return False
    # the point nearest to all three axes
    across = [np.eye(3) - np.outer(axis, axis) for axis in axes]
    right = np.sum([p @ anchor for p, anchor in zip(across, anchors, strict=True)], axis=0)
    point = np.linalg.solve(np.sum(across, axis=0), right)
    return all(np.linalg.norm(p @ (point - anchor)) < SAME_POINT for p, anchor in zip(across, anchors, strict=True))
