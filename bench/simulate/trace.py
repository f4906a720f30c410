"""Traces: true quantities over time, and the sensors of a model that they are read from. No instruments here."""

from collections.abc import Iterable
from dataclasses import dataclass, fields
from typing import Self

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.robot.compiled import CompiledRobot
from bench.robot.folder import Robot

Array = NDArray[np.float64]

_PREFIX = "bench/"


@dataclass(frozen=True, eq=False)
class Trace:
    """True quantities over T instants, all of the same instant; n drives, r reflectors. Equal where all numbers are.

    Attributes:
        time: Shape (T,) [s].
        q, q_velocity: Shape (T, n), motor angle reflected to the joint [rad] and its rate.
        theta, theta_velocity: Shape (T, n), link angle [rad] and its rate.
        motor_torque: Shape (T, n) [Nm], what the servo puts out in the step, reflected to the joint.
        motor_friction, link_friction: Shape (T, n) [Nm], torque of the friction elements on rotor and link.
        reflectors: Shape (T, r, 3) [m], world frame.
        load_point: Shape (T, 3) [m], world frame.
        wrench: Shape (T, 6) [N, Nm], force and moment on the load point, world axes.
        counterbalance_force: Shape (T,) [N], pull of the cylinder; nan for a robot without one.
        gas_force: Shape (T,) [N], part of it that is the gas', without the friction of the seals.
        counterbalance_length: Shape (T,) [m]; nan for a robot without one.
    """

    time: Array
    q: Array
    q_velocity: Array
    theta: Array
    theta_velocity: Array
    motor_torque: Array
    motor_friction: Array
    link_friction: Array
    reflectors: Array
    load_point: Array
    wrench: Array
    counterbalance_force: Array
    gas_force: Array
    counterbalance_length: Array

    def __len__(self) -> int:
        return len(self.time)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Trace):
            return NotImplemented
        pairs = ((getattr(self, f.name), getattr(other, f.name)) for f in fields(self))
        return all(np.array_equal(mine, theirs, equal_nan=True) for mine, theirs in pairs)

    __hash__ = None  # type: ignore[assignment]

    def __getitem__(self, rows: slice | NDArray[np.intp]) -> Self:
        return type(self)(**{f.name: getattr(self, f.name)[rows] for f in fields(self)})

    @classmethod
    def concatenate(cls, parts: Iterable["Trace"]) -> "Trace":
        """Join traces end to end."""
        parts = list(parts)
        return cls(**{f.name: np.concatenate([getattr(part, f.name) for part in parts]) for f in fields(cls)})


def add_trace_sensors(spec: mujoco.MjSpec, robot: Robot) -> None:
    """Add the sensors that a `Trace` is read from, in its order, after the sensors that the MJCF has."""
    kinds, objects = mujoco.mjtSensor, mujoco.mjtObj
    figures = robot.figures

    def add(kind: mujoco.mjtSensor, objtype: mujoco.mjtObj, name: str) -> None:
        spec.add_sensor(name=f"{_PREFIX}{sensor_kind_name(kind)}/{name}", type=kind, objtype=objtype, objname=name)

    for kind in (kinds.mjSENS_JOINTPOS, kinds.mjSENS_JOINTVEL):
        for drive in figures.drives:
            add(kind, objects.mjOBJ_JOINT, drive.rotor)
    for kind in (kinds.mjSENS_JOINTPOS, kinds.mjSENS_JOINTVEL):
        for drive in figures.drives:
            add(kind, objects.mjOBJ_JOINT, drive.joint)
    for part in ("servo", "motor_friction", "link_friction"):
        for drive in figures.drives:
            add(kinds.mjSENS_ACTUATORFRC, objects.mjOBJ_ACTUATOR, getattr(drive, part))
    for site in (*figures.reflectors, figures.load_point):
        add(kinds.mjSENS_FRAMEPOS, objects.mjOBJ_SITE, site)
    if figures.counterbalance:
        add(kinds.mjSENS_ACTUATORFRC, objects.mjOBJ_ACTUATOR, figures.counterbalance.actuator)
        add(kinds.mjSENS_TENDONPOS, objects.mjOBJ_TENDON, figures.counterbalance.tendon)


def sensor_kind_name(kind: mujoco.mjtSensor) -> str:
    """Return the short lower-case name of a sensor kind."""
    return str(kind.name).removeprefix("mjSENS_").lower()


def gas_force(compiled: CompiledRobot, pull: Array, length: Array) -> Array:
    """Return the gas' part of the cylinder's pull, any shape [N], at lengths of the same shape [m]."""
    balance = compiled.counterbalance
    return balance.gas_force(pull, length) if balance else pull


def n_readings(robot: Robot) -> int:
    """Return how many numbers the sensors of `add_trace_sensors` give."""
    figures = robot.figures
    return 7 * robot.n_joints + 3 * (len(figures.reflectors) + 1) + (2 if figures.counterbalance else 0)


def trace_of_readings(compiled: CompiledRobot, time: Array, readings: Array, wrench: Array) -> Trace:
    """Return what the sensors of `add_trace_sensors` say.

    Args:
        compiled: The robot.
        time: Shape (T,) [s].
        readings: Shape (T, `n_readings`).
        wrench: Shape (T, 6) [N, Nm].
    """
    n, r = compiled.n_joints, len(compiled.robot.figures.reflectors)
    joints = readings[:, : 7 * n].reshape(-1, 7, n)
    points = readings[:, 7 * n : 7 * n + 3 * (r + 1)].reshape(-1, r + 1, 3)
    missing = np.full((len(time), 2), np.nan)
    cylinder = readings[:, 7 * n + 3 * (r + 1) :] if compiled.at.counterbalance >= 0 else missing
    return Trace(
        time=time,
        q=joints[:, 0],
        q_velocity=joints[:, 1],
        theta=joints[:, 2],
        theta_velocity=joints[:, 3],
        motor_torque=joints[:, 4],
        motor_friction=joints[:, 5],
        link_friction=joints[:, 6],
        reflectors=points[:, :r],
        load_point=points[:, r],
        wrench=wrench.copy(),
        counterbalance_force=-cylinder[:, 0],
        gas_force=gas_force(compiled, -cylinder[:, 0], cylinder[:, 1]),
        counterbalance_length=cylinder[:, 1],
    )
