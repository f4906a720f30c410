"""Pairs of recordings of one messy machine, with and without a change between them, and what a comparison says."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from threadpoolctl import threadpool_limits

from bench.compare.as_it_was import as_it_was
from bench.compare.compare import comparison_of, weighed
from bench.compare.comparison import Comparison
from bench.compare.joint import joint_of
from bench.compare.recordings import recordings_of
from bench.diagnose.diagnose import FALSE_ALARM_RATE
from bench.effects.effect import Acting, Effect
from bench.errors import BenchError, ConvergenceError
from bench.record.campaign import Campaign
from bench.study.labs import Lab, Setup
from bench.study.limits import Way, detection_limit
from bench.study.machines import components_in, recorded
from bench.study.make import Sized
from bench.study.visible import visibility
from bench.study.worlds import MachineWorld, surroundings_of

QUARTER = 0.25  # of its absolute detection limit, at which a change is to be found (DESIGN 6.8)
# Instruments that are set up anew for each recording: what they do otherwise than before is no change of the machine
ANEW = ("tracker_frame", "tracker_drift", "tracker_scale", "force_gain", "force_tilt", "current_offset")
STRIDE = (
    17  # effects from one that cannot be hidden to the next try: any that does not share a factor with their number
)
TRIES = 60  # effects and places that are drawn until the absolute limit is plausible


@dataclass(frozen=True, eq=False)
class Pair:
    """Two recordings of one machine.

    Attributes:
        before, after: What the comparison is given.
        change: What came between them; None: nothing did.
    """

    before: Campaign
    after: Campaign
    change: Sized | None


@dataclass(frozen=True)
class Outcome:
    """What a comparison says of a pair.

    Attributes:
        hidden: What came between the recordings, in words; "" for nothing.
        size: Its size as a share of its absolute detection limit.
        times: The same as a share of what the comparison says it would have found.
        stands_out: By how many standard deviations it shows to one who knows what it is (`visible.py`).
        is_visible: Whether that is the evidence which the comparison asks for.
        said: What is named, in words.
        is_named: Whether anything is said to have changed, listed or not.
        is_first: Whether the most probable explanation is what was hidden, and nothing else.
        is_among_first: Whether it is part of the most probable explanation.
        is_in_set: Whether it is part of one of those that the data cannot tell apart.
    """

    hidden: str
    size: float
    times: float
    stands_out: float
    is_visible: bool
    said: str
    is_named: bool
    is_first: bool
    is_among_first: bool
    is_in_set: bool


def pair_of(
    setup: Setup,
    number: int,
    seed: int,
    *,
    with_change: bool,
    later: Lab | None = None,
    size: float = QUARTER,
    world: MachineWorld = "messy",
) -> Pair:
    """Return two recordings of a messy machine.

    Effects take turns; the order, places, shapes and signs are drawn. What has no plausible absolute limit gives its
    turn to the next.

    Args:
        setup: Of the lab that records; its null campaign gives absolute detection limits.
        number: Of the pair, from 0; each is of another machine.
        seed: Of everything that is drawn.
        with_change: Whether something comes between the two.
        later: Lab of the second recording, if it does something else.
        size: Of the change, as a share of its absolute detection limit.
        world: Whose plant records.

    Raises:
        ConvergenceError: None of the machines that were drawn finds a rest.
    """
    listed = _listed(setup, world)
    order = np.random.default_rng([seed, len(listed)]).permutation(listed)
    for turn in range(TRIES):
        rng = np.random.default_rng([seed, number, turn, int(with_change)])
        change = None
        if with_change:
            effect = setup.catalogue[str(order[(number + turn * STRIDE) % len(order)])]
            change = _sized(effect, setup, rng, size)
            if change is None:
                continue
        with suppress(ConvergenceError):  # a machine that finds no rest: another one
            return _made(world, setup, later or setup.lab, change, rng)
    raise ConvergenceError(f"pair {number}: none of {TRIES} machines that were drawn finds a rest")


def outcome_of(pair: Pair, setup: Setup, rate: float = FALSE_ALARM_RATE) -> Outcome:
    """Return what a comparison says of a pair."""
    recordings = recordings_of({"before": pair.before}, {"after": pair.after})
    with threadpool_limits(1, "blas"), TemporaryDirectory() as files:
        fitted = as_it_was(pair.before, setup.compiled, Path(files)).robot
        joined = partial(joint_of, recordings, fitted, setup.catalogue)
        background, what = weighed(lambda large, before: joined(large=large, before=before), rate)
        found = comparison_of(background, what, rate)
    names = [{(one.effect, one.place) for one in explanation.changes} for explanation in found.explanations]
    said = " / ".join(" + ".join(one.title for one in explanation.changes) for explanation in found.explanations)
    if found.unlisted:
        said = f"not listed: {found.unlisted.title}"
    if pair.change is None:
        return Outcome("", 0.0, 0.0, 0.0, False, said, found.has_changed, False, False, False)
    acting = pair.change.acting
    stands_out = visibility(background, acting)
    key = _key(acting)
    is_listed = found.unlisted is None and bool(names)
    return Outcome(
        str(acting),
        pair.change.size / pair.change.limit,
        _times(acting, found),
        stands_out,
        0.5 * stands_out**2 >= found.threshold,
        said,
        found.has_changed,
        is_listed and names[0] == {key},
        is_listed and key in names[0],
        is_listed and any(key in one for one in names),
    )


def _times(acting: Acting, found: Comparison) -> float:
    """Return the largest of the sizes of an effect as a share of what would have been found of it."""
    limits = {one.parameter: one.limit for one in found.components if (one.effect, one.place) == _key(acting)}
    null = {parameter.name: parameter.null for parameter in acting.effect.parameters}
    return max((abs(acting.values[name] - null[name]) / limit for name, limit in limits.items()), default=0.0)


def _key(acting: Acting) -> tuple[str, str]:
    return acting.effect.name, str(acting.place)


def counts_of(outcomes: Sequence[Outcome]) -> str:
    """Return the counts in one line."""
    n, named = len(outcomes), sum(one.is_named for one in outcomes)
    if not any(one.hidden for one in outcomes):
        return f"{n} pairs without a change: a change is named in {named}"
    first, among, in_set = (
        sum(getattr(one, name) for one in outcomes) for name in ("is_first", "is_among_first", "is_in_set")
    )
    return (
        f"{n} pairs with a change: named in {named}, the right cause first and alone in {first}, among the first in "
        f"{among}, in the set in {in_set}"
    )


def _listed(setup: Setup, world: MachineWorld) -> list[str]:
    names = {effect.name for effect, _ in components_in(world, setup)}
    return sorted(names - set(ANEW))


def _sized(effect: Effect, setup: Setup, rng: np.random.Generator, size: float) -> Sized | None:
    """Return an effect at a share of its absolute limit; None where that limit is beyond what is plausible."""
    places = setup.lab.places(effect, setup.compiled)
    way = Way.draw(effect, places[int(rng.integers(len(places)))], setup.compiled, rng)
    try:
        limit = detection_limit(way, setup.linear, setup.blur, setup.threshold)
    except BenchError:
        return None
    if limit > 1:
        return None
    return Sized(way.at(size * limit, setup.compiled), size * limit, limit)


def _made(world: MachineWorld, setup: Setup, later: Lab, change: Sized | None, rng: np.random.Generator) -> Pair:
    new: tuple[Acting, ...] = (change.acting,) if change else ()
    known = tuple(components_in(world, setup))
    stays = tuple(one for one, _ in surroundings_of("messy", new, known, setup.compiled, rng))
    machine = int(rng.integers(2**31))
    before = recorded(setup.lab, stays, rng, machine, world)
    after = recorded(later, (*stays, *new), rng, machine, world)
    return Pair(before, after, change)
