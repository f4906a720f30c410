"""Tables: cells, rows, headers, encodings, units, clocks."""

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from tests.poison.variant import Answer, Sheet, Spoil, Variant, in_column, tables

MOTION = "joint1-payload5-speed30-up.csv"  # of the base
STATIC = "pose1-from-below.csv"
MEASURED = ("q_motor_1_rad", "current_2_a", "reflector_1_x_m", "gas_pressure_pa", "load_z_n")
PLACES = [*((MOTION, column) for column in MEASURED), (STATIC, "current_1_a"), (STATIC, "force_z_n")]


def _cell(file: str, row: int, column: str, cell: str) -> Spoil:
    def spoil(folder: Path) -> None:
        sheet = Sheet(folder / "runs" / file)
        sheet.set(row, column, cell)
        sheet.write()

    return spoil


def _cells(family: str, cells: tuple[str, ...], rng: np.random.Generator) -> Iterator[Variant]:
    for cell in cells:
        file, column = PLACES[rng.integers(len(PLACES))]
        row = int(rng.integers(1, 4))
        shown = cell if cell.isprintable() and len(cell) < 12 else f"{len(cell)} characters"
        yield Variant(
            family, f"{shown!r} in {column}", _cell(file, row, column, cell), "error", (file, f"row {row}", column)
        )


def cells_without_a_value(rng: np.random.Generator) -> Iterator[Variant]:
    yield from _cells("cells without a value", ("", "nan", "NaN", "inf", "-inf", "Infinity", " ", "+nan"), rng)


def cells_that_are_words(rng: np.random.Generator) -> Iterator[Variant]:
    words = ("--", "N/A", "1.2.3", "0x1F", "1_000", "٣", "1e", "e5", "1 2", "=A1", "'1", "#REF!", "TRUE", "1;2")
    yield from _cells("cells that are words", words, rng)


def numbers_that_are_too_long(rng: np.random.Generator) -> Iterator[Variant]:
    long = ("9" * 20000, "9" * 20000 + "x", "1" + "0" * 5000, "1." + "1" * 20000 + "e", "-" * 9999, "1e999", "-1e400")
    yield from _cells("numbers that are too long", (*long, "0." + "0" * 20000 + "z", "1" + " " * 20000 + "1"), rng)


def readings_that_cannot_be(rng: np.random.Generator) -> Iterator[Variant]:
    yield from _cells("readings that cannot be", ("1e13", "-1e30", "3.4e38", "1e300", "-1.7976931348623157e308"), rng)
    for column, value in (
        *(("gas_pressure_pa", 1e11), ("ambient_temperature_k", 1e11), ("motor_temperature_2_k", 1e4)),
        *(("q_motor_1_rad", 1e3), ("reflector_1_z_m", 2e4), ("current_1_a", 5e3)),
    ):
        spoil = _cell(MOTION, 2, column, repr(value))
        yield Variant("readings that cannot be", f"{column} = {value:g}", spoil, "error", (MOTION, "row 2", column))


def _text(change: Callable[[bytes], bytes], file: str = MOTION) -> Spoil:
    def spoil(folder: Path) -> None:
        path = folder / "runs" / file
        path.write_bytes(change(path.read_bytes()))

    return spoil


def encodings(rng: np.random.Generator) -> Iterator[Variant]:
    def latin(data: bytes) -> bytes:
        return data.replace(b"q_cmd_1_rad", "q_cmd_1_rad°".encode("latin-1"), 1)

    answers: dict[str, tuple[Callable[[bytes], bytes], Answer]] = {
        "latin-1": (latin, "error"),
        "UTF-16": (lambda data: data.decode().encode("utf-16"), "error"),
        "UTF-32": (lambda data: data.decode().encode("utf-32"), "error"),
        "a zero byte": (lambda data: data.replace(b",", b",\0", 50), "error"),
        "zero bytes alone": (lambda data: b"\0" * 5000, "error"),
        "byte order mark": (lambda data: b"\xef\xbb\xbf" + data, "harmless"),
        "Windows line ends": (lambda data: data.replace(b"\n", b"\r\n"), "harmless"),
        "old line ends": (lambda data: data.replace(b"\n", b"\r"), "harmless"),
        "blank lines at the end": (lambda data: data + b"\n\n \n", "harmless"),
        "quotes": (lambda data: b'"' + data.replace(b",", b'","').replace(b"\n", b'"\n"')[:-1], "harmless"),
        "an open quote": (lambda data: data.replace(b",", b',"', 60), "error or harmless"),
        "quotes and blanks": (lambda data: data + b" " * 100_000 + b'"', "error"),
        "random bytes": (lambda data: rng.bytes(20_000), "error"),
    }
    for name, (change, answer) in answers.items():
        yield Variant("encodings", name, _text(change), answer, (MOTION,) if answer == "error" else ())


def separators(rng: np.random.Generator) -> Iterator[Variant]:
    changes: dict[str, Callable[[bytes], bytes]] = {
        "semicolons": lambda data: data.replace(b",", b";"),
        "tabs": lambda data: data.replace(b",", b"\t"),
        "blanks": lambda data: data.replace(b",", b" "),
        "decimal commas and semicolons": lambda data: data.replace(b",", b";").replace(b".", b","),
        "decimal commas": lambda data: b"\n".join(
            [data.split(b"\n")[0], *(line.replace(b".", b",") for line in data.split(b"\n")[1:])]
        ),
        "pipes": lambda data: data.replace(b",", b"|"),
    }
    yield from (Variant("separators", name, _text(change), "error", (MOTION,)) for name, change in changes.items())


def rows_of_a_wrong_length(rng: np.random.Generator) -> Iterator[Variant]:
    def spoil_of(row: int, change: Callable[[bytes], bytes]) -> Spoil:
        def spoilt(data: bytes) -> bytes:
            lines = data.split(b"\n")
            lines[row] = change(lines[row])
            return b"\n".join(lines)

        return _text(spoilt)

    changes: dict[str, Callable[[bytes], bytes]] = {
        "one cell less": lambda line: line.rsplit(b",", 1)[0],
        "one cell more": lambda line: line + b",1",
        "cut": lambda line: line[: len(line) // 2],
        "empty": lambda line: b"",
        "a million cells": lambda line: b"1," * 1_000_000,
    }
    for name, change in changes.items():
        for row in rng.integers(1, 40, size=2).tolist():
            yield Variant(
                "rows of a wrong length", f"row {row} {name}", spoil_of(row, change), "error", (MOTION, f"row {row}")
            )


def truncated_tables(rng: np.random.Generator) -> Iterator[Variant]:
    for share in (0.0, 0.001, 0.01, 0.02):
        yield Variant(
            "truncated tables", f"{share:.1%} left", _text(lambda d, s=share: d[: int(s * len(d))]), "error", (MOTION,)
        )
    for _ in range(6):
        share = float(rng.uniform(0.1, 0.99))  # cut in a row, in a number, or at the end of one
        spoil = _text(lambda d, s=share: d[: int(s * len(d))])
        yield Variant("truncated tables", f"{share:.2%} left", spoil, "error or harmless")
    yield Variant("truncated tables", "header alone", _text(lambda d: d[: d.index(b"\n") + 1]), "error", (MOTION,))
    yield Variant("truncated tables", "no header", _text(lambda d: d[d.index(b"\n") + 1 :]), "error", (MOTION,))


def headers(rng: np.random.Generator) -> Iterator[Variant]:
    new_names = (
        *(
            "q_cmd_1_deg",
            "Q_CMD_1_RAD",
            "q_cmd_1",
            "position",
            "q_cmd_0_rad",
            "q_cmd_9_rad",
            "",
            "time_s",
            "q_motor_1_m",
        ),
        *("q_cmd_99999_rad", "é" * 300, "x" * 100_000, "current_2_ma", "q_motor_1_rad"),
    )
    for new in new_names:
        spoil = _text(lambda data, n=new: data.replace(b"q_cmd_1_rad", n.encode(), 1))
        yield Variant("headers", f"{new[:20]!r} for q_cmd_1_rad", spoil, "error", (MOTION,))
    yield Variant(
        "headers",
        "two thousand columns",
        _text(lambda data: b",".join([b"a"] * 2000) + b"\n" + b",".join([b"1"] * 2000)),
        "error",
        (MOTION, "BENCH_MOST_TABLE_COLUMNS"),
    )


def units(rng: np.random.Generator) -> Iterator[Variant]:
    found: dict[str, tuple[float, float, tuple[str, ...], Answer]] = {
        "degrees": (57.29578, 0, ("q_cmd_1_rad", "q_motor_1_rad"), "error"),
        "degrees of an encoder": (57.29578, 0, ("q_motor_2_rad",), "error"),
        "milliamperes": (1000, 0, ("current_1_a",), "error"),
        "millimetres": (1000, 0, ("reflector_1_x_m", "reflector_1_y_m", "reflector_1_z_m"), "error"),
        "degrees Celsius": (1, -273.15, ("gear_temperature_1_k",), "error"),
        "bar": (1e-5, 0, ("gas_pressure_pa",), "doubt"),
        "megapascal": (1e-6, 0, ("gas_pressure_pa",), "doubt"),
        "kilonewtons of a sensor": (1e-3, 0, ("force_z_n",), "error"),
        "kilonewtons of loads": (1e-3, 0, ("load_z_n",), "error"),
        "kilograms": (1 / 9.80665, 0, ("load_z_n",), "error"),
        "milliseconds": (1000, 0, ("time_s",), "doubt"),
    }
    for name, (factor, offset, columns, answer) in found.items():
        spoil = in_column(lambda v, f=factor, o=offset: f * v + o, *columns)
        yield Variant("units", name, spoil, answer, (columns[0],))


def _rows(change: Callable[[list[list[str]]], list[list[str]]]) -> Spoil:
    def spoil(folder: Path) -> None:
        for file in tables(folder):
            sheet = Sheet(file)
            if "pose" not in sheet.names:
                sheet.rows = change(sheet.rows)
                sheet.write()

    return spoil


def lost_samples(rng: np.random.Generator) -> Iterator[Variant]:
    for share in (0.05, 0.1, 0.2, 0.2, 0.4):
        seed = int(rng.integers(1000))

        def some(rows: list[list[str]], share: float = share, seed: int = seed) -> list[list[str]]:
            kept = np.random.default_rng(seed).random(len(rows)) > share
            return [row for row, is_kept in zip(rows, kept, strict=True) if is_kept]

        yield Variant("lost samples", f"{share:.0%}, seed {seed}", _rows(some), "harmless", ("lost samples",))
    for begin in (0.2, 0.5):
        spoil = _rows(lambda rows, b=begin: rows[: int(b * len(rows))] + rows[int((b + 0.2) * len(rows)) :])
        yield Variant("lost samples", f"a fifth, from {begin:.0%} on", spoil, "harmless", ("lost samples",))


def clocks(rng: np.random.Generator) -> Iterator[Variant]:
    def swapped(values: np.ndarray) -> np.ndarray:
        values[[5, 6]] = values[[6, 5]]
        return values

    changes: dict[str, tuple[Callable[[np.ndarray], np.ndarray], Answer]] = {
        "two rows swapped": (swapped, "error"),
        "backwards": (lambda t: t[::-1].copy(), "error"),
        "stands": (lambda t: 0 * t, "error"),
        "standing once": (lambda t: np.where(np.arange(len(t)) == 7, t[6], t), "error"),
        "begins late": (lambda t: t + 1e4, "harmless"),
        "one gap of 30 years": (lambda t: t + 1e9 * (np.arange(len(t)) > 20), "error or harmless"),
    }
    for name, (change, answer) in changes.items():

        def spoil(folder: Path, change: Callable[[np.ndarray], np.ndarray] = change) -> None:
            sheet = Sheet(folder / "runs" / MOTION)
            sheet.change("time_s", change)
            sheet.write()

        yield Variant("clocks", name, spoil, answer, (MOTION, "time_s") if answer != "error or harmless" else ())


def mistaken_channels(rng: np.random.Generator) -> Iterator[Variant]:
    minus = in_column(lambda v: -v, "q_motor_1_rad")
    yield Variant("mistaken channels", "an encoder turned", minus, "doubt", ("q_motor_1_rad",))
    for drive in (1, 2):
        name = f"current_{drive}_a"
        yield Variant("mistaken channels", f"{name} turned", in_column(lambda v: -v, name), "doubt", (name,))
        yield Variant("mistaken channels", f"{name} dead", in_column(lambda v: 0 * v, name), "doubt", (name,))
        of_motor = in_column(lambda v: v / 100, name)
        yield Variant("mistaken channels", f"{name} a hundredth", of_motor, "doubt", (name,))
    mirrored = in_column(lambda v: -v, "q_cmd_1_rad", "q_motor_1_rad")
    yield Variant("mistaken channels", "a mirrored joint", mirrored, "doubt", ())
    frozen = in_column(lambda v: 0 * v + v[0], "q_motor_1_rad")
    yield Variant("mistaken channels", "a frozen encoder", frozen, "doubt", ("q_motor_1_rad",))
    clipped = in_column(lambda v: np.minimum(v, v.min() + 0.6 * np.ptp(v)), "q_motor_1_rad")
    yield Variant("mistaken channels", "a clipped encoder", clipped, "doubt", ("q_motor_1_rad",))
    up = in_column(lambda v: -v, "load_z_n", "force_z_n")
    yield Variant("mistaken channels", "weights that pull up", up, "doubt", ("load_z_n",))

    def swap(folder: Path) -> None:
        for file in tables(folder):
            text = file.read_text()
            text = text.replace("q_motor_1_rad", "@").replace("q_motor_2_rad", "q_motor_1_rad")
            file.write_text(text.replace("@", "q_motor_2_rad"))

    yield Variant("mistaken channels", "encoders swapped", swap, "doubt", ("q_motor_1_rad",))


def _without(*prefixes: str) -> Spoil:
    """Return what takes columns out of every table."""

    def spoil(folder: Path) -> None:
        for file in tables(folder):
            sheet = Sheet(file)
            kept = [i for i, name in enumerate(sheet.names) if not name.startswith(prefixes)]
            sheet.names = [sheet.names[i] for i in kept]
            sheet.rows = [[row[i] for i in kept] for row in sheet.rows]
            sheet.write()

    return spoil


def _both(*spoils: Spoil) -> Spoil:
    def spoil(folder: Path) -> None:
        for one in spoils:
            one(folder)

    return spoil


def cross_checks(rng: np.random.Generator) -> Iterator[Variant]:
    """Channels that contradict each other or the model; what a diagnosis weighs itself is said, and no fault."""

    def smooth(values: np.ndarray) -> np.ndarray:
        if len(values) < 50:  # readings at rest
            return values
        return np.convolve(np.pad(values, (8, 0), mode="edge"), np.full(9, 1 / 9), "valid")

    def late(values: np.ndarray) -> np.ndarray:
        return values if len(values) < 50 else np.concatenate([np.full(5, values[0]), values[:-5]])

    def times(factor: float, *columns: str) -> Spoil:
        return in_column(lambda v: factor * v, *columns)

    loads, tracker = ("load_x_n", "load_y_n", "load_z_n"), tuple(f"reflector_1_{axis}_m" for axis in "xyz")
    found: dict[str, tuple[Spoil, Answer, tuple[str, ...]]] = {
        "a clock 10 % fast": (times(1.1, "time_s"), "doubt", ("time_s", "seconds for each second")),
        "a clock twice as fast": (times(2, "time_s"), "doubt", ("time_s", "seconds for each second")),
        "a clock half as fast": (times(0.5, "time_s"), "doubt", ("time_s", "seconds for each second")),
        "a current smoothed": (in_column(smooth, "current_2_a"), "doubt", ("current_2_a", "smoothed?")),
        "a tracker's axis smoothed": (in_column(smooth, tracker[0]), "doubt", (tracker[0], "smoothed?")),
        "kN without a sensor": (_both(_without("force", "moment"), times(1e-3, *loads)), "doubt", ("load_mass_kg",)),
        "kN without sensor and mass": (
            _both(_without("force", "moment", "load_mass"), times(1e-3, *loads)),
            "doubt",
            ("load_z_n", "kilonewtons?"),
        ),
        "kg without sensor and mass": (
            _both(_without("force", "moment", "load_mass"), times(1 / 9.80665, *loads)),
            "doubt",
            ("load_z_n", "kilograms?"),
        ),
        "masses twice": (times(2, "load_mass_kg"), "doubt", ("load_mass_kg", "10 kg weigh 98.07 N")),
        "a mirrored joint with its torque": (
            times(-1, "q_cmd_1_rad", "q_motor_1_rad", "current_1_a"),
            "doubt",
            ("current_1_a",),
        ),
        "a force sensor at 0.7": (times(0.7, "force_z_n"), "harmless", ("force_z_n", "0.70", "channel_scale")),
        "loads twice": (times(2, *loads), "harmless", ("force_z_n", "0.50", "hung_load")),
        "a current doubled": (times(2, "current_2_a"), "harmless", ("current_2_a", "looks doubled", "channel_scale")),
        "a current halved": (times(0.5, "current_1_a"), "harmless", ("current_1_a", "looks halved", "channel_scale")),
        "a current late": (in_column(late, "current_2_a"), "harmless", ("current_2_a", "looks late", "channel_delay")),
        "a tracker late": (in_column(late, *tracker), "harmless", (tracker[0], "looks late", "channel_delay")),
        "nothing": (_without("motor_temperature"), "harmless", (" 0 warnings",)),
    }
    for name, (spoil, answer, places) in found.items():
        yield Variant("cross-checks", name, spoil, answer, places)


def labels(rng: np.random.Generator) -> Iterator[Variant]:
    for column, cell in (
        *(("pose", "1.5"), ("pose", "-1"), ("approach", "0"), ("approach", "2"), ("load_step", "-1")),
        *(("load_step", "0.5"), ("repeat", "-3"), ("repeat", "1e-3")),
    ):
        row = int(rng.integers(1, 4))
        spoil = _cell(STATIC, row, column, cell)
        yield Variant("labels", f"{column} = {cell}", spoil, "error", (STATIC, f"row {row}", column))


FAMILIES = (
    *(cells_without_a_value, cells_that_are_words, numbers_that_are_too_long, readings_that_cannot_be, encodings),
    *(separators, rows_of_a_wrong_length, truncated_tables, headers, units, lost_samples, clocks),
    *(mistaken_channels, cross_checks, labels),
)
