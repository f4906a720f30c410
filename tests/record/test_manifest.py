"""`campaign.yaml`: every fault by its key, all at once."""

from datetime import UTC, datetime
from pathlib import Path

import pytest

from bench.record.check import check_campaign
from bench.record.manifest import Head, read_manifest
from tests.record.build import motion, only, sweep, write_folder

RUN = "{name: a, kind: motion, start_s: 0}"


def folder_with(tmp_path: Path, manifest: str) -> Path:
    folder = write_folder(tmp_path / "campaign", motion(sweep()))
    (folder / "campaign.yaml").write_text(manifest)
    return folder


def head_of(tmp_path: Path, lines: str) -> Head:
    manifest = read_manifest(folder_with(tmp_path, f"format: 1\n{lines}\nruns: [{RUN}]"))
    assert manifest.findings == ()
    assert manifest.head
    return manifest.head


FAULTS = {
    "format": (f"format: 2\nrobot: r\nruns: [{RUN}]", "format", "write 1"),
    "no robot": (f"format: 1\nruns: [{RUN}]", "robot", "is missing"),
    "robot without value": (f"format: 1\nrobot:\nruns: [{RUN}]", "robot", "is missing"),
    "unknown key": (f"format: 1\nrobot: r\nnote: x\nruns: [{RUN}]", "note", "Did you mean 'notes'"),
    "unknown key of a run": (
        "format: 1\nrobot: r\nruns: [{name: a, kind: motion, start_s: 0, load: 3}]",
        "runs[0].load",
        "unknown",
    ),
    "kind": (
        "format: 1\nrobot: r\nruns: [{name: a, kind: moving, start_s: 0}]",
        "runs[0].kind",
        "'static' or 'motion'",
    ),
    "start": ("format: 1\nrobot: r\nruns: [{name: a, kind: motion, start_s: 9 am}]", "runs[0].start_s", "'9 am'"),
    "start before the start": (
        "format: 1\nrobot: r\nruns: [{name: a, kind: motion, start_s: -1}]",
        "runs[0].start_s",
        "greater",
    ),
    "start is nan": ("format: 1\nrobot: r\nruns: [{name: a, kind: motion, start_s: .nan}]", "runs[0].start_s", ".nan"),
    "name": ("format: 1\nrobot: r\nruns: [{name: a/b, kind: motion, start_s: 0}]", "runs[0].name", "letters, digits"),
    "run is a word": ("format: 1\nrobot: r\nruns: [a]", "runs[0]", "'a'"),
    "no runs": ("format: 1\nrobot: r", "runs", "at least one"),
    "runs are a mapping": ("format: 1\nrobot: r\nruns: {a: 1}", "runs", "no list"),
    "one run of no recording": (
        f"format: 1\nrobot: r\nruns: [{RUN}, {{name: b, kind: motion, start_s: 9, recording: may}}]",
        "a.recording",
        "is missing, and other runs have one",
    ),
    "date": (f"format: 1\nrobot: r\nstarted: May\nruns: [{RUN}]", "started", "'May'"),
    "noise of a label": (f"format: 1\nrobot: r\nnoise: {{load: 1}}\nruns: [{RUN}]", "noise.load", "unknown quantity"),
    "negative noise": (
        f"format: 1\nrobot: r\nnoise: {{current: -1}}\nruns: [{RUN}]",
        "noise.current",
        "greater than or equal to 0",
    ),
    "same name": (
        f"format: 1\nrobot: r\nruns: [{RUN}, {{name: A, kind: motion, start_s: 9, file: b.csv}}]",
        "A",
        "two runs",
    ),
    "same file": (
        f"format: 1\nrobot: r\nruns: [{RUN}, {{name: b, kind: motion, start_s: 9, file: runs/a.csv}}]",
        "b",
        "another run",
    ),
    "outside": (
        "format: 1\nrobot: r\nruns: [{name: a, kind: motion, start_s: 0, file: ../a.csv}]",
        "a.file",
        "outside",
    ),
    "absolute": (
        "format: 1\nrobot: r\nruns: [{name: a, kind: motion, start_s: 0, file: /etc/a.csv}]",
        "a.file",
        "outside",
    ),
    "spreadsheet": (
        "format: 1\nrobot: r\nruns: [{name: a, kind: motion, start_s: 0, file: a.xlsx}]",
        "a.file",
        "save it as .csv",
    ),
    "key twice": (f"format: 1\nrobot: r\nrobot: s\nruns: [{RUN}]", "", "line 3: not YAML: key 'robot' occurs twice"),
    "key is a list": (f"format: 1\n[1]: r\nruns: [{RUN}]", "", "line 2: not YAML: a key is no word"),
    "no yaml": ("format: 1\n  robot: [", "", "line 2: not YAML"),
    "a word": ("format", "", "is not a list of"),
    "control character": ("format: 1\nrobot: \x07", "", "not YAML"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_fault_is_named(name: str, tmp_path: Path) -> None:
    manifest, key, words = FAULTS[name]
    findings = [f for f in check_campaign(folder_with(tmp_path, manifest)).findings if f.file == "campaign.yaml"]
    finding = only(findings)
    assert (finding.level, finding.column) == ("error", key)
    assert words in f"{finding.message}; {finding.remedy}"


def test_missing_manifest(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    finding = only(list(check_campaign(tmp_path / "empty").findings))
    assert finding.message == "cannot be read: No such file or directory"


def test_folder_that_is_not_there_is_named(tmp_path: Path) -> None:
    finding = only(list(check_campaign(tmp_path / "nowhere").findings))
    assert finding.message == f"there is no folder {tmp_path / 'nowhere'}"
    assert finding.remedy.startswith("give a campaign folder")


def test_folder_with_a_campaign_in_it_names_that_one(tmp_path: Path) -> None:
    folder = write_folder(tmp_path / "results" / "campaign", motion(sweep()))
    finding = only(list(check_campaign(tmp_path / "results").findings))
    assert "no campaign, but there is one in it" in finding.message
    assert finding.remedy == f"give {folder}"


def test_manifest_in_another_encoding(tmp_path: Path) -> None:
    folder = folder_with(tmp_path, "")
    (folder / "campaign.yaml").write_bytes(b"notes: 20 \xb0C")
    assert only(list(read_manifest(folder).findings)).message == "byte 10 is not UTF-8"


def test_faults_of_manifest_and_tables_are_found_together(tmp_path: Path) -> None:
    folder = folder_with(tmp_path, f"format: 1\nruns: [{RUN}, {{name: b}}]")
    (folder / "runs" / "a.csv").write_text("time_s\n0\n")
    report = check_campaign(folder)
    assert {(f.file, f.column) for f in report.errors} == {
        ("campaign.yaml", "robot"),
        ("campaign.yaml", "runs[1].kind"),
        ("campaign.yaml", "runs[1].start_s"),
        ("runs/a.csv", ""),
    }


def test_scalars_are_what_their_key_expects(tmp_path: Path) -> None:
    head = head_of(tmp_path, "robot: 007\nnotes: no\nstarted:\nnoise: {current: 1e-3}")
    assert (head.robot, head.notes, head.started, head.noise) == ("007", "no", None, {"current": 1e-3})


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("2024-05-13", datetime(2024, 5, 13)),
        ("2024-05-13 09:30", datetime(2024, 5, 13, 9, 30)),
        ("'2024-05-13T09:30:00Z'", datetime(2024, 5, 13, 9, 30, tzinfo=UTC)),
    ],
)
def test_start_is_a_date_or_a_time(text: str, value: datetime, tmp_path: Path) -> None:
    assert head_of(tmp_path, f"robot: r\nstarted: {text}").started == value


def test_link_out_of_the_folder_is_outside(tmp_path: Path) -> None:
    folder = folder_with(tmp_path, f"format: 1\nrobot: r\nruns: [{RUN}]")
    (folder / "runs" / "a.csv").rename(tmp_path / "a.csv")
    (folder / "runs" / "a.csv").symlink_to(tmp_path / "a.csv")
    assert "outside" in only(list(check_campaign(folder).findings)).message


def test_table_that_no_run_names_is_a_warning(tmp_path: Path) -> None:
    folder = folder_with(tmp_path, f"format: 1\nrobot: r\nruns: [{RUN}]")
    (folder / "runs" / "b.csv").write_text("time_s\n")
    report = check_campaign(folder)
    assert [(f.level, f.file) for f in report.findings] == [("warning", "runs/b.csv")]
    assert len(report.usable().runs) == 1


def test_runs_come_in_order_and_do_not_overlap(tmp_path: Path) -> None:
    second = "{name: b, kind: motion, start_s: START, file: runs/b.csv}"
    folder = folder_with(tmp_path, "")
    other = write_folder(tmp_path / "other", motion(sweep(2)))
    (other / "runs" / "a.csv").rename(folder / "runs" / "b.csv")
    (folder / "campaign.yaml").write_text(f"format: 1\nrobot: r\nruns: [{second.replace('START', '60')}, {RUN}]")
    report = check_campaign(folder)
    assert report.findings == ()
    assert [run.name for run in report.usable().runs] == ["a", "b"]
    (folder / "campaign.yaml").write_text(f"format: 1\nrobot: r\nruns: [{second.replace('START', '5')}, {RUN}]")
    finding = only(list(check_campaign(folder).findings))
    assert (finding.level, finding.file) == ("warning", "runs/a.csv")
    assert "after 'b' began at 5 s" in finding.message
