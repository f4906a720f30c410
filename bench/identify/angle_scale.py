"""The scale of logged angles, such as a gear ratio that nobody stated, from the torque that an arm needs.

Angles of the motors are theta / f with an unknown f for each joint. Gravity goes with sin(theta), inertia and Coriolis
torques with products of theta's derivatives: of all f only the right ones give torques of the shape that the drives
report. Their size tells nothing, for torque constants are as unknown. For each drive
y = c_m (M(theta, theta', theta'') + E z) + c_v v + c_s sign(v) + c_0 as in `drive_scale`; f, the mass and the moments z
of a payload and the delay of the readings minimise what is left, each drive weighed with its own, by Gauss-Newton on
the projected residual (variable projection: Golub and Pereyra, SIAM J. Numer. Anal. 10 (1973) 413). Moments are as
uncertain as in `drive_fit.py`: a payload that hangs beside its axis has an inertia about it. Instants at which a drive
turns round are left out, as in `drive_delay.py`.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from scipy.optimize import least_squares

from bench.identify.directions import Flags, directions
from bench.identify.drive_delay import BLOCKS, LATEST, sliding
from bench.identify.drive_fit import payload_errors
from bench.identify.drive_model import TINY, LinksAlong, Motion, model_columns, shifted, solved
from bench.identify.dynamics.regressor import N_INERTIAL, NOT_NEGATIVE
from bench.identify.turned_angles import SAMPLES
from bench.record.campaign import Array
from bench.robot.nominal_dynamics import NominalDynamics

BEYOND = 1.5  # times the joint's limit, up to which angles are sought; soft limits and those of a model differ by less
LEAST_USED = 0.05  # of a joint's range, that a log shows at least (assumed)
START = 0.5  # of a joint's range, from which the search starts (assumed; 0.3 and 0.8 ended at the same place)
SIGNS_TRIED = 3  # combinations of directions that are followed to the end, those that start best (assumed)
REWEIGHED = 3  # times that the noise of each drive is taken from what is left; the last changes it by a hundredth
STEPS = 15  # of one search; it settles within ten
AT_BOUND = 0.01  # relative: a scale that is so near to the edge of what was searched has not been found
UNSEEN = 1e-6  # of the largest sensitivity: a scale with less has no part in the torque
FARTHEST = 10.0  # standard deviations that a moment may be away; no bound, but searches need one
KEPT = 32  # effort: scales of which columns are kept, for derivatives by payload and delay
ROUND = 2 * np.pi  # [rad], of a joint without limits


@dataclass(frozen=True)
class AngleScale:
    """The scale of the angles of n joints.

    Attributes:
        factor: Shape (n,), angle of the joint by the one that was given, positive; 1 where it was not sought.
        sigma: Shape (n,), its relative standard deviation: statistics, masses, centres and rotors together; 0 where it
            was not sought, inf where torques do not tell it.
        unexplained: Share of the readings' variance that is left, mean over drives.
        unexplained_as_given: The same with all angles as they were given, in the best directions.
    """

    factor: Array
    sigma: Array
    unexplained: float
    unexplained_as_given: float


def angle_scale(
    nominal: NominalDynamics, time: Array, angle: Array, reading: Array, sought: Flags, counts: Flags | None = None
) -> AngleScale:
    """Estimate the scale of angles from the torque that the nominal arm needs along them.

    Directions are tried (`directions.py`); only sizes are returned, since a mirrored arm may need the same torque.

    Args:
        nominal: The robot.
        time: Shape (T,) [s], even.
        angle: Shape (T, n), low-passed; [rad] or [m] where it is not sought, else in any unit.
        reading: Shape (T, n), of the drives in any unit, through the same low-pass.
        sought: Shape (n,), joints of which the scale is unknown.
        counts: Shape (n,), whether a drive has a reading that tells anything, at least one; all, if left out.
    """
    read = np.ones(nominal.n_joints, dtype=np.bool_) if counts is None else counts
    places = np.flatnonzero(sought & (np.max(np.abs(angle), axis=0) > 0))
    problem = _Problem(nominal, time, angle, reading[:, read], places, read)
    fits = [_fitted(problem, signs) for signs in problem.best_signs(problem.start, SIGNS_TRIED)]
    best = min(fits, key=lambda fit: fit.misfit)
    factor, sigma = np.ones(nominal.n_joints), np.where(sought, np.inf, 0.0)
    factor[problem.places] = problem.factors(best.x)[problem.places]
    sigma[problem.places] = _sigma(problem, best)
    as_given = np.zeros_like(problem.start)
    (signs,) = problem.best_signs(as_given, 1)
    return AngleScale(factor, sigma, problem.share_left(best.signs, best.x), problem.share_left(signs, as_given))


@dataclass(frozen=True)
class _Problem:
    """What is minimised; x holds log f of the joints at `places`, z, delay by LATEST.

    z is mass and moments of a payload by those of the heaviest one. `reading` has the drives that are `read` alone.
    """

    nominal: NominalDynamics
    time: Array
    angle: Array
    reading: Array
    places: np.ndarray[tuple[int], np.dtype[np.int64]]
    read: Flags

    @property
    def start(self) -> Array:
        return np.asarray(np.r_[self._most + np.log(START / BEYOND), np.zeros(N_INERTIAL + 1)])

    @cached_property
    def bounds(self) -> tuple[Array, Array]:
        """Lower and upper ends of x."""
        least = np.full(N_INERTIAL, -FARTHEST)
        least[NOT_NEGATIVE] = -TINY
        largest = np.r_[1.0 if self.nominal.payload > 0 else TINY, np.full(N_INERTIAL - 1, FARTHEST)]
        return np.r_[self._most + np.log(LEAST_USED / BEYOND), least, -1.0], np.r_[self._most, largest, 1.0]

    @property
    def _most(self) -> Array:
        """Largest log f at `places`."""
        limits = self.nominal.bodies.limits
        reach = np.where(limits[:, 1] > limits[:, 0], np.max(np.abs(limits), axis=1), ROUND)
        most = np.log(BEYOND * reach / np.maximum(np.max(np.abs(self.angle), axis=0), TINY))
        return np.asarray(most[self.places])

    @property
    def payload(self) -> slice:
        """Where z stands in x."""
        return slice(len(self.places), len(self.places) + N_INERTIAL)

    def factors(self, x: Array) -> Array:
        """Return the scale of all joints, shape (n,)."""
        factor = np.ones(self.nominal.n_joints)
        factor[self.places] = np.exp(x[: len(self.places)])
        return np.asarray(factor)

    def left(self, signs: Array, x: Array, nominal: NominalDynamics | None = None) -> Array:
        """Return what the model leaves of the readings, shape (those that are read, samples).

        Args:
            signs: Shape (n,), directions of the joints.
            x: Of the search.
            nominal: The robot with other masses, centres or rotors; None: as it is.
        """
        scale = tuple(float(value) for value in signs * self.factors(x))
        along, own, payload = self._columns(scale)
        if nominal is not None:
            own = model_columns(nominal, along)[self.read, :, :-1]
        torque = own[:, :, :1] + self.nominal.payload * payload @ x[self.payload, None]
        columns = self._counts.T[:, :, None] * np.concatenate([torque, own[:, :, 1:]], axis=2)
        seen = self._counts * shifted(self.time, self.reading, LATEST * x[-1])[:: self._every]
        return np.asarray(seen.T - np.einsum("jtc,jc->jt", columns, solved(columns, seen)))

    @cached_property
    def _counts(self) -> Array:
        """1 where a drive that is read moves clearly, else 0: what friction does as it turns, no model here has."""
        counts = sliding(Motion.along(self.time, self.angle))[:: self._every, self.read]
        return np.where(np.any(counts > 0, axis=0), counts, 1.0)  # all of a drive that stands

    @cached_property
    def _columns(self) -> Callable[[tuple[float, ...]], tuple[LinksAlong, Array, Array]]:
        return lru_cache(KEPT)(self._along)

    def _along(self, scale: tuple[float, ...]) -> tuple[LinksAlong, Array, Array]:
        """Return the motion, columns of each drive that is read without a payload, and those of one, (k, T, c) each."""
        along = LinksAlong.of(self.nominal, Motion.along(self.time, self.angle).seen(np.array(scale), self._every))
        columns, payload = model_columns(self.nominal, along), payload_errors(self.nominal, along)
        return along, columns[self.read, :, :-1], payload[self.read]

    @property
    def _every(self) -> int:
        return max(1, len(self.time) // SAMPLES)

    def share_left(self, signs: Array, x: Array) -> float:
        """Return the share of the readings' variance that is left, mean over drives."""
        return float(np.mean(np.var(self.left(signs, x), axis=1) / np.maximum(np.var(self.reading, axis=0), TINY)))

    def best_signs(self, x: Array, count: int) -> list[Array]:
        """Return directions of the joints, those that leave least first; of a pair of mirror images one."""
        tried = [np.where(turned, -1.0, 1.0) for turned in directions(self.nominal.n_joints)]
        shares = np.array([self.share_left(signs, x) for signs in tried])
        kept: list[int] = []
        for k in np.argsort(shares, kind="stable"):
            if not kept or shares[k] > shares[kept[-1]] * (1 + 1e-6):
                kept.append(int(k))
        return [tried[k] for k in kept[:count]]


@dataclass(frozen=True)
class _Fit:
    """Where a search ended: directions, x, the noise of each drive, residual and its Jacobian, sum of logarithms.

    The last rows of residual and Jacobian are those of z by its uncertainty.
    """

    signs: Array
    x: Array
    noise: Array
    residual: Array
    jacobian: Array
    misfit: float


def _fitted(problem: _Problem, signs: Array) -> _Fit:
    lower, upper = problem.bounds
    x, carried = problem.start, problem.payload
    noise, unsure = np.std(problem.left(signs, x), axis=1), np.ones(N_INERTIAL)
    for _ in range(REWEIGHED):

        def residual(at: Array, noise: Array = noise, unsure: Array = unsure) -> Array:
            return np.asarray(np.r_[(problem.left(signs, at) / noise[:, None]).ravel(), at[carried] / unsure])

        found = least_squares(
            residual,
            np.clip(x, lower + 1e-9 * (upper - lower), upper - 1e-9 * (upper - lower)),
            bounds=(lower, upper),
            max_nfev=STEPS,
        )
        x, weighed = found.x, noise
        noise = np.maximum(np.std(problem.left(signs, x), axis=1), TINY)
        mass = x[carried.start] ** 2 + np.linalg.pinv(found.jac.T @ found.jac)[carried.start, carried.start]
        unsure = np.r_[1.0, np.full(N_INERTIAL - 1, max(min(1.0, mass), np.sqrt(TINY)) ** 0.5)]
    return _Fit(signs, x, weighed, found.fun, found.jac, float(np.sum(np.log(noise))))


def _sigma(problem: _Problem, fit: _Fit) -> Array:
    """Return the standard deviation of log f at each place; inf where it was not found.

    Statistics from the scores of blocks (a sandwich, for what is left is no white noise), what is not known of the
    payload, and what each stated uncertainty of masses, centres and rotors moves, to first order.
    """
    n, size, places = problem.reading.shape[1], len(fit.x), len(problem.places)
    inverse = np.linalg.pinv(fit.jacobian.T @ fit.jacobian)
    seen, prior = np.split(fit.jacobian, [-N_INERTIAL])
    left = fit.residual[:-N_INERTIAL]
    jacobian, residual = seen.reshape(n, -1, size), left.reshape(n, -1)
    scores = [
        np.einsum("jtk,jt->k", jacobian[:, rows], residual[:, rows])
        for rows in np.array_split(np.arange(residual.shape[1]), BLOCKS)
    ]
    spread = np.einsum("bk,bl->kl", scores, scores) * BLOCKS / (BLOCKS - 1) + prior.T @ prior
    covariance = inverse @ spread @ inverse
    for other in _within_uncertainty(problem.nominal):
        moved = (problem.left(fit.signs, fit.x, other) / fit.noise[:, None]).ravel() - left
        covariance += np.outer(shift := inverse @ (seen.T @ moved), shift)
    lower, upper = problem.bounds
    sensitivity = np.linalg.norm(seen, axis=0)
    lost = (fit.x < lower + AT_BOUND) | (fit.x > upper - AT_BOUND) | (sensitivity < UNSEEN * np.max(sensitivity))
    return np.where(lost, np.inf, np.sqrt(np.diag(covariance)))[:places]


def _within_uncertainty(nominal: NominalDynamics) -> Iterator[NominalDynamics]:
    """Yield arms of which one figure each is off by one standard deviation: masses, centres, known rotors."""
    bodies, unsure, drives = nominal.bodies, nominal.uncertainty, nominal.drive_uncertainty
    for k in range(nominal.n_joints):
        scale = np.ones(nominal.n_joints)
        scale[k] += unsure.mass
        heavier = replace(bodies, mass=bodies.mass * scale, inertia=bodies.inertia * scale[:, None, None])
        yield replace(nominal, bodies=heavier)
        for axis in range(3):
            com = bodies.com.copy()
            com[k, axis] += unsure.centre_of_mass_m
            yield replace(nominal, bodies=replace(bodies, com=com))
        if not drives.rotor_is_unknown[k]:
            scale = np.ones(nominal.n_joints)
            scale[k] += drives.rotor_inertia[k]
            yield replace(nominal, rotor_inertia=nominal.rotor_inertia * scale)
