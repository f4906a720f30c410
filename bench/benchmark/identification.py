"""Stiffness from the 108 states of scenario `loading`: the joint method and mujoco.sysid on the same readings."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from threadpoolctl import threadpool_limits

from bench.benchmark.clock import processor_time
from bench.benchmark.section import Row
from bench.benchmark.sysid_loading import fit_with_sysid
from bench.identify.arm import Arm
from bench.identify.from_campaign import static_readings
from bench.identify.methods import METHODS
from bench.identify.options import Options
from bench.identify.readings import StaticReadings
from bench.record.campaign import Array
from bench.robot.links import rigid_bodies
from bench.scenario.files import read_scenario
from bench.scenario.loading import Loading
from bench.simulate.quasistatic import RestLog, rest_log

LEVEL = 0.95  # of the intervals
SEEDS = 20  # of instruments' noise, for the joint method; mujoco.sysid gets the first alone


def measure(robots: Sequence[str]) -> list[Row]:
    """Return time, error and coverage of each way; names of robots are not used."""
    scenario = read_scenario("loading")
    assert isinstance(scenario, Loading)
    log = rest_log(scenario)
    truth = log.compiled.stiffness
    with threadpool_limits(1, "blas"):  # the matrices are small: threads cost five times what they give
        found = [_joint(log, seed) for seed in range(SEEDS)]
        rows = _rows("joint method", found, truth)
        for residual in ("weighted", "default"):
            start = processor_time()
            fit = fit_with_sysid(log.compiled, _readings(log, 0), residual, LEVEL)
            one = _Found(processor_time() - start, fit.stiffness, fit.interval)
            rows += _rows(f"mujoco.sysid, {residual} residual", [one], truth, against=found[0])
    return rows


@dataclass(frozen=True, eq=False)
class _Found:
    """Processor time [s], stiffness, shape (n,), and its interval, shape (2, n) [Nm/rad]."""

    took: float
    stiffness: Array
    interval: Array


def _readings(log: RestLog, seed: int) -> StaticReadings:
    return static_readings(log.read(np.random.default_rng(seed)), log.compiled.robot.figures)


def _joint(log: RestLog, seed: int) -> _Found:
    readings, arm = _readings(log, seed), Arm(rigid_bodies(log.compiled))
    start = processor_time()
    estimate = METHODS["joint"](arm, log.compiled.counterbalance, readings, Options())
    return _Found(processor_time() - start, estimate.stiffness, estimate.interval(LEVEL).T)


def _rows(name: str, found: Sequence[_Found], truth: Array, against: _Found | None = None) -> list[Row]:
    """Return time, error and coverage; of several readings, the median time, and errors and intervals of all."""
    took = float(np.median([one.took for one in found]))
    error = float(np.median([np.abs(one.stiffness / truth - 1) for one in found]))
    covered = float(np.mean([(one.interval[0] <= truth) & (truth <= one.interval[1]) for one in found]))
    words = f"{name}, {len(found)} readings" if len(found) > 1 else name
    return [
        Row(f"{words}: time", took, "s", took / against.took if against else None, "times the joint method"),
        Row(f"{words}: median error", 100 * error, "%"),
        Row(f"{words}: intervals with the truth", 100 * covered, "%"),
    ]
