"""Parameters of bodies that can exist: the posterior's most probable point among them.

A body exists if its pseudo-inertia is positive definite (P. M. Wensing, S. Kim, J.-J. E. Slotine, "Linear matrix
inequalities for physically consistent inertial parameter identification", IEEE Robotics and Automation Letters 3(1),
2018); rotors, friction and compliance are not negative. These constraints are convex, and a barrier method (S. Boyd,
L. Vandenberghe, "Convex Optimization", 2004, section 11.3) finds the most probable point in dozens of Newton steps.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.identify.dynamics.parameters import Layout
from bench.identify.dynamics.regressor import N_INERTIAL
from bench.record.campaign import Array

NOT_NEGATIVE = ("rotor", "coulomb", "viscous", "load", "spring", "presliding")  # columns of the drives
# rounding: of a nominal body's trace, how far below zero an eigenvalue may be, for nominal plates and points are there
THIN = 1e-4
SMALL = 0.1  # effort: of the largest payload, and of friction's uncertainty: where the search begins
SHARPER = 0.2  # effort: factor between one barrier and the next
CLOSE = 1e-3  # rounding: half squared standard deviations that the end may be away from the best
MOST_STEPS = 400  # effort: of Newton; 30 to 80 are needed
ENOUGH = 0.1  # effort: of the decrease that the gradient promises; a step is halved until it gives that (Armijo's rule)
SHORTEST = 1e-12  # rounding: of a step
CENTRED = 0.1  # effort: of the barrier: squared Newton decrement at which the next one is tried


@dataclass(frozen=True)
class Bodies:
    """The constraints: linear maps from the parameters to symmetric matrices that have to be positive definite.

    Attributes:
        names: Of the matrices, length m.
        shapes: For each, shape (p, s, s): what each parameter adds.
        slack: For each, what is added to the diagonal, for nominal figures of plates and points stand at the border.
        start: Shape (p,), parameters that keep all constraints.
    """

    names: tuple[str, ...]
    shapes: tuple[Array, ...]
    slack: tuple[float, ...]
    start: Array

    def matrices(self, parameters: Array) -> tuple[Array, ...]:
        """Return the matrices at given parameters."""
        return tuple(
            np.tensordot(parameters, shape, axes=1) + slack * np.eye(shape.shape[1])
            for shape, slack in zip(self.shapes, self.slack, strict=True)
        )

    def broken(self, parameters: Array) -> tuple[str, ...]:
        """Return the names of the bodies that cannot exist."""
        found = zip(self.names, self.matrices(parameters), strict=True)
        return tuple(name for name, matrix in found if np.linalg.eigvalsh(matrix)[0] <= 0)


def bodies_of(
    layout: Layout, joints: Sequence[str], nominal: Array, sigma: Array, payload_kg: float, payload_side: float
) -> Bodies:
    """Return the constraints of a robot.

    Args:
        layout: Of the parameters.
        joints: Names of the joints.
        nominal: Shape (p,), stated figures.
        sigma: Shape (p,), how well they are known.
        payload_kg: Largest payload [kg].
        payload_side: How large a payload is [m].
    """
    names, shapes, slack, start = [], [], [], nominal.copy()
    for link, joint in enumerate(joints):
        shape = np.zeros((layout.size, 4, 4))
        shape[N_INERTIAL * link : N_INERTIAL * (link + 1)] = PSEUDO
        worst = float(np.linalg.eigvalsh(np.tensordot(nominal, shape, axes=1))[0])
        size = float(np.trace(np.tensordot(nominal, shape, axes=1)))
        names.append(f"link of {joint}")
        shapes.append(shape)
        slack.append(max(THIN * size, -2 * worst, np.finfo(float).eps))
    for where in layout.payloads:
        shape = np.zeros((layout.size, 4, 4))
        shape[where] = PSEUDO
        names.append("payload")
        shapes.append(shape)
        slack.append(THIN * payload_kg)
        start[where] = inertial_parameters(SMALL * payload_kg * np.diag([*(0.1 * payload_side**2,) * 3, 1.0]))
    every = np.arange(layout.size)
    for column, slots in (*((name, layout.of_drives(name)) for name in NOT_NEGATIVE), ("softness", layout.softness)):
        for joint, where in zip(joints, every[slots], strict=True):
            shape = np.zeros((layout.size, 1, 1))
            shape[where] = 1.0
            names.append(f"{column} of {joint}")
            shapes.append(shape)
            slack.append(max(THIN * abs(float(nominal[where])), np.finfo(float).eps))
            start[where] = max(float(nominal[where]), SMALL * float(sigma[where]))
    return Bodies(tuple(names), tuple(shapes), tuple(slack), start)


def nearest(bodies: Bodies, parameters: Array, mean: Array, factor: Array, gram: Array) -> Array:
    """Return the most probable parameters with which all bodies can exist, shape (p,).

    Args:
        bodies: The constraints.
        parameters: Shape (p,), the posterior's mean.
        mean: Shape (p,), of the prior.
        factor: Shape (p, p), of the prior: parameters = mean + factor z; what it holds fixed stays.
        gram: Shape (p, p), of the normal equations.
    """
    if not bodies.broken(parameters):
        return parameters
    precision = np.eye(factor.shape[1]) + factor.T @ gram @ factor
    inverse = np.linalg.pinv(factor, rcond=1e-12)
    best, z = inverse @ (parameters - mean), inverse @ (bodies.start - mean)
    parts: list[_Part | _Positive] = []
    numbers: list[tuple[Array, float]] = []
    for shape, offset in zip(bodies.shapes, bodies.matrices(mean), strict=True):
        turned = np.tensordot(factor.T, shape, axes=1)
        own = np.flatnonzero(turned.any(axis=(1, 2)))
        if len(offset) == 1:
            numbers.append((turned[:, 0, 0], float(offset[0, 0])))
        else:
            parts.append(_Part(own, turned[own], offset))
    if numbers:
        parts.append(_Positive(np.stack([row for row, _ in numbers]), np.array([offset for _, offset in numbers])))
    order = sum(len(part.offset) for part in parts)

    def value(z: Array, sharp: float) -> float:
        return float((z - best) @ precision @ (z - best)) / 2 - sharp * sum(part.log_determinant(z) for part in parts)

    sharp = max(1.0, float((z - best) @ precision @ (z - best)) / 2 / order)
    for _ in range(MOST_STEPS):
        slope, bend = precision @ (z - best), precision.copy()
        for part in parts:
            part.push(z, sharp, slope, bend)
        step = -np.linalg.solve(bend, slope)
        decrement = float(-slope @ step)
        if decrement < CENTRED * sharp:
            if order * sharp < CLOSE:
                break
            sharp *= SHARPER
            continue
        length, now = 1.0, value(z, sharp)
        while length > SHORTEST and not value(z + length * step, sharp) <= now - ENOUGH * length * decrement:
            length /= 2
        z = z + length * step
    return np.asarray(mean + factor @ z)


@dataclass(frozen=True)
class _Part:
    """One constraint over z: offset + sum z_k shape_k positive definite, for the few k in `own`."""

    own: NDArray[np.int64]
    shape: Array
    offset: Array

    def log_determinant(self, z: Array) -> float:
        """Return log det, minus infinity outside."""
        try:
            lower = np.linalg.cholesky(self._matrix(z))
        except np.linalg.LinAlgError:
            return -np.inf
        return 2 * float(np.log(np.diag(lower)).sum())

    def push(self, z: Array, sharp: float, slope: Array, bend: Array) -> None:
        """Add gradient and Hessian of -sharp log det."""
        solved = np.linalg.solve(self._matrix(z)[None], self.shape)
        slope[self.own] -= sharp * np.trace(solved, axis1=1, axis2=2)
        bend[np.ix_(self.own, self.own)] += sharp * np.einsum("aij,bji->ab", solved, solved)

    def _matrix(self, z: Array) -> Array:
        changed = z[self.own] @ self.shape.reshape(len(self.own), -1)
        return np.asarray(changed.reshape(self.offset.shape) + self.offset)


@dataclass(frozen=True)
class _Positive:
    """Constraints on single numbers over z, all at once: offset + shape z positive."""

    shape: Array
    offset: Array

    def log_determinant(self, z: Array) -> float:
        """Return the sum of the logarithms, minus infinity outside."""
        left = self.shape @ z + self.offset
        return float(np.log(left).sum()) if np.all(left > 0) else -np.inf

    def push(self, z: Array, sharp: float, slope: Array, bend: Array) -> None:
        """Add gradient and Hessian of -sharp times that sum."""
        rows = self.shape / (self.shape @ z + self.offset)[:, None]
        slope -= sharp * rows.sum(axis=0)
        bend += sharp * rows.T @ rows


def pseudo_inertia(link: Array) -> Array:
    """Return the pseudo-inertia of a body, shape (4, 4): second moments, first moments and mass of its density.

    Args:
        link: Shape (10,), inertial parameters about the origin of its frame.
    """
    xx, xy, yy, xz, yz, zz = link[4:]
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    found = np.empty((4, 4))
    found[:3, :3] = np.trace(inertia) / 2 * np.eye(3) - inertia
    found[:3, 3] = found[3, :3] = link[1:4]
    found[3, 3] = link[0]
    return found


def inertial_parameters(pseudo: Array) -> Array:
    """Return the inertial parameters, shape (10,), of a pseudo-inertia: the inverse of `pseudo_inertia`."""
    inertia = np.trace(pseudo[:3, :3]) * np.eye(3) - pseudo[:3, :3]
    return np.array([pseudo[3, 3], *pseudo[:3, 3], *inertia[[0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]]])


PSEUDO = np.stack([pseudo_inertia(unit) for unit in np.eye(N_INERTIAL)])
