"""What belongs to the machine, and what may be anew in each recording.

Stricter than a joint diagnosis (`diagnose/replay/levels.py`): there weights, zeros of channels and the calibration of a
force sensor are the machine's, some with a drift; here a change of the machine must not be one of theirs, so all that
reads is anew. Torque constants and viscous friction are the machine's and drift with the temperature, as they do there,
and the thermometer of the gas is the same one: by what it errs today it erred before, but for what gas and wall differ.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.replay.nuisances import THERMOMETER, Nuisance
from bench.record.campaign import Array

EVERY = -1  # exact: in place of a recording: all of them
STAY = ("torque constant of ", THERMOMETER)  # exact: on the machine, though readings show them


@dataclass(frozen=True, eq=False)
class Slopes:
    """What may be off, the machine's and each recording's; m whitened readings.

    Attributes:
        matrix: Shape (m, p), of one standard deviation of each.
        nuisance: Shape (p,), index of the nuisance that each column is of.
        recording: Shape (p,), index of the recording in which it acts, or `EVERY`.
    """

    matrix: Array
    nuisance: NDArray[np.intp]
    recording: NDArray[np.intp]


def is_of_machine(nuisance: Nuisance) -> bool:
    """Whether what may be off is the machine's, but for a drift: figures, zeros of motors, and what of `STAY`.

    All else is set up anew, or of the day, as the temperature of the gas.
    """
    is_figure = nuisance.edit is not None and nuisance.between != "anew"
    return is_figure or nuisance.encoder is not None or nuisance.name.startswith(STAY)


def by_level(jacobian: Array, nuisances: Sequence[Nuisance], recording: NDArray[np.intp], held: float) -> Slopes:
    """Return the slopes with one column for each of the machine's nuisances, and one per recording for the others.

    What drifts has both, and so has what acts to first order alone: how much of its friction a joint holds at rest, and
    how a single weight errs. They are alike every time but for a share.

    Args:
        jacobian: Shape (m, p), whitened, of one standard deviation of each nuisance.
        nuisances: Shape (p,).
        recording: Shape (m,), index of the recording of each row.
        held: Share of those, as a standard deviation, that is new in each recording.
    """
    machine = np.array([is_of_machine(nuisance) for nuisance in nuisances], dtype=bool)
    rests = np.array([not (one.is_simulated or one.between == "anew") for one in nuisances], dtype=bool)
    drifting = np.array([nuisance.own / nuisance.sigma for nuisance in nuisances])
    share = np.where(machine, drifting, np.where(rests, held, 1.0))
    lasting = np.array([nuisance.lasting / nuisance.sigma for nuisance in nuisances])
    anew = jacobian[:, share > 0] * share[share > 0]
    present = np.unique(recording)
    own = [anew * (recording == k)[:, None] for k in present]
    kept = [jacobian[:, machine] * lasting[machine], np.sqrt(1 - held**2) * jacobian[:, rests]]
    every = np.concatenate([*kept, *own], axis=1)
    stays, varies = [*np.flatnonzero(machine), *np.flatnonzero(rests)], np.flatnonzero(share > 0)
    nuisance = np.array([*stays, *np.tile(varies, len(present))], dtype=np.intp)
    where = np.array([*[EVERY] * len(stays), *np.repeat(present, len(varies))], dtype=np.intp)
    seen = np.any(every != 0, axis=0)
    return Slopes(np.asarray(every[:, seen], dtype=np.float64), nuisance[seen], where[seen])
