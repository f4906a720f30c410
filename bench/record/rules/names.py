"""Column names: known, in SI units, one of each, and enough of them to work with."""

from collections import Counter
from collections.abc import Iterator
from difflib import get_close_matches

from bench.record.channels import AXES, Column, columns_of, known_names, parse_column
from bench.record.finding import Finding, counted
from bench.record.rules.sheet import Sheet
from bench.record.table import SET_ASIDE
from bench.record.units import right_name, seen_of

REQUIRED = {"static": ("pose", "load_step"), "motion": ("time_s",)}


def known(sheet: Sheet) -> Iterator[Finding]:
    """Each name stands in the table of channels, and once."""
    for name, count in Counter(sheet.names).items():
        if not seen_of(name):
            yield sheet.error(name, "a column has no name", "name it in the first line, or remove it")
        elif name.startswith(SET_ASIDE):
            continue
        elif parse_column(name) is None:
            yield _unknown(sheet, name)
        elif count > 1:
            yield sheet.error(name, f"{count} columns have this name", "keep the right one")


def enough(sheet: Sheet) -> Iterator[Finding]:
    """There are rows, the labels or the clock of this kind of run, joint angles, and something that was measured."""
    kind = sheet.run.kind
    names = {_meant(name) for name in sheet.names}
    for name in REQUIRED[kind]:
        if name not in names:
            yield sheet.error(name, f"is missing from a {kind} run", f"add it, or change the run's kind from {kind!r}")
    if not columns_of(names, "q_cmd", "q_motor"):
        yield sheet.error("", "no joint angles", "add q_cmd_i_rad or q_motor_i_rad for each drive i")
    if not any(column and column.channel.role == "measured" for column in map(parse_column, names)):
        yield sheet.error("", "no measured channel", "add at least one, for example q_motor_1_rad")
    if sheet.run.columns and len(sheet.run) == 0:
        yield sheet.error("", "no rows", "add readings, or take the run out of campaign.yaml")


def fits_arm(sheet: Sheet) -> Iterator[Finding]:
    """Each joint is either a hinge or a slide, and the robot has it."""
    kinds: dict[int, bool] = dict(enumerate(sheet.arm.is_slide, 1)) if sheet.arm else {}
    drives = [column for column in map(parse_column, dict.fromkeys(sheet.names)) if column and _is_of_drive(column)]
    for column in drives:
        if sheet.arm and column.index > sheet.arm.n_drives:
            yield sheet.error(column.name, f"the robot has {sheet.arm.n_drives} drives", "number it as the robot does")
        elif column.channel.slide_unit and column.is_slide != kinds.setdefault(column.index, column.is_slide):
            word, unit = ("hinge", column.channel.unit) if column.is_slide else ("slide", column.channel.slide_unit)
            yield sheet.error(column.name, f"joint {column.index} is a {word}", f"give it in {unit}")
    if sheet.arm:
        seen = {column.index for column in drives if column.channel.quantity in ("q_cmd", "q_motor")}
        if seen and (unseen := sorted(set(kinds) - seen)):
            numbers = ", ".join(map(str, unseen))
            yield sheet.error("", f"no angle of drive {numbers}", "add q_cmd or q_motor, constant if it stood still")


def reflectors(sheet: Sheet) -> Iterator[Finding]:
    """Each reflector is one that the robot carries, with all three of its coordinates."""
    present: dict[int, list[str]] = {}
    for column in columns_of(dict.fromkeys(map(_meant, sheet.names)), "reflector"):
        present.setdefault(column.index, []).append(column.name)
    carried = sheet.arm.n_reflectors if sheet.arm else None
    for index, names in present.items():
        if carried is not None and index > carried:
            remedy = "number it as reflectors in figures.yaml, or name a site of the MJCF there"
            for name in names:
                yield sheet.error(name, f"the robot has {counted(carried, 'reflector')}", remedy)
        elif len(names) < len(AXES):
            missing = [name for axis in AXES if (name := f"reflector_{index}_{axis}_m") not in names]
            message = f"comes without {' and '.join(missing)}"
            yield sheet.warning(names[0], message, "add what the tracker read; a distance needs all three")


def _is_of_drive(column: Column) -> bool:
    return "i" in column.channel.keys


def _meant(name: str) -> str:
    return right[0] if (right := right_name(name)) else name


def _unknown(sheet: Sheet, name: str) -> Finding:
    if right := right_name(name):
        better, todo = right
        remedy = f"name it {better}" + (f" and {todo}" if todo else "")
        if unseen := [f"U+{ord(one):04X}" for one in name if not seen_of(one)]:
            message = f"has {', '.join(unseen)} in it, which nobody sees"
            return sheet.error(seen_of(name), message, f"{remedy}; save the table without it")
        return sheet.error(name, "is not in the letters and SI units of this format", remedy)
    candidates = known_names(name)
    near = get_close_matches(name.lower(), candidates, n=1)
    hint = f"did you mean {near[0]!r}?" if near else f"known: {', '.join(candidates)}"
    return sheet.error(name, f"unknown column, {hint}", f"rename it, or put {SET_ASIDE!r} before it to leave it out")
