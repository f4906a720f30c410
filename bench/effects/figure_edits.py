"""How a figure of a robot is changed: edits of its `MjSpec`, each a function of by how much."""

from collections.abc import Callable
from typing import Literal

import mujoco
import numpy as np

from bench.effects.friction_elements import DRAG
from bench.record.campaign import Array
from bench.robot.compiled import SpecEdit
from bench.robot.folder import Robot
from bench.robot.moments_of_inertia import moments_of_inertia, second_moments
from bench.robot.plugins import attributes_of, configure, number_of

LEAST_SHARE = -0.999  # rounding: by which a figure that cannot be negative is off at most; MuJoCo needs rotors to weigh


def plugin_scaled(actuator: str, key: str) -> Callable[[float], SpecEdit]:
    """Return how a number of a plugin is multiplied by a factor."""
    return lambda factor: (
        lambda spec, robot: configure(spec, actuator, **{key: factor * number_of(spec, actuator, key)})
    )


def drag_scaled(actuator: str) -> Callable[[float], SpecEdit]:
    """Return how the friction over speed that a friction element has learned is multiplied by a factor."""

    def change(factor: float) -> SpecEdit:
        def edit(spec: mujoco.MjSpec, robot: Robot) -> None:
            there = attributes_of(spec, actuator)
            configure(spec, actuator, **{key: factor * float(there[key]) for key in DRAG if key in there})

        return edit

    return change


def plugin_shifted(actuator: str, key: str) -> Callable[[float], SpecEdit]:
    """Return how something is added to a number of a plugin, in its unit."""
    return lambda x: lambda spec, robot: configure(spec, actuator, **{key: x + number_of(spec, actuator, key)})


def joint_scaled(joint: str, attribute: str) -> Callable[[float], SpecEdit]:
    """Return how a number of a joint is multiplied by a factor."""

    def change(factor: float) -> SpecEdit:
        def edit(spec: mujoco.MjSpec, robot: Robot) -> None:
            found = spec.joint(joint)
            setattr(found, attribute, getattr(found, attribute) * factor)

        return edit

    return change


def stiffness_scaled(element: str) -> Callable[[float], SpecEdit]:
    """Return how the stiffness of an elastic element is multiplied by a factor."""

    def change(factor: float) -> SpecEdit:
        def edit(spec: mujoco.MjSpec, robot: Robot) -> None:
            tendon = spec.tendon(element)
            tendon.stiffness = np.asarray(tendon.stiffness) * factor

        return edit

    return change


def mass_scaled(body: str) -> Callable[[float], SpecEdit]:
    """Return how the mass of a body is multiplied by a factor, its inertia with it."""

    def change(factor: float) -> SpecEdit:
        def edit(spec: mujoco.MjSpec, robot: Robot) -> None:
            link = spec.body(body)
            link.mass = link.mass * factor
            link.inertia = np.asarray(link.inertia) * factor
            link.fullinertia = np.asarray(link.fullinertia) * factor

        return edit

    return change


def mass_spread(body: str, axis: int, axes: Array) -> Callable[[float], SpecEdit]:
    """Return how a link's mass is spread wider along a principal axis; bodies that can exist stay so (A + B >= C).

    Args:
        body: Of the link.
        axis: Which of the three.
        axes: Shape (3, 3), principal axes of the nominal link, columns.
    """

    def change(x: float) -> SpecEdit:
        def edit(spec: mujoco.MjSpec, robot: Robot) -> None:
            link = spec.body(body)
            is_full = not np.isnan(link.fullinertia[0])
            inertia = np.asarray(link.inertia)
            if is_full:
                xx, yy, zz, xy, xz, yz = link.fullinertia
                inertia = np.diag(axes.T @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ axes)
            second = second_moments(inertia)
            second[axis] = max(second[axis] + x * second.sum(), (1 + LEAST_SHARE) * second[axis])
            inertia = moments_of_inertia(second)
            if is_full:
                full = (axes * inertia) @ axes.T
                link.fullinertia = np.array([*np.diag(full), full[0, 1], full[0, 2], full[1, 2]])
            else:
                link.inertia = inertia

        return edit

    return change


def axis_turned(joint: str, lean: Array) -> Callable[[float], SpecEdit]:
    """Return how the axis of a joint leans, by a small angle [rad].

    With the joint at its zero everything stays where it is: what is left of a geometry that is wrong are the directions
    of its axes (the product of exponentials; Okamura and Park, Kinematic calibration using the product of exponentials
    formula, 1996).

    Args:
        joint: Its name.
        lean: Shape (3,), unit vector at right angles to the axis, in the frame of the joint's body; there it leans to.
    """

    def change(x: float) -> SpecEdit:
        def edit(spec: mujoco.MjSpec, robot: Robot) -> None:
            found = spec.joint(joint)
            axis = np.asarray(found.axis)
            found.axis = axis / np.linalg.norm(axis) + np.tan(x) * lean

        return edit

    return change


def place_shifted(kind: Literal["body", "site"], name: str, attribute: str, axis: int) -> Callable[[float], SpecEdit]:
    """Return how a place is moved along an axis of the body that it is in [m].

    Args:
        kind: Of the part.
        name: Of the part.
        attribute: Which place: "pos" of a body in its parent or of a site, "ipos" of a body's centre of mass.
        axis: Which of the three.
    """

    def change(x: float) -> SpecEdit:
        def edit(spec: mujoco.MjSpec, robot: Robot) -> None:
            part = getattr(spec, kind)(name)
            setattr(part, attribute, np.asarray(getattr(part, attribute)) + x * np.eye(3)[axis])

        return edit

    return change
