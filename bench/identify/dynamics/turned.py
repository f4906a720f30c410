"""Axes that count the other way round in angle and torque alike, by which way a linear model fits.

The signs of an axis whose angle and torque are both turned agree with each other: friction still takes energy. What
gives it away is how it turns the axes behind it and the load of those before it. Whatever the links weigh, a model
linear in their inertial parameters (Khalil and Dombre 2002, ch. 12) then fits far worse than with the axis turned back.

Of a slide beside upright axes nothing but its weight tells, which a free offset holds up either way. Axes that this
model tells as well either way are therefore held against what does not turn with them, as in `turned_angles.py`: links
are no lighter than stated, rotors have inertia, friction takes energy whichever way a drive moves, and a reading is off
by no more than is stated. A spring that no file has may break these bounds either way; so they count only where they
cost a drive nothing with the axis turned back. So are axes whose angle alone may be turned: to a linear model without
bounds, friction that gives energy is as good as friction that takes it.

The first pass (`equations.py`) filters every column at full rate, which is right to the noise. Here an error of half is
looked for, in as many models as there are axes: filtered motion and torque at some instants do.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from bench.identify.arm import Arm
from bench.identify.dynamics.band import Band, band_of
from bench.identify.dynamics.equations import known_torque
from bench.identify.dynamics.regressor import N_INERTIAL, NOT_NEGATIVE, link_regressor
from bench.identify.dynamics.samples import MotionSamples, motion_samples
from bench.identify.turned_angles import NINETY_NINE, ROUNDING
from bench.record.campaign import Array, Campaign
from bench.record.moving import TURNING
from bench.robot.nominal_dynamics import NominalDynamics

MOST_INSTANTS = 1500  # effort: many times the number of base parameters of six axes
TIMES_UNKNOWNS = 4  # declared: equations for each unknown, at least; fewer may be fitted by chance
BETTER = 4.0  # declared: times that the variance a drive is left with falls: the error, to half
NO_WORSE = 1.2  # declared: times that of another may rise; within which two axes explain as much
SMALL = 1e-9  # rounding: of a scaled regression, so that what is not told stays small
# exact: unknowns of each drive (rotor, friction forth and back, viscous friction, offset, gas), and which the offset is
DRIVE, OFFSET = 6, 4


@dataclass(frozen=True)
class Turned:
    """An axis that seems to be turned.

    Attributes:
        indices: Of its drive; of several, any of which explains as much (an arm and its mirror image fit alike).
        drive: Whose error falls most with the axis turned back.
        before, after: Its root mean square error [Nm] or [N].
        bounded: Whether it takes the bounds of masses, friction and offset to tell.
        alone: Whether its angle alone is turned, and its torque is not.
    """

    indices: tuple[int, ...]
    drive: int
    before: float
    after: float
    bounded: bool
    alone: bool = False


@dataclass(frozen=True, eq=False)
class _Instants:
    """Filtered motion; T instants of n drives: `state` has position, velocity and acceleration."""

    samples: MotionSamples
    rows: np.ndarray[tuple[int], np.dtype[np.int64]]
    state: tuple[Array, Array, Array]
    torque: Array


@dataclass(frozen=True, eq=False)
class _Problem:
    """Linear equations of n drives, with some axes turned; T instants, u unknowns.

    Attributes:
        columns: Shape (n, T, u), factors of the links' inertial parameters, then of six unknowns for each drive.
        torque: Shape (n, T) [Nm].
        moves: Shape (n, T) bool, the equations that are used.
        lower, upper: Shape (u,), between which the unknowns of a robot can be.
    """

    columns: Array
    torque: Array
    moves: NDArray[np.bool_]
    lower: Array
    upper: Array

    @cached_property
    def free(self) -> Array:
        """Mean squares that are left of drives, shape (n,); nan if they stay, or tell too little."""
        return self._left(_mean_squares(self.torque, self.moves), None)

    @cached_property
    def bounded(self) -> Array:
        """The same with unknowns between their bounds; drives count by what is left of them without."""
        power = _mean_squares(self.torque, self.moves)
        return self._left(np.maximum(self.free, SMALL * power), (self.lower, self.upper))

    def _left(self, noise: Array, bounds: tuple[Array, Array] | None) -> Array:
        counts = [j for j, variance in enumerate(noise) if variance > 0]
        matrix = [self.columns[j, self.moves[j]] / noise[j] ** 0.5 for j in counts]
        values = [self.torque[j, self.moves[j]] / noise[j] ** 0.5 for j in counts]
        stacked = np.concatenate(matrix) if counts else np.zeros((0, 1))
        size = np.linalg.norm(stacked, axis=0)
        told = np.count_nonzero(size) - len(counts)  # friction forth and back and an offset are two unknowns
        if len(stacked) <= TIMES_UNKNOWNS * told:
            return np.full(len(noise), np.nan)
        size = np.where(size > 0, size, 1.0)
        stacked /= size
        root = np.linalg.cholesky(stacked.T @ stacked + SMALL * np.eye(len(size))).T
        seen = np.linalg.solve(root.T, stacked.T @ np.concatenate(values))
        if bounds is None:
            found = np.linalg.solve(root, seen)
        else:
            found = lsq_linear(root, seen, tuple(ends * size for ends in bounds), method="bvls").x
        return _mean_squares(self.torque - self.columns @ (found / size), self.moves)


def turned_axis(campaign: Campaign, nominal: NominalDynamics) -> Turned | None:
    """Return the axis that is turned, if there is one without which every drive is told as well, and one far better.

    One that is turned in angle and torque alike comes before one of which only the angle is.

    Args:
        campaign: With motor torques or currents in motion runs.
        nominal: The robot.

    Raises:
        InputError: No motion run has torques or currents, evenly sampled.
    """
    samples, arm = motion_samples(campaign, nominal), Arm(nominal.bodies)
    parts = _instants(samples, band_of(samples, None))
    none, one_by_one = np.ones(nominal.n_joints), 1 - 2 * np.eye(nominal.n_joints)
    given = _problem(parts, none, none, arm, nominal)
    turned = {j: _problem(parts, signs, signs, arm, nominal) for j, signs in enumerate(one_by_one)}
    if found := _best(given.free, {j: one.free for j, one in turned.items()}):
        return found
    alike = {j: one for j, one in turned.items() if not nominal.bodies.is_hinge[j] and _no_worse(one.free, given.free)}
    if found := _best_bounded(given, alike):
        return found
    if _no_worse(given.bounded, given.free):  # friction is what it can be
        return None
    alone = {j: _problem(parts, signs, none, arm, nominal) for j, signs in enumerate(one_by_one)}
    found = _best_bounded(given, alone)
    return replace(found, alone=True) if found else None


def _best_bounded(given: _Problem, turned: Mapping[int, _Problem]) -> Turned | None:
    """Return the best of some axes with unknowns between their bounds, of both."""
    if not turned:
        return None
    bounded = {j: one.bounded for j, one in turned.items()}
    return _best(given.bounded, bounded, {j: one.free for j, one in turned.items()})


def _best(before: Array, after: Mapping[int, Array], free: Mapping[int, Array] | None = None) -> Turned | None:
    """Return the axis with which turned back a drive is left with far less, and none with more.

    Args:
        before: Shape (n,), mean squares that are left of drives.
        after: The same with an axis turned back.
        free: The same without bounds, where these have them: the drive with far less is left with no more than that.
    """
    found: dict[int, tuple[float, int]] = {}  # axis -> how many times less of which drive
    for j, left in after.items():
        known = np.isfinite(before) & np.isfinite(left) & (left > 0)
        if np.any(known) and _no_worse(left, before):
            falls = np.where(known, before / np.where(known, left, 1.0), 0.0)
            drive = int(np.argmax(falls))
            if falls[drive] > BETTER and (free is None or left[drive] <= NO_WORSE * free[j][drive]):
                found[j] = float(falls[drive]), drive
    if not found:
        return None
    axis = max(found, key=lambda j: found[j])
    most, drive = found[axis]
    alike = tuple(j for j, (times, _) in found.items() if times * NO_WORSE > most)
    return Turned(alike, drive, float(before[drive] ** 0.5), float(after[axis][drive] ** 0.5), free is not None)


def _no_worse(left: Array, than: Array) -> bool:
    """Return whether no drive is left with more, of those that are told."""
    known = np.isfinite(left) & np.isfinite(than)
    return bool(np.all(left[known] <= NO_WORSE * than[known]))


def _mean_squares(values: Array, moves: NDArray[np.bool_]) -> Array:
    """Return the mean square of each drive where it moves, shape (n,), values of shape (n, T); nan where it stays."""
    return np.array([np.mean(own[at] ** 2) if at.any() else np.nan for own, at in zip(values, moves, strict=True)])


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


def _problem(
    parts: Sequence[_Instants], signs: Array, of_torque: Array, arm: Arm, nominal: NominalDynamics
) -> _Problem:
    """Return the equations of drives with some angles turned, and some torques, by their signs, shape (n,) each."""
    columns, torque, speed = [], [], []
    for part in parts:
        q, v, a = (signs * values for values in part.state)
        links = link_regressor(arm, q, v, a)
        gas = nominal.counterbalance.torque(q[:, nominal.counterbalance.joint]) if nominal.counterbalance else None
        forth, back = np.sign(np.maximum(v, 0.0)), np.sign(np.minimum(v, 0.0))
        own = np.stack([a, forth, back, v, np.ones_like(v), _on(gas, nominal, v)], axis=2)
        beside = np.einsum("tjk,ji->tjik", own, np.eye(len(signs))).reshape(*v.shape, -1)
        columns.append(np.concatenate([links, beside], axis=2))
        torque.append(of_torque * part.torque - known_torque(arm, nominal, part.samples, (q, v, a), part.rows))
        speed.append(np.abs(v))
    tau, fast = np.concatenate(torque), np.concatenate(speed)
    moves = np.isfinite(tau) & (fast > TURNING * np.max(fast, axis=0, initial=0.0))
    most = np.max(np.abs(np.where(moves, tau, 0.0)), axis=0, initial=0.0)
    lower, upper = _bounds(nominal, most)
    return _Problem(np.swapaxes(np.concatenate(columns), 0, 1), tau.T, moves.T, lower, upper)


def _bounds(nominal: NominalDynamics, most: Array) -> tuple[Array, Array]:
    """Return between what the unknowns of a robot can be, at 99 %, lower and upper ends of shape (u,).

    A payload, tools and hoses make links heavier than stated. Viscous friction may be negative, for friction falls with
    speed.

    Args:
        nominal: The robot.
        most: Shape (n,), largest torque of each drive [Nm].
    """
    n, unsure = nominal.n_joints, nominal.uncertainty
    links, drives = np.full((n, N_INERTIAL), -np.inf), np.full((n, DRIVE), -np.inf)
    links[:, NOT_NEGATIVE] = 0.0
    lighter = NINETY_NINE * np.hypot(unsure.links * unsure.mass, np.max(nominal.torque_gain_sigma))
    links[:, 0] = nominal.bodies.mass * max(0.0, 1 - lighter)
    drives[:, :3] = 0.0  # rotor, and friction of either direction
    offset = np.maximum(NINETY_NINE * nominal.torque_offset_sigma, ROUNDING * np.maximum(most, 1.0))
    drives[:, OFFSET] = -offset
    lower = np.concatenate([links.ravel(), drives.ravel()])
    upper = np.full(len(lower), np.inf)
    upper[links.size + OFFSET :: DRIVE] = offset
    return lower, upper


def _on(gas: Array | None, nominal: NominalDynamics, like: Array) -> Array:
    """Return the torque of the gas on its own drive, the shape of `like`; zeros without one."""
    found = np.zeros_like(like)
    if gas is not None and nominal.counterbalance:
        found[:, nominal.counterbalance.joint] = gas
    return found
