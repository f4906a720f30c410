"""Drive channels of which the nominal model explains less than half: throughout, or in one run.

A run of its own tells what all together hide: a channel turned in sign, exchanged or played backwards there.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from bench.diagnose.plausibility.drive_picture import LEAST, DrivePicture
from bench.diagnose.plausibility.physical_fit import HALF, left_over
from bench.diagnose.replay.instants import run_of_each
from bench.diagnose.replay.segments import Segment
from bench.record.finding import Finding


def unexplained(picture: DrivePicture, segments: Sequence[Segment]) -> Iterator[Finding]:
    """Yield a warning for each channel, and the run in which the model explains least of it.

    Args:
        picture: What drives did.
        segments: Whose readings these are.
    """
    left = left_over(picture)
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
            remedy = "look at sign, order, clock and lost readings; bench diagnose takes it for defects of the robot"
            yield Finding("warning", "all runs", None, name, message, remedy)
