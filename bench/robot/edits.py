"""Changes of a robot's model, made on its `MjSpec` before it is compiled."""

import mujoco

from bench.errors import RobotError
from bench.robot.compiled import SpecEdit
from bench.robot.folder import Robot
from bench.robot.plugins import configure, number_of


def friction_on(side: str) -> SpecEdit:
    """Return the edit that puts all static friction on one side of the elastic elements.

    "link": as the MJCF has it on the link side, none on the motor side. "motor": the same levels on the motor side, none
    on the link side. "none": none at all. "as-model": both sides as the MJCF has them.
    """

    def edit(spec: mujoco.MjSpec, robot: Robot) -> None:
        for drive in robot.figures.drives:
            level = number_of(spec, drive.link_friction, "coulomb")
            if side in ("link", "motor", "none"):
                configure(spec, drive.link_friction, coulomb=level if side == "link" else 0)
                configure(spec, drive.motor_friction, coulomb=level if side == "motor" else 0)

    return edit


def proportional_servo(spec: mujoco.MjSpec, robot: Robot) -> None:
    """Take the integral action off the servos: they give by torque / kp, as drives without it do."""
    for key in list(spec.keys):
        spec.delete(key)  # its activations no longer fit
    for drive in robot.figures.drives:
        servo = spec.actuator(drive.servo)
        if servo.gaintype != mujoco.mjtGain.mjGAIN_PID:
            raise RobotError(f"{robot.mjcf}: servo {drive.servo!r} is not a <pid>, so it has no integral action to take off.")
        gain, limits = servo.gainprm, servo.dynprm
        gain[0] = limits[0] = 0
        servo.gainprm, servo.dynprm, servo.dyntype = gain, limits, mujoco.mjtDyn.mjDYN_NONE
