"""What follows from Table 5, and what does not, in sentences that are made from the numbers of the study."""

import numpy as np
from numpy.typing import NDArray

from bench.identify.table5_study import Table5Study
from bench.robot.bodies import Array

MICROMETRE = 1e-6  # [m]
CLEAR = 3.0  # standard errors that make a gap
WELL_KNOWN = 0.5  # width of the 5 to 95 % band over its middle, below which a stiffness is known whatever the poses
BAND = (0.05, 0.95)


def conclusions(study: Table5Study) -> tuple[str, ...]:
    """Return one sentence per conclusion, those that need no poses first."""
    return (*_without_poses(study), *_stiffness(study), *_which_method(study))


def _without_poses(study: Table5Study) -> list[str]:
    lines = study.lines
    scatter = np.sqrt(np.mean(lines.deflection_scatter**2, axis=0)) / MICROMETRE
    significance = np.abs(lines.deflection_gap) / lines.deflection_gap_sigma
    missed = int(np.sum(np.any(significance > CLEAR, axis=1)))
    c, axis = np.unravel_index(np.argmax(significance), significance.shape)
    return [
        f"Without any pose: about straight lines over the load, deflections scatter by {scatter[0]:.0f}, "
        f"{scatter[1]:.0f} and {scatter[2]:.0f} um in x, y and z.",
        f"Without any pose: in {missed} of {len(lines.configuration)} configurations the line misses the unloaded "
        f"reading by more than {CLEAR:.0f} standard errors, most clearly by "
        f"{abs(lines.deflection_gap[c, axis]) / MICROMETRE:.0f} um in {'xyz'[axis]} of configuration "
        f"{lines.configuration[c]} ({significance[c, axis]:.0f} standard errors): between unloaded and loaded "
        "something changes that is not in proportion to the load, as static friction on the link side does.",
        _jumping_current(study),
    ]


def _jumping_current(study: Table5Study) -> str:
    """Return what the largest scatter of a current would do to the deflection if the spring felt it."""
    lines, experiment = study.lines, study.table.experiment
    c, joint = np.unravel_index(np.argmax(lines.torque_scatter), lines.torque_scatter.shape)
    torque = lines.torque_scatter[c, joint]
    noise = experiment.sigma_torque[joint] / np.sqrt(experiment.repeats)
    compliance = 1 / study.table6["current"][joint]
    asked, seen = [], []
    for reconstruction in study.reconstructions:
        q = reconstruction.q[lines.configuration[c] - 1]
        column = reconstruction.arm(experiment).jacobian(q, "reflector")[:3, joint]
        asked.append(np.linalg.norm(column) * compliance * torque)
        seen.append(np.linalg.norm(column / np.linalg.norm(column) * lines.deflection_scatter[c]))
    return (
        f"In configuration {lines.configuration[c]} the current of joint {joint + 1} jumps about its line by "
        f"{torque:.0f} Nm, {torque / noise:.0f} times its noise; felt by the spring, that would move the measuring "
        f"point by {np.median(asked) / MICROMETRE:.0f} um (median over the reconstructions), but along that motion it "
        f"scatters by {np.median(seen) / MICROMETRE:.0f} um: this part of the friction "
        + ("is on the motor side." if np.median(asked) > CLEAR * np.median(seen) else "may be on either side.")
    )


def _stiffness(study: Table5Study) -> list[str]:
    sentences = []
    for fit in ("current, plain", "force, plain", "joint"):
        low, middle, high = study.spread(fit)
        width = (high - low) / middle
        error = np.nanmedian(study.relative_error(fit), axis=0)
        sentences.append(
            f"Method {fit}: from reconstruction to reconstruction k1 to k{len(middle)} differ by {_percent(width)} "
            f"(5 to 95 %), in one of them the standard errors are {_percent(error)}; told whatever the poses: "
            f"{_names(width < WELL_KNOWN)}."
        )
    return sentences


def _which_method(study: Table5Study) -> list[str]:
    low, high = np.nanquantile(study.ratio, BAND, axis=0)
    inside = (low <= study.paper_ratio) & (study.paper_ratio <= high)
    above = np.array([np.mean(ratio[np.isfinite(ratio)] > 1) for ratio in study.ratio.T])
    rms = {fit: study.residual_rms(fit) for fit in ("force", "current")}
    return [
        f"The ratio force / current exceeds 1 in {_percent(above)} of the reconstructions; whatever the poses, force "
        f"gives the stiffer joint for {_names(above >= BAND[1])}. The paper's ratio lies in the 5 to 95 % band for "
        f"{_names(inside)}.",
        f"Neither method explains the deflections: residuals are {np.median(rms['force']):.1f} (force) and "
        f"{np.median(rms['current']):.1f} (current) times the nominal noise in the median. Force leaves less in "
        f"{np.mean(rms['force'] < rms['current']):.0%} of the reconstructions, but most were found by letting the load "
        "drive the deflection, so that this does not decide between the methods.",
        _first_load(study),
        _sides(study),
    ]


def _first_load(study: Table5Study) -> str:
    """Return what becomes of the ratio when friction that stands at a constant level while loads rise cancels."""
    without = study.ratio_from_first_load
    told = np.isfinite(without) & np.isfinite(study.ratio)
    seen: NDArray[np.bool_] = np.any(told, axis=0)
    nearer = told & (np.abs(without - 1) < np.abs(study.ratio - 1))
    closer = nearer.sum(axis=0)[seen] / told.sum(axis=0)[seen]
    joints = _names(seen)
    return (
        f"With loads held against the first load instead of none, the ratio force / current of {joints} goes from "
        f"{_ratios(study.ratio[:, seen])} to {_ratios(without[:, seen])} (medians over the reconstructions), nearer to "
        f"1 in {_percent(closer)} of them. Friction in proportion to the load would leave it; friction at a constant "
        "level that turns round before the first load is read takes it away."
    )


def _sides(study: Table5Study) -> str:
    share, sigma = np.median(study.link_share, axis=0), np.median(study.link_share_sigma, axis=0)
    low, high = np.quantile(study.link_share, BAND, axis=0)
    decided = ((high < 0.5) | (low > 0.5)) & (np.abs(share - 0.5) > 2 * sigma)
    sides = [
        f"joint {j + 1}: {share[j]:.2f} of it on the link side ({low[j]:.2f} to {high[j]:.2f} over the reconstructions)"
        for j in np.flatnonzero(decided)
    ]
    if not sides:
        return "On which side most of the friction sits, the joint method cannot tell for any joint whatever the poses."
    return (
        f"By the joint method, most of the friction sits on the same side in nearly all reconstructions for "
        f"{'; '.join(sides)}; it is not decided for {_names(~decided)}."
    )


def _ratios(values: Array) -> str:
    return ", ".join(f"{value:.2f}" for value in np.nanmedian(values, axis=0))


def _percent(values: Array) -> str:
    return ", ".join(f"{value:.0%}" for value in values)


def _names(which: NDArray[np.bool_]) -> str:
    return ", ".join(f"k{j + 1}" for j in np.flatnonzero(which)) or "no joint"
