"""Friction elements of a drive in a spec: read their levels, change their attributes."""

from typing import Literal

import mujoco

from bench.robot.compiled import rolling_of
from bench.robot.figures import Drive
from bench.robot.folder import Robot
from bench.robot.plugins import attributes_of, configure, number_of

Side = Literal["motor", "link"]
SIDES: tuple[Side, Side] = ("motor", "link")
DRAG = ("drag", "drag_square", "drag_cube")  # attributes of what was learned of friction, by power of speed


def element_name(drive: Drive, side: Side) -> str:
    """Return the name of the friction actuator on one side of the elastic element."""
    return drive.motor_friction if side == "motor" else drive.link_friction


def coulomb(spec: mujoco.MjSpec, drive: Drive, side: Side) -> float:
    """Return the Coulomb level on one side [Nm]."""
    return number_of(spec, element_name(drive, side), "coulomb")


def set_coulomb(spec: mujoco.MjSpec, drive: Drive, side: Side, level: float) -> None:
    """Set the Coulomb level on one side [Nm]."""
    configure(spec, element_name(drive, side), coulomb=level)


def scale_coulomb(spec: mujoco.MjSpec, drive: Drive, factor: float) -> None:
    """Multiply the Coulomb levels of both sides."""
    for side in SIDES:
        set_coulomb(spec, drive, side, factor * coulomb(spec, drive, side))


def given(spec: mujoco.MjSpec, drive: Drive, side: Side, attribute: str) -> float:
    """Return an attribute of the element on one side that may be left out; 0 then."""
    return float(attributes_of(spec, element_name(drive, side)).get(attribute, "0"))


def rolling(spec: mujoco.MjSpec, drive: Drive) -> float:
    """Return the rolling friction of the motor side at 1 rad/s (1 m/s) [Nm]."""
    return rolling_of(attributes_of(spec, drive.motor_friction))


def scale_rolling(spec: mujoco.MjSpec, drive: Drive, factor: float) -> None:
    """Multiply the rolling friction of the motor side, if there is any."""
    if there := rolling(spec, drive):
        configure(spec, drive.motor_friction, rolling=factor * there)


def give(spec: mujoco.MjSpec, robot: Robot, drive: Drive, **values: float | str) -> None:
    """Set attributes of the elements on both sides of a drive, which other drives may share an instance with.

    An attribute that was not there becomes the others' too, as they share it. They get the same value where it only
    shapes what they have not got, their own tendon for `element`, and zero for the rest.
    """
    for side in SIDES:
        give_side(spec, robot, drive, side, **values)


def give_side(spec: mujoco.MjSpec, robot: Robot, drive: Drive, side: Side, **values: float | str) -> None:
    """Set attributes of the element on one side of a drive; see `give`."""
    own = element_name(drive, side)
    for key, value in values.items():
        if key in _SHAPES and key not in attributes_of(spec, own):
            for other in _sharing(spec, robot, own):
                configure(spec, element_name(*other), **{key: other[0].element if key == "element" else value})
        configure(spec, own, **{key: value})


_SHAPES = frozenset({"stribeck_velocity", "ripple_period", "drag_speed", "element"})  # attributes that may not be zero


def _sharing(spec: mujoco.MjSpec, robot: Robot, actuator: str) -> list[tuple[Drive, Side]]:
    """Return drives and sides whose friction actuators share a plugin instance with one of them, it included."""
    instance = spec.actuator(actuator).plugin.name
    everything = [(drive, side) for drive in robot.figures.drives for side in SIDES]
    if not instance:
        return [pair for pair in everything if element_name(*pair) == actuator]
    return [pair for pair in everything if spec.actuator(element_name(*pair)).plugin.name == instance]
