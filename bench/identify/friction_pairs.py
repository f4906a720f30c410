"""Friction of a moving arm from the same way there and back, Eq. (48): half the difference of the motor torques.

At equal places the arm needs the same torque both ways but for friction, which turns round with the motion:

    xi I_out - xi I_back = 2 f sign(v_out),   I_f = |I_out - I_back| / 2   (Eq. (48))

f is what the motor pays for friction on both sides of the elastic element together; which share the element feels, the
currents cannot tell. The paper takes the magnitude; here the sign of the motion is used instead, so that noise averages
out rather than adding up, and a friction that comes out negative shows that something else differs between the passes.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.identify.line_passes import LinePass
from bench.robot.bodies import Array

SLIDING = 1e-3  # [rad]; gears reach their friction level after 1e-5 to 1e-4 rad, elastic elements wind back within 5e-4


@dataclass(frozen=True)
class PairFriction:
    """Equivalent friction torque of each joint along a path run there and back; T places, n joints.

    Attributes:
        direction: Shape (T, n), +1 or -1: which way the joint turns on the way out; 0 where it has not turned far
            enough since it last stood for friction to be known.
        torque: Shape (T, n) [Nm], f at each place; nan where the direction is 0.
        level: Shape (n,) [Nm], mean of f along the path; nan for joints that do not turn.
        noise: Shape (n,) [Nm], standard error of the level from the noise of the currents.
        gain: Shape (n,) [Nm], standard error of the level from the torque constants, the same in every other torque.
    """

    direction: NDArray[np.int64]
    torque: Array
    level: Array
    noise: Array
    gain: Array

    @property
    def sigma(self) -> Array:
        """Shape (n,) [Nm], standard error of the level, both parts."""
        return np.hypot(self.noise, self.gain)

    def along(self) -> Array:
        """Return friction on the way out, signed by the motion, shape (T, n) [Nm]; zero where a joint does not turn."""
        return np.asarray(self.direction * np.nan_to_num(self.level))


def pair_friction(out: LinePass, back: LinePass, current_gain: Array) -> PairFriction:
    """Return the friction from a pass out and a pass back under the same load.

    Args:
        out: The pass out.
        back: The pass back, at the same places.
        current_gain: Shape (n,), prior standard deviation of the relative error of xi_j I_j.
    """
    direction = sliding_direction(out.q_cmd)
    torque = direction * (out.current_torque - back.current_torque) / 2
    torque[direction == 0] = np.nan
    count = np.sum(np.isfinite(torque), axis=0)
    known = np.maximum(count, 1)
    level = np.where(count > 0, np.nansum(torque, axis=0) / known, np.nan)
    noise = np.hypot(out.sigma_current_torque, back.sigma_current_torque) / 2 / np.sqrt(known)
    return PairFriction(direction, torque, level, np.where(count > 0, noise, np.nan), np.abs(level) * current_gain)


def sliding_direction(q: Array) -> NDArray[np.int64]:
    """Return which way each joint turns, shape (T, n), from its angles along a path, shape (T, n) [rad].

    0 within `SLIDING` of a turning point, on either side of it, since there and back are compared; and for a joint that
    turns by less than that altogether. Ends of the path are no turning points: there is a lead-in.
    """
    step = np.diff(q, axis=0)
    turning = np.concatenate([step, step[-1:]])  # the direction in which it leaves each place
    direction = np.asarray(np.sign(turning), dtype=np.int64)
    for j in range(q.shape[1]):
        if np.ptp(q[:, j]) < SLIDING:
            direction[:, j] = 0
            continue
        for place in np.flatnonzero(np.diff(direction[:, j])) + 1:
            direction[np.abs(q[:, j] - q[place, j]) < SLIDING, j] = 0
    return np.asarray(direction)
