"""Gearboxes that stay colder than the air they work in, as when the thermometers of two parts are exchanged."""

from collections.abc import Iterator, Sequence
from math import exp, hypot, sqrt

import numpy as np

from bench.diagnose.replay.noise import UNIFORM
from bench.diagnose.replay.nuisances import THERMOMETER_K
from bench.record.campaign import Array, Campaign, Run
from bench.record.finding import Finding
from bench.record.known import CONTRADICTS
from bench.record.rules.sheet import TRAVEL

AIR, GEAR = "ambient_temperature_k", "gear_temperature"
# derived: [s]; density, heat capacity and side of a cube of steel of 0.3 m, larger than any gearbox of a robot, in
# still air, which takes and gives 10 W/(m^2 K) by convection and radiation: rho c L / (6 h)
SLOWEST_S = 7850 * 460 * 0.3 / (6 * 10)
PAUSE_S = 3600.0  # declared: [s]; between two runs, in which the air changes evenly
FEWEST = 2  # exact: runs, of a change
SIGMAS = 2  # declared: of the zeros of two thermometers, by which a gear has to be colder; friction only warms it


def cold_gears(campaign: Campaign) -> Iterator[Finding]:
    """Yield a warning for each gearbox that works, is colder than the air, and does not follow it.

    Heat flows from warmer air into it, and its friction adds to that: from run to run it warms up at least as fast as
    a cube of steel that only stands there.

    Args:
        campaign: A checked campaign.
    """
    for own in _sittings(campaign):
        for name in dict.fromkeys(name for run in own for name in run.columns if name.startswith(GEAR)):
            runs = [run for run in own if {name, AIR} <= run.columns.keys() and len(run)]
            joint = name.removeprefix(f"{GEAR}_").removesuffix("_k")
            if len(runs) >= FEWEST and any(_works(run, joint) for run in own):
                yield from _cold(runs, name)


def _sittings(campaign: Campaign) -> Iterator[list[Run]]:
    """Yield runs that follow each other; in a longer pause nobody knows what the air did."""
    before: list[Run] = []
    for run in sorted(campaign.runs, key=lambda run: (campaign.recordings.index(run.recording), run.start_s)):
        if before and (run.recording != before[-1].recording or run.start_s - before[-1].start_s > PAUSE_S):
            yield before
            before = []
        before.append(run)
    yield before


def _cold(runs: Sequence[Run], name: str) -> Iterator[Finding]:
    """Yield a warning for one gearbox in the runs of a sitting, if it is colder than the air and does not follow it."""
    gear, air = _means(runs, name), _means(runs, AIR)
    passive = _follower(gear[0], air, np.array([run.start_s for run in runs]))
    error = hypot(_error(runs[0], name), _error(runs[-1], name))
    colder = air[-1] - gear[-1]
    if colder > SIGMAS * sqrt(2) * THERMOMETER_K and passive - gear[-1] > CONTRADICTS * error:
        message = (
            f"is {colder:.2g} K colder than the air in run {runs[-1].name!r}, though its drive works, and "
            f"{gear[-1] - gear[0]:+.1f} K since run {runs[0].name!r}, where what only stands in that air gains "
            f"{passive - gear[0]:.1f} K"
        )
        yield Finding("warning", "all runs", None, name, message, f"exchanged with {AIR}, or with another part?")


def _works(run: Run, joint: str) -> bool:
    """Return whether a joint of a motion moves."""
    return run.kind == "motion" and any(
        np.ptp(run.columns[f"{quantity}_{joint}_{unit}"]) > travel
        for unit, travel in TRAVEL.items()
        for quantity in ("q_motor", "q_cmd")
        if f"{quantity}_{joint}_{unit}" in run.columns
    )


def _means(runs: Sequence[Run], name: str) -> Array:
    return np.array([float(np.mean(run.columns[name])) for run in runs])


def _error(run: Run, name: str) -> float:
    """Return the standard error of the mean of a column in a run, noise and rounding [K]."""
    values = run.columns[name]
    steps = np.diff(np.unique(values))
    step = float(np.min(steps)) if len(steps) else 1.0  # one number all along: a thermometer that shows whole kelvins
    return hypot(float(np.std(values)) / sqrt(len(values)), float(UNIFORM) * step)


def _follower(temperature: float, air: Array, time: Array) -> float:
    """Return how warm a cube of steel becomes that begins at some temperature in air of shape (R,) [K] at times [s]."""
    for before, after, seconds in zip(air[:-1], air[1:], np.diff(time), strict=True):
        temperature += ((before + after) / 2 - temperature) * (1 - exp(-seconds / SLOWEST_S))
    return temperature
