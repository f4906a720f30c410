"""Static runs, visit by visit: a visit is one approach of one pose, with the loads that were hung on there."""

from collections import Counter
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.replay.segment_input import SegmentInput, angles_of, wrench_of
from bench.record.campaign import Array, Run
from bench.robot.compiled import CompiledRobot
from bench.simulate.prescribed import Motion

# declared: times the usual time between repeats; what is read so much later is read of gas that has relaxed, and of a
# frame that has drifted
LATER = 10.0
APPROACH = np.deg2rad(2.0)  # rounding: [rad]; friction is sliding long before, so no reading depends on it


def visits_of(run: Run, compiled: CompiledRobot) -> Iterator[SegmentInput]:
    """Yield the visits of a static run: the pose is approached from its side, then load follows load.

    A pose that is visited again from the same side says so in its label, which no other visit of the run has.
    """
    angles, wrenches = angles_of(run, compiled), wrench_of(run, compiled)
    count = np.zeros(len(run))
    pose, step = run.columns["pose"], run.columns["load_step"]
    approach = run.columns.get("approach", count)
    begins = np.flatnonzero(
        np.concatenate([[True], (np.diff(pose) != 0) | (np.diff(approach) != 0) | (np.diff(step) < 0)])
    )
    times = Counter[str]()
    for first, last in zip(begins, np.append(begins[1:], len(run)), strict=True):
        rows = np.arange(first, last)
        clock = run.columns.get("time_s", np.arange(len(run), dtype=np.float64))
        edges = np.flatnonzero((np.diff(step[rows]) != 0) | _much_later(clock[rows])) + 1
        groups = np.split(rows, edges)
        q = np.stack([angles[group].mean(axis=0) for group in groups])
        wrench = np.stack([wrenches[group].mean(axis=0) for group in groups])
        time = run.start_s + np.array([clock[group].mean() for group in groups])
        side = approach[first]
        before = q[:1] - side * APPROACH if side else q[:1]
        zeros = np.zeros((len(q) + 1, q.shape[1]))
        motion = Motion(
            time=np.concatenate([time[:1] - 1.0, time]),
            q=np.concatenate([before, q]),
            velocity=zeros,
            acceleration=zeros,
            wrench=np.concatenate([np.zeros((1, 6)), wrench]),
            read=np.concatenate([[False], np.ones(len(q), dtype=bool)]),
        )
        words = {1.0: " from below", -1.0: " from above"}.get(float(side), "")
        still = np.zeros(q.shape, dtype=bool)
        label = f"{run.name}, pose {pose[first]:g}{words}"
        times[label] += 1
        again = f", visit {times[label]}" if times[label] > 1 else ""
        yield SegmentInput(label + again, tuple(groups), motion, zeros[1:], still, still[:, 0])


def _much_later(time: Array) -> NDArray[np.bool_]:
    """Return which readings but the first come long after the one before, by what is usual here, shape (n - 1,)."""
    gaps = np.diff(time)
    return gaps > LATER * np.median(gaps) if len(gaps) else gaps > 0
