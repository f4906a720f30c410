"""Axes that count the other way round in angle and torque alike, by which way a linear model fits.

The signs of an axis whose angle and torque are both turned agree with each other: friction still takes energy. What
gives it away is how it turns the axes behind it and the load of those before it. Whatever the links weigh, a model
linear in their inertial parameters (Khalil and Dombre 2002, ch. 12) then fits far worse than with the axis turned back.

The first pass (`equations.py`) filters every column at full rate, which is right to the noise. Here an error of half is
looked for, in as many models as there are axes: filtered motion and torque at some instants do.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.identify.arm import Arm
from bench.identify.dynamics.band import Band, band_of
from bench.identify.dynamics.equations import known_torque
from bench.identify.dynamics.regressor import link_regressor
from bench.identify.dynamics.samples import MotionSamples, motion_samples
from bench.record.campaign import Array, Campaign
from bench.record.moving import TURNING
from bench.robot.nominal_dynamics import NominalDynamics

MOST_INSTANTS = 1500  # effort: many times the number of base parameters of six axes
TIMES_UNKNOWNS = 4  # declared: equations for each unknown, at least; fewer may be fitted by chance
BETTER = 4.0  # declared: times that the variance a drive is left with falls: the error, to half
NO_WORSE = 1.2  # declared: times that of another may rise; within which two axes explain as much
SMALL = 1e-9  # rounding: of a scaled regression, so that what is not told stays small


@dataclass(frozen=True)
class Turned:
    """An axis that seems to be turned.

    Attributes:
        indices: Of its drive; of several, any of which explains as much (an arm and its mirror image fit alike).
        drive: Whose error falls most with the axis turned back.
        before, after: Its root mean square error [Nm] or [N].
    """

    indices: tuple[int, ...]
    drive: int
    before: float
    after: float


@dataclass(frozen=True, eq=False)
class _Instants:
    """Filtered motion; T instants of n drives: `state` has position, velocity and acceleration."""

    samples: MotionSamples
    rows: np.ndarray[tuple[int], np.dtype[np.int64]]
    state: tuple[Array, Array, Array]
    torque: Array


def turned_axis(campaign: Campaign, nominal: NominalDynamics) -> Turned | None:
    """Return the axis that is turned, if there is one without which every drive is told as well, and one far better.

    Args:
        campaign: With motor torques or currents in motion runs.
        nominal: The robot.

    Raises:
        InputError: No motion run has torques or currents, evenly sampled.
    """
    samples, arm = motion_samples(campaign, nominal), Arm(nominal.bodies)
    band = band_of(samples, None)
    parts = _instants(samples, band)
    n = nominal.n_joints
    before = _left(parts, np.ones(n), arm, nominal)
    found: dict[int, tuple[float, int, float]] = {}  # axis -> how many times less of which drive, and what is left
    for j in range(n):
        after = _left(parts, np.where(np.arange(n) == j, -1.0, 1.0), arm, nominal)
        known = np.isfinite(before) & np.isfinite(after) & (after > 0)
        if np.any(known) and np.all(after[known] < NO_WORSE * before[known]):
            falls = np.where(known, before / np.where(known, after, 1.0), 0.0)
            best = int(np.argmax(falls))
            if falls[best] > BETTER:
                found[j] = float(falls[best]), best, float(after[best] ** 0.5)
    if not found:
        return None
    most, drive, left = max(found.values())
    alike = tuple(j for j, (times, _, _) in found.items() if times * NO_WORSE > most)
    return Turned(alike, drive, float(before[drive] ** 0.5), left)


def _instants(samples: Sequence[MotionSamples], band: Band) -> list[_Instants]:
    """Return some instants of each stretch, evenly spaced."""
    kept = [band.kept(part) for part in samples]
    every = max(1, -(-sum(len(rows) for rows in kept) // MOST_INSTANTS))
    found = []
    for part, rows in zip(samples, kept, strict=True):
        q, v, a = (values[rows][::every] for values in band.smooth(part))
        torque = np.where(np.isfinite(part.torque).all(axis=0), part.torque, 0.0)
        read = np.where(np.isfinite(part.torque).all(axis=0), 0.0, np.nan)
        found.append(_Instants(part, rows[::every], (q, v, a), band.filtered(torque, part)[::every] + read))
    return found


def _left(parts: Sequence[_Instants], signs: Array, arm: Arm, nominal: NominalDynamics) -> Array:
    """Return the mean squares that a linear model leaves of drives with axes turned, shape (n,); nan if they stay."""
    links, own, torque = [], [], []
    for part in parts:
        q, v, a = (signs * values for values in part.state)
        links.append(link_regressor(arm, q, v, a))
        gas = nominal.counterbalance.torque(q[:, nominal.counterbalance.joint]) if nominal.counterbalance else None
        own.append(np.stack([a, np.sign(v), v, np.ones_like(v), _on(gas, nominal, v)], axis=2))
        known = known_torque(arm, nominal, part.samples, (q, v, a), part.rows)
        torque.append(signs * part.torque - known)
    y, drives, tau = np.concatenate(links), np.concatenate(own), np.concatenate(torque)
    speed = np.abs(drives[:, :, 2])
    moves = np.isfinite(tau) & (speed > TURNING * np.max(speed, axis=0, initial=0.0))
    n = tau.shape[1]
    blocks, right = [], []
    for j in range(n):
        rows = moves[:, j]
        scale = float(np.sqrt(np.mean(tau[rows, j] ** 2))) if rows.any() else 0.0
        if scale > 0:
            beside = np.zeros((int(rows.sum()), n, drives.shape[2]))
            beside[:, j] = drives[rows, j]
            blocks.append(np.concatenate([y[rows, j], beside.reshape(len(beside), -1)], axis=1) / scale)
            right.append(tau[rows, j] / scale)
    matrix = np.concatenate(blocks) if blocks else np.zeros((0, 1))
    size = np.linalg.norm(matrix, axis=0)
    if len(matrix) <= TIMES_UNKNOWNS * np.count_nonzero(size):
        return np.full(n, np.nan)
    values = np.concatenate(right)
    matrix = matrix / np.where(size > 0, size, 1.0)
    gram = matrix.T @ matrix + SMALL * np.eye(matrix.shape[1])
    unknowns = np.linalg.solve(gram, matrix.T @ values) / np.where(size > 0, size, 1.0)
    links_of, own_of = np.split(unknowns, [y.shape[2]])
    left = tau - y @ links_of - np.einsum("tnk,nk->tn", drives, own_of.reshape(n, -1))
    return np.array([np.mean(left[moves[:, j], j] ** 2) if moves[:, j].any() else np.nan for j in range(n)])


def _on(gas: Array | None, nominal: NominalDynamics, like: Array) -> Array:
    """Return the torque of the gas on its own drive, the shape of `like`; zeros without one."""
    found = np.zeros_like(like)
    if gas is not None and nominal.counterbalance:
        found[:, nominal.counterbalance.joint] = gas
    return found
