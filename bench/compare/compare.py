"""From recordings to what changed between them."""

from collections import deque
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial

import numpy as np
from threadpoolctl import threadpool_limits

from bench.compare.background import Background, background_of
from bench.compare.comparison import ChannelNoise, Compared, Comparison, UnlistedChange
from bench.compare.components import components_of
from bench.compare.drift import drifts_of
from bench.compare.explain import explanations_of, findings_of
from bench.compare.fit_large import found_large
from bench.compare.joint import Joint, joint_of
from bench.compare.large import LargeChange
from bench.compare.left_before import left_before
from bench.compare.moved_along import moved_along
from bench.compare.profiles import profiles_of
from bench.compare.recordings import Recording, days_of
from bench.compare.search_changes import Found
from bench.compare.settle import settled_changes
from bench.diagnose.diagnose import FALSE_ALARM_RATE
from bench.diagnose.linearise.generic import Block
from bench.diagnose.replay.segments import MOST_BINS
from bench.diagnose.verdict import Unfinished
from bench.effects.effect import Effect
from bench.errors import NOT_SIMULATED
from bench.executor.contract import Executor
from bench.executor.serial import SERIAL
from bench.executor.watched import Check, Stopped, never
from bench.robot.compiled import CompiledRobot
from bench.store.store import Store

MOST_LARGE = 3  # effort: changes that are too large to be in proportion


def compare(
    recordings: tuple[Recording, ...],
    compiled: CompiledRobot,
    catalogue: Mapping[str, Effect],
    rate: float = FALSE_ALARM_RATE,
    progress: Callable[[str], None] = lambda words: None,
    most_bins: int = MOST_BINS,
    executor: Executor = SERIAL,
    store: Store | None = None,
    check: Check = never,
) -> Comparison:
    """Say what changed on a machine.

    Args:
        recordings: From `recordings_of`.
        compiled: The robot that changes are linear about, from `as_it_was`.
        catalogue: Effects to look for.
        rate: Share of unchanged machines of which anything at all may be said to have changed.
        progress: Called with what is done next.
        most_bins: How many bins the motion of each recording may have.
        executor: Where to simulate; results do not depend on it.
        store: Where signatures are kept between processes; None: nowhere.
        check: Called before each step; where it raises `Stopped`, what was found so far is said.

    Raises:
        Stopped: Before anything was found.
        InputError: A recording has nothing that a replay predicts, or no channel was read both before and after.
        ConvergenceError: The nominal model finds no balance along a measured motion.
    """
    during = ""

    def begin(words: str) -> None:
        nonlocal during
        during = words
        progress(words)
        check()

    with threadpool_limits(1, "blas"):
        joined = partial(joint_of, recordings, compiled, catalogue, most_bins, executor, store)
        known, unfinished = None, None
        try:
            for one in weighing(joined, rate, begin, check):
                known = one
        except Stopped as stopped:
            if known is None:
                raise
            unfinished = Unfinished(str(stopped), during)
        assert known
        progress("values over the recordings")
        return replace(comparison_of(*known, rate), unfinished=unfinished)


def weighed(
    joined: Callable[[tuple[LargeChange, ...], Joint | None], Joint],
    rate: float = FALSE_ALARM_RATE,
) -> tuple[Background, Found]:
    """Return what stayed as it was, with settled noise, and what changed; see `weighing`."""
    return _last(weighing(joined, rate))


def weighing(
    joined: Callable[[tuple[LargeChange, ...], Joint | None], Joint],
    rate: float = FALSE_ALARM_RATE,
    progress: Callable[[str], None] = lambda words: None,
    check: Check = never,
) -> Iterator[tuple[Background, Found]]:
    """Yield what stayed as it was and what changed, at last with settled noise.

    Args:
        joined: Returns all recordings in one model that is linear about a machine with some changes, beside the one
            without.
        rate: Share of unchanged machines of which anything at all may be said to have changed.
        progress: Called with what is done next; what it raises ends it.
        check: Called within that; what it raises ends it.
    """
    progress("signatures")
    for background, found in _settling(joined((), None), rate, progress, check):
        yield background, found
    for _ in range(MOST_LARGE):
        if found.best:
            progress("whether that is in proportion")
        large = found_large(background, found)
        if large is None:
            break
        progress(f"signatures beside {large.cause}")
        try:
            joint = joined((*background.joint.large, large), background.joint)
            again = _last(_settling(joint, rate, progress, check))
        except NOT_SIMULATED:  # signatures about the machine as it was have to do
            break
        if large.cause.key not in again[1].alternatives[0].keys:  # what it does beyond proportion is not there
            break
        background, found = again
        yield background, found


def _settling(
    joint: Joint, rate: float, progress: Callable[[str], None], check: Check
) -> Iterator[tuple[Background, Found]]:
    progress("what stayed as it was")
    background = background_of(joint, check)
    profiles = profiles_of(sum(not one.is_after for one in joint.recordings), days_of(joint.recordings))
    return settled_changes(background, profiles, rate, progress, check)


def _last(known: Iterator[tuple[Background, Found]]) -> tuple[Background, Found]:
    return deque(known, maxlen=1)[0]


def comparison_of(background: Background, found: Found, rate: float) -> Comparison:
    """Return what is said of that; `rate` is the one with which it was weighed."""
    near = [found.alternatives[i].best.terms for i in found.near] if found.alternatives[0].keys else []
    along = {terms: moved_along(background, found, terms) for terms in near}
    return Comparison(
        recordings=_compared(background),
        false_alarm_rate=rate,
        threshold=found.screened[0].threshold,
        probability_unchanged=found.probability_unchanged,
        explanations=explanations_of(background, found, along),
        findings=findings_of(found),
        unlisted=_unlisted(background, found),
        components=components_of(background, found, along),
        noise=_noise(background),
        drifts=drifts_of(background, found),
        left_out=background.joint.left_out,
        left_before=left_before(background.joint),
    )


def _compared(background: Background) -> tuple[Compared, ...]:
    recordings = background.joint.recordings
    count = np.bincount(background.joint.of_instant, minlength=len(recordings)).tolist()
    rows = zip(recordings, days_of(recordings).tolist(), count, background.coinciding.tolist(), strict=True)
    return tuple(
        Compared(one.name, one.is_after, one.started.isoformat() if one.started else None, days, instants, share)
        for one, days, instants, share in rows
    )


def _unlisted(background: Background, found: Found) -> UnlistedChange | None:
    if found.shape is None:
        return None
    possible = found.possible[found.shape]
    block = possible.entry.what
    assert isinstance(block, Block)
    since = background.joint.recordings[possible.profile.since].name
    odds = found.model.log_posterior([found.shape])
    return UnlistedChange(
        str(block), block.place, block.kind, block.depends_on, possible.profile.course, since, float(odds)
    )


def _noise(background: Background) -> tuple[ChannelNoise, ...]:
    known = background.repeatability
    return tuple(
        ChannelNoise(
            quantity.column,
            bool(kind),
            float(np.sqrt(known.own[kind, c])),
            float(np.sqrt(known.shared[kind, c])),
            int(known.pairs[kind, c]),
        )
        for c, quantity in enumerate(background.joint.linear.quantities)
        for kind in (0, 1)
    )
