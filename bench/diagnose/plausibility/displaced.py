"""Trackers and gauges that are not where the nominal model has them, by far more than any defect of a robot."""

from collections.abc import Iterator, Mapping
from itertools import permutations, product

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.plausibility.late_channels import SURE, as_if_in_time, late_reflectors
from bench.diagnose.plausibility.mistaken import doubt
from bench.diagnose.plausibility.physical_fit import FAR_BETTER
from bench.diagnose.plausibility.unlike_gas import unlike_gas
from bench.diagnose.replay.instants import run_of_each
from bench.diagnose.replay.quantities import AXES
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.world import NOMINAL
from bench.record.campaign import Array
from bench.record.finding import Finding
from bench.record.rules.stuck import AT_EXTREME

FAR = 0.1  # assumed: [m]; a calibrated arm errs by millimetres, a nominal one by a centimetre
# assumed: [m]; beyond a nominal arm, and everything listed (a frame by 0.5 mm, a jump of it by 5 mm)
AWAY = 0.01
STATED = 10.0  # assumed: times the stated uncertainty of a place of a joint, if that is more
# assumed: twenty times the scale that a wrong refractive index gives a tracker; a nominal arm is longer by less
SCALE = 0.01
CLOSE = FAR_BETTER**0.5  # derived: of a distance, whose square that is
LENGTHS: Mapping[float, str] = {1e3: "millimetres", 100.0: "centimetres", 39.37: "inches", 3.281: "feet", 1e-3: "km"}
PRESSURES: Mapping[float, str] = {1e-6: "MPa", 1e-5: "bar", 1e-3: "kPa"}
GAS = 3.0  # assumed: times the nominal pressure, or a part of it: gas lost, warmed, or overfilled
LOOK = (
    "look at the tracker's frame, whether it was moved, the prism constant, the places of the reflectors, and zeros of "
    "the joints"
)
STANDS = 0.25  # assumed: of a run; a channel that is late may repeat its first reading for a while


def displaced(replay: Replay) -> Iterator[Finding]:
    """Yield a doubt for each reflector and for the gauge that reads what the nominal model cannot make of it."""
    nominal = replay.predict(NOMINAL)
    observed = replay.observed
    late = [one for one in late_reflectors(replay) if one.delay.value > SURE * one.delay.sigma]
    in_time = as_if_in_time(replay, late, observed, nominal)
    told_as_late = {one.column for one in late if one.explains_most}
    stopped = _stopped(replay, observed, nominal)
    for name, where in stopped.items():
        message = f"does not change in {where} while the model's does"
        yield doubt(name, message, "frozen? saturated? look at its recording")
    for k in sorted({q.index for q in replay.quantities if q.kind == "reflector"}):
        columns = [c for c, q in enumerate(replay.quantities) if q.kind == "reflector" and q.index == k]
        names, axes = [replay.quantities[c].column for c in columns], [replay.quantities[c].axis for c in columns]
        rows = np.all(np.isfinite(observed[:, columns]), axis=1)
        if np.any(rows) and not stopped.keys() & set(names):
            blurred = STATED * replay.compiled.robot.figures.uncertainty.geometry_m
            seen, there = observed[rows][:, columns], nominal[rows][:, columns]
            throughout = list(_reflector(names[0], axes, seen, there, blurred))
            most = FAR if names[0] in told_as_late else _most(replay)
            throughout = throughout or list(_away(names, in_time[rows][:, columns], nominal[rows][:, columns], most))
            yield from throughout or _in_one_run(replay, columns, rows, in_time, nominal, most)
    for c, quantity in enumerate(replay.quantities):
        rows = np.isfinite(observed[:, c])
        if quantity.kind == "gas_pressure" and np.any(rows) and quantity.column not in stopped:
            seen, there, run_of = observed[rows, c], nominal[rows, c], run_of_each(replay.segments)[rows]
            found = list(_pressure(seen, there)) or list(_pressure_in_one_run(run_of, seen, there))
            yield from found or unlike_gas(replay, run_of, seen, there)


def _stopped(replay: Replay, observed: Array, nominal: Array) -> dict[str, str]:
    """Return columns that repeat one number while the model's goes far -> in which run, in words."""
    gauge = replay.compiled.robot.figures.instruments.pressure
    step = GAS * gauge.resolution_pa if gauge else np.inf  # one step of pressures that are as low as gas may have
    far = {"reflector": _most(replay), "gas_pressure": step}
    run_of = run_of_each(replay.segments)
    found: dict[str, str] = {}
    for run in dict.fromkeys(segment.run for segment in replay.segments):
        for c, quantity in enumerate(replay.quantities):
            rows = (run_of == run) & np.isfinite(observed[:, c])
            edges = np.flatnonzero(np.diff(observed[rows, c])) + 1
            parts = np.split(nominal[rows, c], edges)
            usual = float(np.median([len(part) for part in parts]))  # an instrument may be slower than its log
            for k, still in enumerate(parts):
                is_long = len(still) > STANDS * rows.sum() or (k > 0 and len(still) >= AT_EXTREME * usual)
                if is_long and np.ptp(still) > far.get(quantity.kind, np.inf):
                    found.setdefault(quantity.column, f"run {run!r}" if k == 0 else f"a part of run {run!r}")
    for c, quantity in enumerate(replay.quantities):
        rows = np.isfinite(observed[:, c])
        if quantity.kind == "gas_pressure" and len(set(run_of[rows].tolist())) > 1:
            span, moves = np.ptp(observed[rows, c]), np.ptp(nominal[rows, c])
            if span == 0 and moves > step:
                found.setdefault(quantity.column, "any run")
    return found


def _reflector(name: str, axes: list[int], observed: Array, nominal: Array, blurred: float) -> Iterator[Finding]:
    """Yield a doubt for a reflector that has another unit, other axes or another scale than the model, or is elsewhere.

    Args:
        name: Of its first column.
        axes: That are read.
        observed: Shape (t, axes) [m].
        nominal: The same of the model.
        blurred: By how much places of the model may be off [m].
    """
    off = _off(observed, nominal)
    if off < FAR:
        yield from _scaled(name, observed, nominal, blurred)
        return
    factor = min(LENGTHS, key=lambda factor: _off(observed / factor, nominal))
    if _off(observed / factor, nominal) < CLOSE * min(off, _off(nominal, np.zeros(3))):
        message = f"is {factor:g} times as far out as the model has it"
        yield doubt(name, message, f"{LENGTHS[factor]}? give metres")
        return
    if turned := _turned(axes, observed, nominal):
        yield doubt(name, turned, "look at the axes of the base frame")
        return
    advice = "is it in the base frame? else look at zero, sign and order of the joints"
    yield doubt(name, f"lies {off:.2g} m from where the model has it", advice)


def _turned(axes: list[int], observed: Array, nominal: Array) -> str:
    """Return which axes of the model are read as which, in words; "" if none in another order or sign fit better."""
    every = product(permutations(range(len(axes))), product((1.0, -1.0), repeat=len(axes)))
    left, order, signs = min((_off(observed[:, order] * signs, nominal), order, signs) for order, signs in every)
    if left >= CLOSE * _off(observed, nominal):
        return ""
    right = ", ".join(f"{'-' if s < 0 else ''}{AXES[axes[i]]}" for i, s in zip(order, signs, strict=True))
    return f"the model's {', '.join(AXES[axis] for axis in axes)} are read as {right}"


def _scaled(name: str, observed: Array, nominal: Array, blurred: float) -> Iterator[Finding]:
    """Yield a doubt for a reflector whose travel is a multiple of the model's that neither tracker nor arm explains."""
    seen, there = observed - observed.mean(axis=0), nominal - nominal.mean(axis=0)
    spread = float(np.sqrt(np.mean(np.sum(there**2, axis=1))))
    factor = float(np.sum(seen * there) / np.sum(there**2)) if spread > 0 else 1.0
    off = abs(factor - 1)
    left, before = (float(np.sum((seen - f * there) ** 2)) for f in (factor, 1.0))
    if off > SCALE and off * spread > blurred and left < FAR_BETTER * before:
        message = f"travels {factor:.3f} times as far as the model has it"
        yield doubt(name, message, "look at the tracker's unit and scale; refraction makes 0.0005 at most")


def _away(names: list[str], observed: Array, nominal: Array, most: float) -> Iterator[Finding]:
    """Yield a warning for a reflector that is farther off than any listed cause puts it, and near enough to be used."""
    off = _off(observed, nominal)
    if off > most:
        by = np.median(observed - nominal, axis=0)
        is_shifted = _off(observed, nominal + by) < CLOSE * off
        shift = ", ".join(f"{1e3 * one:+.0f} mm in {name[-3]}" for name, one in zip(names, by, strict=True))
        where = f", everywhere by {shift}" if is_shifted else ""
        message = (
            f"lies {1e3 * off:.0f} mm from where the model has it{where}; nothing that is listed puts it so far off"
        )
        yield Finding("warning", "all runs", None, names[0], message, LOOK)


def _most(replay: Replay) -> float:
    """Return how far a reflector of a robot may be from where its model has it [m]."""
    return max(AWAY, STATED * replay.compiled.robot.figures.uncertainty.geometry_m)


def _in_one_run(
    replay: Replay, columns: list[int], rows: NDArray[np.bool_], seen: Array, predicted: Array, most: float
) -> Iterator[Finding]:
    """Yield a doubt for the run in which a reflector is farthest off: a mirrored joint may stand at zero elsewhere."""
    name, axes = replay.quantities[columns[0]].column, [replay.quantities[c].axis for c in columns]
    observed, nominal = seen[:, columns], predicted[:, columns]
    run_of = run_of_each(replay.segments)
    runs = dict.fromkeys(run_of[rows].tolist())
    off = {run: _off(observed[here], nominal[here]) for run in runs if np.any(here := rows & (run_of == run))}
    worst = max(off, key=lambda run: off[run])
    if len(off) == 1:  # all there is, and was looked at
        return
    if off[worst] >= FAR:
        here = rows & (run_of == worst)
        far = here & (np.linalg.norm(np.where(here[:, None], observed - nominal, 0.0), axis=1) >= FAR)
        part = f"in run {worst!r}" if np.all(far[here]) else f"in a part of run {worst!r}"
        if turned := _turned(axes, observed[far], nominal[far]):
            yield doubt(name, f"{turned} {part}, and not in all others", "look at the axes of the base frame there")
            return
        if other := _exchanged(replay, name, observed[far], predicted[far]):
            message = f"lies where the model has {other} {part}, and not in all others"
            yield doubt(name, message, "were the two exchanged there? exchange their columns in these rows")
            return
        message = f"lies {off[worst]:.2g} m from where the model has it in run {worst!r}, and not in all others"
        yield doubt(name, message, "look at zero and sign of the joints that move there")
    elif off[worst] > most:
        message = f"lies {1e3 * off[worst]:.0f} mm from where the model has it in run {worst!r}, and not in all others"
        yield Finding("warning", "all runs", None, name, message, LOOK)


def _exchanged(replay: Replay, name: str, observed: Array, predicted: Array) -> str:
    """Return the reflector, in words, in whose place another one is read; "" if it is in that of none.

    Args:
        replay: What is read.
        name: Of the first column of the reflector that is not where it should be.
        observed: Shape (t, axes) [m], of it.
        predicted: Shape (t, channels), all that the model says.
    """
    places: dict[int, list[int]] = {}
    for c, quantity in enumerate(replay.quantities):
        if quantity.kind == "reflector":
            places.setdefault(quantity.index, []).append(c)
    alike = {k: columns for k, columns in places.items() if len(columns) == observed.shape[1]}
    off = {k: _off(observed, predicted[:, columns]) for k, columns in alike.items()}
    own = next(k for k, columns in alike.items() if replay.quantities[columns[0]].column == name)
    nearest = min(off, key=lambda k: off[k])
    return f"reflector {nearest + 1}" if off[nearest] < CLOSE * off[own] else ""


def _off(observed: Array, nominal: Array) -> float:
    """Return the median distance [m]."""
    return float(np.median(np.linalg.norm(observed - nominal, axis=1)))


def _pressure(observed: Array, nominal: Array) -> Iterator[Finding]:
    ratio = float(np.median(observed) / np.median(nominal))
    if not is_of_gas(ratio):
        remedy = f"{pressure_unit(ratio)}? give pascals above ambient"
        yield doubt("gas_pressure_pa", f"is {ratio:.2g} times what the model has", remedy)


def is_of_gas(ratio: float) -> bool:
    """Return whether gas may have a pressure that is so many times the model's."""
    return 1 / GAS < ratio < GAS


def pressure_unit(ratio: float) -> str:
    """Return the unit in which a pressure that is so many times the model's may have been written."""
    return next((word for factor, word in PRESSURES.items() if factor / 2 < ratio < 2 * factor), "other unit")


def _pressure_in_one_run(run_of: NDArray[np.str_], observed: Array, nominal: Array) -> Iterator[Finding]:
    """Yield a doubt for the runs in which a gauge reads what gas cannot be, while it reads the gas in others."""
    ratio = {run: float(np.median(observed[run_of == run] / nominal[run_of == run])) for run in dict.fromkeys(run_of)}
    if far := [run for run, one in ratio.items() if not is_of_gas(one)]:
        more = f" and {len(far) - 1} more" if len(far) > 1 else ""
        message = f"is {ratio[far[0]]:.2g} times what the model has in run {str(far[0])!r}{more}, and not in all others"
        yield doubt("gas_pressure_pa", message, "was the gauge connected? leave the column out there")
