"""Deflection of the reference point against the unloaded state, along a film."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.robot.bodies import Array, read_only
from bench.simulate.session import Film

STANDING_SPEED = (
    2e-3  # [rad/s]; below the slowest approach (2 deg/s) and above what a servo gives way while a load is put on
)
REFERENCE_TIME = 1.0  # [s], ten readings of the tracker in a film at 10 Hz
UNLOADED_SHARE = 1e-3  # of the largest force in the film


@dataclass(frozen=True)
class Deflection:
    """How far the reference point has moved from where it was unloaded in the same pose.

    Attributes:
        true: Shape (T, 3) [m], world axes; nan while the robot moves and in a pose that was never unloaded.
        measured: Shape (T, 3) [m], the same by the tracker; nan also without a tracker.
    """

    true: Array
    measured: Array


def deflection_of(film: Film) -> Deflection:
    """Return the deflection at every instant of a film.

    The reference of each stand, see `is_standing`, is the mean position over the last `REFERENCE_TIME` before its first
    load, when the links have stopped ringing; if it begins loaded, or is never loaded, over all its unloaded instants.
    """
    true, measured = reference_of(film)
    force = np.linalg.norm(film.trace.wrench[:, :3], axis=1)
    unloaded = force <= UNLOADED_SHARE * np.max(force, initial=0.0)
    moved = {"true": np.full(true.shape, np.nan), "measured": np.full(measured.shape, np.nan)}
    for stand in _stretches(is_standing(film)):
        reference = _reference(unloaded[stand], film.trace.time[stand])
        if not reference.any():
            continue
        for name, position in (("true", true[stand]), ("measured", measured[stand])):
            moved[name][stand] = position - np.mean(position[reference], axis=0)
    return Deflection(read_only(moved["true"]), read_only(moved["measured"]))


def reference_of(film: Film) -> tuple[Array, Array]:
    """Return the true and the measured path of the reference point, shape (T, 3) [m] each.

    It is the first reflector; of a robot without any the load point, which nobody measures.
    """
    if film.trace.reflectors.shape[1] == 0:
        return film.trace.load_point, np.full(film.trace.load_point.shape, np.nan)
    return film.trace.reflectors[:, 0], film.reading.reflectors[:, 0]


def is_standing(film: Film) -> NDArray[np.bool_]:
    """Return where the robot stands, shape (T,): no motor turns faster than `STANDING_SPEED`."""
    return np.asarray(np.all(np.abs(film.trace.q_velocity) < STANDING_SPEED, axis=1))


def _stretches(holds: NDArray[np.bool_]) -> list[slice]:
    edges = np.flatnonzero(np.diff(holds, prepend=False, append=False))
    return [slice(start, end) for start, end in edges.reshape(-1, 2)]


def _reference(unloaded: NDArray[np.bool_], time: Array) -> NDArray[np.bool_]:
    """Return which instants of one stand are its reference."""
    if not unloaded[0] or unloaded.all():
        return unloaded
    loading = int(np.argmin(unloaded))
    return np.asarray((np.arange(len(time)) < loading) & (time > time[loading] - REFERENCE_TIME))
