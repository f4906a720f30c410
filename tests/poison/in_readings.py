"""Readings that were lost, copied or spoilt, and things known besides that the robot cannot have."""

import shutil
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import numpy as np

from tests.poison.in_tables import MOTION
from tests.poison.variant import Answer, Sheet, Spoil, Variant, tables


def _cell(column: str, value: float, rows: tuple[int, ...]) -> Spoil:
    def spoil(folder: Path) -> None:
        sheet = Sheet(folder / "runs" / MOTION)
        for row in rows:
            sheet.set(row, column, repr(value))
        sheet.write()

    return spoil


def spoilt_readings(rng: np.random.Generator) -> Iterator[Variant]:
    row = int(rng.integers(15, 25))
    alone: dict[str, tuple[float, Answer, tuple[str, ...]]] = {
        "current_2_a": (200.0, "harmless", ("current_2_a", "lost or spoilt?")),
        "reflector_1_x_m": (9.0, "harmless", ("reflector_1_x_m", "lost or spoilt?")),
        "gas_pressure_pa": (-1e9, "error", ("gas_pressure_pa", "below zero")),
        "load_mass_kg": (-1.0, "error", ("load_mass_kg", "is no mass")),
        "load_z_n": (-1e9, "error", ("load_z_n", "over 1e+06")),
    }
    for column, (value, answer, words) in alone.items():
        yield Variant("spoilt readings", f"{column} in row {row}", _cell(column, value, (row,)), answer, words)
    places = ("q_motor_2_rad", "is no position of this joint", "lost or spoilt?")
    two = _cell("q_motor_2_rad", 80.0, (row, row + 4))
    yield Variant("spoilt readings", "q_motor_2_rad in two rows", two, "error", places)


def spoilt_single_rows(rng: np.random.Generator) -> Iterator[Variant]:
    """One row of a static run, and one that no drive can have made."""
    row = int(rng.integers(4, 9))

    def load(folder: Path) -> None:
        sheet = next(one for one in map(Sheet, tables(folder)) if "pose" in one.names)
        loads = [float(cells[sheet.names.index("load_z_n")]) for cells in sheet.rows]
        sheet.set(1 + int(np.argmin(loads)), "load_z_n", "-20.0")
        sheet.write()

    words = ("load_z_n", "in other repeats of the same load step")
    yield Variant("spoilt single rows", "a load of one repeat", load, "harmless", words)
    cells: dict[str, tuple[float, bool, Answer, tuple[str, ...]]] = {
        "a reflector at 0": (0.0, True, "harmless", ("reflector_1_x_m", "the median of its repeats")),
        "a reflector at 99.9": (99.9, True, "harmless", ("reflector_1_z_m", "the median of its repeats")),
        "a current of 500 A at rest": (500.0, True, "harmless", ("current_1_a", "the median of its repeats")),
        "an angle that jumps": (0.15, False, "doubt", ("q_motor_1_rad", f"row {row}", "there and back so fast")),
    }
    for name, (value, at_rest, answer, words) in cells.items():

        def spoil(folder: Path, value: float = value, at_rest: bool = at_rest, column: str = words[0]) -> None:
            sheet = next(one for one in map(Sheet, tables(folder)) if ("pose" in one.names) == at_rest)
            before = 0.0 if at_rest else float(sheet.rows[row - 1][sheet.names.index(column)])
            sheet.set(row, column, repr(before + value))
            sheet.write()

        yield Variant("spoilt single rows", name, spoil, answer, words)


def rows_lost_under_an_even_clock(rng: np.random.Generator) -> Iterator[Variant]:
    """Lose rows, and give those after them their times: no gap is left in the clock."""
    first, left = int(rng.integers(12, 16)), int(rng.integers(10, 14))

    def spoil(folder: Path) -> None:
        sheet = Sheet(folder / "runs" / MOTION)
        count = len(sheet.rows) - first - left
        times = [row[sheet.names.index("time_s")] for row in sheet.rows]
        sheet.rows = sheet.rows[:first] + sheet.rows[first + count :]
        for number, time in zip(range(1, len(sheet.rows) + 1), times, strict=False):
            sheet.set(number, "time_s", time)
        sheet.write()

    words = (f"row {first + 1}", "goes on from there", "clock that was made even?")
    yield Variant("rows lost under an even clock", "those in the middle", spoil, "doubt", words)


def one_run_unlike_the_others(rng: np.random.Generator) -> Iterator[Variant]:
    """Spoil the gauge in one run; a constant that gas might have shows nothing at rest."""
    for name, value in (("no pressure", 0.0), ("a pressure of 0.1 MPa", 1e5)):
        spoil = _in_column(lambda v, value=value: 0 * v + value, "gas_pressure_pa")
        words = ("gas_pressure_pa", "joint1-payload5-speed30-up")
        yield Variant("one run unlike the others", name, spoil, "doubt", words)


def several_runs_unlike_the_others(rng: np.random.Generator) -> Iterator[Variant]:
    """Spoil a third of the motions alike: none of them was unlike the others, and causes were named for it at 100 %."""

    def turn(sheet: Sheet) -> None:
        sheet.change("current_1_a", lambda v: -v)

    def exchange(sheet: Sheet) -> None:
        one, other = (sheet.names.index(f"current_{i}_a") for i in (1, 2))
        sheet.names[one], sheet.names[other] = sheet.names[other], sheet.names[one]

    for name, change, words in (
        ("a sign", turn, "current_1_a: has the wrong sign in runs"),
        ("two drives exchanged", exchange, "current_1_a and current_2_a are exchanged in runs"),
    ):

        def spoil(folder: Path, change: Callable[[Sheet], None] = change) -> None:
            motions = [sheet for sheet in map(Sheet, tables(folder)) if "pose" not in sheet.names]
            for sheet in motions[::3]:
                change(sheet)
                sheet.write()

        yield Variant("several runs unlike the others", name, spoil, "doubt", (words, "not in all others"))


def a_gauge_that_never_moves(rng: np.random.Generator) -> Iterator[Variant]:
    def spoil(folder: Path) -> None:
        shown = None
        for sheet in map(Sheet, tables(folder)):
            if "gas_pressure_pa" in sheet.names:
                shown = shown or sheet.rows[0][sheet.names.index("gas_pressure_pa")]
                sheet.change("gas_pressure_pa", lambda v, shown=shown: 0 * v + float(shown))
                sheet.write()

    words = ("gas_pressure_pa", "does not change in")
    yield Variant("a gauge that never moves", "its first reading", spoil, "doubt", words)


def copied_runs(rng: np.random.Generator) -> Iterator[Variant]:
    def over(kind: str, link: bool) -> Spoil:
        def spoil(folder: Path) -> None:
            alike = [file for file in tables(folder) if ("pose" in Sheet(file).names) == (kind == "static")]
            alike[1].unlink()
            if link:
                alike[1].symlink_to(alike[0].name)
            else:
                shutil.copy(alike[0], alike[1])

        return spoil

    for link in (False, True):
        name = "a link to another run" if link else "a copy of another run"
        yield Variant("copied runs", name, over("motion", link), "doubt", ("holds the same readings as",))

    def rewritten(change: Callable[[float], float]) -> Spoil:
        def spoil(folder: Path) -> None:
            over("motion", link=False)(folder)
            alike = [file for file in tables(folder) if "pose" not in Sheet(file).names]
            sheet = Sheet(alike[1])
            sheet.rows = [[repr(change(float(cell))) for cell in row] for row in sheet.rows]
            sheet.write()

        return spoil

    for name, change in (
        ("a copy with other zeros", lambda x: -0.0 if x == 0 else x),
        ("a copy times 1 + 1e-9", lambda x: x * (1 + 1e-9)),
        ("a copy of nine digits", lambda x: float(f"{x:.9g}")),
    ):
        yield Variant("copied runs", name, rewritten(change), "doubt", ("holds the same readings as",))

    def cut_out(first: int, last: int | None) -> Spoil:
        def spoil(folder: Path) -> None:
            alike = [file for file in tables(folder) if "pose" not in Sheet(file).names]
            sheet, rows = Sheet(alike[1]), Sheet(alike[0]).rows
            begin = float(rows[first][0])
            sheet.rows = [[repr(float(row[0]) - begin), *row[1:]] for row in rows[first:last]]
            sheet.write()

        return spoil

    for name, first, last in (("the end of another run", 25, None), ("the middle of another run", 10, 50)):
        yield Variant("copied runs", name, cut_out(first, last), "doubt", ("from row", "do the logs overlap?"))

    def freeze(folder: Path) -> None:
        sheet = Sheet(folder / "runs" / MOTION)
        sheet.rows = [[row[0], *sheet.rows[0][1:]] for row in sheet.rows]
        sheet.write()

    yield Variant("copied runs", "a run frozen to its first row", freeze, "doubt", (MOTION, "that of the first row"))


def impossible_readings(rng: np.random.Generator) -> Iterator[Variant]:
    changes: dict[str, tuple[Callable[[np.ndarray], np.ndarray], tuple[str, ...]]] = {
        "ambient_temperature_k": (lambda v: 0 * v + 950, ("over 343 K",)),
        "ambient_temperature_k ": (lambda v: 0 * v + 210, ("under 223 K",)),
        "gear_temperature_1_k": (lambda v: v + 300, ("over 473 K",)),
        "gas_temperature_k": (lambda v: 0 * v + 900, ("over 473 K",)),
        "gas_pressure_pa": (lambda v: np.where(np.arange(len(v)) == 17, -5, v), ("-5 Pa among readings",)),
        "gas_pressure_pa ": (lambda v: np.where(np.arange(len(v)) == 17, -9e4, v), ("below zero",)),
    }
    for name, (change, words) in changes.items():
        column = name.strip()
        spoil = _in_column(change, column)
        yield Variant("impossible readings", f"{column} {words[0]}", spoil, "error", (column, *words))

    def reported(folder: Path) -> None:
        sheet = Sheet(folder / "runs" / MOTION)
        sheet.names.append("tau_motor_1_nm")
        sheet.rows = [[*row, repr(-1e5 - i % 7)] for i, row in enumerate(sheet.rows)]
        sheet.write()

    words = ("tau_motor_1_nm", "is not used")
    yield Variant("impossible readings", "a torque beside a current", reported, "harmless", words)

    def renamed(old: str, new: str) -> Spoil:
        def spoil(folder: Path) -> None:
            for file in tables(folder):
                file.write_text(file.read_text().replace(old, new, 1))

        return spoil

    nine = renamed("reflector_1_x_m,reflector_1_y_m,reflector_1_z_m", "reflector_9_x_m,reflector_9_y_m,reflector_9_z_m")
    yield Variant("impossible readings", "a ninth reflector", nine, "error", ("reflector_9_x_m", "the robot has"))
    alone = renamed("reflector_1_y_m,reflector_1_z_m", "_y,_z")
    yield Variant("impossible readings", "a coordinate alone", alone, "harmless", ("comes without reflector_1_y_m",))


def _in_column(change: Callable[[np.ndarray], np.ndarray], column: str) -> Spoil:
    """Return what changes a column of one run, which is made where it has none."""

    def spoil(folder: Path) -> None:
        sheet = Sheet(folder / "runs" / MOTION)
        if column not in sheet.names:
            sheet.names.append(column)
            sheet.rows = [[*row, "293.0"] for row in sheet.rows]
        sheet.change(column, change)
        sheet.write()

    return spoil


def known_of_no_such_robot(rng: np.random.Generator) -> Iterator[Variant]:
    entries = {
        "joint 9": ("{quantity: stiffness_nm_per_rad, joint: 9, value: 1.0e6, sigma: 1.0e5}", "known[0].joint"),
        "too few angles": ("{quantity: gas_pressure_pa, at: [0.0], value: 1.0e7, sigma: 1.0e5}", "known[0].at"),
        "degrees": ("{quantity: gas_pressure_pa, at: [0.0, -90.0], value: 1.0e7, sigma: 1.0e5}", "known[0].at"),
        "Celsius": ("{quantity: gas_temperature_k, value: 20, sigma: 1}", "degrees Celsius? add 273.15"),
        "a hot gas": ("{quantity: gas_temperature_k, value: 1.0e6, sigma: 1}", "known[0].value"),
        "bar": ("{quantity: gas_pressure_pa, at: [0.0, 0.0], value: 70, sigma: 1}", "bar? multiply by 100000"),
        "kNm/rad": ("{quantity: stiffness_nm_per_rad, joint: 1, value: 300, sigma: 1}", "kNm/rad or kN/m?"),
        "Nm/deg": ("{quantity: stiffness_nm_per_rad, joint: 1, value: 5200, sigma: 50}", "Nm/deg?"),
        "0617": ("{quantity: payload_kg, value: 0617, sigma: 1}", "known[0].value"),
        "6_1": ("{quantity: payload_kg, value: 6_1, sigma: 1}", "known[0].value"),
        "a sigma of nothing": ("{quantity: payload_kg, value: 1, sigma: 1.0e-300}", "known[0].sigma"),
    }
    for name, (entry, place) in entries.items():

        def spoil(folder: Path, entry: str = entry) -> None:
            file = folder / "campaign.yaml"
            file.write_text(f"{file.read_text()}known: [{entry}]\n")

        yield Variant("known of no such robot", name, spoil, "error", ("campaign.yaml", place))

    def listed(folder: Path, entries: str) -> None:
        file = folder / "campaign.yaml"
        file.write_text(f"{file.read_text()}known: [{entries}]\n")

    high = "{quantity: gas_pressure_pa, at: [0.0, 0.0], value: 3.3e+7, sigma: 1.0e+5}"
    twice = "{quantity: payload_kg, value: 5, sigma: 0.1}, {quantity: payload_kg, value: 1, sigma: 0.1}"
    words = ("known[0].value", "times what the model has")
    yield Variant("known of no such robot", "ten times the gas", partial(listed, entries=high), "doubt", words)
    words = ("known[1].value", "standard errors apart")
    yield Variant("known of no such robot", "a payload twice", partial(listed, entries=twice), "harmless", words)


FAMILIES = (
    spoilt_readings,
    spoilt_single_rows,
    rows_lost_under_an_even_clock,
    one_run_unlike_the_others,
    several_runs_unlike_the_others,
    a_gauge_that_never_moves,
    copied_runs,
    impossible_readings,
    known_of_no_such_robot,
)
