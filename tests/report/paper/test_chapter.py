"""A chapter of the paper in the terminal."""

import re

import pytest

from bench.report.paper.chapter import Chapter, print_chapter
from bench.report.paper.published import PublishedRow


@pytest.mark.parametrize(
    ("ours", "paper", "shown"),
    [
        (4769.9008, 4771.4, ["4769.9", "4771.4", "-1.5"]),
        (0.911234, 0.9112, ["0.9112", "0.9112", "0.0000"]),
        (2.1339e-4, 3e-4, ["0.0002134", "0.0003000", "-0.0000866"]),
        (600.0371, 600.0, ["600.0", "600.0", "0.0"]),
        (0.0, 1.0, ["0.000", "1.000", "-1.000"]),
        (float("nan"), 1.0, ["-", "1.000", "-"]),
    ],
)
def test_numbers_of_a_row_fit_together(
    ours: float, paper: float, shown: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    rows = [PublishedRow("size of it", "", ours, paper), PublishedRow("another", "Nm", 123.0, 1e5)]
    print_chapter(Chapter("name", "Title", rows, (), {}))
    (line,) = (line for line in capsys.readouterr().out.splitlines() if "size of it" in line)
    assert re.split(r" {2,}", line.strip())[1:] == shown
