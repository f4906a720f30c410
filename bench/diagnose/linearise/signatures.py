"""Signatures: what each cause and each nuisance changes in the readings. It depends on what was done, not on readings.

Two campaigns of one session repeat the same motion within microns, so the derivatives of the model are the same.
They are simulated once for every stretch of a session; a study looks them up afterwards. Residuals are never shared.
"""

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass

import numpy as np

from bench.diagnose.linearise.candidates import Cause, plan_of
from bench.diagnose.linearise.changes import Digits, changes_of
from bench.diagnose.linearise.plan import Plan
from bench.diagnose.linearise.reference_motion import SAME_INSTANT, SAME_LOAD
from bench.diagnose.replay.nuisances import Nuisance
from bench.diagnose.replay.quantities import Quantity
from bench.diagnose.replay.segments import Segment
from bench.diagnose.replay.world import NOMINAL, World
from bench.executor.contract import Executor
from bench.executor.serial import SERIAL
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot
from bench.store.store import Store


@dataclass(frozen=True, eq=False)
class Sensitivities:
    """What each nuisance and each cause changes; T instants, c quantities, p nuisances.

    Attributes:
        nuisances: Shape (T, c, p), of one standard deviation each.
        causes: One for each size of each shape of each cause, in the order of `plan_of`, shape (T, c), of `Digits`;
            None: fails.
    """

    nuisances: Array
    causes: tuple[Digits | None, ...]


class Signatures:
    """Sensitivities of a session's readings; it learns each stretch when it first meets it.

    Args:
        compiled: The robot.
        quantities: What is compared.
        nuisances: What may be a little wrong.
        causes: What is looked for.
        around: World that is changed.
        store: Where signatures are kept between processes; None: nowhere.
    """

    def __init__(
        self,
        compiled: CompiledRobot,
        quantities: tuple[Quantity, ...],
        nuisances: tuple[Nuisance, ...],
        causes: Sequence[Cause],
        around: World = NOMINAL,
        store: Store | None = None,
    ) -> None:
        self.compiled = compiled
        self.quantities = quantities
        self.nuisances = nuisances
        self.causes = tuple(causes)
        self.around = around
        self.store = store
        single = [(cause, shape, size) for cause, shape in plan_of(causes) for size in cause.sizes]
        self.plan = tuple(
            cause.acting({**shape, **cause.beside(size), size.name: cause.typical(size)})
            for cause, shape, size in single
        )
        self._beside = {
            i: cause.acting({**shape, **beside})
            for i, (cause, shape, size) in enumerate(single)
            if (beside := cause.beside(size))
        }
        self._times: dict[str, Array] = {}
        self._loads: dict[str, Array] = {}  # as written down; where they differ, so do signatures
        self._lost: set[int] = set()
        self._changes: dict[str, Digits] = {}  # shape (T of the stretch, c, p + causes), nan where there is no balance

    def farther(self, reach: float) -> "Signatures":
        """Return the same of causes that go so many times as far; what is known of them stays."""
        found = copy(self)
        found.causes = tuple(cause.farther(reach) for cause in self.causes)
        return found

    @property
    def unbalanced(self) -> tuple[str, ...]:
        """Causes whose model found no balance along some motion."""
        lost = sorted(self._lost)
        return tuple(dict.fromkeys(f"{self.plan[i].effect.name} {self.plan[i].place}" for i in lost))

    def sensitivities(self, segments: Sequence[Segment], executor: Executor = SERIAL) -> Sensitivities:
        """Return the changes of a campaign's readings; stretches that were never seen are simulated first.

        Args:
            segments: The campaign.
            executor: Where to simulate.
        """
        new = tuple(segment for segment in segments if self._rows(segment) is None)
        found = self._learn(new, executor) if new else None
        if found is None or len(new) < len(segments):
            parts = []
            for segment in segments:
                rows = self._rows(segment)
                assert rows is not None
                parts.append(self._changes[segment.label][rows])
            found = np.concatenate(parts)
        p = len(self.nuisances)
        causes = (found[:, :, i] for i in range(p, found.shape[2]))
        return Sensitivities(
            found[:, :, :p].astype(np.float64), tuple(None if np.any(np.isnan(one)) else one for one in causes)
        )

    def _rows(self, segment: Segment) -> Array | None:
        """Return which known instants are those of a segment, None if some are not known."""
        known = self._times.get(segment.label)
        if known is None:
            return None
        if not np.allclose(_loads(segment), self._loads[segment.label], rtol=SAME_LOAD, atol=0.0):
            return None
        times = _instants(segment)
        nearest: Array = np.argmin(np.abs(times[:, None] - known), axis=1)
        return nearest if np.all(np.abs(known[nearest] - times) < SAME_INSTANT) else None

    def _learn(self, segments: tuple[Segment, ...], executor: Executor) -> Digits:
        """Return what was simulated or read, shape (T, c, p + causes), and keep it by stretches."""
        plan = Plan(self.compiled, self.quantities, self.nuisances, self.plan, beside=self._beside, around=self.around)
        changes = changes_of(plan, segments, self.store, executor)
        lost = np.all(np.isnan(changes[:, :, len(self.nuisances) :]), axis=(0, 1))
        self._lost |= set(np.flatnonzero(lost).tolist())
        edges = np.cumsum([len(segment) for segment in segments])[:-1]
        for segment, part in zip(segments, np.split(changes, edges), strict=True):
            self._times[segment.label], self._changes[segment.label] = _instants(segment), part
            self._loads[segment.label] = _loads(segment)
        return changes


def _instants(segment: Segment) -> Array:
    """Return when a segment was read; rests have no time of their own but their order, shape (T,)."""
    if segment.is_static:
        return np.arange(len(segment), dtype=np.float64)
    times: Array = segment.motion.time[segment.motion.read]
    return times


def _loads(segment: Segment) -> Array:
    """Return payload and mean force at the load point of a segment, shape (2,) [kg], [N]."""
    force = np.linalg.norm(segment.motion.wrench[segment.motion.read, :3], axis=1)
    return np.array([segment.conditions.payload_kg, float(np.mean(force))])
