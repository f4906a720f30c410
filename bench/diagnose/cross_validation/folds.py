"""What is held out at a time: whole recordings, runs of the only one, or blocks of the only run with an effect."""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.replay.alike import runs_together
from bench.diagnose.replay.instants import at_each_instant, recordings_of
from bench.record.campaign import Array
from bench.record.held_out import BLOCKS, GAP, MOST_FOLDS

ALONE = 0.9  # assumed: of all that an extension changes; what shows more than that cannot be checked with the others


@dataclass(frozen=True, eq=False)
class Folds:
    """K folds over T instants.

    Attributes:
        by: Of what kind they are.
        of_instants: Shape (T,), fold of every instant.
        gap: Shape (T, K) bool, instants that are left out beside a fold without being predicted.
        recordings: Name of the recording that each fold is; empty where folds are something else.
        own: How many of the folds, the first ones, are of the recording that shows an extension alone; None: all count.
            What is another recording's own cannot be predicted without that recording, and says nothing of this one.
        of: Name of that recording; "": all count.
    """

    by: Literal["recording", "run", "block"]
    of_instants: NDArray[np.int64]
    gap: NDArray[np.bool_]
    recordings: tuple[str, ...] = ()
    own: int | None = None
    of: str = ""

    def __len__(self) -> int:
        return int(self.gap.shape[1])

    @cached_property
    def key(self) -> tuple[bytes, bytes]:
        """The same for folds that leave out the same."""
        return self.of_instants.tobytes(), np.packbits(self.gap).tobytes()

    def of_rows(self, linear: LinearisedModel) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        """Return the fold, shape (m,), and the gaps, shape (m, K), of whitened readings."""
        return self.of_instants[linear.instant_of], self.gap[linear.instant_of]

    @property
    def counts(self) -> NDArray[np.bool_]:
        """Shape (T,), instants of the folds that count."""
        return self.of_instants < (len(self) if self.own is None else self.own)

    def sums(self, values: Array) -> Array:
        """Return sums over the instants of each fold, shape (K,), of values of shape (T,)."""
        return np.bincount(self.of_instants, values, len(self)).astype(np.float64)


def folds_of(linear: LinearisedModel, changed: Array | None = None, only: str | None = None) -> Folds:
    """Return the folds of a campaign.

    A fold is what a later recording would be: a recording where there are several, else a run. Beyond 40 runs every
    fold takes several that lie far apart, as up and down of one sweep do not. Where an extension acts in one recording
    alone, or that shows nearly all of it, its runs are folds beside the other recordings; where one run does, that is
    cut into blocks.

    Args:
        linear: The campaign.
        changed: Shape (m,), whitened change of the prediction by the extension; None: there is none.
        only: Name of the recording in which alone the extension acts; None: there is none.
    """
    run = at_each_instant(linear.segments, [linear.runs.index(segment.run) for segment in linear.segments])
    power = np.ones(len(linear.runs)) if changed is None else _sums(linear.run_of, changed**2, len(linear.runs))
    names = recordings_of(linear.segments)
    if len(names) == 1:
        return _of_runs(run, power)
    of_run = dict(
        zip([s.run for s in linear.segments], [names.index(s.recording) for s in linear.segments], strict=True)
    )
    recording_of = np.array([of_run[name] for name in linear.runs])
    share = _sums(recording_of, power, len(names))
    alone = int(np.argmax(share)) if only is None else names.index(only)
    recording = recording_of[run]
    if changed is None or (only is None and share[alone] <= ALONE * share.sum()):
        return Folds("recording", recording, np.zeros((len(run), len(names)), dtype=bool), names)
    mine, runs = recording == alone, np.flatnonzero(recording_of == alone)
    inside = _of_runs(np.searchsorted(runs, run[mine]), power[runs])
    fold = len(inside) + recording - (recording > alone)
    fold[mine] = inside.of_instants
    gap = np.zeros((len(run), len(inside) + len(names) - 1), dtype=bool)
    gap[np.flatnonzero(mine)[:, None], np.arange(len(inside))] = inside.gap
    return Folds(inside.by, fold, gap, own=len(inside), of=names[alone])


def folds_of_states(linear: LinearisedModel, changed: Array | None = None) -> Folds | None:
    """Return folds of which each is what several recordings repeat, held out of all of them; None: they repeat nothing.

    Recordings by one program confirm whatever repeats with it, right or wrong: a drive that rings after each ramp is a
    transmission error in every one of them. Whether the machine has it, states say that were not fitted at all.

    Args:
        linear: The campaign.
        changed: Shape (m,), whitened change of the prediction by the extension; what one fold alone shows cannot be
            held out so. None: there is none.
    """
    group = runs_together(linear.segments)
    count = max(group.values()) + 1
    if count == len(group) or len(recordings_of(linear.segments)) == 1:
        return None
    of_row = np.array([group[run] for run in linear.runs])[linear.run_of]
    power = np.ones(count) if changed is None else _sums(of_row, changed**2, count)
    if np.max(power) > ALONE * power.sum():
        return None
    return _of_runs(at_each_instant(linear.segments, [group[segment.run] for segment in linear.segments]), power)


def _sums(group: NDArray[np.int64] | Array, values: Array, count: int) -> Array:
    """Return sums over groups, shape (count,)."""
    return np.bincount(group, values, count).astype(np.float64)


def _of_runs(run: NDArray[np.int64], power: Array) -> Folds:
    """Return the folds of one recording.

    Args:
        run: Shape (T,), indices of its runs.
        power: Shape (runs,), how much of an extension each shows.
    """
    alone = int(np.argmax(power))
    if len(power) == 1 or power[alone] > ALONE * power.sum():
        return _with_blocks(run, alone)
    n_folds = min(len(power), MOST_FOLDS)
    return Folds("run", run % n_folds, np.zeros((len(run), n_folds), dtype=bool))


def _with_blocks(run: NDArray[np.int64], alone: int) -> Folds:
    """Return folds in which one run is cut into blocks of equal numbers of instants.

    Args:
        run: Shape (T,).
        alone: The run to cut.
    """
    mine = np.flatnonzero(run == alone)
    n_blocks = min(BLOCKS, len(mine))
    others = run - (run > alone)  # numbered without the one that is cut
    n_others = min(int(run.max()), MOST_FOLDS)
    fold = n_blocks + (others % n_others if n_others else others)
    position = np.arange(len(mine))
    fold[mine] = position * n_blocks // len(mine)
    gap = np.zeros((len(run), n_blocks + n_others), dtype=bool)
    margin = round(GAP * len(mine) / n_blocks)
    for block in range(n_blocks):
        inside = position[fold[mine] == block]
        near = (position >= inside[0] - margin) & (position <= inside[-1] + margin) & (fold[mine] != block)
        gap[mine[near], block] = True
    return Folds("block", fold, gap)
