"""Table 5 by every method that it allows, over all reconstructions of its poses, each with its errors.

The numbers are of two kinds. The statistical error of one estimate, in one set of poses; and the spread of the
estimates over the sets, which says how much the poses that the paper does not print would matter. A reconstruction
was found by fitting Table 5 under an assumed stiffness, so it tends to give that stiffness back: agreement with Table
6 proves nothing by itself.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.identify.current import identify_current
from bench.identify.estimate import JointEstimate, StiffnessEstimate
from bench.identify.force import identify_force
from bench.identify.joint import identify_joint
from bench.identify.options import PLAIN, Options
from bench.identify.table5 import Reconstruction, Table5, read_reconstructions, read_table5, read_table6
from bench.identify.table5_lines import Lines, fit_lines
from bench.robot.bodies import Array

FIRST_LOAD = ", from the first load"  # loads are held against the first one, not against none
FITS = {
    "current, plain": (identify_current, PLAIN),
    "force, plain": (identify_force, PLAIN),
    f"current, plain{FIRST_LOAD}": (identify_current, PLAIN),
    f"force, plain{FIRST_LOAD}": (identify_force, PLAIN),
    "current": (identify_current, Options()),
    "force": (identify_force, Options()),
    "joint": (identify_joint, Options()),
}  # "plain" is Eq. (41) as the paper solves it


@dataclass(frozen=True)
class Table5Study:
    """Table 5 in r reconstructions; n joints.

    Attributes:
        table: Table 5.
        table6: "current" and "force" -> the paper's stiffness, shape (n,) [Nm/rad].
        reconstructions: Length r, the named ones (A1, A3, B1) first.
        estimates: Key of `FITS` -> one estimate per reconstruction.
        lines: What needs no poses.
        torque_gap: Shape (r, n) [Nm], root mean square of s xi dI - J_f^T dW over the loaded states: currents against
            load.
    """

    table: Table5
    table6: Mapping[str, Array]
    reconstructions: tuple[Reconstruction, ...]
    estimates: Mapping[str, tuple[StiffnessEstimate, ...]]
    lines: Lines
    torque_gap: Array

    def stiffness(self, fit: str) -> Array:
        """Shape (r, n) [Nm/rad]; nan where a joint is not observable."""
        return np.stack([estimate.stiffness for estimate in self.estimates[fit]])

    def relative_error(self, fit: str) -> Array:
        """Shape (r, n), standard error of each compliance over its value."""
        return np.stack([np.sqrt(np.diag(e.covariance)) * e.stiffness for e in self.estimates[fit]])

    def chi_square(self, fit: str) -> Array:
        """Shape (r,), sum of squared deflection residuals in units of their nominal standard deviation."""
        return np.array([np.sum(e.residuals["reflector"] ** 2) for e in self.estimates[fit]])

    def residual_rms(self, fit: str) -> Array:
        """Shape (r,), root mean square of the deflection residuals in units of their nominal standard deviation."""
        return np.array([np.sqrt(np.mean(e.residuals["reflector"] ** 2)) for e in self.estimates[fit]])

    def spread(self, fit: str, quantiles: tuple[float, ...] = (0.05, 0.5, 0.95)) -> Array:
        """Shape (len(quantiles), n) [Nm/rad], of the stiffness over the reconstructions that tell a joint; else nan."""
        stiffness = self.stiffness(fit)
        told = np.isfinite(stiffness).any(axis=0)
        found = np.full((len(quantiles), stiffness.shape[1]), np.nan)
        found[:, told] = np.nanquantile(stiffness[:, told], quantiles, axis=0)
        return found

    @property
    def ratio(self) -> Array:
        """Shape (r, n), stiffness by force over stiffness by current, both plain, as the paper compares them."""
        return self.stiffness("force, plain") / self.stiffness("current, plain")

    @property
    def ratio_from_first_load(self) -> Array:
        """Shape (r, n), the same with loads held against the first one; nan for joints that only one load moves."""
        return self.stiffness(f"force, plain{FIRST_LOAD}") / self.stiffness(f"current, plain{FIRST_LOAD}")

    @property
    def paper_ratio(self) -> Array:
        """Shape (n,), the same in Table 6."""
        return self.table6["force"] / self.table6["current"]

    @property
    def link_share(self) -> Array:
        """Shape (r, n), share of the friction on the link side by the joint method."""
        return np.stack([e.link_share for e in self.estimates["joint"] if isinstance(e, JointEstimate)])

    @property
    def link_share_sigma(self) -> Array:
        """Shape (r, n), its standard deviation."""
        return np.stack([e.link_share_sigma for e in self.estimates["joint"] if isinstance(e, JointEstimate)])


def study_table5(folder: Path, only: Collection[str] = ()) -> Table5Study:
    """Identify the stiffness from Table 5 by every method in every reconstruction.

    Args:
        folder: With table5.csv, table6.csv, experiment.yaml, configurations.json and alternatives.json.
        only: Names of reconstructions, where not all are wanted.

    Raises:
        InputError: A file is missing or lacks a column.
    """
    table = read_table5(folder)
    reconstructions = tuple(r for r in read_reconstructions(folder) if not only or r.name in only)
    setups = [
        (reconstruction.arm(table.experiment), reconstruction.readings(table)) for reconstruction in reconstructions
    ]
    estimates = {
        name: tuple(
            method(arm, None, readings.among_loaded() if name.endswith(FIRST_LOAD) else readings, options)
            for arm, readings in setups
        )
        for name, (method, options) in FITS.items()
    }
    loaded = ~table.is_reference
    gaps = []
    for arm, readings in setups:
        wrench = readings.load(arm.bodies.gravity)
        asked = np.einsum("mkn,mk->mn", arm.jacobian(readings.q_motor, "load"), wrench)
        seen = -(readings.current_torque - readings.current_torque[readings.first_of_series])
        gaps.append(np.sqrt(np.mean((seen - asked)[loaded] ** 2, axis=0)))
    return Table5Study(table, read_table6(folder), reconstructions, estimates, fit_lines(table), np.stack(gaps))
