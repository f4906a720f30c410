"""What friction has more where it is averaged along a motion than at the average speed: its curve over speed bends.

Near standstill the Stribeck curve falls within a few cm/s or deg/s, which a bin of a tenth of a second passes over
where a joint speeds up. A torque averages that curve; a replay has it at the average speed.
"""

import numpy as np
from numpy.typing import NDArray

from bench.actuators.laws import ROLLING_POWER
from bench.diagnose.replay.segment_input import Path
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot


def average_friction(compiled: CompiledRobot, path: Path, speed: Array) -> Array:
    """Return what drives pay more for friction that is averaged, shape (T, n) [Nm] or [N].

    Of what depends on speed and bends: Stribeck's rise on both sides of the elastic element, and rolling friction. A
    joint that turns round within a reading is not read.

    Args:
        compiled: The robot.
        path: Of a motion.
        speed: Shape (T, n) [rad/s] or [m/s], averaged; 0 of joints that stand.
    """
    found: Array = np.zeros_like(speed)
    for j in np.flatnonzero(bends(compiled) & np.any(speed != 0, axis=0)).tolist():
        more = path.mean_of(_level(compiled, j, path.speeds[:, j])) - _level(compiled, j, speed[:, j])
        found[:, j] = np.sign(speed[:, j]) * more
    return found


def bends(compiled: CompiledRobot) -> NDArray[np.bool_]:
    """Return of which drives the friction bends over speed, shape (n,)."""
    rises = compiled.motor_rise * compiled.motor_coulomb + compiled.link_rise * compiled.link_coulomb
    return np.asarray((rises != 0) | (compiled.motor_rolling != 0))


def _level(compiled: CompiledRobot, j: int, speed: Array) -> Array:
    """Return the part of the friction of a drive that bends over speed, at some speeds, same shape [Nm] or [N]."""
    found = compiled.motor_rolling[j] * np.abs(speed) ** ROLLING_POWER
    for side in ("motor", "link"):
        coulomb, rise, stribeck = (getattr(compiled, f"{side}_{name}")[j] for name in ("coulomb", "rise", "stribeck"))
        if coulomb * rise:
            found = found + coulomb * rise * np.exp(-((speed / stribeck) ** 2))
    return np.asarray(found)
