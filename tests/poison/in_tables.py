"""Tables whose text is broken: cells, rows, headers, encodings, labels."""

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from tests.poison.variant import Answer, Sheet, Spoil, Variant

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


def first_lines(rng: np.random.Generator) -> Iterator[Variant]:
    """Spoil what stands above the numbers; each is one sentence."""

    def without_a_name(data: bytes) -> bytes:
        return data.replace(b"q_cmd_1_rad,", b"", 1)

    def header(data: bytes) -> bytes:
        return data[: data.index(b"\n") + 1]

    faults: dict[str, tuple[Callable[[bytes], bytes], str]] = {
        "the header twice": (lambda data: header(data) + data, "holds the header again, row 1"),
        "units": (lambda data: data.replace(b"\n", b"\n" + b"s," * header(data).count(b",") + b"s\n", 1), "of units?"),
        "no header": (lambda data: data[data.index(b"\n") + 1 :], "has no header"),
        "a comment": (lambda data: b"# made by X\n" + data, "holds no names"),
        "a separator": (lambda data: b"sep=,\n" + data, "holds no names"),
        "a name too few": (without_a_name, "name every column in the first line"),
        "UTF-16 without a mark": (lambda data: data.decode().encode("utf-16-le"), "UTF-16"),
        "pipes": (lambda data: data.replace(b",", b"|"), "separated by upright bars"),
        "blanks": (lambda data: data.replace(b",", b" "), "separated by spaces"),
    }
    for name, (change, words) in faults.items():
        yield Variant("first lines", name, _text(change), "error", (MOTION, words, ": 1 error,"))

    def noted(data: bytes) -> bytes:
        first, *lines = data.strip().split(b"\n")
        return b"\n".join([first + b",_note", *(line + b",a word" for line in lines)])

    yield Variant("first lines", "words in a column that is not read", _text(noted), "harmless", (" 0 warnings",))


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
    *(separators, rows_of_a_wrong_length, truncated_tables, headers, first_lines, labels),
)
