"""Weights that each err on their own: what was stated of weights holds for every one of them.

A nuisance of the replay takes all weights as wrong by the same share, as those of one set are. One of another set, or
a load that is pulled over a pulley, errs on its own, and that is no load that was written down wrong. What a single one
changes is, to first order, what all of them change while it hangs there. So is what an error of a pull changes in one
run alone: cable and load cell are set up anew for each pose.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.replay.alike import ALIKE
from bench.diagnose.replay.instants import at_each_instant, run_of_each
from bench.diagnose.replay.nuisances import Nuisance
from bench.diagnose.replay.segments import Segment
from bench.record.campaign import Array

MOST_WEIGHTS = 20  # effort: of more, loads are pulled by something that is no weight, with one gain


def each_weight(
    segments: Sequence[Segment], nuisances: Sequence[Nuisance], sensitivities: Array
) -> tuple[tuple[Nuisance, ...], Array]:
    """Return q nuisances for weights that err on their own, and what they change, shape (T, c, q).

    Args:
        segments: Of the campaign.
        nuisances: Shape (p,), those of all weights among them.
        sensitivities: Shape (T, c, p), of one standard deviation of each.
    """
    forces = [np.linalg.norm(segment.motion.wrench[segment.motion.read, :3], axis=1) for segment in segments]
    hung = np.concatenate(forces)
    bolted = at_each_instant(segments, [segment.conditions.payload_kg for segment in segments])
    found, changes = [], []
    for nuisance, change in zip(nuisances, np.moveaxis(sensitivities, 2, 0), strict=True):
        if nuisance.on_wrench:
            for name, rows in _each_pull(segments, change):
                found.append(replace(nuisance, name=f"{nuisance}, in run {name}", on_wrench=None))
                changes.append(np.where(rows[:, None], change, 0.0))
            continue
        if not (nuisance.scales_wrench or nuisance.scales_payload):
            continue
        size, unit = (hung, "N") if nuisance.scales_wrench else (bolted, "kg")
        acts = np.any(np.nan_to_num(change) != 0, axis=1)
        weights = _alike(np.where(acts, size, 0.0))
        if not 1 < len(weights) <= MOST_WEIGHTS:
            continue
        for rows in weights:
            found.append(Nuisance(f"{nuisance}, that of {size[rows].mean():.4g} {unit}", "", nuisance.sigma))
            changes.append(np.where(rows[:, None], change, 0.0))
    return tuple(found), np.stack(changes, axis=2) if found else np.zeros((*sensitivities.shape[:2], 0))


def _each_pull(segments: Sequence[Segment], change: Array) -> Iterator[tuple[str, NDArray[np.bool_]]]:
    """Yield the runs in which loads are pulled aside, where there are several, and their instants, shape (T,).

    Args:
        segments: Of the campaign.
        change: Shape (T, c), by one error of all of them.
    """
    run = run_of_each(segments)
    runs = np.unique(run[np.any(np.nan_to_num(change) != 0, axis=1)])
    for name in runs if len(runs) > 1 else ():
        yield str(name), run == name


def _alike(sizes: Array) -> list[NDArray[np.bool_]]:
    """Return at which instants each weight acts, shape (T,) each; sizes closer than what counts as alike are one's."""
    known = np.unique(sizes[sizes > 0])
    if not len(known):
        return []
    edges = np.append(known[np.diff(known, prepend=-np.inf) > ALIKE * known], np.inf)
    which = np.searchsorted(edges, sizes, side="right")
    return [which == k for k in range(1, len(edges))]
