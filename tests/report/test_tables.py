"""Tables for the terminal."""

import io
from math import inf, nan

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console

from bench.errors import InputError
from bench.report.tables import Column, Measured, Row, aligned, print_table

COLUMNS = (Column("current", "1e6 Nm/rad"), Column("truth", "1e6 Nm/rad", decimals=3))
ROWS = (
    Row("joint1", (Measured(0.559, 0.12), Measured(0.565))),
    Row("joint2", (Measured(-11.435, 0.021), Measured(1.449))),
    Row("joint3", (Measured(nan, nan), Measured(1.847))),
)


def printed(width: int = 100, encoding: str = "utf-8", **terminal: bool) -> str:
    stream = io.TextIOWrapper(io.BytesIO(), encoding=encoding, newline="")
    print_table(
        "Stiffness",
        COLUMNS,
        ROWS,
        ["joint3 [unloaded] needs another pose."],
        Console(file=stream, width=width, **terminal),
    )
    stream.flush()
    return stream.buffer.getvalue().decode(encoding)


def test_decimal_points_stand_below_each_other() -> None:
    lines = [line for line in printed().splitlines() if line.strip().startswith(("joint1", "joint2"))]
    assert len(lines) == 2
    for text in ("\u00b1", "0.120", "0.021"):
        assert any(text in line for line in lines)
    points = [[i for i, letter in enumerate(line) if letter == "."] for line in lines]
    assert points[0] == points[1]


def test_as_many_digits_as_the_smallest_error_needs() -> None:
    assert aligned([Measured(1.23456, 0.0123), Measured(2.0, 0.2)]) == ["1.235 \u00b1 0.012", "2.000 \u00b1 0.200"]
    assert aligned([Measured(1234.5, 56.0)]) == ["1234 \u00b1 56"]
    assert aligned([Measured(nan, nan), Measured(inf), Measured(2.5)]) == ["-", "inf", "2.5"]


def test_what_rounds_to_zero_has_no_sign() -> None:
    """An axis that stood at -0.3 degrees was at "-0"."""
    assert aligned([Measured(-0.3), Measured(-12.0)], 0) == ["0", "-12"]


def test_plain_where_colour_is_not_wanted() -> None:
    assert "\x1b" not in printed()
    assert "\x1b" in printed(force_terminal=True)


def test_ascii_where_the_output_knows_no_more() -> None:
    text = printed(encoding="ascii")
    assert "+-" in text
    assert "-11.435" in text


def test_no_number_is_cut_where_the_terminal_is_narrow() -> None:
    assert "-11.435 \u00b1 0.021" in printed(width=20)


def test_notes_are_printed_as_they_are() -> None:
    assert "joint3 [unloaded] needs another pose." in printed()


def test_a_row_of_the_wrong_length_is_named() -> None:
    with pytest.raises(InputError, match="joint1"):
        print_table("Stiffness", COLUMNS[:1], ROWS[:1])


@given(st.lists(st.tuples(st.floats(-1e6, 1e6), st.none() | st.floats(0, 1e6)), min_size=1))
def test_a_column_reads_back(numbers: list[tuple[float, float | None]]) -> None:
    values = [Measured(value, error) for value, error in numbers]
    for text, (value, error) in zip(aligned(values, decimals=3, sign="+-"), numbers, strict=True):
        parts = [float(part) for part in text.split("+-")]
        assert parts[0] == pytest.approx(value, abs=6e-4)
        assert (len(parts) == 1) == (error is None)
