"""One run among others: channels of drives that are turned in sign or exchanged there, and nowhere else.

What the nominal model lacks is fitted to all runs but one; where that one is predicted far worse than any other, what
its channels are taken for beside that is told, unless one other run alone says so.
"""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.plausibility.drive_picture import DrivePicture
from bench.diagnose.plausibility.mistaken import mistakes_in
from bench.diagnose.plausibility.one_run import FAR, OTHERS
from bench.diagnose.plausibility.physical_fit import beyond, completed
from bench.diagnose.replay.instants import run_of_each
from bench.diagnose.replay.segments import Segment
from bench.record.campaign import Array
from bench.record.finding import Finding

HOLDS = 2.0  # derived: levels of friction, from one end of what a joint may hold to the other
SEVERAL = 2  # exact: runs, from which on one is not alone
NAMED = 3  # effort: runs that a line names


def mistaken_in_one_run(picture: DrivePicture, segments: Sequence[Segment]) -> Iterator[Finding]:
    """Yield what drives' channels are taken for in one run, by what the nominal model lacks in the others.

    Args:
        picture: What the drives did.
        segments: Whose readings these are.
    """
    # the model has friction at rest at one of its two levels, that of the approach; a servo that settles takes a motor
    # back as far as the other one. Over all runs that evens out, in one it does not.
    picture = replace(picture, slack=np.maximum(picture.slack, HOLDS * picture.level))
    names, run_of = np.unique(run_of_each(segments), return_inverse=True)
    runs = list(dict.fromkeys(run_of.tolist()))
    for finding, alike in _in_several_runs(picture, run_of, runs):
        words = _listed([str(names[run]) for run in alike])
        yield replace(finding, message=f"{finding.message} in runs {words}, and not in all others")
        runs = [run for run in runs if run not in alike]
    while len(runs) > OTHERS:  # the worst first, which then tells nothing of the others
        others = {run: [other for other in runs if other != run] for run in runs}
        far = {run: float(np.max(_beside(picture, run_of, run, others[run])[1])) for run in runs}
        worst = max(far, key=lambda run: far[run])
        if far[worst] <= FAR:
            return
        for finding in _sure(picture, run_of, worst, others[worst]):
            yield replace(finding, message=f"{finding.message} in run {str(names[worst])!r}, and not in all others")
        runs.remove(worst)


def _in_several_runs(
    picture: DrivePicture, run_of: NDArray[np.intp], runs: Sequence[int]
) -> Iterator[tuple[Finding, tuple[int, ...]]]:
    """Yield what channels are taken for in several runs alike, and these runs.

    Held against all others one by one, each of them stands among the others that are mistaken, and none is unlike
    them. So runs that say one mistake of themselves are left out together, with those that say the same beside what is
    left, where they are fewer than the rest; and each is then held against that rest as a single run is.
    """
    suspected: dict[tuple[str, str], list[int]] = defaultdict(list)
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


def _alike_among_themselves(picture: DrivePicture, run_of: NDArray[np.intp], runs: Sequence[int]) -> list[int]:
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


def _said(picture: DrivePicture, run_of: NDArray[np.intp], run: int, others: Sequence[int]) -> set[tuple[str, str]]:
    """Return columns and messages of what channels are taken for in a run, by all others."""
    there, _ = _beside(picture, run_of, run, [other for other in others if other != run])
    return {(finding.column, finding.message) for finding in mistakes_in(there, of_units=False)}


def _listed(runs: Sequence[str]) -> str:
    shown = ", ".join(repr(run) for run in runs[:NAMED])
    return f"{shown} and {len(runs) - NAMED} more" if len(runs) > NAMED else shown


def _sure(picture: DrivePicture, run_of: NDArray[np.intp], run: int, others: Sequence[int]) -> list[Finding]:
    """Return what channels are taken for in a run, without what one other run alone contradicts."""
    mistakes = _mistaken(picture, run_of, run, others)
    for left_out in others if mistakes else ():
        still = _mistaken(picture, run_of, run, [other for other in others if other != left_out])
        mistakes = [finding for finding in mistakes if finding in still]
    return mistakes


def _mistaken(picture: DrivePicture, run_of: NDArray[np.intp], run: int, others: Sequence[int]) -> list[Finding]:
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
    picture: DrivePicture, run_of: NDArray[np.intp], run: int, others: Sequence[int]
) -> tuple[DrivePicture, Array]:
    """Return a run beside what others make of it, and how many times as far it is as any of those, shape (n,)."""
    whole = completed(picture, by=np.isin(run_of, others), zeros=True)
    left = np.nan_to_num(beyond(whole))
    squares = np.stack([np.bincount(run_of, square) for square in (left**2).T], axis=1)
    far = np.sqrt(squares / np.bincount(run_of)[:, None])
    here, most = far[run], np.max(far[list(others)], axis=0)
    past = np.where(here > 0, np.inf, 0.0)  # of others that friction at rest explains altogether
    return whole.of(run_of == run), np.divide(here, most, out=past, where=most > 0)
