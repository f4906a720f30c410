"""Whatever is written comes back bit for bit; whatever is damaged is refused with a `CampaignError` or still sound."""

from datetime import UTC, datetime
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bench.errors import CampaignError
from bench.record import csv_table
from bench.record.campaign import Arm, Array, Campaign, Run, RunKind
from bench.record.channels import NAMES
from bench.record.check import check_campaign
from bench.record.csv_table import read as read_csv
from bench.record.csv_table import write as write_csv
from bench.record.finding import Finding
from bench.record.read import read_campaign
from bench.record.rules.clock import rows_of_a_packet
from bench.record.write import TableFormat, write_campaign
from tests.record.build import ARM, examine, loading, session, sweep

CHANNELS = {  # measured columns and the largest values that no rule takes for another unit
    "q_motor_1_rad": 12.0,
    "q_motor_2_rad": 12.0,
    "current_1_a": 999.0,
    "force_z_n": 1e6,
    "moment_x_nm": 1e6,
    "tau_motor_2_nm": 1e6,
    "gas_pressure_pa": 5e4,  # below zero it ends where no gauge errs so far
}

texts = st.text(st.characters(codec="utf-8"), max_size=30)


def is_no_packet(steps: list[float]) -> bool:
    return not rows_of_a_packet(np.cumsum(steps))


@st.composite
def runs(draw: st.DrawFn, name: str, start_s: float) -> Run:
    n = draw(st.integers(1, 12))

    def column(bound: float) -> Array:
        return np.array(draw(st.lists(st.floats(-bound, bound), min_size=n, max_size=n)))

    columns = {"q_cmd_1_rad": column(12.0)}
    columns |= {channel: column(bound) for channel, bound in CHANNELS.items() if draw(st.booleans())}
    columns["current_2_a"] = column(999.0)
    steps = np.array(draw(st.lists(st.floats(1e-4, 1e3), min_size=n, max_size=n).filter(is_no_packet)))
    if draw(st.booleans()):
        return Run(name, "motion", start_s, {"time_s": np.cumsum(steps)} | columns, draw(texts))
    labels = {
        label: np.array(draw(st.lists(st.integers(0, 99), min_size=n, max_size=n))) for label in ("pose", "load_step")
    }
    return Run(name, "static", start_s, labels | columns, draw(texts))


YEARS = datetime(1970, 1, 2), datetime(2100, 12, 30)  # anywhere on Earth


@st.composite
def campaigns(draw: st.DrawFn) -> Campaign:
    starts = sorted(draw(st.lists(st.floats(0, 1e6), min_size=1, max_size=3)))
    return Campaign(
        robot=draw(texts.filter(bool)),
        runs=tuple(draw(runs(f"run-{i}", start)) for i, start in enumerate(starts)),
        started=draw(st.none() | st.datetimes(*YEARS) | st.datetimes(*YEARS, timezones=st.just(UTC))),
        noise=draw(st.dictionaries(st.sampled_from(["current", "force", "reflector"]), st.floats(1e-9, 0.1))),
        notes=draw(texts),
    )


@pytest.mark.parametrize("table_format", ["csv", "parquet"])
@settings(max_examples=50)
@given(campaign=campaigns())
def test_round_trip_is_exact(table_format: TableFormat, campaign: Campaign) -> None:
    with TemporaryDirectory() as folder:
        write_campaign(campaign, Path(folder) / "campaign", table_format)
        again = read_campaign(Path(folder) / "campaign")
    assert (again.robot, again.started, again.notes) == (campaign.robot, campaign.started, campaign.notes)
    assert again.noise == campaign.noise
    assert len(again.runs) == len(campaign.runs)
    for run, original in zip(again.runs, campaign.runs, strict=True):
        assert (run.name, run.kind, run.start_s, run.note) == (
            original.name,
            original.kind,
            original.start_s,
            original.note,
        )
        assert list(run.columns) == list(original.columns)
        for name, values in run.columns.items():
            assert values.tobytes() == original.columns[name].tobytes(), name
            assert not values.flags.writeable


@given(values=st.lists(st.floats(allow_nan=False), max_size=20))
def test_csv_keeps_every_float(values: list[float]) -> None:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "a.csv"
        write_csv(path, {"x": np.array(values)})
        content = read_csv(path, "a.csv", [])
    assert content
    assert content[1]["x"].tobytes() == np.array(values, dtype=np.float64).tobytes()


cells = st.sampled_from(
    [
        "1",
        "-0",
        "+.5",
        "5.",
        " 7 ",
        "1e400",
        "1e-400",
        "4.9e-324",
        "nan",
        "nan(1)",
        "inf",
        "",
        '"2"',
        "1_0",
        "0x1",
        "٢",
        "a",
    ]
) | st.floats(allow_nan=False, allow_infinity=False).map(repr)


@settings(max_examples=300)
@given(rows=st.lists(st.lists(cells, min_size=2, max_size=2), max_size=4), end=st.sampled_from(["\n", "\r\n", "\r"]))
def test_both_ways_to_read_csv_agree(rows: list[list[str]], end: str) -> None:
    data = end.join(["x,y", *(",".join(row) for row in rows), ""]).encode()
    findings: list[Finding] = []
    slowly = csv_table.cell_by_cell(data, "a.csv", findings)
    if quickly := csv_table.plain_numbers(data):
        assert slowly
        assert not findings
        assert quickly[0] == slowly[0]
        assert {name: values.tobytes() for name, values in quickly[1].items()} == {
            name: values.tobytes() for name, values in slowly[1].items()
        }


@given(rows=st.lists(st.lists(st.floats(-1e300, 1e300), min_size=2, max_size=2), min_size=1))
def test_plain_numbers_are_read_quickly(rows: list[list[float]]) -> None:
    data = "\n".join(["x,y", *(",".join(map(repr, row)) for row in rows)]).encode()
    content = csv_table.plain_numbers(data)
    assert content
    assert np.stack(list(content[1].values()), axis=1).tolist() == rows


@settings(max_examples=150)
@given(data=st.data(), kind=st.sampled_from(["static", "motion"]), arm=st.sampled_from([None, ARM]))
def test_rules_bear_any_number(data: st.DataObject, kind: RunKind, arm: Arm | None) -> None:
    names = data.draw(st.lists(st.sampled_from([name.replace("_i_", "_1_").replace("_k_", "_2_") for name in NAMES])))
    n = data.draw(st.integers(0, 30))
    numbers = st.sampled_from([0.0, 1.0, -1.0, 2.0, 5e-324, 1e-200, 1e12, 1e300, np.nan, np.inf]) | st.floats(-10, 10)
    columns = {name: np.array(data.draw(st.lists(numbers, min_size=n, max_size=n))) for name in names}
    if n and data.draw(st.booleans()):
        columns["time_s"] = np.arange(float(n))
    for finding in examine(Run("a", kind, 0.0, columns), arm):
        assert finding.message
        assert finding.remedy


def test_rules_bear_infinite_numbers_in_a_row() -> None:
    """Found by the test above: the step between two of them is no number, and NumPy's warning was all that was said."""
    current = np.array([0.0, 1.0, -1.0, 2.0, 5e-324, 1e-200, 1e12, 1e300, np.inf, np.inf, 0.5])
    assert examine(Run("a", "motion", 0.0, {"current_1_a": current}), None)


def files_of(table_format: TableFormat) -> dict[str, bytes]:
    """Return a small healthy campaign, file by file."""
    parts = {name: values[::100] for name, values in sweep().items()}, {name: v[:21] for name, v in loading().items()}
    campaign = Campaign("small", (Run("sweep", "motion", 0.0, parts[0]), Run("loading", "static", 99.0, parts[1])))
    with TemporaryDirectory() as folder:
        path = Path(folder) / "campaign"
        write_campaign(campaign, path, table_format)
        return {str(file.relative_to(path)): file.read_bytes() for file in sorted(path.rglob("*")) if file.is_file()}


HEALTHY_FILES = {table_format: files_of(table_format) for table_format in ("csv", "parquet")}

# Bytes that mean something to a reader of CSV or YAML, beside any byte.
junk = st.binary(max_size=6) | st.sampled_from(
    [
        b",",
        b";",
        b"\n",
        b"\r",
        b'"',
        b"nan",
        b"inf",
        b"1e999",
        b"-",
        b"e",
        b"\xef\xbb\xbf",
        b"\xff",
        b": ",
        b"- ",
        b"[",
        b"&a ",
        b"!!int ",
    ]
)


@pytest.mark.parametrize("table_format", ["csv", "parquet"])
@settings(max_examples=150)
@given(data=st.data())
def test_damage_is_refused_or_harmless(table_format: TableFormat, data: st.DataObject) -> None:
    files = HEALTHY_FILES[table_format]
    victim = data.draw(st.sampled_from(sorted(files)))
    content = files[victim]
    for _ in range(data.draw(st.integers(1, 3))):
        start = data.draw(st.integers(0, len(content)))
        content = content[:start] + data.draw(junk) + content[start + data.draw(st.integers(0, 30)) :]
    with TemporaryDirectory() as folder:
        for name, original in files.items():
            path = Path(folder) / name
            path.parent.mkdir(exist_ok=True)
            path.write_bytes(content if name == victim else original)
        report = check_campaign(Path(folder))
        assert (report.campaign is None) == bool(report.errors)
        if report.errors:
            with pytest.raises(CampaignError):
                read_campaign(Path(folder))
        else:
            runs = read_campaign(Path(folder)).runs
            assert len(runs) + sum(finding.message == "no run names this table" for finding in report.findings) == 2
            assert all(np.isfinite(values).all() for run in runs for values in run.columns.values())


def test_campaign_of_both_kinds_comes_back_without_findings(tmp_path: Path) -> None:
    write_campaign(session(), tmp_path / "campaign")
    report = check_campaign(tmp_path / "campaign")
    assert report.findings == ()
    assert [run.name for run in report.usable().of_kind("static")] == ["loading"]
    assert [run.name for run in report.usable().of_kind("motion")] == ["sweep"]
