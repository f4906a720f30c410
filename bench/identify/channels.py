"""Which channels a method needs, and one clear sentence when they are not there."""

import numpy as np
from numpy.typing import NDArray

from bench.errors import InputError
from bench.identify.readings import StaticReadings

MEANING = {
    "current": "motor currents (columns current_i_a)",
    "force": "the load on the robot (force_x_n to moment_z_nm from a sensor, or the known load_x_n to load_mz_nm)",
    "reflector": "a reflector at the reference point (reflector_1_x_m to reflector_1_z_m)",
    "reflectors": "three reflectors not in line (reflector_1_x_m to reflector_3_z_m)",
}


def usable(method: str, readings: StaticReadings, *channels: str) -> StaticReadings:
    """Return the states in which every named channel was read.

    Series that are left without an unloaded or without a loaded state are dropped.

    Args:
        method: Name of the method, for the message.
        readings: All states.
        channels: Keys of `MEANING`.

    Raises:
        InputError: A channel is missing throughout, or no series has all of them in an unloaded and a loaded state.
    """
    there = {channel: _present(readings, channel) for channel in channels}
    lacking = [MEANING[channel] for channel, states in there.items() if not states.any()]
    if lacking:
        raise InputError(f"method {method!r} needs {' and '.join(lacking)}, which these readings lack.")
    keep = np.all(list(there.values()), axis=0)
    for s in np.unique(readings.series):
        states = keep & (readings.series == s)
        if not (np.any(states & readings.is_reference) and np.any(states & ~readings.is_reference)):
            keep &= readings.series != s
    if not keep.any():
        needed = " and ".join(MEANING[channel] for channel in channels)
        raise InputError(f"method {method!r} needs a series with {needed} in an unloaded and in a loaded state.")
    return readings.take(keep)


def _present(readings: StaticReadings, channel: str) -> NDArray[np.bool_]:
    match channel:
        case "current":
            values = readings.current_torque
        case "force":
            values = readings.wrench
        case "reflector":
            values = readings.reflectors[:, 0]
        case _:
            values = readings.reflectors[:, :3].reshape(len(readings.series), -1)
            if readings.reflectors.shape[1] < 3:
                return np.zeros(len(readings.series), dtype=np.bool_)
    return np.array(np.all(np.isfinite(values), axis=1))
