"""What no drive is commanded: a clock that is not in seconds, speeds that are not those of the angles."""

from collections.abc import Iterator

import numpy as np

from bench.record.campaign import Array
from bench.record.finding import counted
from bench.record.rules.clock import SHORTEST_STEP_S, SLOW_STEP_S, UNEVEN
from bench.robot.compiled import CompiledRobot

FAR_BEYOND = 100.0  # times the speed of a drive; twice is a motion that asks too much, and is told so
EVEN = 0.9  # declared: of the steps, alike where a motion is sampled evenly; a planner may have its own
CREEPS = 1e-3  # of a drive's speed, the fastest joint of a motion with rows seconds apart
ANOTHER = 0.9  # of the larger one, root mean square: degrees for radians make 0.98, another sign 2
LEAST = 1e-3  # of a drive's speed in a second; below, rounding of angles is in the derivative


def clock_faults(time: Array, q: Array, compiled: CompiledRobot) -> Iterator[str]:
    """Yield a sentence, without its file, where rows are so near or so far from each other that no arm moves like that.

    Args:
        time: Shape (T,), grows.
        q: Shape (T, n), within the joints' ranges.
        compiled: The robot.
    """
    step = np.diff(time)
    median = float(np.median(step))
    limits = np.array([drive.speed_limit_rad_per_s for drive in compiled.robot.figures.drives])
    with np.errstate(over="ignore"):
        fastest = float(np.max(np.abs(np.diff(q, axis=0)) / step[:, None] / limits))
    remedy = "give it in seconds"
    if median < SHORTEST_STEP_S:
        yield f"time_s: goes on by {median:.2g} s from row to row; {remedy}."
    elif fastest > FAR_BEYOND:
        yield f"time_s: makes a joint {fastest:.3g} times as fast as its drive; {remedy}, or correct the angles."
    elif median >= SLOW_STEP_S and 0 < fastest < CREEPS:
        words = f"goes on by {median:.3g} s from row to row, and no joint reaches {fastest:.1e} of its drive's speed"
        yield f"time_s: {words}; milli-, micro- or nanoseconds? {remedy}."


def gaps(time: Array, q: Array) -> Iterator[str]:
    """Yield a sentence where rows may be missing of a motion that is else sampled evenly: angles go on in between.

    Args:
        time: Shape (T,), grows.
        q: Shape (T, n).
    """
    step = np.diff(time)
    median = float(np.median(step))
    moved = np.any(np.diff(q, axis=0) != 0, axis=1)
    late = np.flatnonzero((step > (1 + UNEVEN) * median) & moved)
    if len(late) and np.mean(np.abs(step - median) <= UNEVEN * median) > EVEN:
        first = int(late[0])
        words = f"time_s: {step[first]:.3g} s pass before row {first + 2}, and {median:.3g} s from row to row else"
        yield f"{words} ({counted(len(late), 'such gap')}); lost rows? torques there are of a straight way between"


def derivative_faults(kind: str, given: Array, expected: Array, compiled: CompiledRobot) -> Iterator[str]:
    """Yield a sentence, without its file, for each column that is not the derivative that its name says.

    Args:
        kind: "velocity" or "acceleration".
        given: Shape (T, n), as it stands in the file.
        expected: Shape (T, n), of the angles, or of the speeds.
        compiled: The robot.
    """
    for j, drive in enumerate(compiled.robot.figures.drives):
        name, values, derivative = f"{kind}_{j + 1}", given[:, j], expected[:, j]
        if not np.all(np.isfinite(values)):
            yield f"{name}: is not a number in some rows; write a number, or leave the columns out."
            continue
        sizes = [float(np.max(np.abs(part))) for part in (values, derivative)]
        largest = max(sizes)
        if largest < LEAST * drive.speed_limit_rad_per_s:
            continue
        ratio = float(np.sqrt(np.mean(((values - derivative) / largest) ** 2)))
        whole = max(float(np.sqrt(np.mean((part / largest) ** 2))) for part in (values, derivative))
        if ratio > ANOTHER * whole:
            of = "q_cmd" if kind == "velocity" else "velocity"
            words = f"reaches {sizes[0]:.3g}, and the derivative of {of}_{j + 1} {sizes[1]:.3g}"
            yield f"{name}: {words}; degrees, or another sign? give SI units, or leave the columns out."
