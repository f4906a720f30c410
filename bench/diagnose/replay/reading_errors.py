"""How errors of instruments change readings, each by its size x: gains, offsets, zeros, frames, drifts."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from bench.record.campaign import Array
from bench.record.units import HOUR
from bench.robot.turned_sites import TurnedSites
from bench.simulate.instruments import Reading, is_slanting, small_rotation

OnReading = Callable[[float, Reading], Reading]


def _column(values: Array, j: int, change: Callable[[Array], Array]) -> Array:
    changed = values.copy()
    changed[:, j] = change(values[:, j])
    return changed


def current_gain(j: int) -> OnReading:
    """Return the relative error of a drive's current, which its torque constant makes as well."""
    return lambda x, reading: replace(reading, current=_column(reading.current, j, lambda c: c * (1 + x)))


def current_offset(j: int) -> OnReading:
    """Return the offset of a drive's current [A]."""
    return lambda x, reading: replace(reading, current=_column(reading.current, j, lambda c: c + x))


def torque_gain(j: int) -> OnReading:
    """Return the relative error of a drive's torque."""
    return lambda x, reading: replace(reading, torque=_column(reading.torque, j, lambda c: c * (1 + x)))


def torque_offset(j: int) -> OnReading:
    """Return the offset of a drive's torque [Nm]."""
    return lambda x, reading: replace(reading, torque=_column(reading.torque, j, lambda c: c + x))


def link_zero(j: int) -> OnReading:
    """Return the zero of an encoder on a link [rad]."""
    return lambda x, reading: replace(reading, q_link=_column(reading.q_link, j, lambda c: c + x))


def thermometer_zero(x: float, reading: Reading) -> Reading:
    """Return a reading with the zero of the gas thermometer off by x [K]."""
    return replace(reading, gas_temperature=reading.gas_temperature + x)


def frame_shift(direction: Array) -> OnReading:
    """Return a shift of the tracker's frame along a direction, shape (3,) [m]."""
    return lambda x, reading: replace(reading, reflectors=reading.reflectors + x * direction)


def frame_turn(direction: Array) -> OnReading:
    """Return a turn of the tracker's frame about a direction, shape (3,) [rad]."""
    return lambda x, reading: replace(reading, reflectors=reading.reflectors @ small_rotation(x * direction).T)


def frame_drift(direction: Array) -> OnReading:
    """Return a drift of the tracker along a direction, shape (3,) [m/h]."""
    return lambda x, reading: replace(
        reading, reflectors=reading.reflectors + x / HOUR * reading.time[:, None, None] * direction
    )


def nest_shift(k: int, axis: int, sites: TurnedSites) -> OnReading:
    """Return by how much a reflector sits off in its nest [m], which turns with the body that carries it.

    Args:
        k: Reflector, from 0.
        axis: Of that body, 0 to 2.
        sites: Of all reflectors.
    """
    along = np.zeros((sites.count, 3))
    along[k, axis] = 1.0

    def change(x: float, reading: Reading) -> Reading:
        return replace(reading, reflectors=reading.reflectors + x * sites.moved(reading.q_motor, along))

    return change


def force_gain(x: float, reading: Reading) -> Reading:
    """Return a reading of a force sensor with a relative error x."""
    return replace(reading, force=reading.force * (1 + x), moment=reading.moment * (1 + x))


def force_tilt(direction: Array) -> OnReading:
    """Return the error of the sensor's direction; a load that hangs is known to hang, whatever the sensor says."""

    def change(x: float, reading: Reading) -> Reading:
        turn = small_rotation(x * direction).T
        slanting = is_slanting(reading.force)
        return replace(
            reading,
            force=np.where(slanting, reading.force @ turn, reading.force),
            moment=np.where(slanting, reading.moment @ turn, reading.moment),
        )

    return change
