"""Factors of what drives report, beside all that may be wrong with the arm: links, rotors, what hangs on the flange.

For each drive y = s (M + E z) + F c: M the torque of the nominal arm, E that of its errors and of a payload, z as
uncertain as the first pass has it (`dynamics/prior.py`), F the columns that the drive has for itself. s and c are free,
z is one for all drives. Where the posterior is highest is found by Gauss-Newton, and what the readings do not tell of z
makes the factors as uncertain as it is. To the drive of an axis that a payload hangs beside, the inertia and the first
moments of the payload are large beside the rotor: what is not known of them is not known of its factor.

First and second moments of a payload of mass m are m r and m r^2, r the side of the cube that the rating allows. Before
the readings are looked at, the mean square of m is that of the largest payload, as in the first pass; then it is what
they tell of it. Figures that err more than they say are seen in z itself: their uncertainty is then as much larger as
the evidence has it (D. J. C. MacKay, Neural Computation 4 (1992) 415, Eq. 4.6), never smaller.
"""

from dataclasses import dataclass

import numpy as np

from bench.identify.arm import Arm
from bench.identify.drive_model import TINY, LinksAlong
from bench.identify.dynamics.noise import noise_of
from bench.identify.dynamics.prior import link_root
from bench.identify.dynamics.regressor import N_INERTIAL, NOT_NEGATIVE
from bench.record.campaign import Array
from bench.robot.nominal_dynamics import NominalDynamics

STEPS = 30  # of Gauss-Newton at most; 6 to 16 are needed
SETTLED = 1e-4  # relative: of the slopes, at which the search ends
ROUNDING = 1e-10  # of a scaled normal matrix: what a drive does not tell at all is this uncertain, not infinitely
CARRIED = slice(0, N_INERTIAL)  # z of the payload
FIGURES = slice(N_INERTIAL, None)  # z of links and rotors


def arm_errors(nominal: NominalDynamics, along: LinksAlong) -> Array:
    """Return E, torques of what may be wrong with an arm [Nm], shape (n, T, p).

    First stand those of a payload, as of `payload_errors`. Links and rotors that are known follow, of one standard
    deviation each.
    """
    arm, n = Arm(nominal.bodies), nominal.n_joints
    unsure, drives = nominal.uncertainty, nominal.drive_uncertainty
    mass, centre = unsure.links * unsure.mass, unsure.links * unsure.centre_of_mass_m
    rotor = np.where(drives.rotor_is_unknown, 0.0, drives.rotor_inertia * nominal.rotor_inertia)
    links = np.split(along.regressor, n, axis=2)
    errors = [
        np.swapaxes(payload_errors(nominal, along), 0, 1),
        *(link @ link_root(arm, i, mass, centre) for i, link in enumerate(links)),
        along.motion.acceleration[:, :, None] * np.diag(rotor),
    ]
    return np.swapaxes(np.concatenate(errors, axis=2), 0, 1)


def payload_errors(nominal: NominalDynamics, along: LinksAlong) -> Array:
    """Return torques of a payload [Nm], shape (n, T, 10).

    Of 1 kg at the load point, and of three first and six second moments of 1 kg that is away by the side of a payload.
    """
    side = nominal.payload_side
    return np.swapaxes(along.payload * np.array([1.0, *(side,) * 3, *(side**2,) * 6]), 0, 1)


@dataclass(frozen=True)
class DriveFit:
    """How readings of k drives go by the torque of the arm.

    Attributes:
        slope: Shape (k,), reading by torque, sign included.
        sigma: Shape (k,), its relative standard deviation.
        payload, payload_sigma: Mass of the payload, and its standard deviation [kg].
        torque: Shape (k, T), of the arm with the errors that were found [Nm].
        noise: Shape (k,), variance of what is left of each reading, for one independent reading.
        prior: Shape (p,), variance of z before the readings are looked at, as wide as they have it.
    """

    slope: Array
    sigma: Array
    payload: float
    payload_sigma: float
    torque: Array
    noise: Array
    prior: Array


def drive_fit(
    columns: Array, errors: Array, reading: Array, payload: float, heaviest: float, counts: Array
) -> DriveFit:
    """Fit readings of drives.

    Args:
        columns: Shape (k, T, c), as of `model_columns`: first the torque of the nominal arm, last that of a payload.
        errors: Shape (k, T, p), as of `arm_errors`, of the same drives.
        reading: Shape (T, k), in any unit.
        payload: Its mass, to begin with [kg].
        heaviest: Largest mass that it may have [kg]; 0: there is none.
        counts: Shape (T, k), 1 for the instants that count: where a drive turns round or rests, its friction is not at
            its level.
    """
    z, size = np.zeros(errors.shape[2]), errors.shape[2]
    z[0] = payload
    lower, upper = np.full(size, -np.inf), np.full(size, np.inf)
    lower[NOT_NEGATIVE], upper[0] = 0.0, heaviest
    variance, slope = _prior(size, heaviest, heaviest**2, 1.0), np.full(len(columns), np.inf)
    for _ in range(STEPS):
        torque, before = columns[:, :, 0] + errors @ z, slope
        own = np.concatenate([torque[:, :, None], columns[:, :, 1:-1]], axis=2)
        slope, noise, normal, right = _linearised(own, errors, reading, z, variance, counts)
        covariance = _inverse(normal)
        right[size :: own.shape[2]] -= _told_by_slope(own, errors, slope, noise, normal, counts)
        if np.all(np.abs(slope - before) <= SETTLED * np.abs(slope)):
            break
        z = _stepped(z, normal, right, lower, upper)
        known = np.diag(covariance)[:size]
        told = size - N_INERTIAL - float(np.sum(known[FIGURES] / variance[FIGURES]))
        wide = max(1.0, float(z[FIGURES] @ z[FIGURES]) / max(told, ROUNDING))
        variance = _prior(size, heaviest, min(heaviest**2, z[0] ** 2 + known[0]), wide)
    slope = np.where(slope == 0, TINY, slope)
    sigma = np.sqrt(np.diag(covariance))
    return DriveFit(
        slope, sigma[size :: own.shape[2]] / np.abs(slope), float(z[0]), float(sigma[0]), torque, noise, variance
    )


def _prior(size: int, heaviest: float, square: float, wide: float) -> Array:
    """Return the variance of z before the readings are looked at, shape (p,).

    Args:
        size: Length of z.
        heaviest: Largest mass of a payload [kg].
        square: Mean square of its mass, as far as it is known [kg^2].
        wide: Times that the variance of what figures state is larger.
    """
    variance = np.full(size, wide)
    variance[CARRIED] = [heaviest**2, *(square,) * (N_INERTIAL - 1)]
    return np.asarray(np.maximum(variance, np.sqrt(TINY)))


def _linearised(
    own: Array, errors: Array, reading: Array, z: Array, variance: Array, counts: Array
) -> tuple[Array, ...]:
    """Return slopes and noise with z as it is, and normal equations of the step of z and each drive's coefficients.

    Drives count by the variance of what is left of them, times how many samples make one independent reading.
    """
    k, size, count = len(own), len(z), own.shape[2]
    slope, variances = np.empty(k), np.empty(k)
    normal = np.zeros((size + k * count,) * 2)
    normal[:size, :size] = np.diag(1 / variance)
    right = np.concatenate([-z / variance, np.zeros(k * count)])
    for j, (design, y) in enumerate(zip(own, reading.T, strict=True)):
        there = counts[:, j] > 0
        design, y = design[there], y[there]
        coefficients = np.linalg.lstsq(design, y, rcond=None)[0]
        left, slope[j] = y - design @ coefficients, coefficients[0]
        noise = noise_of(left, np.cumsum(~there, dtype=np.int64)[there], len(left) - count)
        variances[j] = max(noise.variance * noise.memory, TINY)
        jacobian = np.concatenate([slope[j] * errors[j][there], design], axis=1)
        places = np.r_[:size, size + j * count : size + (j + 1) * count]
        normal[np.ix_(places, places)] += jacobian.T @ jacobian / variances[j]
        right[places] += jacobian.T @ left / variances[j]
    return slope, variances, normal, right


def _told_by_slope(own: Array, errors: Array, slope: Array, noise: Array, normal: Array, counts: Array) -> Array:
    """Return how what is told of the figures grows with each slope, shape (k,): d/ds of half a log determinant.

    Fitted all at once, factors come out too small: what is not known of z adds to its square, and large slopes (a light
    arm) make all of z small. Integrated over z and c, the posterior of the slopes is that of the best z and c times the
    root of the determinant of their covariance, which has no such bias. Nothing is stated of a payload that it could be
    small against, so it does not count.
    """
    count, size = own.shape[2], errors.shape[2]
    given = np.ones(len(normal), dtype=np.bool_)
    given[size::count] = False
    known = np.zeros_like(normal)
    known[np.ix_(given, given)] = _inverse(normal[np.ix_(given, given)])
    found = np.empty(len(slope))
    for j, there in enumerate(counts.T > 0):
        places = np.r_[:size, size + j * count + 1 : size + (j + 1) * count]
        other = np.concatenate([slope[j] * errors[j][there], own[j][there, 1:]], axis=1)
        shares = known[N_INERTIAL:size, places] * (errors[j][there][:, FIGURES].T @ other) / noise[j]
        found[j] = np.sum(shares)
    return found


def _inverse(normal: Array) -> Array:
    """Return the inverse of a normal matrix; what it does not tell is large there."""
    scale = np.sqrt(np.diag(normal))
    scale = np.where(scale > 0, scale, 1.0)
    each = np.outer(scale, scale)
    return np.asarray(np.linalg.inv(normal / each + ROUNDING * np.eye(len(scale))) / each)


def _stepped(z: Array, normal: Array, right: Array, lower: Array, upper: Array) -> Array:
    """Return z after a step within bounds: what would leave its bound stays there, and others step without it."""
    free = np.ones(len(right), dtype=np.bool_)
    while True:
        step = np.zeros(len(right))
        step[free] = _inverse(normal[np.ix_(free, free)]) @ right[free]
        ahead = step[: len(z)]
        leaves = ((z <= lower) & (ahead < 0)) | ((z >= upper) & (ahead > 0))
        if not np.any(leaves):
            return np.clip(z + ahead, lower, upper)
        free[np.flatnonzero(leaves)] = False
