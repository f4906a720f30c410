"""Friction over speed, viscous or learned as a polynomial: how large it is, and from where on it cannot be meant.

A polynomial goes on beyond the speeds at which it was learned. One whose highest power takes away falls for good from
some speed on, and drives at last, as no friction does.
"""

from collections.abc import Iterator

import numpy as np

from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot

SIGNS = ("v", "v|v|", "v^3")  # what the coefficients belong to


def drag_of(compiled: CompiledRobot) -> Array:
    """Return the coefficients of v, v|v| and v^3 of each joint, of motor and link side together, shape (n, 3) [SI]."""
    model, at = compiled.model, compiled.at
    every = np.concatenate([model.dof_damping[:, None], model.dof_dampingpoly], axis=1)
    return np.asarray(every[at.q_dof] + every[at.theta_dof])


def drag_torque(compiled: CompiledRobot, velocity: Array) -> Array:
    """Return what turns joints against that friction, shape (T, n) [Nm].

    Args:
        compiled: The robot.
        velocity: Shape (T, n) [rad/s].
    """
    first, second, third = drag_of(compiled).T
    return np.asarray((first + second * np.abs(velocity) + third * velocity**2) * velocity)


def falls_beyond(coefficients: Array) -> float:
    """Return the speed from which on friction falls for good as speed grows [rad/s]; inf where it never does.

    Args:
        coefficients: Shape (3,), as of `drag_of`.
    """
    first, second, third = coefficients.tolist()
    highest = next((x for x in (third, second, first) if x), 0.0)
    if highest >= 0:
        return float("inf")
    turns = np.roots([3 * third, 2 * second, first])
    return float(max((x.real for x in turns if abs(x.imag) == 0 and x.real > 0), default=0.0))


def learned_words(compiled: CompiledRobot) -> Iterator[str]:
    """Yield the polynomial of each joint that has one, and from where on it falls."""
    for j, (drive, row) in enumerate(zip(compiled.robot.figures.drives, drag_of(compiled), strict=True)):
        if np.any(row[1:]):
            terms = " ".join(f"{x:+.4g} {sign}" for x, sign in zip(row.tolist(), SIGNS, strict=True) if x)
            torque, speed = ("N", "m/s") if compiled.is_slide[j] else ("Nm", "rad/s")
            far = falls_beyond(row)
            ends = f", not to be used beyond {far:.3g} {speed}, where it falls for good" if np.isfinite(far) else ""
            yield f"{drive.joint} {terms} [{torque}]{ends}"


def beyond_learned(compiled: CompiledRobot, velocity: Array) -> Iterator[str]:
    """Yield a sentence for each joint that moves faster than its learned friction can be meant.

    Args:
        compiled: The robot.
        velocity: Shape (T, n) [rad/s].
    """
    for j, (drive, row) in enumerate(zip(compiled.robot.figures.drives, drag_of(compiled), strict=True)):
        speed, far = float(np.max(np.abs(velocity[:, j]))), falls_beyond(row)
        if speed > far:
            unit = "m/s" if compiled.is_slide[j] else "rad/s"
            yield (
                f"{drive.joint}: {speed:.4g} {unit}, and the friction that was learned over its speed falls beyond "
                f"{far:.3g} {unit} for good, as no friction does: do not use the torques there"
            )
