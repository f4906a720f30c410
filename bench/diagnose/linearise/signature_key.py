"""Signatures on disk: which entry of the store holds them, and what the key of that entry is made of.

There is an entry for the nuisances, and one for every effect with all its places and shapes. Its key is a digest of all
that a simulation of its columns depends on: robot, figures, code, engine, motion, channels, and the effect itself.
"""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.diagnose.linearise.effect_source import source_of, source_of_bench
from bench.diagnose.linearise.plan import Plan
from bench.diagnose.linearise.reference_motion import Session, remember, session_of
from bench.diagnose.replay.segments import Segment
from bench.effects.effect import Effect
from bench.simulate.bare import bare_spec
from bench.store.digest import digest
from bench.store.store import Store

COLUMNS = "columns"  # name of the array in an entry


@dataclass(frozen=True)
class Group:
    """Columns that stand in one entry.

    Attributes:
        name: Of the effect, for people.
        columns: Which, among nuisances and then causes.
        key: Of the entry; empty where nobody can say when the columns are the same: they are always simulated.
    """

    name: str
    columns: tuple[int, ...]
    key: str


class StoredSignatures:
    """The columns of a campaign's signatures that the store knows, and the place for those that it does not.

    Args:
        store: On disk.
        plan: Of the columns, nuisances first.
        segments: What has to be simulated.

    Attributes:
        segments: The same, along the motion that the signatures belong to (`reference_motion`).
    """

    def __init__(self, store: Store, plan: Plan, segments: Sequence[Segment]) -> None:
        self._store = store
        self._session = session_of(segments, store)
        self.segments = self._session.segments
        self._shape = sum(len(segment) for segment in segments), len(plan.quantities)
        self._label = (
            f"{plan.compiled.robot.name}, {self._shape[0]} instants of {self._shape[1]} channels, "
            f"{segments[0].run} to {segments[-1].run}"
        )
        self._groups = stored_groups(plan, self._session)

    def read(self) -> Iterator[tuple[int, NDArray[np.floating]]]:
        """Yield what is known: column, and change of the readings, shape (T, c), nan where there is no balance."""
        for group in self._groups:
            kept = self._store.get(group.key) if group.key else None
            columns = kept.get(COLUMNS) if kept else None
            if columns is not None and columns.shape == (len(group.columns), *self._shape[::-1]):
                yield from ((at, column.T) for at, column in zip(group.columns, columns, strict=True))

    def write(self, sensitivities: NDArray[np.floating], new: Collection[int]) -> None:
        """Keep what was simulated.

        Args:
            sensitivities: All columns, shape (T, c, columns).
            new: Those that were not known.
        """
        remember(self._session, self._store, self._label)
        for group in self._groups:
            if group.key and not set(group.columns).isdisjoint(new):
                columns = sensitivities[:, :, list(group.columns)].T  # zeros of a channel side by side
                self._store.put(group.key, {COLUMNS: columns}, self._label)


def stored_groups(plan: Plan, session: Session) -> tuple[Group, ...]:
    """Return the entries of a campaign."""
    nuisances = plan.nuisances
    try:
        about = _key_of_all(plan, session)
    except TypeError:
        return ()
    weather = digest([(segment.run, segment.conditions) for segment in session.segments])
    named = [(n.name, n.recording, n.unit, n.sigma, n.said_before) for n in nuisances]
    groups = [Group("nuisances", tuple(range(len(nuisances))), digest(about, "nuisances", named))] if nuisances else []
    effects = {acting.effect.name: acting.effect for acting in plan.acting}
    for name, effect in effects.items():
        which = [i for i, acting in enumerate(plan.acting) if acting.effect.name == name]
        try:
            acting = [(plan.acting[i].place, dict(plan.acting[i].values)) for i in which]
            key = digest(about, source_of(effect), acting, weather if _feels_weather(effect) else None)
        except TypeError:
            key = ""
        groups.append(Group(name, tuple(len(nuisances) + i for i in which), key))
    return tuple(groups)


def _key_of_all(plan: Plan, session: Session) -> str:
    """Return the digest of what all columns depend on.

    The compiled model does not hold everything: effects edit the description that it was compiled from.
    """
    compiled, around = plan.compiled, plan.around
    model = np.empty(mujoco.mj_sizeModel(compiled.model), np.uint8)
    mujoco.mj_saveModel(compiled.model, None, model)
    return digest(
        source_of_bench(),
        mujoco.__version__,
        np.__version__,
        model,
        bare_spec(compiled.robot).to_xml(),
        compiled.robot.figures.model_dump_json(),
        plan.quantities,
        plan.is_strict,
        plan.simulates_torques,
        [(nuisance.name, nuisance.recording, value) for nuisance, value in around.deviations.items()],
        [(source_of(one.effect), one.place, dict(one.values)) for one in around.acting],
        session.key,
    )


def _feels_weather(effect: Effect) -> bool:
    """Whether temperatures or time enter: those that a model is edited by, or whatever may distort a reading."""
    changes_with_time = type(effect).phase is not Effect.phase
    return effect.depends_on_conditions or changes_with_time or type(effect).distort is not Effect.distort
