"""What a campaign cannot show: effects that stay unseen at their largest plausible size, and what would show them.

Each such effect is simulated along the same motion, with every instrument that is not there. Where one would move by
many of its standard errors, it is named; where none would, other runs are needed.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, replace

import numpy as np

from bench.diagnose.experiment_design.new_instruments import noise_of_new
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.limits import detection_limits, least_shape_seen
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.marginal import Nuisances
from bench.diagnose.linearise.screening import Screening, screening_of, tried_of
from bench.diagnose.name.naming import Naming
from bench.diagnose.replay.quantities import AXES, Quantity
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import Segment
from bench.diagnose.replay.simulations import simulate_all
from bench.diagnose.replay.world import NOMINAL, World
from bench.errors import BenchError
from bench.executor.contract import Executor
from bench.executor.serial import SERIAL
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot

CLEAR = 10.0  # declared: norm of a change in standard errors; an instrument that is new brings errors of its own


@dataclass(frozen=True)
class UndetectableEffect:
    """An effect that a campaign would not have shown.

    Attributes:
        effect: Of the catalogue.
        places: Where.
        shown_by: Quantities of the campaign format that would show it in the same runs ("current", "reflector", ...);
            empty: it takes other runs.
        taken_by: The data show what it would do, but fitted figures may be as far off and do the same: for each place
            the one that takes most of it; empty: the data do not show it.
        below: Where a part of its shapes alone would have been seen, for each place from which value of its shape
            parameter on; empty: it would not have been seen at all.
        shape: Name of that parameter; "" where `below` is empty.
        unit: Of that.
    """

    effect: str
    places: tuple[str, ...]
    shown_by: tuple[str, ...]
    taken_by: tuple[str, ...] = ()
    below: tuple[float, ...] = ()
    shape: str = ""
    unit: str = ""


def undetectable_effects(
    compiled: CompiledRobot,
    segments: tuple[Segment, ...],
    quantities: tuple[Quantity, ...],
    screening: Screening,
    causes: Sequence[Cause],
    executor: Executor = SERIAL,
    found: Set[tuple[str, str]] = frozenset(),
    linear: LinearisedModel | None = None,
    beside: World = NOMINAL,
) -> tuple[UndetectableEffect, ...]:
    """Return what a campaign cannot show.

    Args:
        compiled: The nominal robot.
        segments: The campaign.
        quantities: That it has.
        screening: Of everything, against the nominal model, or that of `beside`.
        causes: That were looked for.
        executor: Where to simulate.
        found: Effect and place of what was found: the nominal robot may hide an effect that stands out beside others.
        linear: The campaign, with the figures that are fitted; None: nobody asks which of them take an effect.
        beside: What acts besides.
    """
    seen = _seen(screening, causes)
    partly = tuple(_partly_seen(screening, [one for one in causes if one.key in seen and one.key not in found]))
    unseen = [cause for cause in causes if cause.key not in seen and cause.key not in found]
    more = _absent(compiled, quantities)
    if not unseen:
        return partly
    shown: list[tuple[str, ...]] = [()] * len(unseen)
    if more:
        replay = Replay(compiled, segments, more)
        nominal = replay.predict(beside)
        sigma = np.array([noise_of_new(quantity, compiled) for quantity in more])
        largest = [cause.acting({s.name: s.null + s.high for s in cause.sizes}) for cause in unseen]
        worlds = [replace(beside, acting=(*beside.acting, acting)) for acting in largest]
        for i, predicted in enumerate(simulate_all(replay, worlds, executor)):
            if not isinstance(predicted, BenchError):
                shown[i] = _clear(more, (predicted - nominal) / sigma)
    taken = _taken(screening, linear, unseen) if linear else {}
    grouped: dict[tuple[str, tuple[str, ...], bool], list[Cause]] = {}
    for cause, by in zip(unseen, shown, strict=True):
        grouped.setdefault((cause.effect.name, by, cause.key in taken), []).append(cause)
    wholly = (
        UndetectableEffect(
            effect,
            tuple(str(cause.place) for cause in mine),
            by,
            tuple(taken[cause.key] for cause in mine if is_taken),
        )
        for (effect, by, is_taken), mine in grouped.items()
    )
    return (*wholly, *partly)


def undetectable_beside(
    compiled: CompiledRobot,
    segments: tuple[Segment, ...],
    quantities: tuple[Quantity, ...],
    naming: Naming,
    causes: Sequence[Cause],
    beside: World,
    executor: Executor = SERIAL,
) -> tuple[UndetectableEffect, ...]:
    """Return what a campaign cannot show of what has a place beside findings alone: friction that was found may rise.

    Args:
        compiled: The nominal robot.
        segments: The campaign.
        quantities: That it has.
        naming: What was found.
        causes: That were looked for on the nominal robot.
        beside: The best model.
        executor: Where to simulate.
    """
    known = {cause.key for cause in causes}
    entries = [one for one in naming.tried.entries if one.cause]
    new = [one for one in entries if one.cause and one.cause.key not in known | naming.found]
    if not new:
        return ()
    findings = [one for one in entries if one.cause and one.cause.key in naming.found]
    columns_of = naming.tried.columns_of
    background = [naming.linear.jacobian, *(columns_of(one) * one.what.plausible for one in findings)]
    tried = tried_of(replace(one.what, columns=columns_of(one)) for one in new)
    marginal = Nuisances(np.concatenate(background, axis=1)).products(naming.linear.white, tried.columns)
    screening = screening_of(naming.linear, marginal, tried.entries, naming.screening.threshold)
    every = tuple({one.cause.key: one.cause for one in new if one.cause}.values())
    return undetectable_effects(
        compiled, segments, quantities, screening, every, executor, naming.found, naming.linear, beside
    )


def _partly_seen(screening: Screening, causes: Iterable[Cause]) -> Iterator[UndetectableEffect]:
    """Yield the causes of whose shapes the lower ones would not have been seen, where a known motion shows them."""
    grouped: dict[tuple[str, str, str], list[tuple[Cause, float]]] = {}
    for cause in causes:
        if cause.effect.motion and len(cause.shapes) == 1:
            (shape,), least = cause.shapes, least_shape_seen(screening, cause)
            if shape.low < least < np.inf:
                grouped.setdefault((cause.effect.name, shape.name, shape.unit), []).append((cause, least))
    for (effect, name, unit), mine in grouped.items():
        places, below = tuple(str(cause.place) for cause, _ in mine), tuple(least for _, least in mine)
        yield UndetectableEffect(effect, places, (), below=below, shape=name, unit=unit)


def _seen(screening: Screening, causes: Iterable[Cause], information: Array | None = None) -> set[tuple[str, str]]:
    """Return the causes that would have been found at a plausible size, with the information of `detection_limits`."""
    largest: Mapping[tuple[str, str, str], float] = {
        (*cause.key, size.name): size.high for cause in causes for size in cause.sizes
    }
    limits = detection_limits(screening, information)
    sizes = ((one, largest.get((one.effect, one.place, one.parameter), -np.inf)) for one in limits)
    return {(one.effect, one.place) for one, high in sizes if one.limit <= high}


def _taken(screening: Screening, linear: LinearisedModel, unseen: Sequence[Cause]) -> dict[tuple[str, str], str]:
    """Return the causes that fitted figures hide -> name of the one that takes most of it.

    The readings show them at a plausible size where all figures are right, and no more where these may be off.
    """
    squares = screening.marginal.columns.squares
    shown = _seen(screening, unseen, squares)
    found: dict[tuple[str, str], str] = {}
    for entry in screening.entries:
        if entry.cause and entry.cause.key in shown:
            clearest = entry.columns[np.argmax(squares[entry.columns])]
            found.setdefault(entry.cause.key, str(linear.nuisances[screening.takes_most[clearest]]))
    return found


def _absent(compiled: CompiledRobot, quantities: tuple[Quantity, ...]) -> tuple[Quantity, ...]:
    """Return what instruments could read that the campaign has not; a drive's torque counts as its current."""
    there = {("current" if q.is_drive else q.kind, q.index, q.axis) for q in quantities}
    every = []
    for j, is_slide in enumerate(compiled.is_slide):
        unit = "m" if is_slide else "rad"
        every.append(Quantity(f"current_{j + 1}_a", "current", "A", j))
        every.append(Quantity(f"q_link_{j + 1}_{unit}", "q_link", unit, j))
    for k in range(len(compiled.robot.figures.reflectors)):
        every += [Quantity(f"reflector_{k + 1}_{a}_m", "reflector", "m", k, i) for i, a in enumerate(AXES)]
    every += [Quantity(f"force_{a}_n", "force", "N", axis=i) for i, a in enumerate(AXES)]
    every += [Quantity(f"moment_{a}_nm", "moment", "Nm", axis=i) for i, a in enumerate(AXES)]
    if compiled.counterbalance is not None and compiled.robot.figures.instruments.pressure is not None:
        every.append(Quantity("gas_pressure_pa", "gas_pressure", "Pa"))
    kinds = {kind for kind, _, _ in there if kind not in ("current", "q_link")}  # one reflector is a tracker
    return tuple(q for q in every if (q.kind, q.index, q.axis) not in there and q.kind not in kinds)


def _clear(quantities: tuple[Quantity, ...], change: Array) -> tuple[str, ...]:
    """Return the kinds of instruments that a change, in standard errors, would show."""
    square: dict[str, float] = {}
    for c, quantity in enumerate(quantities):
        square[quantity.kind] = square.get(quantity.kind, 0.0) + float(np.sum(change[:, c] ** 2))
    return tuple(kind for kind, size in square.items() if size > CLEAR**2)
