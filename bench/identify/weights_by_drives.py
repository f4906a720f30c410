"""Weights that hang, held against what the drives paid for them: each weight beside the others, and all of them.

In the states of a visit that slid, load and current differ by what the joint method says of friction (`friction.py`),

    dGamma - dT = d dT + (F + mu |dGamma|) direction + offset of the series - w dGamma,

d the error of the torque constant, F and mu friction of the joint, and w by how much the weight that hangs there is
heavier than written down. A weight is the same for all joints and poses, so what one joint or one pose alone says of
it is not believed: friction, or a current that is not in proportion to its torque, can be like that.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc

from bench.identify.arm import Arm
from bench.identify.friction import LOAD_DEPENDENT, NEGLIGIBLE
from bench.identify.options import Options
from bench.identify.play import Play, play
from bench.identify.readings import StaticReadings
from bench.identify.statics import equilibrium
from bench.robot.bodies import Array
from bench.robot.counterbalance import Counterbalance

CHANCE = 1e-6  # declared: of right weights with which this is said
ALIKE = 0.02  # declared: weights that differ by less are one, as in a replay
SAME_POSE = 0.02  # declared: [rad] or [m], within which the angles of a pose lie on all its visits
LEAST_POSES = 3  # derived: in which a weight has to hang: one is left out, and of one friction alone may tell
LEAST_JOINTS = 2  # derived: likewise
UNKNOWN = 0.577  # derived: w of a weight of which nobody knows anything; up to 1, evenly, as of the effect hung_load
SETTLED = 4  # effort: passes in which the noise of a joint settles
SEEN = 3.0  # declared: times the noise of a joint that the largest load on it has to be

WEIGH = "weigh them, for stiffnesses from loads err by as much; or currents are not in proportion to torques"


@dataclass(frozen=True)
class WeightsByDrives:
    """What drives say of K weights.

    Attributes:
        weights: Shape (K,) [N], as written down.
        heavier: Shape (K,), by what share each is heavier.
        sigma: Shape (K,), standard deviation of these, torque constants included.
        apart_sigma: Shape (K,), of each against the mean of all, for which these do not matter.
        chance: With which right weights look as wrong, whichever joint or pose is left out.
    """

    weights: Array
    heavier: Array
    sigma: Array
    apart_sigma: Array
    chance: float

    @property
    def are_wrong(self) -> bool:
        """Whether chance does not account for it."""
        return self.chance < CHANCE

    @property
    def words(self) -> str:
        """In a sentence, for people."""
        which = [f"{weight:.0f} N by {100 * x:+.1f} %" for weight, x in zip(self.weights, self.heavier, strict=True)]
        return (
            f"drives paid as if other weights hung there: {', '.join(which)} (± {100 * self.sigma.max():.1f} % for the "
            f"torque constants; ± {100 * self.apart_sigma.max():.1f} % against each other)"
        )


@dataclass(frozen=True, eq=False)
class _Information:
    """What one joint says of all weights: of w, shape (K,), a precision (K, K), and that times the estimate (K,)."""

    precision: Array
    pull: Array


def weights_by_drives(
    arm: Arm, counterbalance: Counterbalance | None, readings: StaticReadings, sigma: float
) -> WeightsByDrives | None:
    """Return what currents say of weights that hang in several poses; None where they say nothing.

    Args:
        arm: The arm.
        counterbalance: Its counterbalance, if it has one.
        readings: With currents and loads.
        sigma: How well weights are known, relative.
    """
    known = np.all(np.isfinite(readings.wrench), axis=1) & np.any(np.isfinite(readings.current_torque), axis=1)
    hangs = known & (readings.is_reference | readings.is_vertical)
    readings = readings.take(np.isin(readings.series, np.setdiff1d(readings.series, readings.series[~hangs])))
    if not len(readings.series):
        return None
    weight = np.linalg.norm(readings.load(arm.bodies.gravity)[:, :3], axis=1)
    which = _which_weight(np.where(readings.is_reference, 0.0, weight))
    poses = _poses(readings)
    count = int(which.max()) + 1
    often = [k for k in range(count) if len(np.unique(poses[which == k])) >= LEAST_POSES]
    if not often:
        return None
    every = np.ones(len(poses), dtype=np.bool_)
    said = list(_of_joints(arm, counterbalance, readings, which, every))
    if len(said) < LEAST_JOINTS:
        return None
    fewer = [[one for one in said if one is not other] for other in said]
    fewer += [list(_of_joints(arm, counterbalance, readings, which, poses != pose)) for pose in np.unique(poses)]
    chance = max(_chance(*_estimate(one, often, count), sigma) for one in fewer)
    heavier, covariance = _estimate(said, often, count)
    about = np.eye(len(often)) - 1 / len(often)
    return WeightsByDrives(
        weights=np.array([weight[which == k].mean() for k in often]),
        heavier=heavier,
        sigma=np.sqrt(np.diag(covariance)),
        apart_sigma=np.sqrt(np.diag(about @ covariance @ about)),
        chance=chance,
    )


def _which_weight(weight: Array) -> NDArray[np.intp]:
    """Return which weight hangs in each state, shape (m,), the lightest 0; -1 where none does."""
    known = np.unique(weight[weight > 0])
    edges = known[np.diff(known, prepend=-np.inf) > ALIKE * known]
    return np.searchsorted(edges, weight, side="right") - 1


def _poses(readings: StaticReadings) -> NDArray[np.intp]:
    """Return the pose of each state, shape (m,), whatever side it was reached from."""
    angles = readings.q_motor[readings.first_of_series]
    found: list[Array] = []
    pose = np.empty(len(angles), dtype=np.intp)
    for i, here in enumerate(angles):
        near = [k for k, there in enumerate(found) if np.max(np.abs(here - there)) < SAME_POSE]
        pose[i] = near[0] if near else len(found)
        if not near:
            found.append(here)
    return pose


def _of_joints(
    arm: Arm,
    counterbalance: Counterbalance | None,
    readings: StaticReadings,
    which: NDArray[np.intp],
    rows: NDArray[np.bool_],
) -> Iterator[_Information]:
    """Yield what each joint says of the weights, by some of the states."""
    count, readings, which = int(which.max()) + 1, readings.take(rows), which[rows]
    n, first = readings.n_joints, readings.first_of_series
    wrench, rigid = readings.load(arm.bodies.gravity), np.zeros(n)
    place = (arm, counterbalance, readings.load_point, readings.q_motor, wrench, rigid, Options().second_order)
    gamma = equilibrium(*place)[1].total
    force, current = gamma - gamma[first], -(readings.current_torque - readings.current_torque[first])
    variance = 2 * readings.sigma_current_torque**2 / readings.n_repeats.min()
    sliding = _sliding(readings, force, current, variance)
    for j in range(n):
        slides = sliding.slides[:, j] & np.isfinite(current[:, j])
        if not slides.any() or np.max(np.abs(force[slides, j])) < SEEN * np.sqrt(variance[j]):
            continue
        asked, way = force[slides, j], sliding.direction[slides, j]
        of_weights = np.where(which[slides, None] == np.arange(count), -asked[:, None], 0.0)
        rows_of = np.column_stack(
            [current[slides, j], way, way * np.abs(asked), of_weights, asked - current[slides, j]]
        )
        series = readings.series[slides]
        for one in np.unique(series):
            rows_of[series == one] -= rows_of[series == one].mean(axis=0)
        freedom = len(rows_of) - len(np.unique(series)) - 2 - count
        if freedom > 0:
            prior = np.array([max(readings.systematic.torque_gain[j], NEGLIGIBLE**2), np.inf, LOAD_DEPENDENT])
            yield _information(rows_of[:, :-1], rows_of[:, -1], prior, float(variance[j]), freedom)


def _sliding(readings: StaticReadings, force: Array, current: Array, variance: Array) -> Play:
    """Return where friction stands at its level in n joints, as of `friction.friction_change`."""
    slid = play(readings, force, NEGLIGIBLE * np.abs(force).max(axis=0)).slides
    slid[readings.first_of_series] = False
    excess = np.sum(np.where(slid, np.nan_to_num(force - current) ** 2 - variance, 0.0), axis=0)
    return play(readings, force, np.sqrt(np.maximum(excess, 0.0) / np.maximum(slid.sum(axis=0), 1)))


def _information(columns: Array, response: Array, prior: Array, variance: float, freedom: int) -> _Information:
    """Return what a joint says of weights, its torque constant and friction integrated out."""
    k = columns.shape[1] - len(prior)
    precision = np.diag(np.concatenate([prior, np.full(k, UNKNOWN)]) ** -2.0)
    noise = variance
    for _ in range(SETTLED):
        fit = np.linalg.pinv(columns.T @ columns / noise + precision, hermitian=True) @ columns.T @ response / noise
        noise = max(float(np.sum((response - columns @ fit) ** 2)) / freedom, variance)
    normal, right = columns.T @ columns / noise, columns.T @ response / noise
    own = slice(len(prior))
    others = slice(len(prior), None)
    solved = normal[others, own] @ np.linalg.pinv(normal[own, own] + precision[own, own], hermitian=True)
    return _Information(normal[others, others] - solved @ normal[own, others], right[others] - solved @ right[own])


def _estimate(said: list[_Information], often: list[int], count: int) -> tuple[Array, Array]:
    """Return by how much weights that hang often are heavier, shape (K,), and the covariance of that, (K, K)."""
    precision, right = np.eye(count) / UNKNOWN**2, np.zeros(count)
    for one in said:
        precision, right = precision + one.precision, right + one.pull
    covariance = np.linalg.inv(precision)
    mean: Array = covariance @ right
    return mean[often], covariance[np.ix_(often, often)].astype(np.float64)


def _chance(heavier: Array, covariance: Array, sigma: float) -> float:
    """Return with which chance weights that are known so well seem so wrong, shape (K,)."""
    known = covariance + sigma**2 * np.eye(len(heavier))
    return float(chdtrc(len(heavier), heavier @ np.linalg.solve(known, heavier)))
