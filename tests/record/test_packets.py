"""Stamps of samples that were written when they arrived together."""

from pathlib import Path

import numpy as np
import pytest

from bench.record.campaign import Array
from bench.record.check import check_campaign
from bench.record.rules.clock import rows_of_a_packet
from tests.record.build import STEP_S, motion, sweep, write_folder


def even(rows: int = 2000) -> Array:
    return STEP_S * np.arange(rows)


def packets(of: int, apart: float) -> Array:
    """Return stamps of packets of so many rows, `apart` [s] within one."""
    rows = np.arange(2000)
    return STEP_S * (rows // of * of) + rows % of * apart


@pytest.mark.parametrize(
    ("time", "rows"),
    [
        (packets(8, 1e-5), 8),
        (packets(25, 1e-6), 25),
        (packets(50, 1e-4), 50),  # as a logger that rounds to tenths of a second and makes rows differ
        (even(), 0),
        (packets(8, 0.5 * STEP_S), 0),  # jitter
        (np.concatenate([even(500), 60 + even(500), 120 + even(500), 180 + even(500), 240 + even(500)]), 0),  # pauses
        (np.delete(even(), np.arange(3, 1500, 7)), 0),  # lost samples
    ],
)
def test_packets_are_told_from_pauses_and_lost_samples(time: Array, rows: int) -> None:
    assert rows_of_a_packet(time) == rows


def test_a_motion_that_came_in_packets_is_an_error_that_names_it(tmp_path: Path) -> None:
    """Such a clock asked for an array of 189 GiB, or kept `bench check` busy for minutes."""
    columns = sweep(3)
    rows = np.arange(len(columns["time_s"]))
    columns["time_s"] = columns["time_s"][rows // 8 * 8] + rows % 8 * 1e-5
    report = check_campaign(write_folder(tmp_path / "campaign", motion(columns)))
    (found,) = report.errors
    assert "runs/a.csv: time_s" in str(found)
    assert "some 8 rows" in str(found)
    assert "samples came in packets" in str(found)
    assert not [one for one in report.findings if "look for lost samples" in one.remedy]
