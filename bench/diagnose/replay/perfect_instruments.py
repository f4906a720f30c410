"""What instruments show that err in nothing, or only in what effects do to them."""

from collections.abc import Iterable

import numpy as np

from bench.diagnose.replay.courses import count_of
from bench.diagnose.replay.instants import slices_of
from bench.diagnose.replay.segments import Segment
from bench.effects.conditions import REFERENCE_K
from bench.effects.effect import Acting, Effect
from bench.robot.compiled import CompiledRobot
from bench.simulate.instruments import Reading
from bench.simulate.trace import Trace


def ideal_reading(compiled: CompiledRobot, trace: Trace) -> Reading:
    """Return what perfect instruments show; every quantity is there."""
    gauge = compiled.robot.figures.instruments.pressure
    area = gauge.piston_area_m2 if gauge else np.nan
    return Reading(
        time=trace.time,
        q_motor=trace.q,
        q_link=trace.theta,
        current=trace.motor_torque / compiled.torque_constant,
        torque=trace.motor_torque,
        force=trace.wrench[:, :3],
        moment=trace.wrench[:, 3:],
        reflectors=trace.reflectors,
        gas_pressure=trace.gas_force / area,
        gas_temperature=np.full(len(trace), REFERENCE_K),
    )


def distorted(reading: Reading, segments: Iterable[Segment], trace: Trace, acting: Iterable[Acting]) -> Reading:
    """Return what instruments show in which some effects act."""
    distorting = [one for one in acting if type(one.effect).distort is not Effect.distort]
    if not distorting:
        return reading
    known = tuple(segments)
    parts = []
    for segment, rows in zip(known, slices_of(count_of(one) for one in known), strict=True):
        seen, there = reading[rows], trace[rows]
        for one in distorting:
            seen = one.effect.distort(one.place, one.values, seen, there, segment.conditions)
        parts.append(seen)
    return Reading.concatenate(parts)
