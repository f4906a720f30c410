"""Changes of a robot's model, made on its `MjSpec` before it is compiled."""

import mujoco

from bench.errors import RobotError
from bench.robot.compiled import SpecEdit
from bench.robot.folder import Robot
from bench.robot.plugins import configure, number_of


def friction_on(side: str) -> SpecEdit:
    """Return the edit that puts all static friction on one side of the elastic elements.

    "link": as the MJCF has it on the link side, none on the motor side. "motor": the same levels on the motor side,
    none on the link side. "none": none at all. "as-model": both sides as the MJCF has them.
    """
    if side == "as-model":
        return lambda spec, robot: None
    return shared_friction(scale=0.0 if side == "none" else 1.0, link_share=1.0 if side == "link" else 0.0)


def shared_friction(scale: float, link_share: float) -> SpecEdit:
    """Return the edit that shares static friction between the sides of the elastic elements.

    Args:
        scale: Friction of both sides together, relative to what the MJCF has on the link side.
        link_share: Share of it that sits on the link side, 0 to 1.
    """

    def edit(spec: mujoco.MjSpec, robot: Robot) -> None:
        for drive in robot.figures.drives:
            level = scale * number_of(spec, drive.link_friction, "coulomb")
            configure(spec, drive.link_friction, coulomb=link_share * level)
            configure(spec, drive.motor_friction, coulomb=(1 - link_share) * level)

    return edit


def proportional_servo(spec: mujoco.MjSpec, robot: Robot) -> None:
    """Take the integral action off the servos: they give by torque / kp, as drives without it do."""
    for key in list(spec.keys):
        spec.delete(key)  # its activations no longer fit
    for drive in robot.figures.drives:
        servo = spec.actuator(drive.servo)
        if servo.gaintype != mujoco.mjtGain.mjGAIN_PID:
            raise RobotError(
                f"{robot.mjcf}: servo {drive.servo!r} is not a <pid>; it has no integral action to take off."
            )
        gain, limits = servo.gainprm, servo.dynprm
        gain[0] = limits[0] = 0
        servo.gainprm, servo.dynprm, servo.dyntype = gain, limits, mujoco.mjtDyn.mjDYN_NONE
