"""CSV as laboratories write it: what is accepted, and how what is not is named."""

from pathlib import Path

import numpy as np
import pytest

from bench.record import check, csv_table
from bench.record.campaign import Arm
from bench.record.check import check_campaign
from bench.record.finding import Finding, spell_rows
from bench.record.read import read_campaign
from bench.record.table import read_table
from tests.record.build import MANIFEST, only

TABLE = """pose,approach,load_step,q_cmd_1_rad,current_1_a
1,1,0,0.1,2.5
1,-1,0,0.1,2.25
"""


def folder_with(tmp_path: Path, table: str | bytes) -> Path:
    (tmp_path / "runs").mkdir()
    (tmp_path / "campaign.yaml").write_text(MANIFEST.replace("KIND", "static"))
    data = table.encode() if isinstance(table, str) else table
    (tmp_path / "runs" / "a.csv").write_bytes(data)
    return tmp_path


ACCEPTED = {
    "plain": TABLE,
    "windows line ends": TABLE.replace("\n", "\r\n"),
    "byte order mark": b"\xef\xbb\xbf" + TABLE.encode(),
    "old macintosh": TABLE.replace("\n", "\r"),
    "no last line end": TABLE.rstrip("\n"),
    "empty lines at the end": TABLE + "\n \n\n",
    "spaces": TABLE.replace(",", " , "),
    "quotes": TABLE.replace("q_cmd_1_rad", '"q_cmd_1_rad"').replace("2.5", '"2.5"'),
    "exponents": TABLE.replace("2.25", "+.225e1"),
    "set aside": TABLE.replace("current_1_a", "current_1_a,_x").replace("2.5", "2.5,0").replace("2.25", "2.25,7"),
}


@pytest.mark.parametrize("name", ACCEPTED)
def test_accepted(name: str, tmp_path: Path) -> None:
    report = check_campaign(folder_with(tmp_path, ACCEPTED[name]))
    assert report.findings == ()
    run = report.usable().runs[0]
    assert list(run.columns) == ["pose", "approach", "load_step", "q_cmd_1_rad", "current_1_a"]
    np.testing.assert_array_equal(run.columns["current_1_a"], [2.5, 2.25])


# Table -> row, column, words of the message or the remedy.
REFUSED: dict[str, tuple[str | bytes, int | None, str, str]] = {
    "semicolons": (TABLE.replace(",", ";"), None, "", "separated by semicolons;"),
    "german": (TABLE.replace(",", ";").replace(".", ","), None, "", "semicolons and numbers have decimal commas"),
    "tabs": (TABLE.replace(",", "\t"), None, "", "separated by tabs"),
    "decimal commas": (TABLE.replace(".", ","), 1, "", "decimal points, not commas"),
    "quoted decimal comma": (TABLE.replace("2.25", '"2,25"'), 2, "current_1_a", "write a decimal point"),
    "short row": (TABLE.replace(",2.25", ""), 2, "", "4 cells under 5 names in row 2"),
    "long row": (TABLE.replace("2.25", "2.25,"), 2, "", "6 cells under 5 names in row 2"),
    "empty line inside": (TABLE.replace("\n1,-1", "\n\n1,-1"), 2, "", "1 cells under 5 names"),
    "word": (TABLE.replace("2.25", "n/a"), 2, "current_1_a", "'n/a' is no number, row 2"),
    "thousands": (TABLE.replace("2.25", "1_000"), 2, "current_1_a", "is no number"),
    "other digits": (TABLE.replace("2.25", "٢"), 2, "current_1_a", "is no number"),
    "empty cell": (TABLE.replace("2.25", ""), 2, "current_1_a", "no value"),
    "nan": (TABLE.replace("2.25", "NaN"), 2, "current_1_a", "no value"),
    "twice": (
        TABLE.replace("q_cmd_1_rad", "current_1_a,q_cmd_1_rad").replace(",0.1", ",1,0.1"),
        None,
        "current_1_a",
        "2 columns",
    ),
    "no name": (
        TABLE.replace("current_1_a", "current_1_a,").replace("2.5", "2.5,0").replace("2.25", "2.25,0"),
        None,
        "",
        "no name",
    ),
    "latin-1": (TABLE.encode() + b"\xb0", None, "", "save it as UTF-8"),
    "utf-16": (TABLE.encode("utf-16"), None, "", "save it as UTF-8"),
    "empty": ("", None, "", "is empty"),
    "empty lines": ("\n\n", None, "", "is empty"),
    "header only": (TABLE.splitlines()[0], None, "", "no rows"),
    "no angles": (TABLE.replace("q_cmd_1_rad", "_q"), None, "", "no joint angles"),
    "nothing measured": (TABLE.replace("current_1_a", "_i"), None, "", "no measured channel"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused(name: str, tmp_path: Path) -> None:
    table, row, column, words = REFUSED[name]
    report = check_campaign(folder_with(tmp_path, table))
    finding = only(list(report.findings))
    assert (finding.level, finding.file, finding.row, finding.column) == ("error", "runs/a.csv", row, column)
    assert words in f"{finding.message}; {finding.remedy}"
    assert report.campaign is None


def test_all_faults_are_found_at_once(tmp_path: Path) -> None:
    folder = folder_with(tmp_path, TABLE.replace("0.1,2.25", "x,").replace("approach", "aproach"))
    assert {finding.column for finding in check_campaign(folder).errors} == {"aproach", "q_cmd_1_rad", "current_1_a"}


def test_tables_are_read_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder, read = folder_with(tmp_path, TABLE), []
    monkeypatch.setattr(check, "read_table", lambda *place: read.append(place) or read_table(*place))
    arm = Arm(is_slide=(False, False), limits=((-0.05, 0.05), (-1.0, 1.0)))
    report = check.check_with_robot(folder, lambda name: arm)
    assert len(read) == 1
    assert report == check.check_campaign(folder, arm)
    assert {finding.message.split(",")[0] for finding in report.findings} == {
        "0.1 rad is no position of this joint",
        "no angle of drive 2",
    }


def test_robot_of_a_broken_campaign_is_not_looked_for(tmp_path: Path) -> None:
    report = check.check_with_robot(folder_with(tmp_path, TABLE.replace("2.5", "x")), pytest.fail)
    assert report.campaign is None


def test_missing_table(tmp_path: Path) -> None:
    folder = folder_with(tmp_path, TABLE)
    (folder / "runs" / "a.csv").unlink()
    assert only(list(check_campaign(folder).findings)).message == "cannot be read: No such file or directory"


def test_error_names_folder_file_row_line_and_column(tmp_path: Path) -> None:
    folder = folder_with(tmp_path, TABLE.replace("2.25", "two"))
    with pytest.raises(Exception, match="is no number") as caught:
        read_campaign(folder)
    assert str(caught.value).startswith(f"{folder}/runs/a.csv: row 2 (line 3): current_1_a: 'two' is no number")


def test_rows_are_spelled_shortly() -> None:
    assert spell_rows([3]) == "row 3"
    assert spell_rows([3, 4]) == "rows 3 and 4"
    assert spell_rows([1, 2, 3, 7, 9, 10]) == "rows 1 to 3, 7, 9 and 10"
    assert spell_rows(range(1, 101, 2)) == "rows 1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23 and 38 more"


def test_only_lines_of_text_are_counted() -> None:
    assert Finding("error", "runs/a.csv", 4, "q", "m", "r").line == 5
    assert Finding("error", "runs/a.parquet", 4, "q", "m", "r").line is None
    assert str(Finding("error", "runs/a.parquet", 4, "q", "m", "r")) == "runs/a.parquet: row 4: q: m; r"


@pytest.mark.parametrize(
    ("begin", "words"),
    [
        (b"PK\x03\x04\x14\x00", "is a workbook"),
        (b"\x1f\x8b\x08", "is compressed by gzip"),
        (b"version https://git-lfs.github.com/spec/v1\noid sha256:0\n", "git lfs pull"),
        (b"PAR1\x15", "name it .parquet"),
    ],
)
def test_what_is_no_csv_is_told_by_its_name(begin: bytes, words: str) -> None:
    findings: list[Finding] = []
    assert csv_table.parse(begin, "runs/a.csv", findings) is None
    (finding,) = findings
    assert words in str(finding)
