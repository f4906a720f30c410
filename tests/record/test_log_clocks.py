"""Clocks of logs: dates, none at all, jitter and lost samples, other rates, several clocks."""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyarrow import parquet

from bench.errors import CampaignError
from bench.record.convert import convert
from bench.record.log_format import LogFormat
from bench.record.logs.resample import Resampling
from bench.record.table import read_table
from tests.record.test_convert import log
from tests.record.test_logs import RATE, layout


def test_resampling_keeps_what_is_slow_and_removes_what_is_fast(tmp_path: Path) -> None:
    """A sine of 3 Hz stays to 0.1 %, one of 180 Hz, which would fold down to 20 Hz, is gone to 0.1 %."""
    time = np.arange(2000) / RATE
    slow, fast = np.sin(2 * np.pi * 3 * time), np.sin(2 * np.pi * 180 * time)
    rows = "".join(f"{t:.7f},{a + b:.7f}\n" for t, a, b in zip(time, slow, fast, strict=True))
    (run,) = convert(log(tmp_path, "x.csv", "t,q\n" + rows), layout(resample={"rate_hz": 100}), "mine").campaign.runs
    clock, inner = run.columns["time_s"], slice(20, -20)
    np.testing.assert_allclose(np.diff(clock), 0.01, atol=1e-12)
    expected = np.sin(2 * np.pi * 3 * clock)
    np.testing.assert_allclose(run.columns["q_motor_1_rad"][inner], expected[inner], atol=2e-3)


def test_stamps_that_jitter_are_made_even(tmp_path: Path) -> None:
    """The first pass cuts a run where a step differs by 5 %; it found nothing in such a log."""
    time = np.arange(2000) / RATE + np.random.default_rng(2).uniform(-2e-4, 2e-4, 2000)
    rows = "".join(f"{t:.7f},{np.sin(6 * t):.7f}\n" for t in time)
    (run,) = convert(log(tmp_path, "x.csv", "t,q\n" + rows), layout(resample={"rate_hz": RATE}), "mine").campaign.runs
    clock = run.columns["time_s"]
    np.testing.assert_allclose(np.diff(clock), 0.002, atol=1e-12)
    np.testing.assert_allclose(run.columns["q_motor_1_rad"], np.sin(6 * (clock + time[0])), atol=6**2 * 0.0024**2 / 8)


def test_lost_samples_are_not_bridged(tmp_path: Path) -> None:
    time = np.concatenate([np.arange(0, 1, 0.01), np.arange(3, 4, 0.01)])
    rows = "".join(f"{t:.2f},{t:.4f}\n" for t in time)
    converted = convert(log(tmp_path, "x.csv", "t,q\n" + rows), layout(resample={"rate_hz": 50}), "mine").campaign
    assert [round(run.start_s, 3) for run in converted.runs] == [0, 3]
    assert "Resampled to 50 Hz" in converted.notes
    assert "20 Hz" in converted.notes  # the filter is stated


def test_slow_columns_with_empty_cells(tmp_path: Path) -> None:
    text = "t,q,temp\n0,0.1,\n1,0.2,20\n2,0.3,\n3,0.4,\n4,0.5,26\n"
    columns = {"time_s": {"from": "t"}, "q_motor_1_rad": {"from": "q"}}
    for how, expected in (("hold", [20, 20, 20, 20, 26]), ("line", [20, 20, 22, 24, 26])):
        slow = {"gear_temperature_1_k": {"from": "temp", "offset": 273.15, "fill": how}}
        form = LogFormat.model_validate({"columns": columns | slow})
        (run,) = convert(log(tmp_path, "x.csv", text), form, "mine").campaign.runs
        np.testing.assert_allclose(run.columns["gear_temperature_1_k"], np.array(expected) + 273.15)


def test_another_table_with_its_own_clock(tmp_path: Path) -> None:
    log(tmp_path, "a.csv", "t,q\n" + "".join(f"{10 + k * 0.004:.3f},{k * 1e-3:.4f}\n" for k in range(500)))
    log(tmp_path, "a_force.csv", "ms;fz\n" + "".join(f"{9990 + 20 * k};{k}\n" for k in range(110)))
    tables = {"force": {"file": "*_force.csv", "time_s": {"from": "ms", "factor": 1e-3}, "table": {"separator": ";"}}}
    columns = {
        "time_s": {"from": "t"},
        "q_motor_1_rad": {"from": "q"},
        "force_z_n": {"from": "fz", "table": "force", "factor": -1},
    }
    form = LogFormat.model_validate({"columns": columns, "tables": tables})
    (run,) = convert(tmp_path, form, "mine").campaign.runs
    expected = -(run.columns["time_s"] + 0.01) / 0.02
    np.testing.assert_allclose(run.columns["force_z_n"], expected, atol=1e-9)
    log(tmp_path, "a_force.csv", "ms;fz\n" + "".join(f"{9990 + 20 * k};{k}\n" for k in range(11)))
    with pytest.raises(CampaignError, match=r"fz of force: no value.*other table has no readings"):
        convert(tmp_path, form, "mine")


def with_beside(folder: Path, rows: str, channel: str, time_s: dict[str, object]) -> LogFormat:
    """Write a log of two seconds and a table beside it, and return the format that takes one channel out of that."""
    log(folder, "a.csv", "t,q\n" + "".join(f"{k * 0.004:.3f},{k * 1e-3:.4f}\n" for k in range(500)))
    log(folder, "a_other.csv", "clock,x\n" + rows)
    columns = {"time_s": {"from": "t"}, "q_motor_1_rad": {"from": "q"}, channel: {"from": "x", "table": "other"}}
    tables = {"other": {"file": "*_other.csv", "time_s": {"from": "clock"} | time_s}}
    return LogFormat.model_validate({"columns": columns, "tables": tables})


@pytest.mark.parametrize(("factor", "unit"), [(1e-3, ""), (1.0, "milliseconds"), (1e3, "microseconds")])
def test_another_table_whose_clock_has_a_finer_unit_is_told(tmp_path: Path, factor: float, unit: str) -> None:
    """In milliseconds its first rows were spread over the whole log, without a word."""
    rows = "".join(f"{20 * k - 30},{k}\n" for k in range(105))
    form = with_beside(tmp_path, rows, "force_z_n", {"factor": factor})
    warnings = convert(tmp_path, form, "mine").warnings
    assert len(warnings) == bool(unit)
    if unit:
        assert f"in {unit}? then write `factor: {1e-3 / factor:g}` in `tables: other: time_s`" in str(warnings[0])


def test_a_table_of_the_whole_day_is_no_finer_unit(tmp_path: Path) -> None:
    rows = "".join(f"{10 * k - 50},{290 + k % 2}\n" for k in range(8640))
    form = with_beside(tmp_path, rows, "ambient_temperature_k", {})
    assert not convert(tmp_path, form, "mine").warnings


@pytest.mark.parametrize("ending", ["csv", "parquet"])
def test_a_clock_is_no_torque(tmp_path: Path, ending: str) -> None:
    """A Parquet column of time stamps was taken for a torque of 1.7 GNm."""
    seconds = np.arange(500) * 0.004
    stamps = (np.int64(1747126800_000_000_000) + np.round(seconds * 1e9).astype(np.int64)).astype("datetime64[ns]")
    if ending == "parquet":
        table = {"t": seconds, "q": 1e-3 * seconds, "m": pa.array(stamps)}
        parquet.write_table(pa.table(table), tmp_path / "a.parquet")
    else:
        rows = "".join(f"{t:.3f},{1e-3 * t:.6f},{s}\n" for t, s in zip(seconds, stamps, strict=True))
        log(tmp_path, "a.csv", "t,q,m\n" + rows)
    columns = {
        "time_s": {"from": "t"},
        "q_motor_1_rad": {"from": "q"},
        "tau_motor_1_nm": {"from": "m", "factor": -0.5},
    }
    with pytest.raises(CampaignError, match=r"m \(tau_motor_1_nm\): holds moments|m: holds moments"):
        convert(tmp_path, LogFormat.model_validate({"columns": columns}), "mine")


@pytest.mark.parametrize(
    ("late", "readings", "rows"), [(0.001, 499, (1, 499)), (-0.001, 500, (0, 499)), (0.0, 500, (0, 500))]
)
def test_another_table_need_not_begin_and_end_with_the_same_sample(
    tmp_path: Path, late: float, readings: int, rows: tuple[int, int]
) -> None:
    """A logger that began half a millisecond later was refused, and one window does for no two logs."""
    log(tmp_path, "a.csv", "t,q\n" + "".join(f"{k * 0.004:.3f},{k * 1e-3:.4f}\n" for k in range(500)))
    log(tmp_path, "a.cur", "t,i\n" + "".join(f"{k * 0.004 + late:.3f},{k}\n" for k in range(readings)))
    columns = {"time_s": {"from": "t"}, "q_motor_1_rad": {"from": "q"}, "current_1_a": {"from": "i", "table": "drives"}}
    form = LogFormat.model_validate(
        {"columns": columns, "tables": {"drives": {"file": "*.cur", "time_s": {"from": "t"}}}}
    )
    (run,) = convert(tmp_path, form, "mine").campaign.runs
    first, last = rows
    np.testing.assert_allclose(run.columns["q_motor_1_rad"], np.arange(first, last) * 1e-3, atol=1e-9)
    np.testing.assert_allclose(run.columns["current_1_a"], np.arange(first, last) - late / 0.004, atol=1e-6)


@pytest.mark.parametrize("stamp", ["{}", "{}Z", "{}+02:00", "{}-05:30"])
@pytest.mark.parametrize("between", ["T", " "])
def test_a_clock_of_dates(tmp_path: Path, stamp: str, between: str) -> None:
    moments = [f"2024-12-31{between}23:59:59.900", f"2025-01-01{between}00:00:00", f"2025-01-01{between}00:00:00.1"]
    rows = "".join(f"{stamp.format(moment)};{0.1 * k:.1f}\n" for k, moment in enumerate(moments))
    form = layout(table={"separator": ";"})
    (run,) = convert(log(tmp_path, "x.csv", "t;q\n" + rows), form, "mine").campaign.runs
    np.testing.assert_allclose(run.columns["time_s"], [0, 0.1, 0.2], atol=1e-6)
    with pytest.raises(CampaignError, match=r"2024-13-31.*is no number"):
        convert(log(tmp_path, "y.csv", "t;q\n" + rows.replace("2024-12", "2024-13")), form, "mine")


def _dated(folder: Path, **begins: float) -> None:
    for name, begin in begins.items():
        log(folder, f"{name}.csv", "t,q\n" + "".join(f"{begin + 0.1 * k:.1f},{0.1 * k:.1f}\n" for k in range(100)))


def test_logs_whose_clocks_are_dates_say_when_they_were_started(tmp_path: Path) -> None:
    """Stamps of ROS count from 1970. Runs were put a minute apart all the same, and drives cool down in ten."""
    _dated(tmp_path, a=1_779_000_720.0, b=1_779_000_000.5)
    campaign = convert(tmp_path, layout(), "mine").campaign
    assert {run.name: round(run.start_s, 6) for run in campaign.runs} == {"a": 719.5, "b": 0.0}
    assert campaign.started is not None
    assert campaign.started.isoformat() == "2026-05-17T06:40:00.500000+00:00"
    assert not any("not known" in run.note for run in campaign.runs)
    later = layout(runs={"windows_s": [[2, 5]]})
    assert sorted(round(run.start_s, 6) for run in convert(tmp_path, later, "mine").campaign.runs) == [2.0, 721.5]


@pytest.mark.parametrize(
    ("first", "second"),
    [
        (1_779_000_000.0, 1_779_000_005.0),  # two clocks that differ, or one log twice
        (1_779_000_000.0, 12.0),  # one that counts from when the machine was turned on
        (946_684_900.0, 946_684_800.0),  # a battery that is dead: 2000-01-01
        (12.0, 1_779_000_000.0),  # as the second, the other way round
        (0.0, 0.0),  # each begins with its log
        (500.0, 30.0),  # a counter that began anew
    ],
)
def test_clocks_that_cannot_be_dates_of_one_machine_say_nothing_of_starts(
    tmp_path: Path, first: float, second: float
) -> None:
    _dated(tmp_path, a=first, b=second)
    campaign = convert(tmp_path, layout(), "mine").campaign
    assert [round(run.start_s, 6) for run in campaign.runs] == [0.0, 69.9]
    assert campaign.started is None
    assert all("time of its start is not known" in run.note for run in campaign.runs)


def test_a_counter_that_ran_on_says_when_logs_were_started(tmp_path: Path) -> None:
    """A stranger's second log began at 150 000 ms and was put a minute after the first; friction falls by the hour."""
    _dated(tmp_path, a=2.5, b=152.5, c=330.0)
    campaign = convert(tmp_path, layout(), "mine").campaign
    assert [round(run.start_s, 6) for run in campaign.runs] == [0.0, 150.0, 327.5]
    assert campaign.started is None
    assert not any("not known" in run.note for run in campaign.runs)


def test_more_rows_than_were_read_are_a_warning(tmp_path: Path) -> None:
    """One `log.yaml` for logs of 500 and of 250 Hz made each second row of the latter out of nothing, unsaid."""
    for name, rate in (("a", 500.0), ("b", 250.0)):
        log(tmp_path, f"{name}.csv", "t,q\n" + "".join(f"{k / rate:.4f},{0.1 * k:.1f}\n" for k in range(100)))
    (warning,) = convert(tmp_path, layout(resample={"rate_hz": 499.9}), "mine").warnings
    assert str(warning).startswith("b.csv: is read 250 times a second, and made 499.9 rows a second by straight lines")
    assert not convert(tmp_path, layout(resample={"rate_hz": 250}), "mine").warnings


@pytest.mark.parametrize(
    "second",
    [
        *("1970-01-01T00:30:01{}+01:00", "1900-01-01 00:00:00{}", "1904-01-01T00:00:00{}Z", "1969-12-31T23:59:59{}"),
        *("0001-01-01T00:00:00{}", "0001-01-01T00:30:00{}+01:00", "9999-12-31T23:59:59{}-01:00"),
    ],
)
def test_a_clock_before_1970_runs_forwards(tmp_path: Path, second: str) -> None:
    """A controller whose battery is dead begins anew in 1970, at midnight of its zone, or in 1900 or 1904."""
    stamps = [second.format(fraction) for fraction in ("", ".25", ".500", ".750000")]
    rows = "".join(f"{stamp},{k}\n" for k, stamp in enumerate(stamps))
    (run,) = convert(log(tmp_path, "x.csv", "t,q\n" + rows), layout(), "mine").campaign.runs
    np.testing.assert_allclose(run.columns["time_s"], [0, 0.25, 0.5, 0.75], atol=1e-4)  # double: 3e-5 s at 2.5e11 s


def test_a_log_without_a_clock(tmp_path: Path) -> None:
    form = LogFormat.model_validate({"columns": {"time_s": {"rate_hz": 500}, "q_motor_1_rad": {"from": "q"}}})
    (run,) = convert(log(tmp_path, "x.csv", "q,z\n0.1,0\n0.2,0\n0.3,0\n"), form, "mine").campaign.runs
    np.testing.assert_allclose(run.columns["time_s"], [0, 0.002, 0.004])


def test_parquet_with_dates(tmp_path: Path) -> None:
    """A campaign's own table refuses dates; of a log they are the clock. A column of words is not asked for."""
    stamps = pa.array(1_700_000_000_000_000 + 2000 * np.arange(4), pa.timestamp("us"))
    content = {"t": stamps, "q": [0.1, 0.2, 0.3, 0.4], "word": ["a", "b", "c", "d"]}
    parquet.write_table(pa.table(content), tmp_path / "x.parquet")
    (run,) = convert(tmp_path, layout(), "mine").campaign.runs
    np.testing.assert_allclose(run.columns["time_s"], [0, 0.002, 0.004, 0.006], atol=1e-6)
    assert "holds timestamp" in str(read_table(tmp_path, "x.parquet").findings[0])


@given(begin=st.integers(0, 500), steps=st.integers(2, 400), rate=st.sampled_from([10.0, 30.0, 50.0, 100.0, 250.0]))
def test_resampling_asks_for_nothing_after_the_last_row(begin: int, steps: int, rate: float) -> None:
    """The last instant of the new clock lay after the last row by rounding, and was read as an empty cell."""
    time = np.arange(begin, begin + steps) * 0.02
    for stretch in Resampling(rate_hz=rate).applied({"time_s": time, "q": time}):
        assert np.all(np.isfinite(stretch["q"]))
