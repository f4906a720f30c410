"""A gauge whose readings do not rise and fall with the gas: mirrored, turned in sign, or of another movement."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.plausibility.late_channels import late_gauges
from bench.diagnose.plausibility.mistaken import doubt
from bench.diagnose.plausibility.physical_fit import HALF
from bench.diagnose.replay.replay import Replay
from bench.record.campaign import Array
from bench.record.finding import Finding

GAUGE = "gas_pressure_pa"


def unlike_gas(replay: Replay, run_of: NDArray[np.str_], observed: Array, nominal: Array) -> Iterator[Finding]:
    """Yield what is wrong with a gauge by how its readings change within runs; whatever gas it is, it is compressed.

    Nothing is told where the model's pressure changes by less than what the gauge resolves, or where the gauge is late.

    Args:
        replay: The recording.
        run_of: Run of each reading, shape (t,).
        observed: Shape (t,) [Pa].
        nominal: Shape (t,) [Pa], of the model.
    """
    gauge = replay.compiled.robot.figures.instruments.pressure
    seen, there = observed.copy(), nominal.copy()
    for run in np.unique(run_of):
        for part in (seen, there):
            part[run_of == run] -= np.mean(part[run_of == run])
    moves, shown = float(np.sum(there**2)), float(np.sum(seen**2))
    if gauge is None or not shown or moves <= gauge.resolution_pa**2 * len(there):
        return
    factor = float(np.sum(seen * there)) / moves
    left = float(np.sum((seen - factor * there) ** 2)) / shown
    if left < HALF and factor < 0:
        message = f"falls where the model's rises: within runs it changes by {factor:.2f} times as much"
        yield doubt(GAUGE, message, "mirrored, or a wrong sign? give pascals above ambient")
    elif left > HALF and not any(late.explains_most for late in late_gauges(replay)):
        message = f"is hardly that of the gas: of how it changes within runs the model explains {1 - left:.0%}"
        yield Finding("warning", "all runs", None, GAUGE, message, "look at its clock, and for lost readings")
