"""Columns that must agree because they tell of the same thing: sign, order of the joints, unit."""

from collections.abc import Iterator, Mapping
from math import pi

import numpy as np

from bench.record.campaign import Array
from bench.record.finding import Finding
from bench.record.rules.alignment import least_misfit
from bench.record.rules.sheet import LOAD_N, TRAVEL, Sheet
from bench.record.units import STANDARD_GRAVITY

MANY = 10  # rows; fewer may agree by chance
CLEAR = 0.1  # another explanation must leave a tenth of the difference that the column's own one leaves
WRONG = 0.3  # part of the movement that the column's own explanation must miss; real servos miss up to 0.2
CORRELATED = 0.95
NEAR = 0.05  # of a factor between two units; gain errors of sensors are smaller, no two factors are closer

ANGLES: Mapping[str, Mapping[float, str]] = {
    "rad": {180 / pi: "degrees?", pi / 180: "degrees in the other?"},
    "m": {1e3: "millimetres?", 1e-3: "millimetres in the other?"},
}
FORCES: Mapping[float, str] = {
    STANDARD_GRAVITY: "kilograms in the load?",
    1 / STANDARD_GRAVITY: "kilograms in the sensor?",
    1e3: "kilonewtons in the load?",
    1e-3: "kilonewtons in the sensor?",
}


def encoders_follow(sheet: Sheet) -> Iterator[Finding]:
    """Each motor follows its own command, in its own direction, and a secondary encoder its motor."""
    for column, values in sheet.columns("q_motor", "q_link"):
        source = "q_cmd" if column.channel.quantity == "q_motor" else "q_motor"
        own = sheet.joint(column.index, source)
        frozen = [values] if own is None or source == "q_cmd" else [values, own[1]]  # encoders; told elsewhere
        if own is None or any(np.ptp(one) == 0 for one in frozen):
            continue
        own_misfit, moved = float(np.std(values - own[1])), float(max(np.std(values), np.std(own[1])))
        both_move = sheet.moves(own[0].name) and sheet.moves(column.name)
        if not both_move and own_misfit <= TRAVEL[column.unit]:
            continue
        if own_misfit <= WRONG * moved:
            yield from _in_one_unit(sheet, column.name, own[0].name, ANGLES[column.unit])
            continue
        misfits = {
            (sign, other.name): float(np.std(values - sign * reference))
            for other, reference in sheet.columns(source)
            for sign in (1, -1)
            if sheet.moves(other.name)
        }
        (sign, best), misfit = min(misfits.items(), key=lambda item: item[1], default=((1, own[0].name), own_misfit))
        if misfit < CLEAR * own_misfit:
            message = f"follows {'minus ' if sign < 0 else ''}{best}, not {own[0].name}"
            remedy = "look at the order of the joints" if best != own[0].name else "turn the sign of one of them"
            yield sheet.doubt(column.name, message, remedy)
        elif in_another_unit := list(_in_one_unit(sheet, column.name, own[0].name, ANGLES[column.unit])):
            yield from in_another_unit
        elif own_misfit >= np.std(values):  # it would be nearer to any constant
            message = f"does not follow {own[0].name}: misses it by more than it moves itself"
            yield sheet.warning(column.name, message, "is each the angle at every instant, of this joint?")
        elif (left := _left_by_shifts(sheet, values, own[1])) > max(WRONG * moved, TRAVEL[column.unit]):
            message = f"does not follow {own[0].name}: misses it by {left / moved:.0%} of the movement, at any delay"
            yield sheet.warning(column.name, message, "is each the angle at every instant, of this joint?")


def _left_by_shifts(sheet: Sheet, values: Array, source: Array) -> float:
    """Return what an angle misses another one by at the best delay, as a standard deviation; at rest there is none."""
    time = sheet.get("time_s")
    if sheet.run.kind != "motion" or time is None or len(time) < MANY:
        return float(np.std(values - source))
    return least_misfit(values, source, float(np.median(np.diff(time))))


def encoders_rest_at_their_command(sheet: Sheet) -> Iterator[Finding]:
    """At rest a motor is where it was commanded to be, to within less than what counts as travel."""
    if sheet.run.kind != "static":
        return
    for column, values in sheet.columns("q_motor"):
        command = sheet.joint(column.index, "q_cmd")
        off = np.median(values - command[1]) if command and len(values) else 0.0
        if command and abs(off) > TRAVEL[column.unit]:
            message = f"rests {off:+.3g} {column.unit} beside {command[0].name}"
            yield sheet.warning(column.name, message, "have both the same zero? else the servo gives, or was settling")


def sensors_agree(sheet: Sheet) -> Iterator[Finding]:
    """Each force sensor feels the load, a current makes torque in its own direction, and a weight pulls down."""
    for axis in "xyz":
        force, load = f"force_{axis}_n", f"load_{axis}_n"
        if not {force, load} <= set(sheet.run.columns):
            continue
        # of either: in kilonewtons no load changes by 10
        if max(np.ptp(sheet.run.columns[name]) for name in (force, load)) > LOAD_N:
            yield from _in_one_direction(sheet, force, load)
            yield from _in_one_unit(sheet, force, load, FORCES)
    for column, _ in sheet.columns("tau_motor"):
        if (current := f"current_{column.index}_a") in sheet.run.columns:
            yield from _in_one_direction(sheet, column.name, current)
    if not any(True for _ in sheet.columns("load")):
        return
    load_force = sheet.run.load_wrench()[:, :3]
    is_vertical = bool(np.all(load_force[:, :2] == 0))
    if is_vertical and load_force.min(initial=0) >= 0 and load_force.max(initial=0) > LOAD_N:
        yield sheet.doubt("load_z_n", "all loads pull straight up", "a weight is negative: z points up")


def _in_one_direction(sheet: Sheet, name: str, reference: str) -> Iterator[Finding]:
    if _correlation(sheet.run.columns[name], sheet.run.columns[reference]) < -CORRELATED:
        yield sheet.doubt(name, f"runs against {reference}", "turn the sign of one of them")


def _in_one_unit(sheet: Sheet, name: str, reference: str, factors: Mapping[float, str]) -> Iterator[Finding]:
    values, references = sheet.run.columns[name], sheet.run.columns[reference]
    own, other = float(np.std(values)), float(np.std(references))
    ratio = own / other if other > 0 else 0.0
    for factor, guess in factors.items():
        if abs(ratio / factor - 1) < NEAR and _correlation(values, references) > CORRELATED:
            yield sheet.error(name, f"is {ratio:.4g} times {reference}", f"{guess} give both in SI units")


def _correlation(first: Array, second: Array) -> float:
    """Return the correlation coefficient; 0 where there is none, or too few rows to tell."""
    if len(first) < MANY or np.ptp(first) == 0 or np.ptp(second) == 0:
        return 0.0
    a, b = first - first.mean(), second - second.mean()
    norms = float(np.sqrt(np.sum(a * a)) * np.sqrt(np.sum(b * b)))  # no BLAS: its threads cost more than they give
    return float(np.sum(a * b)) / norms if norms > 0 else 0.0
