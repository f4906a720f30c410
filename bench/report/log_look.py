"""A `log.yaml` proposed for a log that nobody has described, with the reason of each guess."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.errors import CampaignError
from bench.identify.drive_scale import DriveScale, drive_scale
from bench.record.campaign import Array
from bench.record.limits import TABLE_BYTES
from bench.record.logs.dialect import PLAIN, Dialect, guess_dialect, read_log_table
from bench.record.logs.mcap_table import MCAP, read_topic
from bench.record.look.families import Family, span
from bench.record.look.names import clocks, families_by_name, unit_of
from bench.record.look.values import clock_factor, clock_of, evenly, families_by_value, moving
from bench.record.plain_file import FileFault, read_plain
from bench.record.rules.scale import MAX_ANGLE
from bench.record.table import Table
from bench.record.units import FOREIGN
from bench.robot.nominal_dynamics import NominalDynamics

EXPLAINED = 0.5  # share of a reading's variance, mean over drives, from which it is a torque or a current (assumed)
NEAR_ONE = 0.25  # relative: a factor this near to one is no gear ratio; payload and masses may be off so far (assumed)
UNTOLD = 0.3  # relative standard deviation of a factor that is no proposal (assumed: gears of one arm differ by less)
JITTER = 0.05  # of a step, from which the first pass cuts a run (`identify/dynamics/samples.py`)
MAX_TRAVEL = 10.0  # [m] of a slide; tracks that carry arms are this long, and in mm 10 would be a centimetre
QUANTITY = {"link": "q_link", "current": "current", "torque": "tau_motor", "temperature": "motor_temperature"}


@dataclass(frozen=True)
class Line:
    """One column of a proposed `log.yaml`; one that is open is a comment there."""

    column: str
    source: str
    factor: float
    offset: float
    why: str
    is_open: bool = False

    def __str__(self) -> str:
        """As it stands in the file."""
        quoted = self.source if self.source.replace("_", "").isalnum() else f'"{self.source}"'
        parts = [f"from: {quoted}"]
        parts += [f"factor: {self.factor:.12g}"] if self.factor != 1 else []
        parts += [f"offset: {self.offset:g}"] if self.offset else []
        mark = "# " if self.is_open else ""
        return f"  {mark}{self.column}: {{{', '.join(parts)}}}" + (f"  # {self.why}" if self.why else "")


def look(file: Path, topic: str = "", nominal: NominalDynamics | None = None) -> str:
    """Return a proposed `log.yaml` as text; comments say what each line was guessed from.

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
        raise CampaignError(
            f"{file.name}: no column rises evenly, so none is a clock; write `time_s: {{rate_hz: ...}}` into a log.yaml"
        )
    factor, why = clock_factor(columns[clock], unit_of(clock))
    time = factor * (columns[clock] - columns[clock][0])
    others = {name: values for name, values in columns.items() if name != clock}
    is_slide = None if nominal is None else [not bool(hinge) for hinge in nominal.bodies.is_hinge]
    families = _families(time, others, dialect, nominal)
    lines = [Line("time_s", clock, factor, 0.0, f"rises evenly; {why}")]
    lines += _positions(families, others, is_slide, nominal)
    remarks: list[str] = []
    lines += _drives(families, lines, time, others, nominal, remarks)
    lines += _temperatures(families, others)
    if len(lines) == 1:
        remarks.append(
            "no column was recognised as a position; name the robot with --robot, or write the lines yourself"
        )
    named = {line.source for line in lines}
    head = [f"# Proposed by `bench convert --look {file.name}`: guesses, each with its reason. Check every line."]
    named |= {
        name for family in families if family.kind in QUANTITY or family.kind == "unknown" for name in family.sources
    }
    head += [f"# {remark}" for remark in (*remarks, *_unused(families, others, named))]
    head += [f"table: {dialect}  # from its text"] if dialect != PLAIN else []
    head += [f"topic: {topic}"] if topic else []
    return "\n".join([*head, *_evenness(time), "columns:", *map(str, lines)]) + "\n"


def _opened(file: Path, topic: str) -> tuple[Table, Dialect]:
    """Return the table of a log, and how it is written."""
    dialect = PLAIN
    if file.suffix.lower() == MCAP:
        table = read_topic(file, topic)
    elif file.suffix.lower() == ".parquet":
        table = read_log_table(file, PLAIN)
    else:
        try:
            dialect = guess_dialect(read_plain(file, TABLE_BYTES)) or PLAIN
        except FileFault as fault:
            raise CampaignError(f"{file}: {fault}; {fault.remedy}") from fault
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
    if any(family.kind == "position" for family in families):
        return families
    if n is None and families:
        n = len(families[0].sources)
    taken = {name for family in families for name in family.sources}
    return families + families_by_value(time, {k: v for k, v in others.items() if k not in taken}, n)


def _fits(family: Family, n: int) -> bool:
    """Return whether a family goes by the drives of a robot; only some joints may have a secondary encoder."""
    every = tuple(range(1, n + 1))
    return set(family.numbers) <= set(every) if family.kind == "link" else family.numbers == every


def _positions(
    families: Sequence[Family],
    columns: Mapping[str, Array],
    is_slide: Sequence[bool] | None,
    nominal: NominalDynamics | None,
) -> Iterator[Line]:
    """Yield the lines of commands, encoders and secondary encoders; the first family of a kind is taken."""
    taken: set[str] = set()
    for family in families:
        if family.kind not in ("position", "link"):
            continue
        quantity = "q_link" if family.kind == "link" else "q_cmd" if family.is_command else "q_motor"
        if quantity in taken:
            continue
        taken.add(quantity)
        for number, source in zip(family.numbers, family.sources, strict=True):
            slides = bool(is_slide and is_slide[number - 1])
            factor, why = _unit(family, columns[source], slides)
            reasons = f"{family.why}; {why}" if number == family.numbers[0] or why.startswith("reaches") else ""
            yield Line(f"{quantity}_{number}_{'m' if slides else 'rad'}", source, factor, 0.0, reasons)


def _unit(family: Family, values: Array, slides: bool) -> tuple[float, str]:
    """Return the factor of a position to rad or m, and why."""
    target = "m" if slides else "rad"
    foreign = FOREIGN.get(family.unit)
    if foreign and foreign.si == target:
        return foreign.factor, f"unit {family.unit} in its name"
    if family.unit == target:
        return 1.0, f"unit {family.unit} in its name"
    largest = float(np.max(np.abs(values)))
    if not slides and largest > MAX_ANGLE:
        return FOREIGN["deg"].factor, f"reaches {largest:.3g}, so degrees"
    if slides and largest > MAX_TRAVEL:
        return FOREIGN["mm"].factor, f"reaches {largest:.3g}, so millimetres"
    return 1.0, f"taken as {target}"


def _drives(
    families: Sequence[Family],
    lines: Sequence[Line],
    time: Array,
    columns: Mapping[str, Array],
    nominal: NominalDynamics | None,
    remarks: list[str],
) -> list[Line]:
    """Return the lines of torques and currents; turned angles are remarked."""
    candidates = [f for f in families if f.kind in ("torque", "current", "unknown") and not f.is_command]
    places = {line.column: line for line in lines}
    if nominal is None:
        named = [family for family in candidates if family.kind != "unknown"]
        unknown = [family.shown for family in candidates if family.kind == "unknown"]
        if unknown:
            remarks.append(f"{', '.join(unknown)}: move with the robot; currents or torques? --robot DIR tells")
        if named:
            remarks.append("torques and currents are as logged: --robot DIR tells gear ratio, sign and delay")
        return [line for family in named for line in _as_logged(family, columns)]
    angles = [
        next(
            (
                places[name]
                for name in (f"{q}_{j}_{u}" for q in ("q_motor", "q_cmd") for u in ("rad", "m"))
                if name in places
            ),
            None,
        )
        for j in range(1, nominal.n_joints + 1)
    ]
    found: list[Line] = []
    for family in candidates if all(angles) and len(angles) == nominal.n_joints else ():
        sources = {line.source: line for line in angles if line}
        clock, slow = evenly(time, {name: columns[name] for name in (*sources, *family.sources)})
        position = np.stack([line.factor * slow[name] for name, line in sources.items()], axis=1)[5:-5]
        reading = np.stack([slow[name] for name in family.sources], axis=1)[5:-5]
        if not np.all(np.ptp(reading, axis=0) > 0):
            continue
        scale = drive_scale(nominal, clock[5:-5], position, reading)
        if np.mean(scale.explained) < EXPLAINED:
            remarks.append(
                f"{family.shown}: the model explains {100 * np.mean(scale.explained):.0f} % of it; not taken"
            )
            continue
        found += _scaled(family, scale, nominal, remarks)
    return found


def _as_logged(family: Family, columns: Mapping[str, Array]) -> Iterator[Line]:
    unit = "a" if family.kind == "current" else "nm"
    foreign = FOREIGN.get(family.unit)
    factor = foreign.factor if foreign and foreign.si == unit else 1.0
    for number, source in zip(family.numbers, family.sources, strict=True):
        yield Line(f"{QUANTITY[family.kind]}_{number}_{unit}", source, factor, 0.0, family.why if number == 1 else "")


def _scaled(family: Family, scale: DriveScale, nominal: NominalDynamics, remarks: list[str]) -> Iterator[Line]:
    """Yield the lines of one family of readings that go by the torque that the arm needs."""
    names = nominal.bodies.names
    if np.any(scale.turned):
        who = ", ".join(name for name, turned in zip(names, scale.turned, strict=True) if turned)
        remarks.append(f"angles of {who} seem to count the other way round than the model: give them factor -1")
    remarks.append(
        f"{family.shown}: held against the masses of the robot with {scale.payload:.3g} kg of payload, with which "
        f"all drives agree best; they lag the angles by {1e3 * scale.delay:.1f} ms"
    )
    near = bool(np.all(np.abs(np.abs(scale.factor) - 1) < NEAR_ONE))
    if family.kind == "current":
        estimated = zip(names, scale.factor, scale.sigma, strict=True)
        constants = ", ".join(f"{name} {abs(k):.3g} +- {100 * s:.0f} %" for name, k, s in estimated)
        remarks.append(f"for figures.yaml, torque_constant_nm_per_a as estimated: {constants} (torque_constant_error)")
    elif not near:
        widest = float(np.max(scale.sigma[scale.sigma < UNTOLD], initial=0.01))
        remarks.append(
            f"factors of {family.shown} are estimates: write gear ratios or constants there where they are known, else "
            f"`gain_sigma: {widest:.2g}` under instruments: torque: of figures.yaml"
        )
    for number, source in zip(family.numbers, family.sources, strict=True):
        k = number - 1
        sign = float(np.sign(scale.factor[k]))
        unit = "nm" if nominal.bodies.is_hinge[k] else "n"
        told = f"{100 * scale.explained[k]:.0f} % explained"
        if family.kind == "current":
            yield Line(f"current_{number}_a", source, sign, 0.0, f"{told}; sign as the model has it")
        elif near:
            why = f"{told}; joint torque within {100 * abs(abs(scale.factor[k]) - 1):.0f} % of the model's"
            yield Line(f"tau_motor_{number}_{unit}", source, sign, 0.0, why)
        else:
            wide = scale.sigma[k] > UNTOLD
            remedy = ": not told by this log, write the gear ratio" if wide else ""
            why = f"{told}; +- {100 * scale.sigma[k]:.0f} %{remedy}"
            factor = float(f"{scale.factor[k]:.3g}")
            yield Line(f"tau_motor_{number}_{unit}", source, factor, 0.0, why, is_open=bool(wide))


def _temperatures(families: Sequence[Family], columns: Mapping[str, Array]) -> Iterator[Line]:
    for family in [family for family in families if family.kind == "temperature"][:1]:
        for number, source in zip(family.numbers, family.sources, strict=True):
            kelvin = family.unit == "k" or float(np.min(columns[source])) > 200
            why = f"{family.why}; taken as winding, in {'K' if kelvin else 'degrees Celsius'}"
            yield Line(f"motor_temperature_{number}_k", source, 1.0, 0.0 if kelvin else 273.15, why)


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
