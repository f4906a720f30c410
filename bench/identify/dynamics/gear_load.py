"""Friction that grows with the torque that a gear passes on: its column, |t| sign(v), with the arm found first.

Teeth and rolling elements rub more the harder they are pressed (P. Hamon, M. Gautier, P. Garrec, "Dynamic
identification of robots with a dry friction model depending on load and velocity", IROS 2010). The column is as exact
as the arm is: links that err by some per cent change it by as much.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.interpolate import CubicSpline

from bench.identify.dynamics.band import Band
from bench.identify.dynamics.equations import DRIVE_COLUMNS, Equations
from bench.identify.dynamics.found_arm import FoundArm

LOAD = DRIVE_COLUMNS.index("load")


def loaded(equations: Sequence[Equations], arm: FoundArm, band: Band) -> tuple[Equations, ...]:
    """Return equations with the column of friction that grows with the load.

    Args:
        equations: Of stretches.
        arm: As found.
        band: The filter that they passed.
    """
    return tuple(_loaded(part, arm, band) for part in equations)


def _loaded(equations: Equations, arm: FoundArm, band: Band) -> Equations:
    samples = equations.samples
    passed = arm.passed(samples, band)
    torque = CubicSpline(passed.time, passed.rigid + passed.known)(samples.time)
    velocity = band.smooth(samples)[1]
    drives = equations.drives.copy()
    drives[:, :, LOAD] = band.filtered(np.abs(torque) * np.sign(velocity), samples)
    return replace(equations, drives=drives)
