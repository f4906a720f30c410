"""What is held out at a time: whole runs, or blocks of time where there is one run."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bench.identify.dynamics.equations import Equations
from bench.record.campaign import Array
from bench.record.held_out import BLOCKS, GAP, MOST_FOLDS

SAME_PATH = 0.5  # declared: more than this share of one, that is most of it, lies on the path of the other
# derived: cosine of the angle between paths that run along each other; of directions in a plane at random two ninths do
# (20 of 90 degrees), fewer than `SAME_PATH`
ALONG = np.cos(np.deg2rad(20.0))
AT_REST = 0.1  # rounding: of the step between two points, below which a path has no direction


@dataclass(frozen=True)
class Folds:
    """K folds over the instants of all stretches.

    Attributes:
        by: What they are made of: recordings, runs, or blocks of the only run.
        names: Length K, names of recordings or runs, or times of blocks.
        of: For each stretch shape (T,), the fold of its instants; -1: it is never held out.
        near: For each stretch shape (T, K) bool, instants that are neither fitted nor predicted beside a fold.
        repeats: Whether all goes over one path again and again, so that no fold shows other angles than the rest.
    """

    by: Literal["recording", "run", "block"]
    names: tuple[str, ...]
    of: tuple[NDArray[np.int64], ...]
    near: tuple[NDArray[np.bool_], ...]
    repeats: bool

    def __len__(self) -> int:
        return len(self.names)

    def parts(self) -> tuple[tuple[NDArray[np.int64], ...], int]:
        """Return the part of each instant of a stretch (-1: never held out), and how many parts there are.

        Few folds are cut in time, into no more parts than the only run has blocks: two runs of which each is held out
        whole are two numbers, whose scatter hardly tells what is sure, and one run of their length is eight.
        """
        each = max(BLOCKS // len(self), 1)
        every = np.concatenate(self.of)
        part = np.full(len(every), -1)
        for fold in range(len(self)):
            mine = np.flatnonzero(every == fold)
            part[mine] = each * fold + np.arange(len(mine)) * each // max(len(mine), 1)
        return tuple(np.split(part, np.cumsum([len(of) for of in self.of])[:-1])), each * len(self)


def folds_of(stretches: Sequence[Equations]) -> Folds:
    """Return the folds of a campaign.

    Runs, or blocks of the only run, that go over the same angles, there and back, are one fold. If that leaves one
    fold, as on a single axis, they stay apart, and `repeats` says so.
    """
    names = list(dict.fromkeys(part.samples.run for part in stretches))
    if len(names) > 1:
        unit = [np.full(len(part), names.index(part.samples.run) % MOST_FOLDS) for part in stretches]
        near = [np.zeros((len(part), 0), dtype=np.bool_) for part in stretches]
        labels = [", ".join(names[k::MOST_FOLDS]) for k in range(min(len(names), MOST_FOLDS))]
        return _joined("run", labels, unit, near, stretches)
    block, near_all, count = _blocks([len(part) for part in stretches])
    time, every = np.concatenate([part.time for part in stretches]), np.concatenate(block)
    labels = [f"{time[every == k][0]:.1f} to {time[every == k][-1]:.1f} s" for k in range(count)]
    return _joined("block", labels, block, near_all, stretches)


def blocks_of(stretches: Sequence[Equations]) -> Folds:
    """Return folds that hold out a block of each run at a time, so that something of each recording stays."""
    of, near = [np.empty(0, dtype=np.int64)] * len(stretches), [np.empty((0, BLOCKS), dtype=np.bool_)] * len(stretches)
    for run in dict.fromkeys(part.samples.run for part in stretches):
        mine = [i for i, part in enumerate(stretches) if part.samples.run == run]
        block, beside, count = _blocks([len(stretches[i]) for i in mine])
        for i, own, close in zip(mine, block, beside, strict=True):
            of[i], near[i] = own, np.pad(close, ((0, 0), (0, BLOCKS - count)))
    names = tuple(f"block {k + 1} of each run" for k in range(BLOCKS))
    return Folds("block", names, tuple(of), tuple(near), repeats=False)


def _blocks(lengths: Sequence[int]) -> tuple[list[NDArray[np.int64]], list[NDArray[np.bool_]], int]:
    """Return the block of each instant of a run's stretches, which blocks it is near to, and how many there are."""
    total = sum(lengths)
    count = min(BLOCKS, total)
    block = np.arange(total) * count // total
    margin = int(np.ceil(GAP * total / count))
    place = np.arange(total)
    near = np.stack(
        [(np.abs(place[:, None] - place[block == k]).min(axis=1) <= margin) & (block != k) for k in range(count)],
        axis=1,
    )
    cuts = np.cumsum(lengths)[:-1]
    return np.split(block, cuts), np.split(near, cuts), count


def _joined(
    by: Literal["run", "block"],
    labels: list[str],
    unit: list[NDArray[np.int64]],
    near: list[NDArray[np.bool_]],
    stretches: Sequence[Equations],
) -> Folds:
    """Join the units that go over the same path."""
    count = len(labels)
    path = np.concatenate([part.position for part in stretches])
    span = np.ptp(path, axis=0)
    path = path[:, span > 0] / span[span > 0]
    member = np.concatenate(unit)
    group = list(range(count))
    pieces = [path[member == k] for k in range(count)]
    for a in range(count):
        for b in range(a):
            if group[a] != group[b] and (_covers(pieces[a], pieces[b]) or _covers(pieces[b], pieces[a])):
                old, new = group[a], group[b]
                group = [new if g == old else g for g in group]
    kept = sorted(set(group))
    repeats = len(kept) == 1 and count > 1
    if repeats:
        group, kept = list(range(count)), list(range(count))
    number = np.array([kept.index(g) for g in group])
    widened = []
    for fold, beside in zip(unit, near, strict=True):
        mask = np.zeros((len(fold), len(kept)), dtype=np.bool_)
        for k in range(beside.shape[1]):
            mask[:, number[k]] |= beside[:, k]
        mask[np.arange(len(fold)), number[fold]] = False
        widened.append(mask)
    names = tuple(" and ".join(labels[k] for k in range(count) if number[k] == fold) for fold in range(len(kept)))
    return Folds(by, names, tuple(number[fold] for fold in unit), tuple(widened), repeats)


def _covers(one: Array, other: Array) -> bool:
    """Return whether most of one path, shape (T, n), lies on the other and runs along it, there or back.

    On it is what lies within a step between its points. Any two paths of two joints lie near each other wherever they
    cross, so directions count as well.
    """
    if len(one) < 2 or len(other) < 2:
        return False
    step = max(float(np.median(np.linalg.norm(np.diff(path, axis=0), axis=1))) for path in (one, other))
    distance, nearest = cKDTree(other).query(one)
    along = np.abs(np.sum(_direction(one, step) * _direction(other, step)[nearest], axis=1))
    at_rest = np.isnan(along)
    return bool(np.mean((distance <= step) & (at_rest | (along > ALONG))) > SAME_PATH)


def _direction(path: Array, step: float) -> Array:
    """Return the unit vector along a path at each instant, shape (T, n); nan where it moves far less than a step."""
    change = np.gradient(path, axis=0)
    length = np.linalg.norm(change, axis=1, keepdims=True)
    return np.asarray(change / np.where(length > AT_REST * step, length, np.nan))
