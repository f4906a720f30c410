"""Drive channels of which the nominal model explains less than half: of all, of one run, or of what changes in runs.

A run of its own tells what all together hide: a channel turned in sign, exchanged or played backwards there. How a
channel changes within its runs tells what a large mean hides: noise about the weight of an arm, or motions backwards.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.plausibility.drive_picture import LEAST, DrivePicture
from bench.diagnose.plausibility.physical_fit import HALF, completed, left_over
from bench.diagnose.replay.instants import run_of_each
from bench.diagnose.replay.segments import Segment
from bench.record.finding import Finding

REMEDY = "look at sign, order, clock and lost readings; bench diagnose takes it for defects of the robot"


def unexplained(picture: DrivePicture, segments: Sequence[Segment]) -> Iterator[Finding]:
    """Yield a warning for each channel, and the run in which the model explains least of it.

    Args:
        picture: What drives did.
        segments: Whose readings these are.
    """
    left, whole = left_over(picture), completed(picture)
    run_of = run_of_each(segments)
    for j, name in enumerate(picture.names):
        seen = np.isfinite(left[:, j])
        shares: dict[str, float] = {}
        for run in dict.fromkeys(run_of[seen & ~picture.standing[:, j]].tolist()):
            rows = seen & (run_of == run)
            if rows.sum() >= LEAST:  # a run in which the drive does less than usual is held against the usual
                own = float(np.mean(picture.observed[rows, j] ** 2) / np.mean(picture.observed[seen, j] ** 2))
                shares[run] = float(np.mean(left[rows, j])) / max(own, 1.0)
        bad = [run for run, share in shares.items() if share > HALF]  # more than is explained: 71 % of the size
        if bad:
            worst = max(bad, key=lambda run: shares[run])
            where = f"run {worst!r}" + (f" and {len(bad) - 1} more of {len(shares)}" if len(bad) > 1 else "")
            message = (
                f"is hardly what its drive did in {where}: with any friction, payload and gas the model misses "
                f"{shares[worst] ** 0.5:.0%} of its size"
            )
            yield Finding("warning", "all runs", None, name, message, REMEDY)
        elif (share := _of_changes(whole, j, run_of)) < HALF:
            message = (
                f"is hardly what its drive did: of how it changes within runs, with any friction, payload and gas, the "
                f"model explains {share:.0%}"
            )
            yield Finding("warning", "all runs", None, name, message, REMEDY)


def _of_changes(whole: DrivePicture, j: int, run_of: NDArray[np.str_]) -> float:
    """Return how much of a channel's changes within runs the model explains, times any factor, as a part of all.

    1 where the model has a drive do less than half of what is seen: such a drive works against what nobody models.

    Args:
        whole: What drives did, with a model that has what the nominal one lacks.
        j: Of the drive.
        run_of: Run of each instant, shape (T,).
    """
    seen = np.isfinite(whole.observed[:, j]) & ~whole.standing[:, j]
    shown, there = (np.where(seen, part[:, j], 0.0) for part in (whole.observed, whole.model))
    for run in dict.fromkeys(run_of[seen].tolist()):
        rows = seen & (run_of == run)
        if rows.sum() < LEAST:
            seen = seen & ~rows
        for part in (shown, there):
            part[rows] -= np.mean(part[rows])
    power, moves = float(np.sum(shown[seen] ** 2)), float(np.sum(there[seen] ** 2))
    if not moves or moves < HALF * power:
        return 1.0
    return max(float(np.sum(shown[seen] * there[seen])), 0.0) ** 2 / (moves * power) if power else 0.0
