"""Friction that falls during a recording, as that of drives that warm up does: its column.

The share r of its friction that a drive loses in an hour, times the hours from the middle of what was recorded to each
instant. Another recording has the friction of the middle, for nobody knows how warm its drives are.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.identify.dynamics.equations import DRIVE_COLUMNS, Equations
from bench.identify.dynamics.parameters import Layout
from bench.record.campaign import Array
from bench.record.moving import FEWEST_TIMES, TIME_STEP_S
from bench.record.units import HOUR

COULOMB, VISCOUS, WARMING = (DRIVE_COLUMNS.index(name) for name in ("coulomb", "viscous", "warming"))


@dataclass(frozen=True)
class FallingFriction:
    """Friction that may fall.

    Attributes:
        middle: Recording -> the middle of its motion [s]; those of too few times are none of them.
        levels: Shape (n, 2), Coulomb [Nm] and viscous [Nm s/rad] friction in that middle.
    """

    middle: Mapping[str, float]
    levels: Array

    def added_to(self, equations: Equations) -> Equations:
        """Return equations with the column of friction that falls, of a stretch of what was fitted."""
        samples = equations.samples
        if samples.recording not in self.middle:
            return equations
        hours = (samples.start + equations.time - self.middle[samples.recording]) / HOUR
        drives = equations.drives.copy()
        drives[:, :, WARMING] = -hours[:, None] * np.sum(drives[:, :, [COULOMB, VISCOUS]] * self.levels, axis=2)
        return replace(equations, drives=drives)


def falling_friction(equations: Sequence[Equations], layout: Layout, parameters: Array) -> FallingFriction:
    """Return the friction that may fall in the recordings that have three times to show it.

    Args:
        equations: Of stretches.
        layout: Of the parameters.
        parameters: Shape (p,), as found with friction that stays.
    """
    spans: dict[str, list[Array]] = {}
    for part in equations:
        spans.setdefault(part.samples.recording, []).append(part.samples.start + part.time)
    middle = {
        recording: float(min(one[0] for one in times) + max(one[-1] for one in times)) / 2
        for recording, times in spans.items()
        if len(np.unique(np.round(np.concatenate(times) / TIME_STEP_S))) >= FEWEST_TIMES
    }
    return FallingFriction(
        middle, np.stack([parameters[layout.of_drives(name)] for name in ("coulomb", "viscous")], axis=1)
    )
