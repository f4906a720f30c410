"""The columns of a campaign out of one log, with every fault in the words of the log."""

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from pathlib import Path

import numpy as np

from bench.record.campaign import Array, Run
from bench.record.finding import Finding
from bench.record.limits import TABLE_CELLS
from bench.record.log_format import Beside, LogFormat, Origin
from bench.record.logs.dates import is_dated
from bench.record.logs.dialect import Dialect, read_log_table
from bench.record.logs.likewise import listed
from bench.record.logs.mcap_table import MCAP, read_topic
from bench.record.logs.resample import at_times, even_rows, filled
from bench.record.rules.clock import UNITS
from bench.record.rules.sheet import Sheet, rows_where
from bench.record.table import Table

LIKE = 0.1  # assumed: two loggers are started and stopped within a tenth of a recording
CLOCKS_DIFFER = 0.01  # of a recording (assumed: two clocks of one logger agree as well as that)


@dataclass(frozen=True)
class LogColumns:
    """What was read of one log.

    Attributes:
        columns: Column name of a campaign -> shape (n_rows,); `time_s` as the log's clock has it, in seconds. Cells
            may still be nan.
        unused: Columns of the log that the format does not name.
        lines_before: Lines above the first row.
        covered: The rows in which other tables have readings. Clocks of their own begin and end up to a step later or
            earlier; what lacks more is a fault, and its rows are among these.
        warnings: What looks wrong with it and may be right.
    """

    columns: dict[str, Array]
    unused: tuple[str, ...]
    lines_before: int
    covered: slice
    warnings: tuple[Finding, ...] = ()


def read_log(file: Path, layout: LogFormat, findings: list[Finding]) -> LogColumns | None:
    """Read one log, and what stands beside it; faults are added to `findings`, and then None is returned."""
    own = {name: origin for name, origin in layout.columns.items() if not origin.table}
    table = _table(file, layout.topic, layout.table)
    columns, faults = _columns(file.name, table, own)
    if "time_s" in own and own["time_s"].rate_hz is not None and table.columns:
        rows = len(next(iter(table.columns.values())))
        columns["time_s"] = np.arange(rows) / own["time_s"].rate_hz
    if "time_s" in columns:
        faults += _clocks(file.name, columns, own, columns["time_s"])
    covered = slice(0, max(map(len, columns.values()), default=0))
    warnings: list[Finding] = []
    for name, beside in layout.tables.items():
        if not faults:
            wanted = {key: origin for key, origin in layout.columns.items() if origin.table == name}
            others, seen, found = _beside(file, name, beside, wanted, columns["time_s"])
            columns |= others
            for finding in found:
                (warnings if finding.level == "warning" else faults).append(finding)
            covered = slice(max(covered.start, seen.start), min(covered.stop, seen.stop))
    findings += faults
    if faults:
        return None
    named = {origin.name_in(table.names) for origin in own.values()}
    unused = tuple(name for name in dict.fromkeys(table.names) if name and name not in named)
    return LogColumns(columns, unused, layout.table.lines_before, covered, tuple(warnings))


def no_values(file: Path, columns: dict[str, Array], rows: slice, log: LogColumns, layout: LogFormat) -> list[Finding]:
    """Return a finding for each column with cells of some rows that hold no number."""
    found = []
    for name, values in columns.items():
        if bad := rows_where(~np.isfinite(values[rows])):
            sheet = Sheet(Run("log", "motion", 0.0, {}), file.name, ())
            origin = layout.columns[name]
            remedy = "remove these rows; of a slower instrument write `fill: hold` or `fill: line` behind its column"
            if origin.table:
                remedy = "there the other table has no readings; give a window (runs: windows_s) in which both do"
            finding = sheet.error(
                str(origin), "no value (empty, NaN or infinite)", remedy, [r + rows.start for r in bad]
            )
            found.append(in_log(finding, log))
    return found


def in_log(finding: Finding, log: LogColumns) -> Finding:
    """Return a finding whose line is that of the log."""
    return replace(finding, lines_before=log.lines_before)


def _table(file: Path, topic: str, dialect: Dialect) -> Table:
    return read_topic(file, topic) if file.suffix.lower() == MCAP else read_log_table(file, dialect)


def _columns(file: str, table: Table, wanted: dict[str, Origin]) -> tuple[dict[str, Array], list[Finding]]:
    """Return columns of a campaign out of one table, and its faults."""
    sources = {name: origin.name_in(table.names) for name, origin in wanted.items() if origin.rate_hz is None}
    named = set(sources.values())
    faults = [finding for finding in table.findings if not finding.column or finding.column in named]
    columns: dict[str, Array] = {}
    if not table.names:
        return columns, faults
    missing: list[str] = []
    for name, source in sources.items():
        origin, count = wanted[name], table.names.count(source)
        if count == 0 or not source:
            missing += [] if origin.optional else [name]
        elif count > 1:
            faults.append(
                Finding(
                    "error",
                    file,
                    None,
                    str(origin),
                    f"{count} columns have this name",
                    "rename one of them, or keep the right one",
                )
            )
        elif source in table.columns:
            values = table.columns[source]
            with np.errstate(over="ignore"):  # what is beyond all numbers is told as no reading, with its row
                values = origin.factor * values + origin.offset
            columns[name] = filled(values, origin.fill, None) if origin.fill else values
    if missing:
        faults.append(_missing(file, table, wanted, missing))
    return columns, faults


def _clocks(file: str, columns: dict[str, Array], wanted: dict[str, Origin], time: Array) -> list[Finding]:
    """Return a finding for each channel that is a clock of the log: seconds since 1970 that pass as its time does."""
    found = []
    for name, values in columns.items():
        seconds = (values - wanted[name].offset) / wanted[name].factor
        if name == "time_s" or len(time) < 2 or not is_dated(float(seconds[0])):
            continue
        passed, span = seconds - seconds[0], time - time[0]
        if span[-1] > 0 and bool(np.all(np.abs(passed - span) < CLOCKS_DIFFER * span[-1])):
            message = f"holds moments, in seconds since 1970; they are no {name}"
            found.append(Finding("error", file, None, str(wanted[name]), message, "name the column that holds it"))
    return found


def _missing(file: str, table: Table, wanted: dict[str, Origin], missing: Sequence[str]) -> Finding:
    """Return one finding for all columns that a table does not have."""
    names = [name for name in dict.fromkeys(table.names) if name]
    told = listed([f"{wanted[name]} ({name})" for name in missing])
    close = _near(wanted[missing[0]].source, names)
    remedy = (
        f"it has {len(names)} columns: {listed(names)}{close}; correct `from:` in the log.yaml, or add `optional: true`"
    )
    return Finding("error", file, None, "", f"lacks {told}", remedy)


def _near(name: str, names: Sequence[str]) -> str:
    near = get_close_matches(name, names, n=1)
    return f" (did you mean {near[0]!r}?)" if near else ""


def _beside(
    file: Path, key: str, beside: Beside, wanted: dict[str, Origin], time: Array
) -> tuple[dict[str, Array], slice, list[Finding]]:
    """Return columns of another table of a log at the times of the log, the rows that it covers, and what is wrong."""
    every = slice(0, len(time))
    other = file if beside.topic else file.with_name(beside.file.replace("*", file.stem))
    is_there = os.path.isfile(other)  # noqa: PTH113  a name may be too long for pathlib
    if all(origin.optional for origin in wanted.values()) and not is_there:
        return {}, every, []
    columns, found = _columns(other.name, _table(other, beside.topic, beside.table), {"time_s": beside.time_s} | wanted)
    clock = columns.pop("time_s", np.empty(0))
    if found or not columns:
        return {}, every, found
    if len(clock) < 2 or not np.all(np.diff(clock) > 0):
        message, remedy = "does not rise from row to row", "put the rows in order of time, one for each"
        return {}, every, [Finding("error", other.name, None, str(beside.time_s), message, remedy)]
    if TABLE_CELLS.exceeded(even_rows(clock) * len(columns)):
        message = f"pauses: {clock[-1] - clock[0]:g} s in steps of {float(np.median(np.diff(clock))):g} s"
        remedy = f"are more than {TABLE_CELLS}; cut what does not belong together"
        return {}, every, [Finding("error", other.name, None, str(beside.time_s), message, remedy)]
    found = _clocks(other.name, columns, wanted, clock)
    if finer := _finer_unit(time, clock):
        unit, factor = finer
        message = f"counts {clock[-1] - clock[0]:g} s, {1 / factor:g} times as long as {file.name}"
        remedy = f"in {unit}? then write `factor: {factor:g}` in `tables: {key}: time_s`"
        found.append(Finding("warning", other.name, None, str(beside.time_s), message, remedy))
    return at_times(clock, columns, time), _covered(time, clock), found


def _finer_unit(time: Array, clock: Array) -> tuple[str, float] | None:
    """Return the unit finer than a second [s] in which a clock counts as long as the log's does; None: in none."""
    ratio = (clock[-1] - clock[0]) / span if len(time) > 1 and (span := time[-1] - time[0]) > 0 else 1.0
    return next((unit for unit in UNITS if abs(ratio * unit[1] - 1) < LIKE), None)


def _covered(time: Array, clock: Array) -> slice:
    """Return the rows of a log between the ends of another clock; all, where that lacks a step or more."""
    step = float(np.median(np.diff(clock)))
    first, last = int(np.searchsorted(time, clock[0])), int(np.searchsorted(time, clock[-1], "right"))
    is_near = len(time) > 0 and clock[0] - time[0] < step and time[-1] - clock[-1] < step
    return slice(first, last) if is_near and first < last else slice(0, len(time))
