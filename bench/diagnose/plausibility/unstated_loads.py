"""Loads that nobody wrote down: at rest, in one pose, instruments move though no load is stated to change.

Within a visit to a pose nothing but the load changes. Where none is stated to change from one load step to the next, a
reflector stays where it was and drives hold what they held, but for noise and drift. A force sensor says so by itself
(`bench.record.rules.weights`); runs that have one are left to it.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.plausibility.drive_picture import HELD
from bench.diagnose.plausibility.mistaken import doubt
from bench.diagnose.plausibility.physical_fit import HOLDS
from bench.diagnose.plausibility.repeated import Repeated
from bench.diagnose.replay.quantities import Quantity
from bench.diagnose.replay.segments import Segment
from bench.diagnose.replay.static_segments import visits_of
from bench.diagnose.replay.world import NOMINAL
from bench.effects.places import torque_limit
from bench.record.campaign import Array
from bench.record.finding import Finding, counted
from bench.record.rules.sheet import LOAD_N
from bench.robot.compiled import CompiledRobot

SHARE = (
    0.1  # declared: of the rated force, beyond what cables, hands and hours of creep make; smaller loads are not told
)
AXES = 3  # exact: of space


@dataclass(frozen=True, eq=False)
class _Visit:
    """A visit to a pose; t states, c quantities.

    Attributes:
        run: Name of the run.
        step: Shape (t,), load step of each state.
        load: Shape (t, 3) [N], as stated.
        observed: Shape (t, c).
        compliance: Index of a reflector -> shape (3, 3) [m/N], what forces move it by the nominal model.
    """

    run: str
    step: Array
    load: Array
    observed: Array
    compliance: dict[int, Array]


def unstated_loads(repeated: Repeated) -> Iterator[Finding]:
    """Yield a doubt where a tracker or drives show loads that no column states.

    Args:
        repeated: The campaign.
    """
    shown: dict[str, str] = {}
    for visit in _visits(repeated):
        if visit.run not in shown and (words := _shown(visit, repeated.compiled, repeated.quantities)):
            shown[visit.run] = words
    if shown:
        run, words = next(iter(shown.items()))
        more = f", and likewise in {counted(len(shown) - 1, 'other run')}" if len(shown) > 1 else ""
        yield doubt(
            "load_z_n", f"{words}, in run {run!r}{more}", "was the load forgotten? write what hung in each step"
        )


def _visits(repeated: Repeated) -> Iterator[_Visit]:
    """Yield the visits of runs without a force sensor, in which there is more than one load step."""
    of_run: dict[str, list[Segment]] = {}
    for segment in repeated.segments:
        if segment.is_static:
            of_run.setdefault(segment.run, []).append(segment)
    found = []
    for run in repeated.campaign.of_kind("static"):
        if any(name.startswith("force_") for name in run.columns):
            continue
        by_label = {one.label: one for one in visits_of(run, repeated.compiled)}
        for segment in of_run.get(run.name, ()):
            groups = by_label[segment.label].groups if segment.label in by_label else ()
            step = np.array([run.columns["load_step"][rows[0]] for rows in groups])
            if len(step) == len(segment) and np.ptp(step) > 0:
                found.append((segment, step))
    every = _compliances(repeated, [segment for segment, _ in found])
    for (segment, step), compliance in zip(found, every, strict=True):
        load = segment.motion.wrench[segment.motion.read][:, :AXES]
        yield _Visit(segment.run, step, load, segment.observed, compliance)


def _compliances(repeated: Repeated, visits: list[Segment]) -> list[dict[int, Array]]:
    """Return for each visit what forces move each reflector, shape (3, 3) [m/N] each."""
    places = _places(repeated.quantities)
    if not visits or not places:
        return [{} for _ in visits]
    rated = repeated.compiled.robot.figures.rating.force_n
    pulled = [_predicted(repeated, visits, force) for force in (np.zeros(AXES), *rated * np.eye(AXES))]
    moved = np.stack([one - pulled[0] for one in pulled[1:]], axis=2) / rated  # shape (T, c, 3)
    begins = np.cumsum([0, *(len(visit) for visit in visits)])[:-1]
    return [{k: moved[i, c] for k, c in places.items()} for i in begins]


def _predicted(repeated: Repeated, visits: list[Segment], force: Array) -> Array:
    wrench = np.concatenate([force, np.zeros(AXES)])
    loaded = tuple(
        replace(one, motion=replace(one.motion, wrench=np.tile(wrench, (len(one.motion.wrench), 1)))) for one in visits
    )
    return repeated.replay(loaded, repeated.quantities).predict(NOMINAL)


def _places(quantities: tuple[Quantity, ...]) -> dict[int, list[int]]:
    """Return index of a reflector -> the places of its three axes among the quantities."""
    found: dict[int, list[int]] = {}
    for c, quantity in enumerate(quantities):
        if quantity.kind == "reflector":
            found.setdefault(quantity.index, []).append(c)
    return {k: axes for k, axes in found.items() if len(axes) == AXES}


def _shown(visit: _Visit, compiled: CompiledRobot, quantities: tuple[Quantity, ...]) -> str:
    """Return what a visit shows beyond what is stated, in words; "" of nothing."""
    rated = compiled.robot.figures.rating.force_n
    for k, axes in _places(quantities).items():
        place = visit.observed[:, axes]
        if np.isfinite(place).all() and (words := _moved(visit, f"reflector_{k + 1}", place, k, SHARE * rated)):
            return words
    for c, quantity in enumerate(quantities):
        if quantity.is_drive:
            unit = abs(compiled.torque_constant[quantity.index]) if quantity.kind == "current" else 1.0
            held = held_at_rest(compiled, quantity.index) / unit
            for before, after in _unchanged(visit):
                more = float(abs(visit.observed[after, c] - visit.observed[before, c]))
                if more > held:
                    what = f"{quantity.column} changes by {more:.3g} {quantity.unit}, more than friction holds,"
                    return f"{what} {_while_unchanged(visit, before, after)}"
    return ""


def held_at_rest(compiled: CompiledRobot, j: int) -> float:
    """Return what friction of a drive may hold at rest [Nm]: as usual, or what the model states where that is more."""
    stated = HOLDS * float(compiled.motor_coulomb[j] + compiled.link_coulomb[j])
    return max(HELD * torque_limit(compiled, j), stated)


def _moved(visit: _Visit, name: str, place: Array, reflector: int, least_n: float) -> str:
    """Return how a reflector moves without a load that is stated to change, or against all that is, in words.

    Args:
        visit: In which.
        name: Of the reflector.
        place: Shape (t, 3) [m].
        reflector: Its index.
        least_n: Least force that is told [N].
    """
    compliance = visit.compliance[reflector]
    softest = float(np.linalg.norm(compliance, 2))  # [m/N], in the direction in which most gives way
    for before, after in _unchanged(visit):
        moved = float(np.linalg.norm(place[after] - place[before]))
        if moved > least_n * softest:
            what = f"{name} moves by {1e3 * moved:.2g} mm, as under {moved / softest:.2g} N or more,"
            return f"{what} {_while_unchanged(visit, before, after)}"
    steps, stated = np.diff(place, axis=0), np.diff(visit.load, axis=0) @ compliance.T
    against = np.sum(steps * stated, axis=1) < 0
    sizes = np.linalg.norm(steps, axis=1)
    for state in range(1, len(steps)):
        moved = float(np.mean(sizes[state - 1 : state + 1]))
        if against[state - 1 : state + 1].all() and moved > least_n * softest:
            what = f"{name} moves by {1e3 * moved:.2g} mm against what is stated to hang,"
            return f"{what} into load step {visit.step[state]:g} and out of it again"
    return ""


def _while_unchanged(visit: _Visit, before: int, after: int) -> str:
    steps = f"from load step {visit.step[before]:g} to {visit.step[after]:g}"
    return f"{steps} while no load is stated to change"


def _unchanged(visit: _Visit) -> Iterator[tuple[int, int]]:
    """Yield pairs of states of different load steps, between which no load is stated to have changed."""
    same: NDArray[np.bool_] = np.linalg.norm(np.diff(visit.load, axis=0), axis=1) <= LOAD_N
    for after in range(1, len(visit.step)):
        for before in range(after - 1, -1, -1):
            if not same[before]:
                break
            if visit.step[before] != visit.step[after]:
                yield before, after
