"""What the second plant's instruments make of the truth, beside noise and background errors."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Channel:
    """What channels show of what their sensors would: (1 + scale) y + offset + drift t, t in hours since the start.

    Attributes:
        scale: Relative.
        offset: In the unit of the channel.
        drift: In that unit per hour.
    """

    scale: Array | float
    offset: Array | float
    drift: Array | float

    @classmethod
    def right(cls, zero: Array | float) -> Self:
        """Return that of channels that show what there is; `zero` has their shape."""
        return cls(zero, zero, zero)

    def shows(self, seen: Array, hours: Array) -> Array:
        """Return what is shown for what the sensors see, shape (T, n) or (T,); `hours`, shape (T,)."""
        time = hours.reshape(-1, *(1 for _ in seen.shape[1:]))
        shown: Array = (1 + self.scale) * seen + self.offset + self.drift * time
        return shown


@dataclass(frozen=True, eq=False)
class Readout:
    """What instruments make of the truth beside noise and background errors; n drives.

    Attributes:
        zero: Shape (n,) [rad], encoder reading less truth.
        delay: Of the encoders [s].
        torque_constant: Shape (n,), relative error.
        currents: Shape (n,) each [A].
        gauge: [Pa].
        dead_band: Shape (n,) [A], currents below which read zero.
        shift, turn: Shape (3,) [m] and [rad], of the tracker's frame.
        creep, leaning: Shape (3,) [m/h] and [rad/h], of the tracker's stand.
        scale: Of the tracker's distances from the base, relative error.
        force_gain: Relative error of the force sensor.
        force_tilt: Shape (3,) [rad], of its axes against a slanting load.
    """

    zero: Array
    delay: float
    torque_constant: Array
    currents: Channel
    gauge: Channel
    dead_band: Array
    shift: Array
    turn: Array
    creep: Array
    leaning: Array
    scale: float
    force_gain: float
    force_tilt: Array

    @classmethod
    def perfect(cls, n: int) -> Self:
        """Return that of instruments that are right, for n drives."""
        drives, vector = np.zeros(n), np.zeros(3)
        currents, gauge = Channel.right(drives), Channel.right(0.0)
        return cls(drives, 0.0, drives, currents, gauge, drives, *(vector,) * 4, 0.0, 0.0, vector)
