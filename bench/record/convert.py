"""From a laboratory's own logs to a campaign, as a `LogFormat` says."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from bench.errors import CampaignError, unknown_name
from bench.record.campaign import Array, Campaign, Run
from bench.record.check import examine_all
from bench.record.finding import Finding
from bench.record.log_format import LogFormat
from bench.record.manifest import SUFFIXES
from bench.record.rules.sheet import Sheet, rows_where
from bench.record.table import read_table

PAUSE_S = 60.0  # [s] between two logs whose times of day nobody wrote down


@dataclass(frozen=True)
class Converted:
    """A campaign made of logs.

    Attributes:
        campaign: One run for each file, named after it.
        unused: File name -> its columns that the format does not name.
    """

    campaign: Campaign
    unused: Mapping[str, tuple[str, ...]]


def convert(source: Path, layout: LogFormat, robot: str) -> Converted:
    """Make a campaign of a log, or of all logs of a folder in the order of their names.

    The clock of each run begins at its first row. Logs do not say when they were started: each run is put a minute
    after the end of the one before, and its note says so.

    Args:
        source: A file, CSV or Parquet, or a folder of such files.
        layout: How they read.
        robot: Name of the robot, or path to its folder; written into the campaign.

    Raises:
        CampaignError: There is no log, or one cannot be used; every fault with file, row and column.
    """
    files = _logs(source)
    findings: list[Finding] = []
    unused: dict[str, tuple[str, ...]] = {}
    runs: list[Run] = []
    start = 0.0
    for file in files:
        read = _read(file, layout, findings)
        if read is None:
            continue
        columns, unused[file.name] = read
        note = f"made of {file.name}" + ("" if len(files) == 1 else "; the time of its start is not known")
        run = Run(_run_name(file, {run.name for run in runs}), layout.kind, start, columns, note)
        findings += _faults_of(run, file, layout)
        runs.append(run)
        if "time_s" in columns and len(run):
            start += float(columns["time_s"][-1]) + PAUSE_S
    if findings:
        raise CampaignError(str(finding) for finding in findings)
    return Converted(Campaign(robot, tuple(runs), noise=layout.noise, notes=layout.notes), unused)


def _logs(source: Path) -> list[Path]:
    if source.is_file() and source.suffix.lower() in SUFFIXES:
        return [source]
    if source.is_file():
        raise CampaignError(f"{source}: is no table; save it as {' or '.join(SUFFIXES)}")
    if not source.is_dir():
        raise CampaignError(f"{source}: no such file or folder; give a log, or a folder of logs")
    files = sorted(path for path in source.iterdir() if path.suffix.lower() in SUFFIXES)
    if not files:
        raise CampaignError(f"{source}: holds no {' or '.join(SUFFIXES)} file; give a log, or a folder of logs")
    return files


def _read(file: Path, layout: LogFormat, findings: list[Finding]) -> tuple[dict[str, Array], tuple[str, ...]] | None:
    """Return the columns of a campaign, and which of the log are not used; None if something is missing or broken."""
    table = read_table(file.parent, file.name)
    named = {origin.source for origin in layout.columns.values()}
    faults = [finding for finding in table.findings if not finding.column or finding.column in named]
    columns: dict[str, Array] = {}
    for name, origin in layout.columns.items() if table.names else ():
        count = table.names.count(origin.source)
        if count == 0 and origin.optional:
            continue
        if count != 1:
            what = "is missing" if count == 0 else f"{count} columns have this name"
            hint = unknown_name("column", origin.source, table.names).removeprefix("unknown column ").rstrip(".")
            remedy = f"{name} is made of it; {hint}" if count == 0 else "keep the right one"
            faults.append(Finding("error", file.name, None, origin.source, what, remedy))
        elif origin.source in table.columns:
            logged = table.columns[origin.source]
            if rows := rows_where(~np.isfinite(logged)):
                message, remedy = "no value (empty, NaN or infinite)", "remove these rows, or repeat the last reading"
                faults.append(_in_rows(file, origin.source, message, remedy, rows))
            columns[name] = origin.factor * logged + origin.offset
    findings += faults
    if faults:
        return None
    if "time_s" in columns and len(columns["time_s"]):
        columns["time_s"] = columns["time_s"] - columns["time_s"][0]
    return columns, tuple(name for name in dict.fromkeys(table.names) if name not in named)


def _in_rows(file: Path, column: str, message: str, remedy: str, rows: list[int]) -> Finding:
    sheet = Sheet(Run("log", "motion", 0.0, {}), file.name, ())
    return sheet.error(column, message, remedy, rows)


def _faults_of(run: Run, file: Path, layout: LogFormat) -> list[Finding]:
    """Return what keeps a run from being used, in the words of the log it was made of."""
    found = examine_all([Sheet(run, file.name, tuple(run.columns))])
    origins = {name: origin.source for name, origin in layout.columns.items()}
    return [
        replace(finding, column=f"{origins[finding.column]} ({finding.column})" if finding.column in origins else "")
        for finding in found
        if finding.level == "error"
    ]


def _run_name(file: Path, taken: set[str]) -> str:
    """Return a name for a run: the file's, with what no name may hold replaced, and a number where it is taken."""
    stem = re.sub(r"[^A-Za-z0-9_.-]", "_", file.stem)[:90]
    stem = stem if re.match(r"[A-Za-z0-9]", stem) else f"run{stem}"
    lowered = {name.casefold() for name in taken}
    name, number = stem, 2
    while name.casefold() in lowered:
        name, number = f"{stem}_{number}", number + 1
    return name
