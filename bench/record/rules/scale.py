"""Values that are only possible in another unit than the one in the column's name."""

from collections.abc import Iterator
from math import inf, pi

import numpy as np

from bench.record.channels import Column
from bench.record.finding import Finding
from bench.record.rules.sheet import Sheet, rows_where

# A joint of an arm turns by at most two rounds either way; the wrist axes with the widest range have 720 deg.
MAX_ANGLE = 4 * pi
MAX_LENGTH = 100.0  # [m]; no arm stands on a longer track, and no tracker sees a reflector much further away
MAX_CURRENT = 1000.0  # [A]; drives of the heaviest arms stay below 200
MIN_TEMPERATURE = 200.0  # [K]; colder than any place with a robot, and above any temperature there in degrees Celsius
MAX_TEMPERATURE = 1000.0  # [K]; iron glows, and no winding or gas seal lasts
MAX_FORCE = 1e6  # [N], [Nm]; the strongest arms carry 2.3 t, 4 m out
MAX_MASS = 1e5  # [kg]; weighs as much
VACUUM = -1.1e5  # [Pa] above ambient pressure; the highest ambient pressure ever measured is 1.085e5 (Tosontsengel)
MAX_PRESSURE = 1e9  # [Pa]; no cylinder holds it
MIN_PRESSURE = 5e4  # [Pa]; counterbalances hold 2 to 30 MPa, and 30 MPa are 3e4 in kPa

DEGREE = pi / 180
ROUNDED = 1e-3  # of a factor for degrees that somebody rounded
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
        if sheet.within(column.name, max(lower, -bound), min(upper, bound)):
            continue
        if rows := rows_where(np.abs(values) > bound):
            guess = "millimetres? multiply by 0.001"
            if not column.is_slide:
                guess = _what_an_angle_may_be(sheet, column, float(np.max(np.abs(values))), bound)
            message = f"{values[rows[0] - 1]:g} {column.unit} is no position of this joint"
            yield sheet.error(column.name, message, guess, rows)
        elif rows := rows_where((values < lower - beside) | (values > upper + beside)):
            message = f"leaves the joint's limits, {lower:g} to {upper:g} {column.unit}"
            yield sheet.doubt(column.name, message, "look at zero position, sign and order of the joints", rows)


def _what_an_angle_may_be(sheet: Sheet, column: Column, largest: float, bound: float) -> str:
    """Return advice for an angle that reaches too far: each way of reading it that brings it into range."""
    factor = abs(sheet.factors.get(column.name, 1.0))
    was_degrees = factor <= DEGREE * (1 + ROUNDED)
    stated = sheet.gear_ratios[column.index - 1] if column.index <= len(sheet.gear_ratios) else None
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
    for column, values in sheet.columns("reflector"):
        if not sheet.within(column.name, -MAX_LENGTH, MAX_LENGTH) and (rows := rows_where(np.abs(values) > MAX_LENGTH)):
            yield sheet.error(column.name, f"over {MAX_LENGTH:g} m", "millimetres? multiply by 0.001", rows)
    for column, values in sheet.columns("current"):
        if not sheet.within(column.name, -MAX_CURRENT, MAX_CURRENT) and (
            rows := rows_where(np.abs(values) > MAX_CURRENT)
        ):
            yield sheet.error(column.name, f"over {MAX_CURRENT:g} A", "milliamperes? multiply by 0.001", rows)
    for column, values in sheet.columns("load", "force", "moment"):
        if not sheet.within(column.name, -MAX_FORCE, MAX_FORCE) and (rows := rows_where(np.abs(values) > MAX_FORCE)):
            yield sheet.error(column.name, f"over {MAX_FORCE:g} {column.unit.capitalize()}", "look at its unit", rows)
    for column, values in sheet.columns("load_mass"):
        if not sheet.within(column.name, 0.0, MAX_MASS) and (rows := rows_where((values < 0) | (values > MAX_MASS))):
            message = f"{values[rows[0] - 1]:g} kg is no mass that hangs on an arm"
            yield sheet.error(column.name, message, "correct it; a weight has its sign in load_z_n", rows)
    temperatures = ("motor_temperature", "gear_temperature", "gas_temperature", "ambient_temperature")
    for column, values in sheet.columns(*temperatures):
        if not sheet.within(column.name, MIN_TEMPERATURE, inf) and (rows := rows_where(values < MIN_TEMPERATURE)):
            yield sheet.error(column.name, f"under {MIN_TEMPERATURE:g} K", "degrees Celsius? add 273.15", rows)
        if not sheet.within(column.name, -inf, MAX_TEMPERATURE) and (rows := rows_where(values > MAX_TEMPERATURE)):
            yield sheet.error(column.name, f"over {MAX_TEMPERATURE:g} K", "millikelvin? multiply by 0.001", rows)
    for column, values in sheet.columns("gas_pressure"):
        if not sheet.within(column.name, -inf, MAX_PRESSURE) and (rows := rows_where(values > MAX_PRESSURE)):
            yield sheet.error(column.name, f"over {MAX_PRESSURE:g} Pa", "look at its unit", rows)
        if not sheet.within(column.name, VACUUM, inf) and (rows := rows_where(values < VACUUM)):
            yield sheet.error(column.name, "under that of a vacuum", "give pascals above ambient pressure", rows)
        if 0 < np.max(np.abs(values), initial=0.0) < MIN_PRESSURE:
            message = f"never reaches {MIN_PRESSURE:g} Pa, an empty cylinder"
            yield sheet.doubt(column.name, message, "bar? multiply by 100000; MPa? by 1000000")
