"""What no replay can predict: noise of the instruments, and where static friction came to rest.

A joint at rest holds any friction torque up to its level; which one depends on how the servo settled and on what shook.
The replay knows the side of the approach, the rest is scatter: a part that stays over a visit or a run, and a part
anew at every rest. So it is with a link in a gear with play: as long as friction holds its load, it may rest anywhere
between the flanks. Dividing by scatter (whitening) makes all quantities comparable and independent.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from bench.diagnose.linearise.common_modes import modes_of, put_back, take_out
from bench.diagnose.linearise.rattling import PLACED, rattling
from bench.diagnose.linearise.torque_response import TorqueResponse
from bench.diagnose.replay.play import is_loose
from bench.diagnose.replay.quantities import Quantity
from bench.diagnose.replay.segments import Segment
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot

# assumed: shares of the Coulomb level, from the virtual robot in time (../README.md): how far friction lies, anew at
# every rest, from what the path of commands and loads alone would leave.
MOTOR_REST, LINK_REST = 0.8, 0.15
MOTOR_VISIT = 2.0  # assumed: the same for a visit; a motor may have let go of all it held, and more
LINK_VISIT = 3**-0.5  # exact: a link has let go of anything between none and all of what it held
STANDING = 1.0  # assumed: a joint that stands while others move: anywhere between its two levels, changing slowly
SLOWNESS = 5  # assumed: polynomials over the run that describe the slow change
# effort: cosines beyond these. A joint that stands holds its friction until a load moves it, so what is not known of
# it walks over its levels in steps. Cosine k of a random walk that crosses one level in a run has a standard
# deviation of sqrt(2) / (pi k) levels (Karhunen and Loeve); what lies beyond K of them is 1 / (pi sqrt(K)), here a
# tenth of a level. Without them corners of friction at the wrist were taken for hysteresis (37 and 45 nats on two
# sound machines).
WALKS = 10
CREEPS = 0.05  # assumed: of a gap, slowly, while other joints move
STIRS = 0.02  # assumed: of a gap, anew at every instant
SAME_PLAY = 0.1  # rounding: relative; a change of play that changes hardly any scatter


@dataclass(frozen=True, eq=False)
class Scatter:
    """How friction and play scatter in a model; n joints, their links before their motors.

    Attributes:
        play: Shape (n,) [rad] or [m], of the gears.
        levels: Shape (2, n) [Nm] or [N], up to which friction holds.
        shaken: Share of its friction that a standing joint takes anew at every instant (`standing_joints.py`).
        new: Share of the scatter at rest that counts: less than all of it where rests repeat.
        repeats: Share of the variance at rest that visits have in common that repeat each other
            (`repeated_rests.py`).
        placed: Shape (n,) [rad] or [m], by how much the places of loose links may differ from run to run of a joint
            that stands (`loose_places.py`), at most; None: within their gaps, anywhere.
    """

    play: Array
    levels: Array
    shaken: float
    new: float = 1.0
    repeats: float = 0.0
    placed: Array | None = None


def scatters_alike(one: Array, other: Array) -> bool:
    """Whether two plays, or two sets of friction levels, of the same shape scatter links alike."""
    return bool(np.all(np.abs(one - other) <= SAME_PLAY * np.maximum(one, other)))


@dataclass(frozen=True, eq=False)
class Whitening:
    """A linear map after which what cannot be predicted is standard normal, for one segment.

    Attributes:
        rows: Shape (T * c,) bool; entries that were measured.
        factors: Shape (T, c, c), inverse Cholesky factors, instant by instant.
        modes: Shape (m, r), orthonormal, what is common to the segment, in whitened space.
        shrink: Shape (r,), by how much each mode is taken back.
    """

    rows: NDArray[np.bool_]
    factors: Array
    modes: Array
    shrink: Array

    def __call__(self, values: Array) -> Array:
        """Return whitened values, shape (m, ...), of values of shape (T, c, ...); entries not measured are dropped."""
        length, c, *more = values.shape
        k = math.prod(more)
        white = (self.factors @ np.nan_to_num(values.reshape(length, c, k))).reshape(length * c, k)
        whitened: Array = white[self.rows]
        self.settle(whitened)
        return whitened.reshape(len(whitened), *more)

    def settle(self, white: Array) -> None:
        """Take what is common to the segment out of values, shape (m, k), that were whitened instant by instant."""
        take_out(white, self.modes, self.shrink)

    def undone(self, whitened: Array) -> Array:
        """Return values, shape (T, c, k), of whitened ones, shape (m, k); 0 where not measured."""
        white = whitened.copy()
        put_back(white, self.modes, self.shrink)
        length, c, _ = self.factors.shape
        flat = np.zeros((length * c, whitened.shape[1]))
        flat[self.rows] = white
        return np.asarray(np.linalg.solve(self.factors, flat.reshape(length, c, -1)), dtype=np.float64)

    @property
    def common(self) -> Array:
        """Shape (m, r), C: values that were whitened instant by instant have the covariance I + C C'."""
        return np.asarray(self.modes * np.sqrt(1 / (1 - self.shrink) ** 2 - 1), dtype=np.float64)

    @property
    def log_determinants(self) -> Array:
        """Shape (m,); their sum is the logarithm of the map's determinant. What is common counts with equal shares."""
        diagonal = np.diagonal(self.factors, axis1=1, axis2=2).reshape(-1)[self.rows]
        common = float(np.sum(np.log(1 - self.shrink))) / max(len(diagonal), 1)
        return np.asarray(np.log(diagonal) + common, dtype=np.float64)


def whitening_of(
    compiled: CompiledRobot,
    segment: Segment,
    response: TorqueResponse,
    quantities: tuple[Quantity, ...],
    scatter: Scatter,
) -> Whitening:
    """Return how a segment is whitened.

    Args:
        compiled: The robot.
        segment: To whiten.
        response: Of its readings to torques.
        quantities: What is compared.
        scatter: Of friction and play.
    """
    length, c = segment.observed.shape
    measured = measured_in(segment, quantities)
    is_drive = np.array([quantity.is_drive for quantity in quantities])
    play, stands = scatter.play, np.logical_or(segment.is_static, segment.standing)
    slowly = np.ones((length, 1), dtype=np.float64) if segment.is_static else slow(length)
    once, lasting = rest_friction(compiled, segment, response, quantities, scatter)
    loose = is_loose(compiled, response.link_load) & stands & (play > 0)
    gaps = of_links(compiled, response, measured, quantities) * play
    stirs = np.where(loose, STIRS, 0.0)
    if not segment.is_static and np.any(play):
        stirs += rattling(compiled, segment, response, play)
    stirred = gaps * stirs[:, None]
    noise = np.where(measured, segment.sigma, 1.0)
    covariance = once @ once.transpose(0, 2, 1)
    covariance += stirred @ stirred.transpose(0, 2, 1)
    error = segment.acceleration_error
    felt, of_rotors = (error, error) if segment.drive_error is None else segment.drive_error
    links = np.where(is_drive[:, None], felt[:, None, :], error[:, None, :])
    for inertial in (
        response.link * response.link_inertia[:, None] * links,
        response.motor * response.rotor_inertia * of_rotors[:, None, :],
    ):
        seen = np.where(measured[:, :, None], inertial, 0.0)
        covariance += seen @ seen.transpose(0, 2, 1)
    covariance[:, np.arange(c), np.arange(c)] += noise**2
    factors = np.linalg.inv(np.linalg.cholesky(covariance))
    rows = measured.reshape(-1)
    part = lasting[:, :, np.any(lasting != 0, axis=(0, 1))]
    shared = [part * slowly[:, m, None, None] for m in range(slowly.shape[1])]
    placed = np.full(compiled.n_joints, PLACED * scatter.new)
    if not segment.is_static and scatter.placed is not None:
        placed = np.minimum(PLACED, scatter.placed / np.where(play > 0, play, 1.0))
    for j in np.flatnonzero(loose.any(axis=0)):
        gap, begins = gaps[:, :, [j]], begins_of(loose[:, j])
        shared.append(placed[j] * gap * (begins[:, None] == np.unique(begins[begins >= 0]))[:, None])
        creeps = CREEPS * gap * loose[:, j, None, None]
        shared += [creeps * slowly[:, m, None, None] for m in range(1, min(SLOWNESS, slowly.shape[1]))]
    common = np.concatenate([factors @ mode for mode in shared], axis=2)
    return Whitening(rows, factors, *modes_of(common.reshape(length * c, -1)[rows]))


def of_links(
    compiled: CompiledRobot, response: TorqueResponse, measured: NDArray[np.bool_], quantities: tuple[Quantity, ...]
) -> Array:
    """Return what each reading shows of a link that lies elsewhere in its gap, shape (T, c, n), per rad or m.

    Args:
        compiled: The robot.
        response: Of the readings to torques.
        measured: Shape (T, c), entries that count.
        quantities: What is compared.
    """
    moves = measured & np.array([not quantity.is_drive for quantity in quantities])  # a drive feels no torque of it
    return np.where(moves[:, :, None], response.link * compiled.stiffness, 0.0)


def begins_of(loose: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Return since which instant a link has been loose, shape (T,), -1 where it is not: until it is pushed, it stays.

    Args:
        loose: Shape (T,).
    """
    first = loose & ~np.concatenate([[False], loose[:-1]])
    return np.where(loose, np.maximum.accumulate(np.where(first, np.arange(len(loose)), -1)), -1)


def measured_in(segment: Segment, quantities: tuple[Quantity, ...]) -> NDArray[np.bool_]:
    """Return which entries of a segment count, shape (T, c)."""
    measured: NDArray[np.bool_] = np.isfinite(segment.observed) & np.isfinite(segment.sigma)
    if segment.is_static:
        return measured
    # what a motor pays that stands says nothing about its load
    is_gain = np.array([quantity.is_drive and bool(segment.standing[quantity.index]) for quantity in quantities])
    counted: NDArray[np.bool_] = np.logical_and(measured, ~is_gain)
    return counted


def rest_friction(
    compiled: CompiledRobot,
    segment: Segment,
    response: TorqueResponse,
    quantities: tuple[Quantity, ...],
    scatter: Scatter,
) -> tuple[Array, Array]:
    """Return what friction of joints that stand changes, anew at every instant and for a while, shape (T, c, 2 n) each.

    Links before motors, each with a deviation of one.

    Args:
        compiled: The robot.
        segment: A visit or a motion.
        response: Of its readings to torques.
        quantities: What is compared.
        scatter: Of friction and play.
    """
    n = compiled.n_joints
    if segment.is_static:
        once, lasting = np.repeat([LINK_REST, MOTOR_REST], n), np.repeat([LINK_VISIT, MOTOR_VISIT], n)
    else:
        once, lasting = (share * np.tile(segment.standing, 2) for share in (scatter.shaken, STANDING))
    spread = np.concatenate([response.link, response.motor], axis=2) * (scatter.new * scatter.levels.ravel())
    spread = np.where(measured_in(segment, quantities)[:, :, None], spread, 0.0)  # (T, c, 2n), a whole level
    return spread * once, spread * lasting


def slow(length: int) -> Array:
    """Return how friction of a standing joint may change over a motion, shape (T, k), each with a deviation of one."""
    polynomials = legendre.legvander(np.linspace(-1, 1, length), SLOWNESS - 1)
    k = np.arange(SLOWNESS, min(SLOWNESS + WALKS, length))  # no more than there are instants
    walk = np.sqrt(2) / (np.pi * k) * np.cos(np.pi * k * (np.arange(length)[:, None] + 0.5) / length)
    return np.concatenate([polynomials, walk], axis=1, dtype=np.float64)
