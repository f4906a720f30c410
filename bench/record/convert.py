"""From a laboratory's own logs to a campaign, as a `LogFormat` says."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np

from bench.errors import CampaignError, not_utf_8
from bench.record.campaign import Arm, Array, Campaign, Run
from bench.record.check import examine_all
from bench.record.finding import Finding
from bench.record.limits import TABLE_BYTES
from bench.record.log_format import LogFormat
from bench.record.logs.dates import EPOCH, is_dated
from bench.record.logs.likewise import likewise
from bench.record.logs.mcap_table import MCAP
from bench.record.logs.read import LogColumns, in_log, no_values, read_log
from bench.record.plain_file import FileFault, expect_plain
from bench.record.rules.sheet import Sheet

PAUSE_S = 60.0  # [s] between two logs whose times of day nobody wrote down
SUFFIXES = (".csv", ".tsv", ".dat", ".parquet", ".mcap")  # of the logs in a folder; a log by its own name has any
PLAIN_TEXT = ".txt"  # logs too where a folder has no others; beside them it is somebody's notes


@dataclass(frozen=True)
class Converted:
    """A campaign made of logs.

    Attributes:
        campaign: One run for each file, or for each piece of it, named after it.
        unused: File name -> its columns that the format does not name.
        warnings: What was done to a log that the format did not mean.
    """

    campaign: Campaign
    unused: Mapping[str, tuple[str, ...]]
    warnings: tuple[Finding, ...] = ()


@dataclass(frozen=True)
class _Log:
    """What became of one log.

    Attributes:
        file: Where it was.
        pieces: The runs of it, each with the time at which it begins [s] after its first row.
        first: What its clock shows in its first row [s]; nan without a clock.
        length: From its first row to its last [s].
    """

    file: Path
    pieces: list[tuple[float, dict[str, Array]]]
    first: float
    length: float


def convert(source: Path, layout: LogFormat, robot: str, arm: Arm | None = None) -> Converted:
    """Make a campaign of a log, or of all logs of a folder in the order of their names.

    The clock of each run begins at its first row. Where no two logs overlap by their clocks, and these are dates or
    rise with the files' names, they say when each was started. Else each is put a minute after the end of the one
    before, and notes of its runs say so.

    Args:
        source: A file, or a folder of files; text, Parquet or MCAP.
        layout: How they read.
        robot: Name of the robot, or path to its folder; written into the campaign.
        arm: The robot, if it is known; then what a check refuses because of it is refused here.

    Raises:
        CampaignError: There is no log, or one cannot be used; every fault once, with file, row and column.
    """
    files = _logs(source, layout)
    if odd := [shown for file in files if (shown := not_utf_8(file.name))]:
        raise CampaignError(f"{name}: is no UTF-8, and runs are named after their logs; rename it" for name in odd)
    _expect_topics_of(files, layout)
    findings: list[Finding] = []
    unused: dict[str, tuple[str, ...]] = {}
    warnings: list[Finding] = []
    logs: list[_Log] = []
    for file in files:
        log = read_log(file, layout, findings)
        if log is None:
            continue
        unused[file.name] = log.unused
        warnings += log.warnings
        clock = log.columns.get("time_s", np.empty(0))
        if layout.resample and (message := layout.resample.invented(clock)):
            warnings.append(Finding("warning", file.name, None, "", *message))
        pieces, length = _pieces(file, log, layout, arm, findings)
        logs.append(_Log(file, pieces, float(clock[0]) if len(clock) else np.nan, length))
    if findings:
        raise CampaignError(str(finding) for finding in likewise(findings))
    starts, started, is_known = _starts(logs)
    unknown = "" if is_known else "; the time of its start is not known"
    runs: list[Run] = []
    for one, start in zip(logs, starts, strict=True):
        for begin, columns in one.pieces:
            name = _run_name(one.file, {run.name for run in runs})
            cut = f" from {begin:g} s" if not layout.runs.cuts_nothing else ""
            note = f"made of {one.file.name}{cut}{unknown}"
            runs.append(Run(name, layout.kind, round(start + begin, 9), columns, note))
    if not runs:
        raise CampaignError(f"{source}: nothing is left of it; look at `runs` and `resample` in the log.yaml")
    campaign = Campaign(robot, tuple(runs), started, layout.noise, _notes(layout))
    return Converted(campaign, unused, tuple(warnings))


def _starts(logs: Sequence[_Log]) -> tuple[list[float], datetime | None, bool]:
    """Return when each log begins after the first one [s], when that began if clocks are dates, and if this is known.

    Clocks that each begin with their log overlap. Where none does, and they rise with the files' names, one clock ran
    on; one that began anew in between would have to fall.
    """
    first = np.array([log.first for log in logs])
    if logs and np.isfinite(first).all():
        order = np.argsort(first, kind="stable")
        ends = (first + [log.length for log in logs])[order]
        dated = [is_dated(one) for one in first.tolist()]
        are_dates, ran_on = all(dated), not any(dated) and bool(np.all(np.diff(order) > 0))
        if np.all(ends[:-1] < first[order][1:]) and (are_dates or ran_on):
            begin = float(first.min())
            return (first - begin).tolist(), EPOCH + timedelta(seconds=begin) if are_dates else None, True
    pauses = [log.length + PAUSE_S if np.isfinite(log.first) else 0.0 for log in logs]
    return [float(sum(pauses[:k])) for k in range(len(logs))], None, len(logs) < 2


def _expect_topics_of(files: Sequence[Path], layout: LogFormat) -> None:
    """Refuse a format that names topics where no log has any.

    Raises:
        CampaignError: It does.
    """
    keys = ["topic"] if layout.topic else []
    keys += [f"tables.{name}.topic" for name, beside in layout.tables.items() if beside.topic]
    if keys and not any(file.suffix.lower() == MCAP for file in files):
        raise CampaignError(
            f"{files[0]}: is no MCAP recording, and the log.yaml names a topic of one ({', '.join(keys)}); take it out"
        )


def _logs(source: Path, layout: LogFormat) -> list[Path]:
    if source.is_file():
        return [source]
    if not source.is_dir():
        try:
            expect_plain(source, TABLE_BYTES)
        except FileFault as fault:
            raise CampaignError(f"{source}: {fault}; give a log, or a folder of logs") from fault
        return [source]
    files = sorted(path for path in source.iterdir() if path.suffix.lower() in SUFFIXES)
    files = files or sorted(path for path in source.iterdir() if path.suffix.lower() == PLAIN_TEXT)
    besides = {
        file.with_name(table.file.replace("*", file.stem))
        for table in layout.tables.values()
        if table.file
        for file in files
    }
    if logs := [file for file in files if file not in besides]:
        return logs
    known = ", ".join((*SUFFIXES, PLAIN_TEXT))
    raise CampaignError(f"{source}: holds no log ({known}); give a log, or a folder of logs")


def _pieces(
    file: Path, log: LogColumns, layout: LogFormat, arm: Arm | None, findings: list[Finding]
) -> tuple[list[tuple[float, dict[str, Array]]], float]:
    """Return the runs of a log, each with the time at which it begins [s], and the length of the log [s]."""
    columns = dict(log.columns)
    if not any(map(len, columns.values())):
        remedy = "record it again, or leave it out"
        findings.append(Finding("error", file.name, None, "", "holds a header and no rows", remedy))
        return [], 0.0
    time = columns.get("time_s")
    if time is None:
        faults = no_values(file, columns, slice(0, None), log, layout)
        findings += faults or _faults_of(columns, file, log, layout, arm, 0)
        return [(0.0, columns)], 0.0
    columns["time_s"] = time = time - time[0]
    pieces = []
    windows = layout.runs.windows(time) if layout.runs.windows_s else [log.covered]
    for rows, window in zip(windows, layout.runs.windows_s or [()], strict=True):
        if rows.stop - rows.start == 0:
            message = f"window {list(window)} s holds no row: the log ends after {time[-1]:g} s"
            remedy = "give one within the log (--window-s, or `runs: windows_s` in the log.yaml)"
            findings.append(Finding("error", file.name, None, "", message, remedy))
            continue
        part = {name: values[rows] for name, values in columns.items()}
        faults = no_values(file, columns, rows, log, layout)
        faults = faults or _faults_of(part, file, log, layout, arm, rows.start)
        if layout.resample and not faults:
            faults = [Finding("error", file.name, None, "", *words) for words in layout.resample.faults(part)]
        findings += faults
        if faults:
            continue
        for stretch in layout.resample.applied(part) if layout.resample else [part]:
            for cut in layout.runs.split(stretch):
                piece = {name: values[cut] for name, values in stretch.items()}
                begin = float(piece["time_s"][0])
                pieces.append((begin, piece | {"time_s": piece["time_s"] - begin}))
    return pieces, float(time[-1])


def _faults_of(
    columns: dict[str, Array], file: Path, log: LogColumns, layout: LogFormat, arm: Arm | None, first: int
) -> list[Finding]:
    """Return what keeps a run from being used, in the words of the log it was made of, whose row `first` is its own."""
    run = Run("log", layout.kind, 0.0, columns)
    factors = {name: origin.factor for name, origin in layout.columns.items()}
    found = examine_all([Sheet(run, file.name, tuple(columns), arm, factors)])
    return [_in_words(in_log(finding, log), layout, first) for finding in found if finding.level == "error"]


def _in_words(finding: Finding, layout: LogFormat, first: int) -> Finding:
    origin = layout.columns.get(finding.column)
    column = f"{origin} ({finding.column})" if origin else finding.column
    if not first or finding.row is None:
        return replace(finding, column=column)
    message = f"{finding.message}, counted from row {first + 1} on"
    return replace(finding, column=column, row=finding.row + first, message=message)


def _notes(layout: LogFormat) -> str:
    """Return the notes of the campaign: what the lab wrote, and what was done to the numbers."""
    if layout.resample is None:
        return layout.notes
    return " ".join([*([layout.notes.strip()] if layout.notes else []), layout.resample.description()])


def _run_name(file: Path, taken: Sequence[str] | set[str]) -> str:
    """Return a name for a run: the file's, with what no name may hold replaced, and a number where it is taken."""
    stem = re.sub(r"[^A-Za-z0-9_.-]", "_", file.stem)[:90]
    stem = stem if re.match(r"[A-Za-z0-9]", stem) else f"run{stem}"
    lowered = {name.casefold() for name in taken}
    name, number = stem, 2
    while name.casefold() in lowered:
        name, number = f"{stem}_{number}", number + 1
    return name
