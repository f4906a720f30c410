"""Values that are only possible in another unit than the one in the column's name."""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import inf, pi

import numpy as np

from bench.record.campaign import Array
from bench.record.channels import Column
from bench.record.finding import Finding
from bench.record.possible import (
    BELOW_ZERO,
    FILLED,
    MAX_MASS,
    MAX_PRESSURE,
    MIN_PRESSURE,
    PRESSURES,
    TEMPERATURES,
    what_a_temperature_may_be,
)
from bench.record.rules.sheet import Sheet, rows_where
from bench.record.turns import as_offset, in_words, whole_turns

# A joint of an arm turns by at most two rounds either way; the wrist axes with the widest range have 720 deg.
MAX_ANGLE = 4 * pi
MAX_LENGTH = 100.0  # [m]; no arm stands on a longer track, and no tracker sees a reflector much further away
MAX_CURRENT = 1000.0  # [A]; drives of the heaviest arms stay below 200
MAX_FORCE = 1e6  # [N], [Nm]; the strongest arms carry 2.3 t, 4 m out

DEGREE = pi / 180
MILLI = 1e-3
ROUNDED = 1e-3  # of a factor for degrees or millimetres that somebody rounded
SPOILT = "lost or spoilt? leave such rows out"
FAR = 1.5  # times the joint's own limit; model limits and soft limits differ by less
BESIDE = {"rad": 0.02, "m": 0.005}  # what zero offsets and end stops explain


def angles(sheet: Sheet) -> Iterator[Finding]:
    """Joint coordinates lie in the limits of the robot, or, if it is not known, of any robot."""
    for column, values in sheet.columns("q_cmd", "q_motor", "q_link"):
        lower, upper = sheet.arm.limits[column.index - 1] if sheet.arm else (-inf, inf)
        bound = MAX_LENGTH if column.is_slide else MAX_ANGLE
        if sheet.arm:
            bound = FAR * max(abs(lower), abs(upper))
        beside = BESIDE[column.unit]
        if rows := sheet.rows_outside(column.name, -bound, bound):
            is_reduced = abs(sheet.factors.get(column.name, 1.0)) <= MILLI * (1 + ROUNDED)
            guess = "counts of an encoder? look at its factor" if is_reduced else "millimetres? multiply by 0.001"
            if not column.is_slide:
                turns = _turns(sheet, column, values)
                is_alone = turns and _others_fit(sheet, column)
                guess = "" if is_alone else _what_an_angle_may_be(sheet, column, float(np.max(np.abs(values))), bound)
                guess = "; ".join(filter(None, (_of_turns(turns), guess)))
                if 2 * len(rows) < len(values):  # the unit of a channel is that of most of its rows
                    guess = SPOILT if _are_single(rows) else f"{SPOILT}; {guess}"
            message = f"{values[rows[0] - 1]:g} {column.unit} is no position of this joint"
            yield sheet.error(column.name, message, guess, rows)
        elif rows := sheet.rows_outside(column.name, lower - beside, upper + beside):
            message = f"leaves the joint's limits, {lower:g} to {upper:g} {column.unit}"
            turns = 0 if column.is_slide else _turns(sheet, column, values)
            remedy = "look at zero position, sign and order of the joints"
            yield sheet.doubt(column.name, message, "; ".join(filter(None, (_of_turns(turns), remedy))), rows)


def _are_single(rows: Sequence[int]) -> bool:
    """Whether no two rows, in rising order, are neighbours."""
    return all(after - before > 1 for before, after in pairwise(rows))


def _turns(sheet: Sheet, column: Column, values: Array) -> int:
    """Return how many whole turns the counter of a hinge is on; 0 of a robot that is not known."""
    if sheet.arm is None:
        return 0
    lower, upper = sheet.arm.limits[column.index - 1]
    return whole_turns(values[np.isfinite(values)], lower, upper, BESIDE["rad"])


def _of_turns(turns: int) -> str:
    return f"{in_words(turns)}? add the offset {as_offset(turns):.8g}" if turns else ""


def _others_fit(sheet: Sheet, column: Column) -> bool:
    """Return whether the other hinges, two at least, are in range, so that the unit of all of them is right."""
    others = [other for other, _ in sheet.columns(column.channel.quantity) if other != column and not other.is_slide]
    bounds = [FAR * max(map(abs, sheet.arm.limits[other.index - 1])) for other in others] if sheet.arm else []
    return len(bounds) > 1 and all(sheet.within(o.name, -b, b) for o, b in zip(others, bounds, strict=True))


def _what_an_angle_may_be(sheet: Sheet, column: Column, largest: float, bound: float) -> str:
    """Return advice for an angle that reaches too far: each way of reading it that brings it into range."""
    factor = abs(sheet.factors.get(column.name, 1.0))
    was_degrees = factor <= DEGREE * (1 + ROUNDED)
    gear_ratios = sheet.arm.gear_ratios if sheet.arm else ()
    stated = gear_ratios[column.index - 1] if column.index <= len(gear_ratios) else None
    of_figures = f"the gear ratio of the robot's figures, {stated:g}" if stated else ""
    ways = []
    if not was_degrees and largest * DEGREE <= bound:
        ways.append("degrees? multiply by pi / 180")
    if stated and largest / stated <= bound:
        ways.append(f"an angle of the motor? divide by {of_figures}")
    elif stated and not was_degrees and largest * DEGREE / stated <= bound:
        ways.append(f"an angle of the motor in degrees? multiply by pi / 180 and divide by {of_figures}")
    elif not ways:
        was_divided = factor < DEGREE * (1 - ROUNDED)
        ways.append("look at its factor" if was_divided else "an angle of the motor? divide by the gear ratio")
    return "; ".join(ways)


def magnitudes(sheet: Sheet) -> Iterator[Finding]:
    """Positions, currents, loads, temperatures and pressures have a size that occurs in a laboratory."""
    for column, _ in sheet.columns("reflector"):
        if rows := sheet.rows_outside(column.name, -MAX_LENGTH, MAX_LENGTH):
            yield sheet.error(column.name, f"over {MAX_LENGTH:g} m", "millimetres? multiply by 0.001", rows)
    for column, _ in sheet.columns("current"):
        if rows := sheet.rows_outside(column.name, -MAX_CURRENT, MAX_CURRENT):
            yield sheet.error(column.name, f"over {MAX_CURRENT:g} A", "milliamperes? multiply by 0.001", rows)
    for column, _ in sheet.columns("load", "force", "moment"):
        if rows := sheet.rows_outside(column.name, -MAX_FORCE, MAX_FORCE):
            yield sheet.error(column.name, f"over {MAX_FORCE:g} {column.unit.capitalize()}", "look at its unit", rows)
    for column, values in sheet.columns("load_mass"):
        if rows := sheet.rows_outside(column.name, 0.0, MAX_MASS):
            message = f"{values[rows[0] - 1]:g} kg is no mass that hangs on an arm"
            yield sheet.error(column.name, message, "correct it; a weight has its sign in load_z_n", rows)
    for column, values in sheet.columns(*TEMPERATURES):
        least, most = TEMPERATURES[column.channel.quantity]
        if rows := sheet.rows_outside(column.name, least, inf):
            guess = what_a_temperature_may_be(values[rows[0] - 1], (least, most))
            yield sheet.error(column.name, f"under {least:g} K", guess, rows)
        if rows := sheet.rows_outside(column.name, -inf, most):
            guess = what_a_temperature_may_be(values[rows[0] - 1], (least, most))
            yield sheet.error(column.name, f"over {most:g} K", guess, rows)
    for column, values in sheet.columns("gas_pressure"):
        if rows := sheet.rows_outside(column.name, -inf, MAX_PRESSURE):
            yield sheet.error(column.name, f"over {MAX_PRESSURE:g} Pa", "look at its unit", rows)
        if rows := sheet.rows_outside(column.name, BELOW_ZERO, inf):
            message = f"under {BELOW_ZERO:g} Pa, further below zero than a gauge errs"
            yield sheet.error(column.name, message, "give pascals above ambient pressure", rows)
        elif np.max(values, initial=0.0) > FILLED and (rows := rows_where(values < MIN_PRESSURE)):
            message = f"{values[rows[0] - 1]:g} Pa among readings up to {np.max(values):.3g} Pa"
            yield sheet.error(column.name, message, "lost readings? remove these rows", rows)
        if 0 < np.max(np.abs(values), initial=0.0) < MIN_PRESSURE:
            message = f"never reaches {MIN_PRESSURE:g} Pa, an empty cylinder"
            yield sheet.doubt(column.name, message, PRESSURES)
