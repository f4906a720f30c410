"""One run among others: drive channels and a clock that are not there what they are in all other runs.

What every channel of a drive is made of (`first_look.py`) is fitted to all runs but one, and predicts that one. Errors
of the model are in all of them; where one run is predicted far worse than the model fits any other, and one number
explains why, it is told:

    scaled   y = f (prediction)                           f: another gain
    moved    y = prediction + f                           f: another zero
    clock    y = rest + friction + f^2 motion + f viscous  f: seconds counted for each second
"""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.plausibility.drive_picture import DrivePicture
from bench.diagnose.plausibility.first_look import inflation
from bench.diagnose.plausibility.late_channels import SURE
from bench.diagnose.plausibility.mistaken import mistakes_in
from bench.diagnose.plausibility.physical_fit import beyond, completed
from bench.diagnose.replay.instants import run_of_each
from bench.diagnose.replay.segments import Segment
from bench.record.campaign import Array
from bench.record.finding import Finding, counted

HOLDS = 2.0  # derived: levels of friction, from one end of what a joint may hold to the other
FAR = 3.0  # declared: times what the model leaves of any other run, before a run is unlike the others
EXPLAINED = 2 / 3  # declared: of what a run has that others have not: twice as much as one number leaves
OTHERS = 3  # declared: runs in which a drive moves, at least, beside the one that is held against them
SEVERAL = 2  # exact: runs, from which on one is not alone
NAMED = 3  # effort: runs that a line names
READINGS = 5  # declared: of a drive that moves in a run
TINY = 1e-18  # rounding: [Nm^2]
MOTION, VISCOUS = 0, 3  # exact: columns of what a channel is made of


def mistaken_in_one_run(picture: DrivePicture, segments: Sequence[Segment]) -> Iterator[Finding]:
    """Yield what drives' channels are taken for in one run, by what the nominal model lacks in the others.

    Args:
        picture: What the drives did.
        segments: Whose readings these are.
    """
    # the model has friction at rest at one of its two levels, that of the approach; a servo that settles takes a motor
    # back as far as the other one. Over all runs that evens out, in one it does not.
    picture = replace(picture, slack=np.maximum(picture.slack, HOLDS * picture.level))
    run_of = run_of_each(segments)
    runs = list(dict.fromkeys(run_of.tolist()))
    for finding, alike in _in_several_runs(picture, run_of, runs):
        yield replace(finding, message=f"{finding.message} in runs {_listed(alike)}, and not in all others")
        runs = [run for run in runs if run not in alike]
    while len(runs) > OTHERS:  # the worst first, which then tells nothing of the others
        others = {run: [other for other in runs if other != run] for run in runs}
        far = {run: float(np.max(_beside(picture, run_of, run, others[run])[1])) for run in runs}
        worst = max(far, key=lambda run: far[run])
        if far[worst] <= FAR:
            return
        for finding in _sure(picture, run_of, worst, others[worst]):
            yield replace(finding, message=f"{finding.message} in run {worst!r}, and not in all others")
        runs.remove(worst)


def _in_several_runs(
    picture: DrivePicture, run_of: NDArray[np.str_], runs: Sequence[str]
) -> Iterator[tuple[Finding, tuple[str, ...]]]:
    """Yield what channels are taken for in several runs alike, and these runs.

    Held against all others one by one, each of them stands among the others that are mistaken, and none is unlike
    them. So runs that say one mistake of themselves are left out together, with those that say the same beside what is
    left, where they are fewer than the rest; and each is then held against that rest as a single run is.
    """
    suspected: dict[tuple[str, str], list[str]] = defaultdict(list)
    for run in runs:
        for finding in mistakes_in(picture.of(run_of == run), of_units=False):
            suspected[finding.column, finding.message].append(run)
    for (column, message), themselves in suspected.items():
        alike, others = list(themselves), [run for run in runs if run not in themselves]
        while more := [run for run in others if (column, message) in _said(picture, run_of, run, others)]:
            alike, others = alike + more, [run for run in others if run not in more]
        if len(alike) < SEVERAL or len(others) <= max(OTHERS, len(alike)):
            continue
        others = _alike_among_themselves(picture, run_of, others)
        held = {
            run: finding
            for run in alike
            for finding in _mistaken(picture, run_of, run, others)
            if (finding.column, finding.message) == (column, message)
        }
        sure = (run for run, finding in held.items() if finding in _sure(picture, run_of, run, others))
        if len(list(islice(sure, SEVERAL))) == SEVERAL:
            yield next(iter(held.values())), tuple(held)


def _alike_among_themselves(picture: DrivePicture, run_of: NDArray[np.str_], runs: Sequence[str]) -> list[str]:
    """Return runs without those that are far from what the others make of them, the worst left out first."""
    left = list(runs)
    while len(left) > OTHERS:
        others = {run: [other for other in left if other != run] for run in left}
        far = {run: float(np.max(_beside(picture, run_of, run, others[run])[1])) for run in left}
        worst = max(far, key=lambda run: far[run])
        if far[worst] <= FAR:
            break
        left.remove(worst)
    return left


def _said(picture: DrivePicture, run_of: NDArray[np.str_], run: str, others: Sequence[str]) -> set[tuple[str, str]]:
    """Return columns and messages of what channels are taken for in a run, by all others."""
    there, _ = _beside(picture, run_of, run, [other for other in others if other != run])
    return {(finding.column, finding.message) for finding in mistakes_in(there, of_units=False)}


def _listed(runs: Sequence[str]) -> str:
    shown = ", ".join(repr(run) for run in runs[:NAMED])
    return f"{shown} and {len(runs) - NAMED} more" if len(runs) > NAMED else shown


def _sure(picture: DrivePicture, run_of: NDArray[np.str_], run: str, others: Sequence[str]) -> list[Finding]:
    """Return what channels are taken for in a run, without what one other run alone contradicts."""
    mistakes = _mistaken(picture, run_of, run, others)
    for left_out in others if mistakes else ():
        still = _mistaken(picture, run_of, run, [other for other in others if other != left_out])
        mistakes = [finding for finding in mistakes if finding in still]
    return mistakes


def _mistaken(picture: DrivePicture, run_of: NDArray[np.str_], run: str, others: Sequence[str]) -> list[Finding]:
    """Return what channels are taken for in a run, of those that are far from what the others make of them.

    Nothing is told that one reading alone shows: at rest friction may hold more than it did in motion.
    """
    there, times = _beside(picture, run_of, run, others)
    far = {name for name, one in zip(picture.names, times, strict=True) if one > FAR}
    found = [finding for finding in mistakes_in(there, of_units=False) if finding.column in far]
    for j, name in enumerate(picture.names):
        if any(finding.column == name for finding in found):
            left = np.nan_to_num(beyond(there)[:, j])
            still = list(mistakes_in(there.of(np.arange(len(left)) != np.argmax(left)), of_units=False))
            found = [finding for finding in found if finding.column != name or finding in still]
    return found


def _beside(
    picture: DrivePicture, run_of: NDArray[np.str_], run: str, others: Sequence[str]
) -> tuple[DrivePicture, Array]:
    """Return a run beside what others make of it, and how many times as far it is as any of those, shape (n,)."""
    whole = completed(picture, by=np.isin(run_of, others), zeros=True)
    left = np.nan_to_num(beyond(whole))
    here, *there = (np.sqrt(np.mean(left[run_of == one] ** 2, axis=0)) for one in (run, *others))
    most = np.max(there, axis=0)
    past = np.where(here > 0, np.inf, 0.0)  # of others that friction at rest explains altogether
    return whole.of(run_of == run), np.divide(here, most, out=past, where=most > 0)


@dataclass(frozen=True)
class _Unlike:
    """What makes a drive's channel unlike itself in other runs.

    Attributes:
        how: "scaled", "moved" [Nm] or "clock".
        value: The number.
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
        far, worst, unlike = every[0]
        if far <= FAR:
            return
        # nothing is told where another run may be the culprit as well
        if unlike.is_told and not any(other > 1 and one.is_told for other, _, one in every[1:]):
            yield worst, unlike
        runs.remove(worst)


def _held_against(
    columns: Array, y: Array, run: NDArray[np.str_], runs: Sequence[str], name: str
) -> tuple[float, str, _Unlike]:
    """Return how many times as far a run is from what others predict as any of those is, its name, and what it has."""
    own, others = run == name, np.isin(run, [one for one in runs if one != name])
    scale = np.maximum(np.linalg.norm(columns[others], axis=0), 1e-12)
    scaled = columns / scale
    found = np.linalg.lstsq(scaled[others], y[others])[0]
    left = y - scaled @ found
    most = max(float(np.mean(left[run == one] ** 2)) for one in runs if one != name)
    far = float(np.sqrt(np.mean(left[own] ** 2) / most)) if most else 0.0
    variance = float(np.mean(left[others] ** 2)) * inflation(left[others])
    covariance = variance * np.linalg.pinv(scaled[others].T @ scaled[others])
    return far, name, _unlike(scaled[own], found, left[own], covariance)


def _unlike(columns: Array, found: Array, left: Array, covariance: Array) -> _Unlike:
    """Return the number that explains most of what is left of a run.

    Args:
        columns: Shape (T, k).
        found: Their coefficients by the other runs, shape (k,).
        left: Shape (T,).
        covariance: Of the coefficients, shape (k, k).
    """
    expected = columns @ found
    motion, viscous = (columns[:, k] * found[k] for k in (MOTION, VISCOUS))
    clock = _clock(motion, viscous, left + motion + viscous)
    factor = 1 + float(expected @ left) / max(float(expected @ expected), TINY)
    shift = float(np.mean(left))
    tried = {  # what it adds, and by how much more with the number
        "scaled": (factor, (factor - 1) * expected, expected),
        "moved": (shift, np.full(len(left), shift), np.ones(len(left))),
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
    return max(every, key=lambda one: one.explained)


def _clock(motion: Array, viscous: Array, whole: Array) -> float:
    """Return f > 0 that leaves least of whole - f^2 motion - f viscous, shape (T,) each; 1 where none does."""
    cubic = [-2 * motion @ motion, -3 * motion @ viscous, 2 * whole @ motion - viscous @ viscous, whole @ viscous]
    real = [float(root.real) for root in np.roots(cubic) if abs(root.imag) < 1e-9 * abs(root) and root.real > 0]
    return min(real, key=lambda f: float(np.sum((whole - f**2 * motion - f * viscous) ** 2)), default=1.0)
