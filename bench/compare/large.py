"""A change that is too large to be in proportion: the search is linear about a machine in which it acts.

Signatures are those of that machine then, and what it does beyond proportion is taken off the readings.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.compare.profiles import Profile
from bench.compare.recordings import Recording
from bench.diagnose.extend.fit import Unknown
from bench.diagnose.linearise.candidates import Cause, plan_of
from bench.diagnose.linearise.changes import Digits
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.world import NOMINAL, World
from bench.effects.effect import Acting
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot


@dataclass(frozen=True, eq=False)
class LargeChange:
    """A change with sizes that simulation found.

    Attributes:
        cause: What.
        shape: Its other parameters.
        sizes: Shape (k,), in the units of its parameters, beyond those that change nothing.
        profile: Which share of them acts in each recording.
    """

    cause: Cause
    shape: dict[str, float]
    sizes: Array
    profile: Profile

    def acting(self, share: float) -> Acting:
        """Return the cause with a share of its sizes."""
        found = zip(self.cause.sizes, (share * self.sizes).tolist(), strict=True)
        return self.cause.acting({**self.shape, **{size.name: size.null + x for size, x in found}})

    def sizes_as(self, other: "LargeChange") -> Array:
        """Return its sizes in the order of another change of its cause, which may have more or fewer, shape (k,)."""
        known = dict(zip([size.name for size in self.cause.sizes], self.sizes.tolist(), strict=True))
        return np.array([known.get(size.name, 0.0) for size in other.cause.sizes])

    def world(self, recordings: Sequence[Recording]) -> World:
        """Return a world in which it acts in joined recordings."""
        acting = []
        for one, share in zip(recordings, self.profile.weights.tolist(), strict=True):
            if share:
                whole = self.acting(share)
                acting.append(replace(whole, place=replace(whole.place, recording=one.name)))
        return World(acting=tuple(acting))


def bounds_of(cause: Cause, compiled: CompiledRobot) -> tuple[Array, Array]:
    """Return the least and the largest that each size of a cause may change by, shape (k,).

    Of a size that has one sign as much may be gone as the model has.
    """
    there = cause.effect.there_already(compiled, cause.place)
    null = np.array([size.null for size in cause.sizes])
    low, high = np.array([Unknown(cause, size).bounds for size in cause.sizes]).T - null
    return low - np.array([there.get(size.name, 0.0) for size in cause.sizes]), high


def all_acting(large: Sequence[LargeChange], recordings: Sequence[Recording]) -> World:
    """Return a world in which several changes act in joined recordings."""
    return World(acting=tuple(one for change in large for one in change.world(recordings).acting))


def in_recording(large: Sequence[LargeChange], k: int) -> World:
    """Return a world in which several changes act as in recording `k`, for that alone."""
    shares = [(change, float(change.profile.weights[k])) for change in large]
    return World(acting=tuple(change.acting(share) for change, share in shares if share))


def beyond_proportion(
    replay: Replay,
    large: Sequence[LargeChange],
    recordings: Sequence[Recording],
    signatures: Sequence[Sequence[Digits]],
) -> Array:
    """Return what changes do beyond proportion, shape (T, c): to readings less that, signatures about them apply.

    Args:
        replay: All recordings.
        large: The changes.
        recordings: Which.
        signatures: For each change, what the typical value of each of its sizes changes, shape (T, c).
    """
    if not large:
        return np.zeros(replay.shape)
    names = np.repeat([segment.recording for segment in replay.segments], [len(one) for one in replay.segments])
    found = replay.predict(all_acting(large, recordings)) - replay.predict(NOMINAL)
    for change, own in zip(large, signatures, strict=True):
        for one, share in zip(recordings, change.profile.weights.tolist(), strict=True):
            rows = names == one.name
            for x, size, signature in zip(change.sizes.tolist(), change.cause.sizes, own, strict=True):
                found[rows] -= share * x / (change.cause.typical(size) - size.null) * signature[rows]
    return np.asarray(found)


def places_of(change: LargeChange, causes: Sequence[Cause]) -> tuple[int, ...]:
    """Return where the signatures of a change's sizes stand among those of all causes, in the order of `plan_of`."""
    first = 0
    for cause, shape in plan_of(causes):
        if cause.key == change.cause.key and shape == change.shape:
            names = [size.name for size in cause.sizes]
            return tuple(first + names.index(size.name) for size in change.cause.sizes)
        first += len(cause.sizes)
    raise KeyError(change.cause.key)
