"""All recordings in one linearised model: the same robot replays them, and one list of causes acts in them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.compare.large import LargeChange, beyond_proportion, in_recording, places_of
from bench.compare.recordings import Recording
from bench.diagnose.explain import measured_by
from bench.diagnose.linearise.candidates import Candidate, Cause, candidates_of, causes_of, plan_of
from bench.diagnose.linearise.changes import Digits
from bench.diagnose.linearise.generic import Block, blocks_of
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.nominal_model import linearised_model_of
from bench.diagnose.linearise.other_noise import with_scatter
from bench.diagnose.linearise.signatures import Sensitivities, Signatures
from bench.diagnose.replay.instants import at_each_instant
from bench.diagnose.replay.levels import gas_of_the_day
from bench.diagnose.replay.nuisances import Nuisance, nuisances_of
from bench.diagnose.replay.quantities import Quantity, quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import MOST_BINS, Segment, segments_of
from bench.effects.effect import Effect
from bench.effects.recorded import Recorded, RecordedRun, recorded_in
from bench.errors import ConvergenceError, InputError
from bench.executor.contract import Executor
from bench.executor.serial import SERIAL
from bench.record.campaign import Array
from bench.record.known import PAYLOAD
from bench.robot.compiled import CompiledRobot
from bench.store.store import Store

MASS = "geometry and mass"  # the family of effects that change what links weigh, or where


@dataclass(frozen=True, eq=False)
class Joint:
    """All recordings, linear about the robot as it was before; K recordings, S segments, m whitened readings.

    Attributes:
        recordings: Which.
        linear: All of them, one after the other.
        of_segment: Shape (S,), index of each segment's recording.
        causes: What is looked for.
        sensitivities: Of the readings to each of them, shape (T, c) each, in the order of `plan_of`.
        stayed: The same of what stayed: about the robot as it was, without any large change (`_stayed`).
        left_out: Columns that were read before or after alone.
        large: Changes that are too large to be in proportion, about which it is linear.
        beyond: Shape (T, c), what they change beyond proportion, which is taken off the readings.
    """

    recordings: tuple[Recording, ...]
    linear: LinearisedModel
    of_segment: NDArray[np.intp]
    causes: tuple[Cause, ...]
    sensitivities: tuple[Digits | None, ...]
    stayed: tuple[Digits | None, ...]
    left_out: tuple[str, ...]
    large: tuple[LargeChange, ...]
    beyond: Array

    @property
    def of_instant(self) -> NDArray[np.intp]:
        """Shape (T,), index of each instant's recording."""
        return at_each_instant(self.linear.segments, self.of_segment)

    @property
    def of_row(self) -> NDArray[np.intp]:
        """Shape (m,), index of each whitened reading's recording."""
        return self.of_instant[self.linear.instant_of]

    def tried(self) -> tuple[Candidate | Block, ...]:
        """Return every visible cause and every free shape, as they act in all recordings alike."""
        return self._acting(self.sensitivities)

    def discrepancy(self) -> tuple[Candidate | Block, ...]:
        """Return the same as what stayed, of which a large change makes nothing more.

        About a machine with a large change what stayed would show otherwise after it, in proportion to both. The
        discrepancy has all plausible causes at once, with sizes far beyond what is left to explain; they would scale
        the change (a payload of 1 kg on an arm of 15 kg, with all torque constants and masses free, by 9 %).
        """
        return self._acting(self.stayed)

    def _acting(self, sensitivities: tuple[Digits | None, ...]) -> tuple[Candidate | Block, ...]:
        return (*candidates_of(self.linear, self.causes, sensitivities), *blocks_of(self.linear))


def joint_of(
    recordings: tuple[Recording, ...],
    compiled: CompiledRobot,
    catalogue: Mapping[str, Effect],
    most_bins: int = MOST_BINS,
    executor: Executor = SERIAL,
    store: Store | None = None,
    large: tuple[LargeChange, ...] = (),
    before: Joint | None = None,
) -> Joint:
    """Return all recordings in one linearised model.

    Args:
        recordings: Of one machine.
        compiled: Its robot, that changes are linear about.
        catalogue: Effects to look for.
        most_bins: How many bins the motion of each recording may have.
        executor: Where to simulate.
        store: Where signatures are kept between processes; None: nowhere.
        large: Changes that are too large to be in proportion.
        before: The same with fewer of these. Masses that stayed, and the discrepancy, are taken from there.

    Raises:
        InputError: A recording has nothing that a replay predicts, or no channel was read both before and after.
        ConvergenceError: The nominal model finds no balance along a measured motion, or one with a large change.
    """
    quantities, left_out = _compared(recordings, compiled)
    if not quantities:
        raise InputError(
            "no channel that a replay predicts was read both before and after: log the same motor currents or torques, "
            "reflectors, link encoders or gas pressure as before."
        )
    recorded = recorded_in_any(recordings, compiled)
    measured = frozenset[str]().union(*(measured_by(one.campaign) for one in recordings))
    measured -= {one.kind for one in left_out} - {one.kind for one in quantities}
    causes = causes_of(catalogue.values(), compiled, measured, recorded)
    first = {one.campaign.runs[0].name for one in recordings}  # what sets in with it acts in all of a recording
    causes = tuple(cause for cause in causes if cause.place.since not in first)
    nuisances = _as_weighed(nuisances_of(compiled, quantities), recordings)
    if compiled.counterbalance:
        nuisances = (*nuisances, gas_of_the_day())
    known: list[tuple[tuple[Segment, ...], Sensitivities]] = []
    for k, one in enumerate(recordings):
        segments = segments_of(one.campaign, compiled, quantities, most_bins)
        if not segments:
            raise InputError(
                f"{one.name}: has no channel that a replay predicts: log motor currents or torques, a reflector, a "
                "link encoder, or the gas pressure, beside the motor angles."
            )
        # each recording has its own: signatures depend on temperatures, which are other ones each day
        about = compiled, quantities, nuisances, causes, in_recording(large, k), store
        found = Signatures(*about).sensitivities(segments, executor)
        known.append((segments, found))
    joined = tuple(
        replace(segment, run=f"{one.name}.{segment.run}", label=f"{one.name}.{segment.label}", recording=one.name)
        for one, (segments, _) in zip(recordings, known, strict=True)
        for segment in segments
    )
    changes = np.concatenate([found.nuisances for _, found in known])
    of = np.repeat(np.arange(len(recordings)), [sum(map(len, segments)) for segments, _ in known])
    if before:
        for i, nuisance in enumerate(nuisances):
            if nuisance.of_mass:
                changes[:, :, i] = _smaller(changes[:, :, i], before.linear.sensitivities[:, :, i], of)
    sensitivities = tuple(_stacked(parts) for parts in zip(*(found.causes for _, found in known), strict=True))
    replay = Replay(compiled, joined, quantities)
    beyond = beyond_proportion(
        replay, large, recordings, [_sound(sensitivities, places_of(one, causes)) for one in large]
    )
    if large:
        read = zip(joined, np.split(beyond, np.cumsum([len(one) for one in joined])[:-1]), strict=True)
        joined = tuple(replace(segment, observed=segment.observed - part) for segment, part in read)
        replay = Replay(compiled, joined, quantities)
    linear = linearised_model_of(replay, nuisances, changes)
    # how much of the friction at rest repeats is asked for here with all that recordings share (`background.py`)
    linear = with_scatter(linear, replace(linear.scatter, repeats=0.0))
    of_segment = np.repeat(np.arange(len(recordings)), [len(segments) for segments, _ in known])
    columns = tuple(one.column for one in left_out)
    stayed = _stayed(causes, sensitivities, before.stayed, of) if before else sensitivities
    return Joint(recordings, linear, of_segment, causes, sensitivities, stayed, columns, large, beyond)


def recorded_in_any(recordings: Sequence[Recording], compiled: CompiledRobot) -> Recorded:
    """Return the runs of a program, each with what was recorded of it in any of the recordings."""
    found: dict[str, RecordedRun] = {}
    for one in recordings:
        for run in recorded_in(one.campaign.runs, compiled.model.opt.gravity).runs:
            known = found.get(run.name, run)
            found[run.name] = replace(
                known,
                columns=known.columns | run.columns,
                hangs=known.hangs or run.hangs,
                payload_kg=max(known.payload_kg, run.payload_kg),
                moving=known.moving | run.moving,
            )
    return Recorded(tuple(sorted(found.values(), key=lambda run: run.start_s)))


def _compared(
    recordings: Sequence[Recording], compiled: CompiledRobot
) -> tuple[tuple[Quantity, ...], tuple[Quantity, ...]]:
    """Return the channels that were read both before and after, and those that were not.

    What one side alone read says nothing of a change. What the model gets wrong about it every time would be taken for
    one, since nothing before shows it.
    """
    before, after = (
        quantities_of(tuple(run for one in recordings if one.is_after == side for run in one.campaign.runs), compiled)
        for side in (False, True)
    )
    both = tuple(one for one in after if one in before)
    return both, tuple(one for one in (*before, *after) if one not in both)


def _as_weighed(nuisances: Sequence[Nuisance], recordings: Sequence[Recording]) -> tuple[Nuisance, ...]:
    """Return background errors in which what is bolted on is no better known than it was weighed."""
    payloads = [one for recording in recordings for one in recording.campaign.known if one.quantity == PAYLOAD]
    worst = max((one.sigma / one.value for one in payloads if one.value), default=0.0)
    return tuple(
        replace(one, sigma=max(one.sigma, worst), own=max(one.own, worst)) if one.scales_payload else one
        for one in nuisances
    )


def _sound(sensitivities: Sequence[Digits | None], places: Sequence[int]) -> list[Digits]:
    """Return some of the sensitivities.

    Raises:
        ConvergenceError: The model of one of them finds no balance.
    """
    found = [change for i in places if (change := sensitivities[i]) is not None]
    if len(found) < len(places):
        raise ConvergenceError("a change beside a large one finds no balance")
    return found


def _stayed(
    causes: Sequence[Cause], now: Sequence[Digits | None], before: Sequence[Digits | None], of: NDArray[np.intp]
) -> tuple[Digits | None, ...]:
    """Return what causes that stayed change: as about the robot as it was, or less, where their mass was taken off.

    Args:
        causes: What is looked for.
        now: About a machine with large changes, shape (T, c) each, in the order of `plan_of`.
        before: About the robot as it was.
        of: Shape (T,), index of each instant's recording.
    """
    masses = [cause.effect.family == MASS for cause, _ in plan_of(causes) for _ in cause.sizes]
    both = zip(now, before, masses, strict=True)
    return tuple(
        _smaller(one, other, of) if is_mass and one is not None and other is not None else other
        for one, other, is_mass in both
    )


def _smaller(one: NDArray[Any], other: NDArray[Any], of: NDArray[np.intp]) -> NDArray[Any]:
    """Return in each recording the one of two changes, shape (T, c), that is smaller over all channels.

    What is off of a body that carries a payload is off of what was there, and no more of what is bolted on later; and
    it is gone with what was taken off.
    """
    found = other.copy()
    for k in np.unique(of):
        rows = of == k
        new, old = (np.sum(np.square(values[rows], dtype=np.float64), axis=0) for values in (one, other))
        seen = old > 0
        if np.any(seen) and np.mean(new[seen] / old[seen]) < 1:
            found[rows] = one[rows]
    return found


def _stacked(parts: Sequence[Digits | None]) -> Digits | None:
    """Return what a cause changes in all recordings; None where its model finds no balance in one of them."""
    sound = [part for part in parts if part is not None]
    return np.concatenate(sound) if len(sound) == len(parts) else None
