"""A stretch of a run as it will be replayed, before its instruments are read; and what drives it: angles and loads."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from bench.record.campaign import Array, Run
from bench.robot.compiled import CompiledRobot
from bench.simulate.prescribed import Motion

SAMPLES_OF_PARABOLA = 4  # fewer samples have no curvature to speak of


@dataclass(frozen=True, eq=False)
class Piece:
    """T instants of a run; n drives.

    Attributes:
        label: Run, and pose and approach of a static visit.
        groups: T arrays, the rows of the run that make each instant.
        motion: What the motors did, with the instants before that shape friction.
        acceleration_error: Shape (T, n), standard deviation of the motors' accelerations, as differentiated.
        turning: Shape (T, n) bool, drives that start, stop or turn round: their friction is between its levels.
        rings: Shape (T,) bool, instants so soon after a jerk that the arm may still ring.
    """

    label: str
    groups: tuple[NDArray[np.int64], ...]
    motion: Motion
    acceleration_error: Array
    turning: NDArray[np.bool_]
    rings: NDArray[np.bool_]

    @property
    def rows(self) -> NDArray[np.int64]:
        """Rows of the run that it rests on."""
        return np.concatenate(self.groups)


def angles_of(run: Run, compiled: CompiledRobot) -> Array:
    """Return motor angles by encoder, where there is none by command, shape (rows, n)."""
    n = compiled.n_joints
    keys = tuple(str(i + 1) for i in range(n))
    measured, commanded = (
        np.where(np.isnan(rad), run.stack(quantity, "m", keys), rad)
        for quantity, rad in ((q, run.stack(q, "rad", keys)) for q in ("q_motor", "q_cmd"))
    )
    angles: Array = np.where(np.isnan(measured), commanded, measured)
    return angles


def wrench_of(run: Run, compiled: CompiledRobot) -> Array:
    """Return the wrench on the load point without the weight of what is bolted to it, shape (rows, 6)."""
    wrench = np.array(run.load_wrench())
    if not any(name.startswith("load_") and name.endswith(("_n", "_nm")) for name in run.columns):
        keys = ("x", "y", "z")
        sensed = np.concatenate([run.stack("force", "n", keys), run.stack("moment", "nm", keys)], axis=1)
        felt: Array = np.nan_to_num(sensed)
        return felt
    if "load_mass_kg" in run.columns:
        wrench[:, :3] -= run.columns["load_mass_kg"][:, None] * compiled.model.opt.gravity
    wrench[np.abs(wrench) < 1e-6] = 0.0
    return wrench


@lru_cache(maxsize=1000)
def centre_weights(n: int) -> Array:
    """Return weights of n equidistant samples that give a parabola's value at their middle, shape (n,).

    A plain mean would cut the corners: a reflector on an arc of 2 m moves 0.4 mm inwards over a bin of four degrees.
    """
    if n < SAMPLES_OF_PARABOLA:
        return np.full(n, 1 / n)
    basis = np.vander(np.linspace(-1, 1, n), 3, increasing=True)
    weights: Array = np.linalg.pinv(basis)[0]
    return weights
