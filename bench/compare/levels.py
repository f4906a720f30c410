"""What belongs to the machine, and what may be anew in each recording."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.replay.nuisances import Nuisance
from bench.record.campaign import Array

GAIN = "torque constant of "  # of a motor, with the amplifier beside it: the machine's, though readings show it


def is_of_machine(nuisance: Nuisance) -> bool:
    """Whether what may be off is the machine's: its figures and torque constants. All else is set up anew."""
    return nuisance.edit is not None or nuisance.name.startswith(GAIN)


def by_level(jacobian: Array, nuisances: Sequence[Nuisance], recording: NDArray[np.intp]) -> Array:
    """Return the slopes with one column for each of the machine's nuisances, and one per recording for the others.

    Args:
        jacobian: Shape (m, p), whitened, of one standard deviation of each nuisance.
        nuisances: Shape (p,).
        recording: Shape (m,), index of the recording of each row.
    """
    machine = np.array([is_of_machine(nuisance) for nuisance in nuisances], dtype=bool)
    own = [jacobian[:, ~machine] * (recording == k)[:, None] for k in np.unique(recording)]
    every = np.concatenate([jacobian[:, machine], *own], axis=1)
    return np.asarray(every[:, np.any(every != 0, axis=0)], dtype=np.float64)
