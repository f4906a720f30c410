"""Lines of a proposed `log.yaml` that a log alone tells."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.record.campaign import Array
from bench.record.channels import parse_column
from bench.record.look.families import Family
from bench.record.rules.scale import MAX_ANGLE
from bench.record.units import FOREIGN

MAX_TRAVEL = 10.0  # [m] of a slide; tracks that carry arms are this long, and in mm 10 would be a centimetre
KELVIN = 200.0  # a temperature above it is in kelvin, below in degrees Celsius; no winding has either in the other
ANGLES = ("q_cmd", "q_motor", "q_link")
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

    @property
    def number(self) -> int:
        """Number of the drive whose angle it is; 0 of what is no angle."""
        column = parse_column(self.column)
        return column.index if column is not None and column.channel.quantity in ANGLES else 0

    def turned(self) -> "Line":
        """Return the line with the angle counted the other way round."""
        return replace(self, factor=-self.factor, offset=-self.offset)

    def __str__(self) -> str:
        """As it stands in the file."""
        quoted = self.source if self.source.replace("_", "").isalnum() else f'"{self.source}"'
        parts = [f"from: {quoted}"]
        parts += [f"factor: {self.factor:.12g}"] if self.factor != 1 else []
        parts += [f"offset: {self.offset:g}"] if self.offset else []
        mark = "# " if self.is_open else ""
        return f"  {mark}{self.column}: {{{', '.join(parts)}}}" + (f"  # {self.why}" if self.why else "")


def positions(
    families: Sequence[Family],
    columns: Mapping[str, Array],
    is_slide: Sequence[bool] | None,
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


def as_logged(family: Family, columns: Mapping[str, Array]) -> Iterator[Line]:
    """Yield the lines of torques or currents as they stand in the log."""
    unit = "a" if family.kind == "current" else "nm"
    foreign = FOREIGN.get(family.unit)
    factor = foreign.factor if foreign and foreign.si == unit else 1.0
    for number, source in zip(family.numbers, family.sources, strict=True):
        yield Line(f"{QUANTITY[family.kind]}_{number}_{unit}", source, factor, 0.0, family.why if number == 1 else "")


def temperatures(families: Sequence[Family], columns: Mapping[str, Array]) -> Iterator[Line]:
    """Yield the lines of temperatures; those of windings, if nothing else is said."""
    for family in [family for family in families if family.kind == "temperature"][:1]:
        for number, source in zip(family.numbers, family.sources, strict=True):
            kelvin = family.unit == "k" or float(np.min(columns[source])) > KELVIN
            why = f"{family.why}; taken as winding, in {'K' if kelvin else 'degrees Celsius'}"
            yield Line(f"motor_temperature_{number}_k", source, 1.0, 0.0 if kelvin else 273.15, why)
