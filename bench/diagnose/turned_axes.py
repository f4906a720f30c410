"""Axes whose angle and torque are both turned: friction does not tell, gravity and the inertia of other joints do."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import nnls

from bench.diagnose.drive_picture import DrivePicture, drive_picture
from bench.diagnose.quantities import Quantity
from bench.diagnose.replay import Replay
from bench.diagnose.segments import Segment
from bench.errors import ConvergenceError
from bench.record.campaign import Array
from bench.record.finding import Finding
from bench.robot.compiled import CompiledRobot

GOOD = 0.05  # of the mean square of a drive's torque: what is left by a model without turned axes, and by most defects
BETTER = 0.25  # part of what is left over all drives, that remains with one axis turned


def turned_axes(
    picture: DrivePicture, segments: Sequence[Segment], quantities: tuple[Quantity, ...], compiled: CompiledRobot
) -> Iterator[Finding]:
    """Yield the axis which, turned, makes the nominal model with friction, payload and gas fit by far better."""
    before = misfit(picture)
    if np.max(before) < GOOD:
        return
    after = {}
    for j in range(compiled.n_joints):
        try:
            after[j] = float(
                misfit(drive_picture(Replay(compiled, _turned(segments, quantities, j), quantities))).sum()
            )
        except ConvergenceError:
            continue
    best = min(after, key=lambda j: after[j], default=-1)
    if best >= 0 and after[best] < BETTER * float(before.sum()):
        drive, name = compiled.robot.figures.drives[best].joint, picture.names[best] or f"q_motor_{best + 1}"
        yield doubt(
            name,
            f"{drive} moves against the model's sense of turning, torque and angle alike",
            "turn the sign of both, or the axis in the MJCF",
        )


def misfit(picture: DrivePicture) -> Array:
    """Return what a physical model leaves of every drive's torque, shape (n,), as a part of its mean square.

    The nominal model, with amounts of friction (one per drive), of payload and of gas that are zero or more.
    """
    n, e = picture.missing.shape[1:]
    columns, values, drive = [], [], []
    for j in range(n):
        seen = np.isfinite(picture.observed[:, j])
        power = float(np.sqrt(np.mean(picture.observed[seen, j] ** 2))) if np.any(seen) else 0.0
        if power == 0.0:
            continue
        own, v = np.zeros((int(seen.sum()), e + 2 * n)), picture.velocity[seen, j]
        own[:, :e] = picture.missing[seen, j]
        own[:, e + 2 * j], own[:, e + 2 * j + 1] = np.sign(v), v
        columns.append(own / power)
        values.append((picture.observed[seen, j] - picture.model[seen, j]) / power)
        drive.append(np.full(len(own), j))
    if not columns:
        return np.zeros(n)
    stacked, response, of = np.concatenate(columns), np.concatenate(values), np.concatenate(drive)
    size = np.maximum(np.linalg.norm(stacked, axis=0), 1e-12)
    amounts, _ = nnls(stacked / size, response)
    left = (response - stacked / size @ amounts) ** 2
    return np.array([left[of == j].mean() if np.any(of == j) else 0.0 for j in range(n)])


def doubt(column: str, message: str, remedy: str) -> Finding:
    """Return a warning on a channel of a whole campaign."""
    return Finding("warning", "all runs", None, column, message, remedy)


def _turned(segments: Sequence[Segment], quantities: tuple[Quantity, ...], j: int) -> tuple[Segment, ...]:
    """Return segments with the angle and the torque of one drive turned."""
    found = []
    for segment in segments:
        sign = np.where(np.arange(segment.motion.q.shape[1]) == j, -1.0, 1.0)
        motion = replace(
            segment.motion,
            q=sign * segment.motion.q,
            velocity=sign * segment.motion.velocity,
            acceleration=sign * segment.motion.acceleration,
        )
        reading = np.where([quantity.index == j for quantity in quantities], -1.0, 1.0)
        found.append(replace(segment, motion=motion, observed=reading * segment.observed))
    return tuple(found)
