"""Steps of a fit towards the least sum of squares, and what each of them tells of the derivatives."""

from collections.abc import Iterator

import numpy as np

from bench.record.campaign import Array

HALVINGS = 5  # effort: lengths of a step that are tried
DAMPINGS = (0.1, 1.0, 10.0)  # effort: of the curvature of each parameter alone


def ever_shorter(step: Array, curvature: Array, gradient: Array, low: Array, high: Array) -> Iterator[Array]:
    """Yield a step, parts of it, and where none of them serves, steps that turn towards the gradient (Marquardt)."""
    for halving in range(HALVINGS):
        yield 0.5**halving * step
    for damping in DAMPINGS:
        yield bounded_step(curvature + damping * np.diag(np.diag(curvature)), gradient, low, high)


def bounded_step(curvature: Array, gradient: Array, low: Array, high: Array) -> Array:
    """Return the Newton step; parameters that would leave their bounds stop there, and the rest is solved again.

    Args:
        curvature: Shape (q, q).
        gradient: Shape (q,).
        low: Shape (q,), least steps.
        high: Shape (q,), largest steps.
    """
    step = np.asarray(np.linalg.solve(curvature, gradient), dtype=np.float64)
    stopped = np.zeros(len(step), dtype=bool)
    for _ in range(len(step)):
        inside = np.clip(step, low, high)
        out = inside != step
        if not np.any(out):
            break
        step = inside
        stopped |= out
        free = ~stopped
        rest = gradient[free] - curvature[np.ix_(free, stopped)] @ step[stopped]
        step[free] = np.linalg.solve(curvature[np.ix_(free, free)], rest)
    return np.clip(step, low, high)


def broyden(tangent: Array, precision: Array, change: Array, step: Array, scale: Array) -> tuple[Array, Array]:
    """Return derivatives that are right along a step that was simulated, as near as may be to those before.

    J' = J + u v', u = y - J s, v = D^-2 s / s' D^-2 s, with what the step s changed, y (Broyden, A class of methods for
    solving nonlinear simultaneous equations, 1965), in units D, so that parameters of different units count alike. The
    precision, J' J and that of priors, follows: P + (J' u) v' + v (J' u)' + (u' u) v v'.

    Args:
        tangent: Shape (m, q), change of what is simulated with each parameter.
        precision: Shape (q, q), of the parameters.
        change: Shape (m,), what the step changed.
        step: Shape (q,).
        scale: Shape (q,), units of the parameters.

    Returns:
        The derivatives, and the precision with them.
    """
    along = step / scale**2
    along = along / float(along @ step)
    missed = change - tangent @ step
    cross = np.outer(tangent.T @ missed, along)
    more = cross + cross.T + float(missed @ missed) * np.outer(along, along)
    return tangent + np.outer(missed, along), precision + more
