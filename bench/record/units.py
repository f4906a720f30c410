"""Units that laboratories write and this format does not: what they are called here, and the factor."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi
from unicodedata import category

from bench.record.channels import parse_column

STANDARD_GRAVITY = 9.80665  # [m/s^2], CGPM 1901
HOUR = 3600.0  # [s]


@dataclass(frozen=True)
class Foreign:
    """A unit and its way to the SI: value_si = value * factor + offset."""

    si: str
    factor: float
    offset: float = 0.0

    def __str__(self) -> str:
        scaled = "" if self.factor == 1 else f"multiply by {self.factor:.8g}"
        shifted = f"add {self.offset:g}" if self.offset else ""
        return " and ".join(part for part in (scaled, shifted) if part)


FOREIGN: Mapping[str, Foreign] = {
    "deg": Foreign("rad", pi / 180),
    "mdeg": Foreign("rad", pi / 180e3),
    "mrad": Foreign("rad", 1e-3),
    "urad": Foreign("rad", 1e-6),
    "arcmin": Foreign("rad", pi / 180 / 60),
    "arcsec": Foreign("rad", pi / 180 / 3600),
    "rev": Foreign("rad", 2 * pi),
    "mm": Foreign("m", 1e-3),
    "um": Foreign("m", 1e-6),
    "cm": Foreign("m", 1e-2),
    "in": Foreign("m", 0.0254),
    "kn": Foreign("n", 1e3),
    "kgf": Foreign("n", STANDARD_GRAVITY),
    "kg": Foreign("n", STANDARD_GRAVITY),
    "knm": Foreign("nm", 1e3),
    "nmm": Foreign("nm", 1e-3),
    "ma": Foreign("a", 1e-3),
    "bar": Foreign("pa", 1e5),
    "mbar": Foreign("pa", 1e2),
    "kpa": Foreign("pa", 1e3),
    "mpa": Foreign("pa", 1e6),
    "psi": Foreign("pa", 6894.757),
    "ms": Foreign("s", 1e-3),
    "us": Foreign("s", 1e-6),
    "min": Foreign("s", 60.0),
    "h": Foreign("s", HOUR),
    "g": Foreign("kg", 1e-3),
    "c": Foreign("k", 1.0, 273.15),
    "degc": Foreign("k", 1.0, 273.15),
    "degf": Foreign("k", 5 / 9, 459.67 * 5 / 9),
}


UNSEEN = ("Cc", "Cf", "Zs", "Zl", "Zp")  # categories of Unicode: controls, marks such as U+FEFF and U+200B, spaces


def seen_of(name: str) -> str:
    """Return a name without the characters in it that nobody sees."""
    return "".join(character for character in name if category(character) not in UNSEEN)


def right_name(name: str) -> tuple[str, str] | None:
    """Return the right name for a column whose unit is wrong, and what to do with its values ("" if nothing).

    Finds foreign units ("q_cmd_1_deg"), capitals ("tau_motor_1_Nm"), units left out ("q_cmd_1") and characters that
    nobody sees (a byte order mark that two exports left). None if the name is wrong in another way.
    """
    lower = seen_of(name).lower()
    stem, _, unit = lower.rpartition("_")
    foreign = FOREIGN.get(unit)
    if foreign and parse_column(f"{stem}_{foreign.si}"):
        return f"{stem}_{foreign.si}", str(foreign)
    if parse_column(lower):
        return lower, ""
    for base in (lower, stem):
        for si in ("rad", "s", "a", "nm", "n", "m", "k", "pa", "kg"):
            if parse_column(f"{base}_{si}"):
                return f"{base}_{si}", f"give them in {si}"
    return None
