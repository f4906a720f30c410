"""What nuisances and effects change in the readings of a campaign: kept on disk, to first order, or simulated."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.linearise.first_order import FirstOrder
from bench.diagnose.linearise.plan import Plan
from bench.diagnose.linearise.signature_key import StoredSignatures
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import Segment
from bench.diagnose.replay.simulations import simulate_all
from bench.diagnose.replay.world import World
from bench.effects.own import EffectError
from bench.errors import BenchError
from bench.executor.contract import Executor
from bench.executor.serial import SERIAL
from bench.record.campaign import Array
from bench.simulate.instruments import is_slanting
from bench.store.store import Store

Digits = NDArray[np.float32]
DIGITS = np.float32  # kept of a signature: balances are found within 1e-6, and half the memory serves twice the causes


def changes_of(
    plan: Plan, segments: tuple[Segment, ...], store: Store | None = None, executor: Executor = SERIAL
) -> Digits:
    """Return what each of a plan changes, nuisances first, shape (T, c, p + acting); nan where there is no balance.

    Args:
        plan: What is changed.
        segments: Of the campaign, T instants in all.
        store: Where changes are kept between processes; None: nowhere.
        executor: Where to simulate.

    Raises:
        ConvergenceError, RobotError: The world that is changed has no balance, or a nuisance leaves a strict plan none.
        EffectError: An effect of the user's own fails.
    """
    stored = StoredSignatures(store, plan, segments) if store else None
    rows = sum(len(segment) for segment in segments)
    changes: Digits = np.empty((rows, len(plan.quantities), len(plan)), dtype=DIGITS)
    new = set(range(len(plan)))
    for i, column in stored.read() if stored else ():
        changes[:, :, i] = column
        new.remove(i)
    if new:
        _simulate(changes, sorted(new), plan, stored.segments if stored else segments, executor)
    if stored and new:
        stored.write(changes, new)
    return changes


def _simulate(
    changes: Digits, which: Sequence[int], plan: Plan, segments: tuple[Segment, ...], executor: Executor
) -> None:
    """Write some columns of the changes; nan where there is no balance."""
    replay = Replay(plan.compiled, segments, plan.quantities)
    off, acting = plan.around.deviations, plan.around.acting
    p = len(plan.nuisances)
    first_order = None if plan.simulates_torques else FirstOrder(replay, plan.around)
    worlds: dict[int, World] = {}
    is_pulled = any(np.any(is_slanting(segment.motion.wrench)) for segment in segments)
    for i in which:
        if i < p:
            nuisance = plan.nuisances[i]
            if nuisance.on_wrench and not is_pulled:
                changes[:, :, i] = 0.0
                continue
            worlds[i] = World({**off, nuisance: off.get(nuisance, 0.0) + nuisance.sigma}, acting)
            continue
        change = first_order.change(plan.acting[i - p]) if first_order else None
        if change is None:
            worlds[i] = World(off, (*acting, plan.acting[i - p]))
        else:
            changes[:, :, i] = change
    nominal = replay.predict(plan.around)
    grounds = _grounds(replay, plan, executor)
    for i, result in zip(worlds, simulate_all(replay, list(worlds.values()), executor), strict=True):
        if isinstance(result, BenchError):
            if (i < p and plan.is_strict) or isinstance(result, EffectError):
                raise result
            changes[:, :, i] = np.nan
        else:
            changes[:, :, i] = result - grounds.get(i - p, nominal)


def _grounds(replay: Replay, plan: Plan, executor: Executor) -> dict[int, Array]:
    """Return what instruments show with what acts beside, by its place in the plan; nan: no balance."""
    distinct = {(one.effect.name, one.place, *one.values.items()): one for one in plan.beside.values()}
    off, acting = plan.around.deviations, plan.around.acting
    worlds = [World(off, (*acting, one)) for one in distinct.values()]
    lost = np.full(replay.shape, np.nan)
    found = simulate_all(replay, worlds, executor)
    shown = {key: lost if isinstance(one, BenchError) else one for key, one in zip(distinct, found, strict=True)}
    return {i: shown[one.effect.name, one.place, *one.values.items()] for i, one in plan.beside.items()}
