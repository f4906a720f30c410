"""Logs as robots give them: separators, no header, windows, long logs."""

from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyarrow import parquet

from bench.cli import main
from bench.errors import CampaignError, InputError
from bench.record.convert import convert
from bench.record.log_format import LogFormat, read_log_format
from bench.record.logs.dialect import Dialect, guess_dialect, read_log_table
from bench.report.log_look.look import look
from tests.record.test_convert import log

JOINTS = 3
RATE = 500.0  # [Hz]


def layout(**more: Any) -> LogFormat:
    return LogFormat.model_validate({"columns": {"time_s": {"from": "t"}, "q_motor_1_rad": {"from": "q"}}} | more)


def by_number(**more: Any) -> LogFormat:
    """31 columns without names: clock, then angles, and at the end currents."""
    columns: dict[str, Any] = {"time_s": {"from": "1"}}
    for j in range(JOINTS):
        columns[f"q_motor_{j + 1}_rad"] = {"from": str(2 + j)}
        columns[f"current_{j + 1}_a"] = {"from": str(29 + j)}
    return LogFormat.model_validate({"columns": columns} | more)


def wide(rows: int = 40) -> np.ndarray:
    """Return a UR style log: 31 numbers a row, at 500 Hz."""
    cells = np.random.default_rng(3).normal(size=(rows, 31)).round(4)
    cells[:, 0] = np.arange(rows) / RATE
    return cells


def text_of(cells: np.ndarray, separator: str = ",", decimal: str = ".", end: str = "") -> str:
    return "".join(separator.join(f"{x:.4f}".replace(".", decimal) for x in row) + end + "\n" for row in cells)


@pytest.mark.parametrize(
    ("separator", "decimal", "end", "stated"),
    [
        (",", ".", "", {}),
        (";", ",", "", {"separator": ";", "decimal": ","}),
        (";", ".", ";", {"separator": ";"}),
        (" ", ".", "", {"separator": "space"}),
        ("\t", ",", "", {"separator": "tab", "decimal": ","}),
        ("|", ".", "", {"separator": "|"}),
    ],
)
def test_columns_by_number_in_any_dialect(
    tmp_path: Path, separator: str, decimal: str, end: str, stated: dict[str, str]
) -> None:
    cells, table = wide(), {"header": False} | stated
    file = log(tmp_path, "ur.csv", text_of(cells, separator, decimal, end))
    assert guess_dialect(file.read_bytes()) == Dialect.model_validate(table)
    (run,) = convert(file, by_number(table=table), "mine").campaign.runs
    np.testing.assert_allclose(run.columns["time_s"], cells[:, 0], atol=1e-12)
    np.testing.assert_array_equal(run.columns["q_motor_3_rad"], cells[:, 3])
    np.testing.assert_array_equal(run.columns["current_3_a"], cells[:, 30])


def test_lines_before_the_header_and_a_header_that_is_a_comment(tmp_path: Path) -> None:
    file = log(tmp_path, "x.txt", "recorder 3\ndate: today\n# t q\n 0.0   1e-1\n 0.5   2e-1\n")
    table = {"separator": "space", "skip_lines": 2}
    assert guess_dialect(b"recorder 3\n\nt;q;\n0;1,5;\n1;2,5;\n") == Dialect.model_validate(
        {"separator": ";", "decimal": ",", "skip_lines": 2}
    )
    (run,) = convert(file, layout(table=table), "mine").campaign.runs
    np.testing.assert_array_equal(run.columns["q_motor_1_rad"], [0.1, 0.2])


def test_a_line_of_units_below_the_header(tmp_path: Path) -> None:
    file = log(tmp_path, "x.csv", "made by y\nt;q\n[s];[rad]\n0;1\n1;oops\n2;3\n")
    table = {"separator": ";", "skip_lines": 1, "units_line": True}
    assert guess_dialect(file.read_bytes().replace(b"oops", b"2")) == Dialect.model_validate(table)
    with pytest.raises(CampaignError, match=r"x\.csv: row 2 \(line 5\): q: 'oops' is no number"):
        convert(file, layout(table=table), "mine")
    file.write_text(file.read_text().replace("oops", "2"))
    np.testing.assert_array_equal(
        convert(file, layout(table=table), "mine").campaign.runs[0].columns["q_motor_1_rad"], [1, 2, 3]
    )


def test_a_log_without_a_header_is_one_error(tmp_path: Path) -> None:
    """It was one error for each column that was asked for, each with 31 numbers as known names."""
    for name in ("a.csv", "b.csv", "c.csv"):
        log(tmp_path, name, text_of(wide()))
    names = [f"q{j}" for j in range(13)]
    asked = {f"q_motor_{j + 1}_rad": {"from": name} for j, name in enumerate(names)}
    with pytest.raises(CampaignError) as caught:
        convert(tmp_path, LogFormat.model_validate({"columns": {"time_s": {"from": "t"}} | asked}), "mine")
    (told,) = caught.value.problems
    assert told.startswith("a.csv: has no header: its first line holds numbers (likewise in b.csv, c.csv);")
    assert "write `table: {header: false}` into the log.yaml" in told
    assert "0.0" not in told


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            "t;q\n0;1,5\n1;2,5\n",
            r"separated by semicolons, numbers have decimal commas.*separator: \";\", decimal: \",\"",
        ),
        ("t\tq\n0\t1\n1\t2\n", r"separated by tabs; write `table: \{separator: tab\}`"),
        ("made by x\nt,q\n0,1\n1,2\n", r"numbers begin in line 3; write `table: \{skip_lines: 1\}`"),
        ("t,q\ns,rad\n0,1\n1,2\n", r"numbers begin in line 3; write `table: \{units_line: true\}`"),
        ("t,q\n0,1\n1,\n2,3\n", r"row 2 \(line 3\): q: no value.*fill: hold"),
    ],
)
def test_another_dialect_is_told_with_what_to_write(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(CampaignError, match=said):
        convert(log(tmp_path, "x.csv", text), layout(), "mine")


def test_one_fault_in_many_columns_and_files_is_one_error(tmp_path: Path) -> None:
    """Degrees in all joints of all files were an error for each joint of each file."""
    columns = {"time_s": {"from": "t"}} | {f"q_motor_{j}_rad": {"from": f"q{j}"} for j in (1, 2, 3)}
    for name in ("a.csv", "b.csv"):
        rows = "".join(f"{k},{50 + k},{-80 - k},{90 + k}\n" for k in range(5))
        log(tmp_path, name, "t,q1,q2,q3\n" + rows)
    with pytest.raises(CampaignError) as caught:
        convert(tmp_path, LogFormat.model_validate({"columns": columns}), "mine")
    (told,) = caught.value.problems
    assert "a.csv: row 1 (line 2): q1 (q_motor_1_rad): 50 rad is no position" in told
    assert "(likewise in q2 (q_motor_2_rad), q3 (q_motor_3_rad) and in b.csv)" in told


def test_missing_columns_are_one_error_for_all_files(tmp_path: Path) -> None:
    for name in ("a.csv", "b.csv"):
        log(tmp_path, name, text_of(wide()[:, :2]).replace("0.0000", "t,angle\n0", 1))
    with pytest.raises(CampaignError) as caught:
        convert(tmp_path, by_number(), "mine")
    (told,) = caught.value.problems
    assert "a.csv: lacks column 29 (current_1_a), column 3 (q_motor_2_rad), " in told
    assert "likewise in b.csv" in told


def test_command_is_not_demanded(tmp_path: Path) -> None:
    (run,) = convert(log(tmp_path, "x.csv", "t,q\n0,1\n1,2\n"), layout(), "mine").campaign.runs
    assert set(run.columns) == {"time_s", "q_motor_1_rad"}


def test_windows_and_stated_splits(tmp_path: Path) -> None:
    time = 100 + np.arange(0, 60, 0.1)
    file = log(tmp_path, "x.csv", "t,q\n" + "".join(f"{t:.1f},{np.sin(t):.6f}\n" for t in time))
    runs = convert(file, layout(runs={"windows_s": [[10, 20], [30, 50]], "split_at_s": [40]}), "mine").campaign.runs
    assert [(run.name, round(run.start_s, 6)) for run in runs] == [("x", 10.0), ("x_2", 30.0), ("x_3", 40.0)]
    np.testing.assert_allclose([run.columns["time_s"][-1] for run in runs], [10, 9.9, 10])
    np.testing.assert_allclose(runs[2].columns["q_motor_1_rad"], np.sin(time[400:501]), atol=1e-6)
    assert "from 40 s" in runs[2].note
    with pytest.raises(CampaignError, match=r"window \[70.0, 80.0\] s holds no row: the log ends after 59.9 s"):
        convert(file, layout(runs={"windows_s": [[70, 80]]}), "mine")


def test_faults_outside_of_the_window_do_not_matter_and_rows_are_those_of_the_log(tmp_path: Path) -> None:
    rows = [f"{t},{'' if t in (1, 7) else 0.1 * t}" for t in range(12)]
    file = log(tmp_path, "x.csv", "t,q\n" + "\n".join(rows) + "\n")
    (run,) = convert(file, layout(runs={"windows_s": [[2, 6]]}), "mine").campaign.runs
    assert len(run) == 5
    with pytest.raises(CampaignError, match=r"x\.csv: row 8 \(line 9\): q: no value"):
        convert(file, layout(runs={"windows_s": [[2, 9]]}), "mine")


def test_a_long_log_is_split_where_the_robot_stands(tmp_path: Path) -> None:
    """Three strokes of 2 s with rests of 3 s and 0.4 s: only the long rest ends a run, half of the asked rest stays."""
    step, noise = 0.01, np.random.default_rng(1)
    speed = np.concatenate([np.full(round(d / step), v) for d, v in [(2, 0.2), (3, 0), (2, -0.2), (0.4, 0), (2, 0.2)]])
    position = np.cumsum(speed) * step + noise.normal(scale=2e-5, size=len(speed))
    rows = "".join(f"{k * step:.2f},{q:.6f}\n" for k, q in enumerate(position))
    runs = convert(log(tmp_path, "x.csv", "t,q\n" + rows), layout(runs={"split_at_rest_s": 1.0}), "mine").campaign.runs
    np.testing.assert_allclose([run.start_s for run in runs], [0, 4.5], atol=0.03)
    np.testing.assert_allclose([run.columns["time_s"][-1] for run in runs], [2.5, 4.9], atol=0.03)


@given(
    rows=st.integers(3, 30),
    columns=st.integers(2, 12),
    seed=st.integers(0, 2**32 - 1),
    dialect=st.sampled_from(
        [(",", "."), (";", "."), (";", ","), (" ", "."), (" ", ","), ("\t", "."), ("\t", ","), ("|", ".")]
    ),
    header=st.booleans(),
    before=st.integers(0, 3),
    end=st.booleans(),
)
def test_any_way_of_writing_is_guessed_and_read_back(
    tmp_path_factory: pytest.TempPathFactory,
    rows: int,
    columns: int,
    seed: int,
    dialect: tuple[str, str],
    header: bool,
    before: int,
    end: bool,
) -> None:
    separator, decimal = dialect
    cells = np.random.default_rng(seed).normal(scale=30, size=(rows, columns)).round(4)
    above = "".join(" ".join(["remark"] * 20) + "\n" for _ in range(before))  # more words than columns
    names = separator.join(f"c{k}" for k in range(columns)) + "\n" if header else ""
    file = tmp_path_factory.mktemp("log") / "x.csv"
    text = text_of(cells, separator, decimal, separator if end and separator != " " else "")
    file.write_text(above + names + text)
    guess = guess_dialect(file.read_bytes())
    assert guess is not None
    assert guess.header == header
    table = read_log_table(file, guess)
    assert not table.findings
    assert table.names == tuple(f"c{k}" for k in range(columns)) if header else table.names[0] == "1"
    for name, values in zip(table.names, cells.T, strict=True):
        np.testing.assert_array_equal(table.columns[name], values)


def test_a_window_on_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rows = "".join(f"{k / 100},{0.1 * np.sin(k / 9)},{0.1 * np.sin(k / 9)},{np.cos(k / 9)}\n" for k in range(300))
    log(tmp_path, "x.csv", "time_s,q_cmd_m,q_m,u_V\n" + rows)
    command = ["convert", "emps", str(tmp_path / "x.csv"), "-o", str(tmp_path / "campaign")]
    assert main([*command, "--window-s", "2", "1"]) == 2
    assert main([*command, "--window-s", "0.5", "1.5"]) == 0
    assert "1 run, 101 rows" in capsys.readouterr().out
    assert main([*command[:-1], str(tmp_path / "late"), "--window-s", "7", "8"]) == 3
    assert "window [7.0, 8.0] s holds no row: the log ends after 2.99 s; give one within the log (--window-s, or" in (
        capsys.readouterr().err
    )


def test_columns_by_number_below_a_header(tmp_path: Path) -> None:
    form = LogFormat.model_validate({"columns": {"time_s": {"from": "1"}, "q_motor_1_rad": {"from": "3"}}})
    converted = convert(log(tmp_path, "x.csv", "t,q,q2\n0,1,5\n1,2,6\n"), form, "mine")
    np.testing.assert_array_equal(converted.campaign.runs[0].columns["q_motor_1_rad"], [5, 6])
    assert converted.unused == {"x.csv": ("q",)}


def test_parquet(tmp_path: Path) -> None:
    cells = wide()
    parquet.write_table(pa.table({"t": cells[:, 0], "q": cells[:, 1]}), tmp_path / "x.parquet")
    (run,) = convert(tmp_path, layout(runs={"windows_s": [[0.01, 0.02]]}), "mine").campaign.runs
    np.testing.assert_array_equal(run.columns["q_motor_1_rad"], cells[5:11, 1])


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("columns: {time_s: {factor: 2}}", "name or the number of a column"),
        ("columns: {q_motor_1_rad: {rate_hz: 2}}", "rate_hz is for time_s alone"),
        ("columns: {q_motor_1_rad: {from: a}}\nresample: {rate_hz: 5}", "need a clock"),
        ("columns: {time_s: {from: a}}\nresample: {rate_hz: 5, cutoff_hz: 3}", "above half of rate_hz, 2.5 Hz"),
        ("columns: {time_s: {from: a}}\ntable: {decimal: ','}", "which comma is which"),
        ("columns: {time_s: {from: a}}\nruns: {windows_s: [[5, 3]]}", "5 is not before 3"),
        ("columns: {time_s: {from: a}}\nruns: {windows_s: [[1, 3], [2, 4]]}", "a row belongs to one run"),
        ("columns: {time_s: {from: a}}\nruns: {split_at_s: [3, 2]}", "in rising order"),
        ("columns: {time_s: {from: a, table: b}}", "unknown table 'b'"),
        (
            "columns: {q_motor_1_rad: {from: a, factor: 0}}",
            r"columns\.q_motor_1_rad\.factor: is 0.*one unit of the log",
        ),
        ("columns: {time_s: {from: a, factor: -0.0}}", r"columns\.time_s\.factor: is 0"),
        ("columns: {time_s: {from: a}, current_1_a: }", r"line 1: columns\.current_1_a has no value"),
        ("columns: {time_s: {from: !x a}}", "line 1: 'a' is no !x that is read"),
    ],
)
def test_a_format_that_cannot_be_is_told(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        read_log_format(log(tmp_path, "log.yaml", text))


@pytest.mark.parametrize(
    ("cells", "said"),
    [
        (
            ("01.02.2024 00:00:00.{k:03d}", "{k}.5", "2.5"),
            "column 't', row 1: '01.02.2024 00:00:00.000' .*write seconds",
        ),
        (("{k}", "1.{k:03d},5", "3"), "column 'q', row 1: '1.000,5' is no number; .*without marks between thousands"),
        (("{k}", "on", "3"), "column 'q', row 1: 'on' is no number"),
    ],
)
def test_a_cell_that_is_no_number_is_named_and_not_the_separator(
    tmp_path: Path, cells: tuple[str, ...], said: str
) -> None:
    rows = "".join(";".join(cells).format(k=k) + "\n" for k in range(40))
    with pytest.raises(CampaignError, match=said) as raised:
        look(log(tmp_path, "a.csv", "t;q;i\n" + rows))
    assert "separated" not in str(raised.value)


def test_plain_text_is_a_log_where_a_folder_has_no_others(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text("t,q\n0,1\n0.1,2\n0.2,3\n")
    assert [run.name for run in convert(tmp_path, layout(), "mine").campaign.runs] == ["a"]
    (tmp_path / "b.csv").write_text("t,q\n0,1\n0.1,2\n0.2,3\n")
    (tmp_path / "a.txt").write_text("notes")
    assert [run.name for run in convert(tmp_path, layout(), "mine").campaign.runs] == ["b"]


@pytest.mark.parametrize(
    ("more", "key"),
    [
        ({"topic": "/joint_states"}, "(topic)"),
        ({"tables": {"force": {"topic": "/force", "time_s": {"from": "t"}}}}, "(tables.force.topic)"),
    ],
)
def test_a_table_has_no_topics(tmp_path: Path, more: dict[str, Any], key: str) -> None:
    """A topic was left aside without a word."""
    with pytest.raises(CampaignError) as caught:
        convert(log(tmp_path, "x.csv", "t,q\n0,0\n1,1\n"), layout(**more), "mine")
    assert "x.csv: is no MCAP recording" in str(caught.value)
    assert key in str(caught.value)


def test_a_proposal_may_stand_in_a_folder_that_is_new(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """`bench convert -o` makes folders; with `--look` it did not."""
    time = np.arange(200) / 100
    np.savetxt(tmp_path / "x.csv", np.stack([time, np.sin(time)], 1), delimiter=",", header="t,q", comments="")
    place = tmp_path / "new" / "deep" / "l.yaml"
    assert main(["convert", "--look", str(tmp_path / "x.csv"), "--topic", "/a", "-o", str(place)]) == 3
    assert "leave --topic out" in capsys.readouterr().err
    assert not place.parent.exists()
    assert main(["convert", "--look", str(tmp_path / "x.csv"), "-o", str(place)]) == 0
    assert place.is_file()
