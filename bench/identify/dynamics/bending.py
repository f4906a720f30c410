"""How much less, or more, torque a drive needs because gears wind up and links stand elsewhere than their motors.

A gear of stiffness k winds up by t/k under the torque t on its link, so links move as q - t/k. To first order in how
much softer gears are than stated, x = k stated / k,

    tau(q - x t/k) = tau(q) + sum_j x_j [tau(q - e_j t_j/k_j) - tau(q)]

with the torques of a rigid arm that was found first, its counterbalance included. It holds far below the lowest mode,
where the filter's band lies (`band.py`). What a known load pulls is taken where the motors are.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from bench.identify.dynamics.band import Band
from bench.identify.dynamics.equations import Equations
from bench.identify.dynamics.found_arm import FoundArm
from bench.record.campaign import Array


@dataclass(frozen=True)
class Bending:
    """Gears that wind up.

    Attributes:
        found: The arm as found with rigid gears.
        winds: Shape (n,), gears that wind up; the others are rigid.
    """

    found: FoundArm
    winds: NDArray[np.bool_]

    def columns(self, equations: Equations, band: Band) -> Array:
        """Return what each gear's winding as stated adds to the torque of each drive, shape (T, n, n), thinned.

        Args:
            equations: Of a stretch.
            band: The filter that they passed.
        """
        samples, n = equations.samples, self.found.nominal.n_joints
        arm, passed = self.found.carrying(samples.recording), self.found.passed(samples, band)
        wound = CubicSpline(passed.time, (passed.rigid + passed.known) / self.found.nominal.stiffness)
        added = np.zeros((len(passed.time), n, n))
        for j in np.flatnonzero(self.winds):
            of_j = np.arange(n) == j
            moved = (x - of_j * wound(passed.time, k) for k, x in enumerate(passed.state))
            added[:, :, j] = self.found.torque(arm, *moved) - passed.rigid
        return band.filtered(CubicSpline(passed.time, added)(samples.time), samples)


def bending_of(found: FoundArm) -> Bending:
    """Return the bending of an arm that was found rigid."""
    return Bending(found, np.isfinite(found.nominal.stiffness))


def bent(equations: Equations, bending: Bending, band: Band) -> Equations:
    """Return equations with the winding of the gears."""
    return replace(equations, winding=bending.columns(equations, band))
