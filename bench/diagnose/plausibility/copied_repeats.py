"""Repeats at rest that are copies of each other: noise as stated, and rounding, do not let all channels agree."""

from collections.abc import Iterator

import numpy as np
from scipy.special import bdtrc

from bench.diagnose.plausibility.repeated import Repeated
from bench.diagnose.replay.noise import Noise
from bench.diagnose.replay.quantities import Quantity
from bench.record.campaign import Run
from bench.record.finding import Finding, counted
from bench.record.rules.labels import STATE

CHANCE = 1e-6  # declared: of a run without copies to be told


def copied_repeats(repeated: Repeated) -> Iterator[Finding]:
    """Yield a warning where, in a run at rest, too many repeats read as the row before in all channels.

    Args:
        repeated: The campaign.
    """
    noise = Noise(repeated.campaign, repeated.compiled.robot.figures)
    told: list[str] = []
    for run in repeated.campaign.of_kind("static"):
        own = [one for one in repeated.quantities if one.column in run.columns]
        states = [run.columns[name] for name in STATE if name in run.columns]
        if not own or not states:
            continue
        is_repeat = np.all(np.diff(np.stack(states), axis=1) == 0, axis=0)
        read = np.stack([run.columns[one.column] for one in own])
        is_copy = is_repeat & np.all(np.diff(read, axis=1) == 0, axis=0)
        chance = float(np.prod([_agree_by_chance(noise, one, run) for one in own]))
        if is_copy.any() and bdtrc(is_copy.sum() - 1, is_repeat.sum(), chance) < CHANCE:
            told.append(f"{is_copy.sum()} of {counted(int(is_repeat.sum()), 'repeat')} in run {run.name!r}")
    if told:
        more = f", and likewise in {counted(len(told) - 1, 'other run')}" if len(told) > 1 else ""
        message = f"{told[0]} read as the row before, to the last digit in all channels{more}"
        remedy = "copied, or without noise? leave such rows out: each counts as a reading of its own"
        yield Finding("warning", "all runs", None, "repeat", message, remedy)


def _agree_by_chance(noise: Noise, quantity: Quantity, run: Run) -> float:
    """Return how likely two readings of one number are the same, by noise and the finest step that was read."""
    values = run.columns[quantity.column]
    sigma = float(np.median(noise.of(quantity, values, run)))
    steps = np.diff(np.unique(values))
    step = float(steps.min()) if len(steps) else 0.0
    return min(1.0, step / (2 * np.sqrt(np.pi) * sigma)) if sigma > 0 and step > 0 else 1.0
