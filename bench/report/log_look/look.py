"""A log looked at: which of its columns is what, and what is written of it."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.errors import CampaignError
from bench.record.campaign import Array
from bench.record.csv_table import in_place_of
from bench.record.limits import TABLE_BYTES
from bench.record.logs.dialect import PLAIN, Dialect, cells_that_are_no_numbers, guess_dialect, read_log_table
from bench.record.logs.mcap_table import MCAP, read_topic
from bench.record.look.families import Family, span
from bench.record.look.names import clocks, families_by_name, unit_of
from bench.record.look.rests import rest_columns
from bench.record.look.values import clock_factor, clock_of, families_by_value, moving, readable, without_holes
from bench.record.plain_file import FileFault, read_plain
from bench.record.rules.clock import JITTER
from bench.record.table import Table
from bench.report.log_look.drives import drives, readings_of
from bench.report.log_look.gears import geared
from bench.report.log_look.lines import QUANTITY, Line, positions, temperatures
from bench.report.log_look.trial import refusals
from bench.robot.nominal_dynamics import NominalDynamics


@dataclass(frozen=True)
class Proposal:
    """A proposed `log.yaml`.

    Attributes:
        text: Of the file; comments say what each line was guessed from.
        questions: What has to be looked at before it is used; these stand in the text too.
    """

    text: str
    questions: tuple[str, ...]


def look(file: Path, topic: str = "", nominal: NominalDynamics | None = None) -> Proposal:
    """Return a proposed `log.yaml`, tried on the log it was made of.

    Args:
        file: The log.
        topic: Of an MCAP recording.
        nominal: The robot that moved, if it is known.

    Raises:
        CampaignError: The log cannot be read, or nothing in it rises like a clock.
    """
    table, dialect = _opened(file, topic)
    columns = {name: table.columns[name] for name in dict.fromkeys(table.names) if name in table.columns}
    clock = clock_of(columns, clocks(table.names))
    if clock is None:
        raise CampaignError(f"{file.name}: no column rises evenly, so none is a clock; {_without_clock(table.names)}")
    factor, why = clock_factor(columns[clock], unit_of(clock))
    time = factor * (columns[clock] - columns[clock][0])
    if "" in table.names:
        raise CampaignError(f"{file.name}: a column has no name; name it in the first line")
    read = {name: values for name, values in columns.items() if name != clock}
    others = {name: without_holes(values, time) for name, values in read.items()}
    others = {name: values for name, values in others.items() if np.all(np.isfinite(values))}
    remarks: list[str] = []
    if holes := [name for name, values in read.items() if name not in others or np.any(others[name] != values)]:
        remarks.append(f"no number in every row: {', '.join(holes)}; of a slow instrument write `fill: hold` behind it")
    others = {name: readable(values) for name, values in others.items()}
    families = _families(time, others, dialect, nominal)
    readings = readings_of(families)
    known = geared(list(positions(families, others, nominal)), readings, time, others, nominal)
    lines = [Line("time_s", clock, factor, 0.0, f"rises evenly; {why}"), *known.lines]
    found = drives(readings, lines, time, others, nominal, known.sigma, remarks)
    lines = [*(line.turned() if line.number in found.turned else line for line in lines), *found.lines]
    lines += temperatures(families, others)
    if len(lines) == 1:
        remedy = "name the robot with --robot, or write the lines yourself" if nominal is None else "write the lines"
        remarks.append(f"no column was recognised as a position; {remedy}")
    named = {line.source for line in lines}
    head = [f"# Proposed by `bench convert --look {file.name}`: guesses, each with its reason. Check every line."]
    named |= {
        name for family in families if family.kind in QUANTITY or family.kind == "unknown" for name in family.sources
    }
    remarks += _unused(families, others, named)
    settings = [f"table: {dialect}  # from its text"] if dialect != PLAIN else []
    settings += [f"topic: {topic}"] if topic else []
    body = "\n".join([*settings, *_evenness(time), "columns:", *map(str, lines)]) + "\n"
    questions = (*known.questions, *found.questions, *refusals(file, body, nominal))
    return Proposal("\n".join([*head, *(f"# {remark}" for remark in (*questions, *remarks)), body]), questions)


def _without_clock(names: Sequence[str]) -> str:
    """Return what to write for a log without a clock: of rests if its columns are named so, else of a motion."""
    if rests := rest_columns(names):
        lines = ", ".join(f"`{column}: {{from: {name}}}`" for column, name in rests.items())
        missing = "" if "load_step" in rests else "; it needs a column for `load_step` too, 0 where nothing hangs"
        return (
            f"by their names {', '.join(rests.values())} tell readings at rest apart, which are not proposed: write "
            f"`kind: static` into a log.yaml, and under `columns` {lines}, and what was read{missing} "
            "(an example: bench/record/logs/README.md)"
        )
    return "write `time_s: {rate_hz: ...}` into a log.yaml"


def _opened(file: Path, topic: str) -> tuple[Table, Dialect]:
    """Return the table of a log, and how it is written."""
    dialect = PLAIN
    if topic and file.suffix.lower() != MCAP:
        raise CampaignError(f"{file}: is no MCAP recording, and has no topic {topic!r}; leave --topic out")
    if file.suffix.lower() == MCAP:
        table = read_topic(file, topic)
    elif file.suffix.lower() == ".parquet":
        table = read_log_table(file, PLAIN)
    else:
        try:
            data = read_plain(file, TABLE_BYTES)
            guess = guess_dialect(data)
            faults = [] if guess else list(cells_that_are_no_numbers(data))
        except FileFault as fault:
            raise CampaignError(f"{file}: {fault}; {fault.remedy}") from fault
        if faults:
            raise CampaignError(
                f"{file.name}: column {name!r}, row {row}: {cell[:40]!r} is no number; {in_place_of(cell)}"
                for name, row, cell in faults
            )
        dialect = guess or PLAIN
        table = read_log_table(file, dialect)
    if not table.columns:
        raise CampaignError([str(finding) for finding in table.findings] or f"{file}: holds no column of numbers")
    return table, dialect


def _families(
    time: Array, others: Mapping[str, Array], dialect: Dialect, nominal: NominalDynamics | None
) -> list[Family]:
    joints = () if nominal is None else nominal.bodies.names
    families = families_by_name(list(others), joints) if dialect.header else []
    n = None if nominal is None else nominal.n_joints
    if nominal is not None:
        families = [family for family in families if _fits(family, nominal.n_joints)]
    placed = next((family for family in families if family.kind == "position"), None)
    if placed is not None:
        moves = set(moving(others))
        return [
            family
            for family in families
            if family.kind != "unknown" or (family.numbers == placed.numbers and moves.issuperset(family.sources))
        ]
    families = [family for family in families if family.kind != "unknown"]
    if n is None and families:
        n = len(families[0].sources)
    taken = {name for family in families for name in family.sources}
    return families + families_by_value(time, {k: v for k, v in others.items() if k not in taken}, n)


def _fits(family: Family, n: int) -> bool:
    """Return whether a family goes by the drives of a robot; only some joints may have a secondary encoder."""
    every = tuple(range(1, n + 1))
    return set(family.numbers) <= set(every) if family.kind == "link" else family.numbers == every


def _unused(families: Sequence[Family], columns: Mapping[str, Array], named: set[str]) -> Iterator[str]:
    """Yield a remark for what is not taken up."""
    for family in families:
        if family.kind in ("velocity", "acceleration"):
            yield (
                f"{family.shown}: {family.kind}, not needed: positions are differentiated after a stated low-pass "
                "(bench/identify/dynamics/README.md)"
            )
            named = named | set(family.sources)
    moves = set(moving(columns))
    if still := [name for name in columns if name not in moves and name not in named]:
        yield f"not used, they stand still or have empty cells: {span(still) if len(still) > 3 else ', '.join(still)}"
    if rest := [name for name in columns if name in moves and name not in named]:
        yield f"not used: {', '.join(rest[:12])}{' ...' if len(rest) > 12 else ''}"


def _evenness(time: Array) -> Iterator[str]:
    """Yield what a clock that is not even asks for."""
    step = np.diff(time)
    median = float(np.median(step))
    uneven = float(np.mean(np.abs(step - median) > JITTER * median))
    if uneven > 0:
        rate = float(f"{1 / median:.4g}")
        yield f"resample: {{rate_hz: {rate:g}}}  # {100 * uneven:.2g} % of steps are over 5 % off: that cuts a motion"
