"""Table 5 by every method that it allows, over all reconstructions of its poses, and what follows from that.

The numbers are of two kinds. The statistical error of one estimate, in one set of poses; and the spread of the estimates over
the sets, which says how much the poses that the paper does not print would matter. A reconstruction was found by fitting
Table 5 under an assumed stiffness, so it tends to give that stiffness back: agreement with Table 6 proves nothing by itself.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bench.identify.current import identify_current
from bench.identify.estimate import JointEstimate, StiffnessEstimate
from bench.identify.force import identify_force
from bench.identify.joint import identify_joint
from bench.identify.options import PLAIN, Options
from bench.identify.table5 import (
    TORQUE_CONSTANT,
    Reconstruction,
    Table5,
    read_reconstructions,
    read_table5,
    read_table6,
)
from bench.identify.table5_lines import Lines, fit_lines

Array = NDArray[np.float64]

FITS = {
    "current, plain": (identify_current, PLAIN),
    "force, plain": (identify_force, PLAIN),
    "current": (identify_current, Options()),
    "force": (identify_force, Options()),
    "joint": (identify_joint, Options()),
}  # "plain" is Eq. (41) as the paper solves it


@dataclass(frozen=True)
class Table5Study:
    """Table 5 in r reconstructions.

    Attributes:
        table: Table 5.
        table6: "current" and "force" -> the paper's stiffness, shape (6,) [Nm/rad].
        reconstructions: Length r, the named ones (A1, A3, B1) first.
        estimates: Key of `FITS` -> one estimate per reconstruction.
        lines: What needs no poses.
        torque_gap: Shape (r, 6) [Nm], root mean square of s xi dI - J_f^T dW over the loaded states: currents against load.
    """

    table: Table5
    table6: Mapping[str, Array]
    reconstructions: tuple[Reconstruction, ...]
    estimates: Mapping[str, tuple[StiffnessEstimate, ...]]
    lines: Lines
    torque_gap: Array

    def stiffness(self, fit: str) -> Array:
        """Shape (r, 6) [Nm/rad]; nan where a joint is not observable."""
        return np.stack([estimate.stiffness for estimate in self.estimates[fit]])

    def relative_error(self, fit: str) -> Array:
        """Shape (r, 6), standard error of each compliance over its value."""
        return np.stack([np.sqrt(np.diag(e.covariance)) * e.stiffness for e in self.estimates[fit]])

    def chi_square(self, fit: str) -> Array:
        """Shape (r,), sum of squared deflection residuals in units of their nominal standard deviation."""
        return np.array([np.sum(e.residuals["reflector"] ** 2) for e in self.estimates[fit]])

    def residual_rms(self, fit: str) -> Array:
        """Shape (r,), root mean square of the deflection residuals in units of their nominal standard deviation."""
        return np.array([np.sqrt(np.mean(e.residuals["reflector"] ** 2)) for e in self.estimates[fit]])

    def spread(self, fit: str, quantiles: tuple[float, ...] = (0.05, 0.5, 0.95)) -> Array:
        """Shape (len(quantiles), 6) [Nm/rad], of the stiffness over the reconstructions that tell a joint."""
        return np.nanquantile(self.stiffness(fit), quantiles, axis=0)

    @property
    def ratio(self) -> Array:
        """Shape (r, 6), stiffness by force over stiffness by current, both plain, as the paper compares them."""
        return self.stiffness("force, plain") / self.stiffness("current, plain")

    @property
    def paper_ratio(self) -> Array:
        """Shape (6,), the same in Table 6."""
        return self.table6["force"] / self.table6["current"]

    @property
    def link_share(self) -> Array:
        """Shape (r, 6), share of the friction on the link side by the joint method."""
        return np.stack([e.link_share for e in self.estimates["joint"] if isinstance(e, JointEstimate)])

    @property
    def link_share_sigma(self) -> Array:
        """Shape (r, 6), its standard deviation."""
        return np.stack([e.link_share_sigma for e in self.estimates["joint"] if isinstance(e, JointEstimate)])


def study_table5(folder: Path) -> Table5Study:
    """Identify the stiffness from Table 5 by every method in every reconstruction.

    Args:
        folder: With table5.csv, table6.csv, configurations.json and alternatives.json (models/hh150/paper).

    Raises:
        InputError: A file is missing or lacks a column.
    """
    table, reconstructions = read_table5(folder), read_reconstructions(folder)
    setups = [(reconstruction.arm(), reconstruction.readings(table)) for reconstruction in reconstructions]
    estimates = {
        name: tuple(method(arm, None, readings, options) for arm, readings in setups)
        for name, (method, options) in FITS.items()
    }
    loaded = ~table.is_reference
    gaps = []
    for arm, readings in setups:
        wrench = readings.load(arm.bodies.gravity)
        asked = np.einsum("mkn,mk->mn", arm.jacobian(readings.q_motor, "load"), wrench)
        seen = -(readings.current_torque - readings.current_torque[readings.first_of_series])
        gaps.append(np.sqrt(np.mean((seen - asked)[loaded] ** 2, axis=0)))
    return Table5Study(
        table, read_table6(folder), reconstructions, estimates, fit_lines(table), np.stack(gaps)
    )


def conclusions(study: Table5Study) -> tuple[str, ...]:
    """Return what follows from the numbers, and what does not, one sentence each."""
    return (*_without_poses(study), *_stiffness(study), *_which_method(study))


def _without_poses(study: Table5Study) -> list[str]:
    lines = study.lines
    significance = np.abs(lines.deflection_gap) / lines.deflection_gap_sigma
    c, axis = np.unravel_index(np.argmax(significance), significance.shape)
    missed = int(np.sum(np.any(significance > 3, axis=1)))
    scatter = np.sqrt(np.mean(lines.deflection_scatter**2, axis=0)) / 1e-6
    c_torque, joint = np.unravel_index(np.argmax(lines.torque_scatter), lines.torque_scatter.shape)
    noise = TORQUE_CONSTANT[joint] * 0.02 / np.sqrt(10)
    return [
        f"Without any pose: about straight lines over the load, deflections scatter by {scatter[0]:.0f}, {scatter[1]:.0f} and "
        f"{scatter[2]:.0f} um in x, y and z.",
        f"Without any pose: in {missed} of {len(lines.configuration)} configurations the line misses the unloaded reading by "
        f"more than three standard errors, at most by {abs(lines.deflection_gap[c, axis]) / 1e-6:.0f} um (configuration "
        f"{lines.configuration[c]}, {'xyz'[axis]}, {significance[c, axis]:.0f} standard errors): something other than the load "
        "changes between unloaded and loaded, as static friction on the link side does.",
        f"Without any pose: the current of joint {joint + 1} scatters by {lines.torque_scatter[c_torque, joint]:.0f} Nm in "
        f"configuration {lines.configuration[c_torque]}, {lines.torque_scatter[c_torque, joint] / noise:.0f} times its "
        "nominal noise: static friction that differs from load to load.",
    ]


def _stiffness(study: Table5Study) -> list[str]:
    sentences = []
    for fit in ("current, plain", "force, plain", "joint"):
        low, middle, high = study.spread(fit)
        width = (high - low) / middle
        error = np.nanmedian(study.relative_error(fit), axis=0)
        told = [f"k{j + 1}" for j in range(6) if width[j] < 0.5]
        sentences.append(
            f"Method {fit}: over the reconstructions k1 to k6 spread by {_percent(width)} (5 to 95 %), against statistical "
            f"standard errors of {_percent(error)} in one; known within a factor of 1.3 whatever the poses: "
            f"{', '.join(told) or 'none'}."
        )
    return sentences


def _which_method(study: Table5Study) -> list[str]:
    low, high = np.nanquantile(study.ratio, (0.05, 0.95), axis=0)
    inside = (low <= study.paper_ratio) & (study.paper_ratio <= high)
    above = np.nanmean(np.where(np.isnan(study.ratio), np.nan, study.ratio > 1), axis=0)
    by_force = np.mean(study.residual_rms("force") < study.residual_rms("current"))
    ours = np.median(study.residual_rms("force")), np.median(study.residual_rms("current"))
    share, sigma = np.median(study.link_share, axis=0), np.median(study.link_share_sigma, axis=0)
    apart = np.quantile(study.link_share, (0.05, 0.95), axis=0)
    decided = [
        f"joint {j + 1} ({'link' if share[j] > 0.5 else 'motor'} side, share {share[j]:.2f}, {apart[0, j]:.2f} to "
        f"{apart[1, j]:.2f} over the reconstructions)"
        for j in range(6)
        if (apart[1, j] < 0.5 or apart[0, j] > 0.5) and abs(share[j] - 0.5) > 2 * sigma[j]
    ]
    names = [f"k{j + 1}" for j in range(6) if inside[j]]
    clear = [f"k{j + 1}" for j in range(6) if above[j] >= 0.95]
    return [
        f"The ratio force / current exceeds 1 in {_percent(above)} of the reconstructions; the paper's ratio lies in the 5 to "
        f"95 % band for {', '.join(names) or 'no joint'}. That force gives the stiffer joint whatever the poses holds for "
        f"{', '.join(clear) or 'no joint'}.",
        f"Neither method explains the deflections: their residuals are {ours[0]:.1f} (force) and {ours[1]:.1f} (current) times "
        f"the nominal noise in the median; force leaves less in {by_force:.0%} of the reconstructions, but most were "
        "found by letting the load drive the deflection, so this does not decide between the methods.",
        "Side of the friction, by the joint method in all reconstructions alike: "
        + (", ".join(decided) if decided else "not decided for any joint")
        + ("; not decided for the others." if decided else "."),
    ]


def _percent(values: Array) -> str:
    return ", ".join(f"{value:.0%}" for value in values)
