"""The columns of a run's table: what they hold, in which unit, and how their names are made.

A name is `<quantity>_<key>_<unit>`; the key says which drive, axis or reflector, and is left out where there is one.
README.md beside this file shows the same table to people; a test holds the two together.
"""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

Role = Literal["clock", "label", "command", "load", "measured"]


def _join(*parts: str) -> str:
    return "_".join(part for part in parts if part)


@dataclass(frozen=True)
class Channel:
    """One line of the table of columns.

    Attributes:
        quantity: First part of the column name; what `noise` in the manifest refers to.
        keys: Middle part, one for each column; "i" (drive) and "k" (reflector) stand for a number from 1. Empty: none.
        unit: Last part, an SI unit in lower case. Empty for labels.
        role: What the numbers are: counted, set, hung, or read from an instrument. Only "measured" has noise.
        description: One line for the documentation.
        slide_unit: Unit where drive i moves a slide instead of a hinge. Empty: the same for both.
    """

    quantity: str
    keys: tuple[str, ...]
    unit: str
    role: Role
    description: str
    slide_unit: str = ""

    @property
    def names(self) -> tuple[str, ...]:
        """Column names with the letters i and k in them, those of a hinge first."""
        units = (self.unit, self.slide_unit) if self.slide_unit else (self.unit,)
        return tuple(_join(self.quantity, key, unit) for unit in units for key in self.keys or ("",))


@dataclass(frozen=True)
class Column:
    """A column name taken apart.

    Attributes:
        name: The whole name.
        channel: Its line of the table.
        key: Middle part as written, "" if there is none: "2", "mx", "1_z".
        index: Number of the drive or reflector from 1; 0 if the channel has none.
        unit: Unit as written.
    """

    name: str
    channel: Channel
    key: str
    index: int
    unit: str

    @property
    def is_slide(self) -> bool:
        """Whether the unit says that the drive moves a slide."""
        return bool(self.channel.slide_unit) and self.unit == self.channel.slide_unit


AXES = ("x", "y", "z")

CHANNELS: tuple[Channel, ...] = (
    Channel("time", (), "s", "clock", "time; a row was read `start_s + time_s` after the start of its recording"),
    Channel("pose", (), "", "label", "number of the pose"),
    Channel("approach", (), "", "label", "+1 or -1: the side from which the pose was reached"),
    Channel("load_step", (), "", "label", "state of load in one visit to a pose, in order; 0: nothing hung"),
    Channel("repeat", (), "", "label", "which reading of this state it is, 1, 2, 3, ..."),
    Channel("q_cmd", ("i",), "rad", "command", "commanded angle (or position) of joint i", "m"),
    Channel("q_motor", ("i",), "rad", "measured", "motor encoder of drive i, reflected to the joint", "m"),
    Channel("q_link", ("i",), "rad", "measured", "secondary encoder of joint i, after the gear", "m"),
    Channel("current", ("i",), "a", "measured", "motor current of drive i that makes torque"),
    Channel("tau_motor", ("i",), "nm", "measured", "motor torque that drive i reports, times the gear ratio", "n"),
    Channel("motor_temperature", ("i",), "k", "measured", "winding of motor i"),
    Channel("gear_temperature", ("i",), "k", "measured", "gearbox i"),
    Channel("load", AXES, "n", "load", "known force on the load point, world axes, z up: a hung mass is -m g in z"),
    Channel("load", ("mx", "my", "mz"), "nm", "load", "known moment about the load point, world axes"),
    Channel("load_mass", (), "kg", "load", "mass that moves with the load point; its weight stands in load_z_n"),
    Channel("force", AXES, "n", "measured", "force sensor: force on the load point, world axes, signs as load_*_n"),
    Channel("moment", AXES, "nm", "measured", "force sensor: moment about the load point, world axes"),
    Channel("reflector", ("k_x", "k_y", "k_z"), "m", "measured", "laser tracker: reflector k in the base frame"),
    Channel("gas_pressure", (), "pa", "measured", "gas of the counterbalance, above ambient pressure"),
    Channel("gas_temperature", (), "k", "measured", "gas of the counterbalance"),
    Channel("ambient_temperature", (), "k", "measured", "air around the robot"),
)

NAMES: tuple[str, ...] = tuple(name for channel in CHANNELS for name in channel.names)
NOISY: Mapping[str, str] = {
    channel.quantity: channel.unit for channel in CHANNELS if channel.role == "measured"
}  # units


def table() -> str:
    """Return the table of columns in Markdown, as it stands in README.md."""
    lines = ["| column | holds |", "|---|---|"]
    for channel in CHANNELS:
        names = ", ".join(f"`{name}`" for name in channel.names)
        lines.append(f"| {names} | {channel.description} |")
    return "\n".join(lines)


@lru_cache(maxsize=4096)
def parse_column(name: str) -> Column | None:
    """Take a column name apart; None if it is not in the table."""
    for pattern, channel, unit in _PATTERNS:
        if match := pattern.fullmatch(name):
            key = match["key"] or ""
            number = re.match(r"\d+", key)
            return Column(name, channel, key, int(number[0]) if number else 0, unit)
    return None


def known_names(like: str) -> list[str]:
    """Return every column name, numbered as `like` is ("q_cmd_i_rad" as "q_cmd_3_rad" if a 3 stands in `like`)."""
    number = re.search("[1-9][0-9]{0,3}", like)
    return [re.sub(r"_[ik](?=_)", f"_{number[0] if number else 1}", name) for name in NAMES]


def columns_of(names: Iterable[str], *quantities: str) -> list[Column]:
    """Return those columns, taken apart, that hold one of the quantities, in their order."""
    return list(_columns_of(tuple(names), quantities))


@lru_cache(maxsize=1024)
def _columns_of(names: tuple[str, ...], quantities: tuple[str, ...]) -> tuple[Column, ...]:
    """Do it once for all runs with the same columns."""
    parsed = (parse_column(name) for name in names)
    return tuple(column for column in parsed if column is not None and column.channel.quantity in quantities)


def _patterns() -> list[tuple[re.Pattern[str], Channel, str]]:
    found = []
    for channel in CHANNELS:
        keys = "|".join(re.sub("[ik]", "[1-9][0-9]{0,3}", key, count=1) for key in channel.keys)
        for unit in dict.fromkeys((channel.unit, channel.slide_unit or channel.unit)):
            stem = f"{channel.quantity}_(?P<key>{keys})" if keys else f"{channel.quantity}(?P<key>)"
            found.append((re.compile(_join(stem, unit)), channel, unit))
    return found


_PATTERNS = _patterns()
