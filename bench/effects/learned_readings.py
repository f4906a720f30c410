"""Learned errors of readings: of what drives report, of the tracker and of a gauge. They do not stand in the model."""

from dataclasses import replace
from itertools import product
from typing import Literal

import numpy as np

from bench.effects.conditions import Conditions
from bench.effects.effect import Array, Parameter, Place, Values
from bench.effects.learned import Learned
from bench.record.units import HOUR
from bench.simulate.instruments import Reading
from bench.simulate.trace import Trace

AXES = "xyz"
# effort: of the largest reading, where dead bands and offsets of amplifiers are
NEAR_ZERO = np.array([-0.2, -0.1, -0.05, -0.02, 0.0, 0.02, 0.05, 0.1, 0.2])
OF_READING = ("proportional", "square", "cube", "signed_square", *(f"at_{i + 1}" for i in range(len(NEAR_ZERO))))
IN_ROOM = tuple(f"{axis}_from_{other}_squared" for axis, other in product(AXES, AXES)) + tuple(
    f"{axis}_from_{axis}" for axis in AXES
)
IN_TIME = tuple(f"{axis}_{term}" for term in ("rate", "bend") for axis in AXES)
UNDER_FORCE = tuple(f"{axis}_{term}" for term in ("share", "square", "cube") for axis in AXES)


class LearnedScale(Learned):
    """What one drive reports, by what it ought to.

    Args:
        parameters: Some of `OF_READING` by name.
        channel: Which channel of the drive is wrong.
        largest: Reading at which the powers are 1.
    """

    name = "learned_scale"
    title = "scale of what a drive reports, as learned"
    physics = "The drive reports x + a u + b u^2 + c u^3 + d u |u| + e(u) with u = x/x_max; e is a table about zero."

    def __init__(
        self, parameters: tuple[Parameter, ...], channel: Literal["current", "torque"], largest: float
    ) -> None:
        super().__init__(parameters)
        self.channel = channel
        self.largest = largest

    def distort(self, place: Place, values: Values, reading: Reading, trace: Trace, conditions: Conditions) -> Reading:
        seen = getattr(reading, self.channel)[:, place.index]
        error = of_reading(seen / self.largest)[:, _chosen(OF_READING, self)] @ self.sizes(values)
        return _reported(reading, self.channel, place.index, error)


class LearnedLoss(Learned):
    """What a motor pays, over the load of its gear, with the direction.

    No friction element knows the load in that way, so it stands in what the drive reports and not in the model. A motor
    that follows its encoder moves the same.

    Args:
        parameters: One for each node.
        nodes: Shape (k,) [Nm], transmitted torque, rising.
        stiffness: Of the elastic element [Nm/rad].
        torque_constant: Of the drive [Nm/A].
    """

    name = "learned_loss"
    title = "loss of the gear over its load, as learned"
    physics = "In motion the motor pays -T(load) sign(v) more, T the torque in motion towards +, linear between nodes."

    def __init__(
        self, parameters: tuple[Parameter, ...], nodes: Array, stiffness: float, torque_constant: float
    ) -> None:
        super().__init__(parameters)
        self.nodes = nodes
        self.stiffness = stiffness
        self.torque_constant = torque_constant

    def distort(self, place: Place, values: Values, reading: Reading, trace: Trace, conditions: Conditions) -> Reading:
        j = place.index
        load = self.stiffness * (trace.q[:, j] - trace.theta[:, j])
        paid = -np.interp(load, self.nodes, self.sizes(values)) * np.sign(trace.q_velocity[:, j])
        return _reported(
            _reported(reading, "torque", j, paid),
            "current",
            j,
            paid / self.torque_constant,
        )


class LearnedStick(Learned):
    """The gauge, by the direction in which the joint of the counterbalance moves.

    Args:
        parameters: One for each node.
        nodes: Shape (k,) [rad], angle of that joint, rising.
        joint: Its index.
    """

    name = "learned_stick"
    title = "gauge that sticks, as learned"
    physics = "In motion the gauge reads p(q) sign(v) too much, linear between nodes."

    def __init__(self, parameters: tuple[Parameter, ...], nodes: Array, joint: int) -> None:
        super().__init__(parameters)
        self.nodes = nodes
        self.joint = joint

    def distort(self, place: Place, values: Values, reading: Reading, trace: Trace, conditions: Conditions) -> Reading:
        error = np.interp(trace.q[:, self.joint], self.nodes, self.sizes(values))
        return replace(reading, gas_pressure=reading.gas_pressure + error * np.sign(trace.q_velocity[:, self.joint]))


class LearnedRoom(Learned):
    """The tracker, by the place in the room that it looks at.

    Args:
        parameters: Some of `IN_ROOM` by name.
        centre: Shape (3,) [m], of the room.
        size: Of the room [m].
    """

    name = "learned_room"
    title = "error of the tracker over the room, as learned"
    physics = "The tracker reads a polynomial of second degree of the place, in units of the room's size, too much."

    def __init__(self, parameters: tuple[Parameter, ...], centre: Array, size: float) -> None:
        super().__init__(parameters)
        self.centre = centre
        self.size = size

    def distort(self, place: Place, values: Values, reading: Reading, trace: Trace, conditions: Conditions) -> Reading:
        functions = in_room((trace.reflectors.mean(axis=1) - self.centre) / self.size)[:, :, _chosen(IN_ROOM, self)]
        return replace(reading, reflectors=reading.reflectors + (functions @ self.sizes(values))[:, None, :])


class LearnedDrift(Learned):
    """The tracker, over time.

    Args:
        parameters: Some of `IN_TIME` by name.
        start: Time of the campaign from which it is counted [s].
    """

    name = "learned_drift"
    title = "drift of the tracker, as learned"
    physics = "The tracker drifts by a t + b t^2, t in hours from the first instant that was compared."

    def __init__(self, parameters: tuple[Parameter, ...], start: float) -> None:
        super().__init__(parameters)
        self.start = start

    def distort(self, place: Place, values: Values, reading: Reading, trace: Trace, conditions: Conditions) -> Reading:
        functions = in_time((trace.time - self.start) / HOUR)[:, :, _chosen(IN_TIME, self)]
        return replace(reading, reflectors=reading.reflectors + (functions @ self.sizes(values))[:, None, :])


class LearnedMount(Learned):
    """One reflector of the tracker, under the force at the load point.

    Args:
        parameters: Some of `UNDER_FORCE` by name.
        reflector: Its index.
        largest: Force at which the functions are 1 [N].
    """

    name = "learned_mount"
    title = "mount of a reflector under force, as learned"
    physics = "One reflector is a u + b u^2 + c u^3 off, u = |F|/F_max, along each axis."

    def __init__(self, parameters: tuple[Parameter, ...], reflector: int, largest: float) -> None:
        super().__init__(parameters)
        self.reflector = reflector
        self.largest = largest

    def distort(self, place: Place, values: Values, reading: Reading, trace: Trace, conditions: Conditions) -> Reading:
        functions = under_force(force_of(trace) / self.largest)[:, :, _chosen(UNDER_FORCE, self)]
        reflectors = reading.reflectors.copy()
        reflectors[:, self.reflector] += functions @ self.sizes(values)
        return replace(reading, reflectors=reflectors)


def of_reading(share: Array) -> Array:
    """Return `OF_READING` of relative readings, shape (T,): four powers and a table about zero, shape (T, 13)."""
    table = [np.interp(share, NEAR_ZERO, row) for row in np.eye(len(NEAR_ZERO))]
    return np.stack([share, share**2, share**3, np.abs(share) * share, *table], axis=1)


def in_room(place: Array) -> Array:
    """Return what `IN_ROOM` adds to each axis at places, shape (T, 3): shape (T, 3, 12)."""
    found = np.zeros((len(place), 3, len(IN_ROOM)))
    for axis in range(3):
        found[:, axis, 3 * axis : 3 * axis + 3] = place**2
        found[:, axis, 9 + axis] = place[:, axis]
    return found


def in_time(hours: Array) -> Array:
    """Return what `IN_TIME` adds to each axis at times, shape (T,) [h]: shape (T, 3, 6)."""
    return _along_each(hours, hours**2)


def under_force(share: Array) -> Array:
    """Return what `UNDER_FORCE` adds to each axis under forces relative to the largest, shape (T,): shape (T, 3, 9)."""
    return _along_each(share, share**2, share**3)


def force_of(trace: Trace) -> Array:
    """Return the size of the force at the load point, shape (T,) [N], without what is bolted to it."""
    return np.asarray(np.linalg.norm(trace.wrench[:, :3], axis=1), dtype=np.float64)


def _along_each(*functions: Array) -> Array:
    """Return f functions of T instants along each of three axes, one axis after another: shape (T, 3, 3 f)."""
    found = np.zeros((len(functions[0]), 3, 3 * len(functions)))
    for i, function in enumerate(functions):
        for axis in range(3):
            found[:, axis, 3 * i + axis] = function
    return found


def _chosen(names: tuple[str, ...], effect: Learned) -> list[int]:
    return [names.index(parameter.name) for parameter in effect.parameters]


def _reported(reading: Reading, channel: str, drive: int, error: Array) -> Reading:
    values = getattr(reading, channel).copy()
    values[:, drive] += error
    return replace(reading, **{channel: values})
