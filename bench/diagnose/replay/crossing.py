"""How links cross the gaps of gears with play: as heavy as they are, it takes them a while.

A replay follows the motors and balances every instant, so a link with play is always at the flank to which it is
pushed. In truth it leaves one flank when the torque changes sign, as fast as its gear lets go (T'/k), follows it with
what damps the gear, I x'' + d x' = T(t), and lands on the other one later. Where T grows with a slope s and nothing
damps, that is after a time t with s t / k + s t^3 / (6 I) = g, the gap: a link of 300 kg m^2 whose load changes by
16 Nm/s takes a third of a second for 0.3 mrad, in which four instants are read.

Left out: that links bounce where they land (`linearise/rattling.py`), and that other links give way.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid

from bench.record.campaign import Array

APART = 1.5  # rounding: times the usual distance of instants; beyond, something was left out between them
FINE = 32  # effort: steps of a flight from instant to instant


class Gears(NamedTuple):
    """Gears with play and the links behind them; n joints.

    Attributes:
        inertia: Shape (n,) [kg m^2] or [kg], of the links and all that they carry.
        stiffness: Shape (n,) [Nm/rad] or [N/m].
        damping: Shape (n,) [Nm s/rad] or [N s/m].
        gaps: Shape (n,) [rad] or [m]; 0: none.
    """

    inertia: Array
    stiffness: Array
    damping: Array
    gaps: Array


class Crossing(NamedTuple):
    """Where links are in the gaps of their gears, at T instants of n joints.

    Attributes:
        places: Shape (T, n), mean around each instant: from -1 to 1, the flanks.
        landing: Shape (T, n) [rad/s] or [m/s], how fast a link lands around an instant; 0 where none does.
    """

    places: Array
    landing: Array


def crossing_of(torque: Array, time: Array, gears: Gears) -> Crossing:
    """Return how links cross.

    Args:
        torque: Shape (T, n) [Nm] or [N], on the links, positive towards the flank at 1; where it is 0, they stay.
        time: Shape (T,) [s], the middles of intervals as long as each other; between some, others may be left out.
        gears: With play or without.
    """
    found = Crossing(np.where(torque < 0, -1.0, 1.0), np.zeros_like(torque))
    if len(time) < 2:
        return found
    steps = np.diff(time)
    step = float(np.median(steps))
    for rows in np.split(np.arange(len(time)), np.flatnonzero(steps > APART * step) + 1):
        for j in np.flatnonzero(gears.gaps):
            one = _crossing(torque[rows, j], step, Gears(*(each[j] for each in gears)))
            found.places[rows, j], found.landing[rows, j] = one
    return found


def _crossing(torque: Array, step: float, gear: Gears) -> Crossing:
    """Return the same of one link, shapes (T,), whose torque is linear from one instant to the next."""
    sides = np.sign(torque[torque != 0])
    side = float(sides[0]) if len(sides) else 1.0
    if np.all(sides == side):
        return Crossing(np.full(len(torque), side), np.zeros(len(torque)))
    length, fine = len(torque), step / FINE
    along = np.interp((np.arange(length * FINE) + 0.5) / FINE - 0.5, np.arange(length), torque)
    places, landing = np.full(len(along), side), np.zeros(len(along))
    leaves = _first(along * side < 0)
    while leaves is not None:
        let_go = -side * max(0.0, side * (along[leaves - 1] - along[leaves])) / fine / gear.stiffness
        speed = _speed(along[leaves:], fine, let_go, gear)
        places[leaves:] = way = side + cumulative_trapezoid(speed, dx=fine, initial=0) / (gear.gaps / 2)
        flight = _first(np.abs(way[1:]) > 1)
        if flight is None:
            break
        lands, side = leaves + 1 + flight, float(np.sign(way[1 + flight]))
        places[lands:], landing[lands] = side, abs(speed[1 + flight])
        left = _first(along[lands:] * side < 0)
        leaves = None if left is None else lands + left
    return Crossing(places.reshape(length, FINE).mean(axis=1), landing.reshape(length, FINE).max(axis=1))


def _speed(torque: Array, step: float, begins: float, gear: Gears) -> Array:
    """Return the speed of a link that flies, shape (T,) [rad/s] or [m/s], from what it begins with."""
    from scipy.signal import lfilter  # here: half a second that who needs none need not wait

    fades = np.exp(-gear.damping / gear.inertia * step)
    pushed = (torque[1:] + torque[:-1]) / 2 * step / gear.inertia * np.sqrt(fades)  # each as in the middle of its step
    found: Array = lfilter([1.0], [1.0, -fades], np.concatenate([[begins], pushed]))
    return found


def _first(where: NDArray[np.bool_]) -> int | None:
    found = np.flatnonzero(where)
    return int(found[0]) if len(found) else None
