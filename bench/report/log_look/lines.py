"""Lines of a proposed `log.yaml` that a log alone tells."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.record.campaign import Array
from bench.record.channels import parse_column
from bench.record.look.families import Family
from bench.record.look.names import unit_of, words_of
from bench.record.turns import as_offset, in_words
from bench.record.units import FOREIGN
from bench.record.yaml_text import in_quotes
from bench.report.log_look.angle_units import Side, angle_unit, reaches, turns_of
from bench.robot.nominal_dynamics import NominalDynamics

MAX_TRAVEL = 10.0  # [m] of a slide; tracks that carry arms are this long, and in mm 10 would be a centimetre
KELVIN = 200.0  # a temperature above it is in kelvin, below in degrees Celsius; no winding has either in the other
ANGLES = ("q_cmd", "q_motor", "q_link")
UNTOLD = 0.3  # relative standard deviation of a factor that is no proposal (assumed: gears of one arm differ by less)
GEARS = {"gear", "gears", "gearbox", "reducer", "oil", "getriebe", "joint", "joints", "axis", "achse"}
WINDINGS = {"motor", "motors", "winding", "windings", "stator", "drive", "wicklung"}
QUANTITY = {"link": "q_link", "current": "current", "torque": "tau_motor", "temperature": "motor_temperature"}


@dataclass(frozen=True)
class Line:
    """One column of a proposed `log.yaml`; one that is open is a comment there.

    Attributes:
        unit: Of an angle as logged; "" if it is not known.
        side: Of the gear, on which an angle is.
        was_estimated: Whether its factor was found against the robot's masses.
        turns: Of an angle that fits its joint in radians, but for so many whole turns (0 too); None: it does not.
    """

    column: str
    source: str
    factor: float
    offset: float
    why: str
    is_open: bool = False
    unit: str = ""
    side: Side = "joint"
    was_estimated: bool = False
    turns: int | None = None

    @property
    def number(self) -> int:
        """Number of the drive whose angle it is; 0 of what is no angle."""
        column = parse_column(self.column)
        return column.index if column is not None and column.channel.quantity in ANGLES else 0

    def turned(self) -> "Line":
        """Return the line with the angle counted the other way round."""
        return replace(self, factor=-self.factor, offset=-self.offset)

    def counted(self, turns: int) -> "Line":
        """Return the line of an angle of the joint without whole turns."""
        if not turns:
            return replace(self, side="joint")
        why = self.and_why(f"{in_words(turns)}, by its first sample")
        return replace(self, side="joint", offset=as_offset(turns), why=why)

    def and_why(self, more: str) -> str:
        """Return its reason with another one behind it."""
        return f"{self.why}; {more}" if self.why else more

    def __str__(self) -> str:
        """As it stands in the file."""
        quoted = self.source if self.source.replace("_", "").isalnum() else in_quotes(self.source)
        parts = [f"from: {quoted}"]
        parts += [f"factor: {self.factor:.12g}"] if self.factor != 1 else []
        parts += [f"offset: {self.offset:.10g}"] if self.offset else []
        mark = "# " if self.is_open else ""
        return f"  {mark}{self.column}: {{{', '.join(parts)}}}" + (f"  # {self.why}" if self.why else "")


def positions(
    families: Sequence[Family], columns: Mapping[str, Array], nominal: NominalDynamics | None
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
        yield from _family_lines(quantity, family, columns, nominal)


def _family_lines(
    quantity: str, family: Family, columns: Mapping[str, Array], nominal: NominalDynamics | None
) -> Iterator[Line]:
    reach = reaches(nominal, max(family.numbers))
    pairs = list(zip(family.numbers, family.sources, strict=True))
    slides = {number for number, _ in pairs if nominal is not None and not nominal.bodies.is_hinge[number - 1]}
    hinges = [(number, source) for number, source in pairs if number not in slides]
    unit = unit_of(hinges[0][1]) if hinges and family.unit else ""  # slides may have another
    turning = replace(family, unit=unit, sources=tuple(s for _, s in hinges), numbers=tuple(n for n, _ in hinges))
    read = angle_unit(turning, columns, reach[[n - 1 for n, _ in hinges]], nominal is not None) if hinges else None
    turns = turns_of(turning, columns, nominal) if nominal is not None else {}
    for number, source in pairs:
        if number in slides or read is None:
            factor, why = _slide_unit(unit_of(source) if family.unit else "", columns[source])
            line = Line(f"{quantity}_{number}_m", source, factor, 0.0, why)
        else:
            side: Side = read.side if np.any(columns[source]) else "joint"  # of a zero nobody needs a factor
            line = Line(f"{quantity}_{number}_rad", source, read.factor, 0.0, read.why, unit=read.unit, side=side)
        is_first = number == family.numbers[0]
        reasons = dict.fromkeys([family.why, line.why] if is_first else [line.why] if number in slides else [])
        line = replace(line, why="; ".join(reasons))
        if number in turns and line.unit and (line.side == "joint" or family.unit):  # its unit is known
            yield line.counted(turns[number])
        else:
            yield replace(line, turns=turns.get(number))


def _slide_unit(unit: str, values: Array) -> tuple[float, str]:
    """Return the factor of a slide's position to m, and why."""
    foreign = FOREIGN.get(unit)
    if foreign and foreign.si == "m":
        return foreign.factor, f"unit {unit} in its name"
    if unit == "m":
        return 1.0, "unit m in its name"
    largest = float(np.max(np.abs(values)))
    if largest > MAX_TRAVEL:
        return FOREIGN["mm"].factor, f"reaches {largest:.3g}, so millimetres"
    return 1.0, "taken as m"


def si_factor(family: Family) -> float:
    """Return the factor from the unit in the name of torques, forces or currents to Nm, N or A; 1 if there is none."""
    foreign = FOREIGN.get(family.unit)
    wanted = {"a"} if family.kind == "current" else {"nm", "n"}
    return foreign.factor if foreign and foreign.si in wanted else 1.0


def as_logged(family: Family) -> Iterator[Line]:
    """Yield the lines of torques or currents as they stand in the log."""
    unit, factor = "a" if family.kind == "current" else "nm", si_factor(family)
    for number, source in zip(family.numbers, family.sources, strict=True):
        yield Line(f"{QUANTITY[family.kind]}_{number}_{unit}", source, factor, 0.0, family.why if number == 1 else "")


def temperatures(families: Sequence[Family], columns: Mapping[str, Array]) -> Iterator[Line]:
    """Yield the lines of temperatures; those of joints are of gearboxes, others of windings."""
    first: dict[str, Family] = {}
    for family in families:
        if family.kind == "temperature":
            words = set(words_of(family.sources[0]))
            first.setdefault("gear" if words & GEARS and not words & WINDINGS else "motor", family)
    for part, family in first.items():
        for number, source in zip(family.numbers, family.sources, strict=True):
            kelvin = family.unit == "k" or float(np.min(columns[source])) > KELVIN
            taken = "gearbox, whose friction follows it" if part == "gear" else "winding"
            why = f"{family.why}; taken as {taken}, in {'K' if kelvin else 'degrees Celsius'}"
            yield Line(f"{part}_temperature_{number}_k", source, 1.0, 0.0 if kelvin else 273.15, why)
