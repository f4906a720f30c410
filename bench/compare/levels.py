"""What belongs to the machine, and what may be anew in each recording."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.replay.levels import DRIFTING
from bench.diagnose.replay.nuisances import Nuisance
from bench.record.campaign import Array

ANEW = {"same": 0.0, "drifts": DRIFTING, "anew": 1.0}  # part of the variance that each recording has for itself


def is_held_friction(nuisance: Nuisance) -> bool:
    """Whether it is how much of its friction a joint holds at rest: neither a figure nor an error of a reading."""
    acts_otherwise = nuisance.scales_wrench or nuisance.scales_payload
    return nuisance.edit is None and nuisance.on_reading is None and not acts_otherwise


def by_level(jacobian: Array, nuisances: Sequence[Nuisance], recording: NDArray[np.intp], held: float) -> Array:
    """Return the slopes with one column for what recordings share of each nuisance, and one per recording for the rest.

    Args:
        jacobian: Shape (m, p), whitened, of one standard deviation of each nuisance.
        nuisances: Shape (p,).
        recording: Shape (m,), index of the recording of each row.
        held: Share of friction at rest, as a standard deviation, that is new in each recording.
    """
    own = np.array([held**2 if is_held_friction(one) else ANEW[one.between] for one in nuisances], dtype=np.float64)
    anew = (jacobian * np.sqrt(own))[:, own > 0]
    parts = [anew * (recording == k)[:, None] for k in np.unique(recording)]
    every = np.concatenate([(jacobian * np.sqrt(1 - own))[:, own < 1], *parts], axis=1)
    return np.asarray(every[:, np.any(every != 0, axis=0)], dtype=np.float64)
