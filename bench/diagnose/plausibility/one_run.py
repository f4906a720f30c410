"""One run among others: drives' gains, zeros and a clock that are not there what they are in all other runs.

What every channel of a drive is made of (`drive_looks.py`) is fitted to all runs but one, and predicts that one. Errors
of the model are in all of them; where one run is predicted far worse than the model fits any other, and one number
explains why, it is told:

    scaled   y = f (prediction)                           f: another gain
    moved    y = prediction + f                           f: another zero
    clock    y = rest + friction + f^2 motion + f viscous  f: seconds counted for each second

or none does, and they miss more than half of its mean square.

What the other runs do not determine, a run may have as it likes; and with each of them left out, the rest has to say
the same.
"""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.plausibility.drive_looks import inflation
from bench.diagnose.plausibility.drive_picture import DrivePicture
from bench.diagnose.plausibility.late_channels import SURE
from bench.diagnose.plausibility.physical_fit import HALF
from bench.diagnose.replay.instants import run_of_each
from bench.diagnose.replay.segments import Segment
from bench.record.campaign import Array
from bench.record.finding import Finding, counted

FAR = 3.0  # declared: times what the model leaves of any other run, before a run is unlike the others
EXPLAINED = 2 / 3  # declared: of what a run has that others have not: twice as much as one number leaves
OTHERS = 2  # exact: runs in which a drive moves, at least, beside the one that is held against them: two agree
READINGS = 5  # declared: of a drive that moves in a run
TINY = 1e-18  # rounding: [Nm^2]
SAME = 1e-6  # rounding: of the size of columns, that one may have beside the others and still be the same
MOTION, VISCOUS = 0, 3  # exact: columns of what a channel is made of


@dataclass(frozen=True)
class _Unlike:
    """What makes a drive's channel unlike itself in other runs.

    Attributes:
        how: "scaled", "moved" [Nm], "clock", or "hardly": no one number explains it.
        value: The number; of "hardly" the share of its mean square that is missed.
        sigma: Its standard error.
        explained: Of what the run has that others have not.
    """

    how: str
    value: float
    sigma: float
    explained: float

    @property
    def is_told(self) -> bool:
        """Whether it explains enough, for sure."""
        if self.how == "hardly":
            return True
        off = self.value if self.how == "moved" else self.value - 1
        return self.explained > EXPLAINED and abs(off) > SURE * self.sigma and (self.how == "moved" or self.value > 0)


def unlike_other_runs(picture: DrivePicture, segments: Sequence[Segment], at_rest: Array) -> Iterator[Finding]:
    """Yield a warning for each run whose clock, or a channel of whose drives, is not what it is in the others.

    Args:
        picture: What the drives did.
        segments: Whose readings these are.
        at_rest: Shape (T, n) [Nm], from `resting_torque`.
    """
    run_of = run_of_each(segments)
    every: dict[str, dict[int, _Unlike]] = defaultdict(dict)
    for j, name in enumerate(picture.names):
        for run, unlike in _of_drive(picture, j, run_of, at_rest) if name else ():
            every[run][j] = unlike
    for run, drives in every.items():
        if clocks := [one.value for one in drives.values() if one.how == "clock"]:
            message = (
                f"counts {float(np.median(clocks)):.2f} seconds for each second in run {run!r} and not in others, by "
                f"the inertia that {counted(len(clocks), 'drive')} paid for"
            )
            remedy = "look at its sampling rate; else is a load of that run not written down?"
            yield Finding("warning", "all runs", None, "time_s", message, remedy)
            continue
        for j, one in drives.items():
            words = f"{one.value:.2f} times" if one.how == "scaled" else f"{one.value / picture.unit[j]:+.3g} beside"
            words = "hardly" if one.how == "hardly" else words
            message = f"is {words} what the other runs make of it in run {run!r}"
            remedy = "look at how that run was recorded, and at its loads"
            yield Finding("warning", "all runs", None, picture.names[j], message, remedy)


def _of_drive(picture: DrivePicture, j: int, run_of: NDArray[np.str_], at_rest: Array) -> Iterator[tuple[str, _Unlike]]:
    """Yield runs in which a drive is unlike itself, the worst first; that one then tells nothing of the others."""
    rows = np.isfinite(picture.observed[:, j]) & ~picture.standing[:, j]
    motion, (_, *others) = picture.model[:, j] - at_rest[:, j], picture.columns(j).T
    columns, y = np.column_stack([motion, at_rest[:, j], *others])[rows], picture.observed[rows, j]
    run = run_of[rows]
    runs = [name for name in dict.fromkeys(run.tolist()) if (run == name).sum() >= READINGS]
    while len(runs) > OTHERS:
        every = sorted((_held_against(columns, y, run, runs, name) for name in runs), key=lambda found: -found[0])
        if every[0][0] <= FAR:
            return
        (_, worst, unlike), *rest = every
        # nothing is told where another run may be the culprit as well; of three runs a culprit is half of what each
        # other one is held against, so these are looked at without it, too
        rivals = [(name, one) for far, name, one in rest if far > 1 and one.is_told]
        if len(runs) == OTHERS + 1:
            rivals = [(name, one) for name, one in rivals if _is_sure(columns, y, run, runs, name, one)]
        if not rivals and _is_sure(columns, y, run, runs, worst, unlike):
            yield worst, unlike
        runs.remove(worst)


def _is_sure(
    columns: Array, y: Array, run: NDArray[np.str_], runs: Sequence[str], name: str, unlike: "_Unlike"
) -> bool:
    """Return whether a run is unlike all others, and with each of them left out it is so in the same way."""
    others = [other for other in runs if other != name]
    without = ([name, *(other for other in others if other != left_out)] for left_out in others)
    again = (_held_against(columns, y, run, some, name)[2] for some in without)
    return unlike.is_told and all(one.is_told and one.how == unlike.how for one in again)


def _held_against(
    columns: Array, y: Array, run: NDArray[np.str_], runs: Sequence[str], name: str
) -> tuple[float, str, _Unlike]:
    """Return how many times as far a run is from what others predict as any of those is, its name, and what it has."""
    own, others = run == name, np.isin(run, [one for one in runs if one != name])
    scale = np.maximum(np.linalg.norm(columns[others], axis=0), 1e-12)
    scaled = columns / scale
    found = np.linalg.lstsq(scaled[others], y[others])[0]
    left = y - scaled @ found
    beside = _undetermined(scaled[others], scaled[own])
    here = float(np.mean(_beyond(beside, left[own]) ** 2))
    most = max(float(np.mean(left[run == one] ** 2)) for one in runs if one != name)
    far = float(np.sqrt(here / most)) if most else 0.0
    variance = float(np.mean(left[others] ** 2)) * inflation(left[others])
    covariance = variance * np.linalg.pinv(scaled[others].T @ scaled[others])
    unlike = _unlike(scaled[own], found, left[own], covariance, beside)
    missed = here / max(TINY, *(float(np.mean(y[rows] ** 2)) for rows in (own, others)))
    return far, name, unlike if unlike.is_told or missed <= HALF else _Unlike("hardly", missed, 0.0, 1.0)


def _undetermined(others: Array, own: Array) -> Array:
    """Return a basis of what a run may have that other runs do not determine, shape (T, m).

    Where a drive turned one way alone, nobody knows its friction from its zero, nor what it has the other way.

    Args:
        others: What the channel is made of in the other runs, shape (t, k).
        own: The same of the run, shape (T, k).
    """
    _, sizes, directions = np.linalg.svd(np.linalg.qr(others, mode="r"))
    free = own @ directions[np.count_nonzero(sizes > SAME * sizes[0]) :].T
    basis, sizes, _ = np.linalg.svd(free, full_matrices=False)
    return basis[:, sizes > SAME * np.linalg.norm(own)]


def _beyond(basis: Array, values: Array) -> Array:
    """Return what values, shape (T,) or (T, k), have beside an orthonormal basis, shape (T, m)."""
    return values - basis @ (basis.T @ values)


def _unlike(columns: Array, found: Array, left: Array, covariance: Array, beside: Array) -> _Unlike:
    """Return the number that explains most of what is left of a run.

    Args:
        columns: Shape (T, k).
        found: Their coefficients by the other runs, shape (k,).
        left: Shape (T,).
        covariance: Of the coefficients, shape (k, k).
        beside: What the run may have in any case, from `_undetermined`.
    """
    columns, left, one = (_beyond(beside, values) for values in (columns, left, np.ones(len(left))))
    expected = columns @ found
    motion, viscous = (columns[:, k] * found[k] for k in (MOTION, VISCOUS))
    clock = _clock(motion, viscous, left + motion + viscous)
    factor = 1 + float(expected @ left) / max(float(expected @ expected), TINY)
    shift = float(one @ left) / max(float(one @ one), TINY)
    tried = {  # what it adds, and by how much more with the number
        "scaled": (factor, (factor - 1) * expected, expected),
        "moved": (shift, shift * one, one),
        "clock": (clock, (clock**2 - 1) * motion + (clock - 1) * viscous, 2 * clock * motion + viscous),
    }
    every = []
    for how, (value, added, slope) in tried.items():
        rest, power = left - added, float(slope @ slope)
        if power <= TINY:  # nothing is there that it could multiply
            continue
        weights = slope @ columns
        variance = (float(np.mean(rest**2)) * inflation(rest) + float(weights @ covariance @ weights) / power) / power
        explained = 1 - float(rest @ rest) / max(float(left @ left), TINY)
        every.append(_Unlike(how, value, float(np.sqrt(variance)), explained))
    nothing = _Unlike("moved", 0.0, 0.0, 0.0)  # the others determine nothing of a run as short as that
    return max(every, key=lambda one: one.explained, default=nothing)


def _clock(motion: Array, viscous: Array, whole: Array) -> float:
    """Return f > 0 that leaves least of whole - f^2 motion - f viscous, shape (T,) each; 1 where none does."""
    cubic = [-2 * motion @ motion, -3 * motion @ viscous, 2 * whole @ motion - viscous @ viscous, whole @ viscous]
    real = [float(root.real) for root in np.roots(cubic) if abs(root.imag) < 1e-9 * abs(root) and root.real > 0]
    return min(real, key=lambda f: float(np.sum((whole - f**2 * motion - f * viscous) ** 2)), default=1.0)
