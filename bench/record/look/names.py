"""What the names of columns tell: quantity, unit, number of the drive."""

import re
from collections.abc import Sequence
from dataclasses import replace

from bench.record.look.families import Family, Kind
from bench.record.units import FOREIGN

# Words that loggers use, from ROS 2 (JointState), Universal Robots (RTDE), KUKA (RSI), Franka, and German controllers
COMMANDED = {"target", "cmd", "command", "commanded", "des", "desired", "set", "setpoint", "ref", "reference", "soll"}
WORDS: tuple[tuple[Kind, frozenset[str]], ...] = (
    ("temperature", frozenset({"temp", "temps", "temperature", "temperatures"})),
    ("acceleration", frozenset({"qdd", "ddq", "acc", "accel", "acceleration"})),
    (
        "velocity",
        frozenset({"qd", "dq", "vel", "velo", "velocity", "velocities", "speed", "spd", "rpm", "qdot", "omega"}),
    ),
    ("current", frozenset({"current", "currents", "curr", "cur", "amp", "amps", "i", "iq", "strom"})),
    ("torque", frozenset({"torque", "torques", "tau", "effort", "trq", "moment", "drehmoment"})),
    ("link", frozenset({"link", "secondary", "abtrieb"})),
    ("position", frozenset({"q", "pos", "position", "positions", "angle", "theta", "enc"})),
    ("torque", frozenset({"m"})),  # behind "pos" and "angle": of "m1_pos" it is the motor
    ("position", frozenset({"joint", "axis", "achse"})),  # may be any quantity of a joint
)
CLOCKS = {"t", "time", "timestamp", "stamp", "zeit", "clock", "log"}
STAMPS = {"time", "timestamp", "stamp"}  # "log_time", "header.stamp"
SI = {"rad", "m", "s", "a", "nm", "n", "k"}
# other words for units, as loggers write them: "Achse 1 [Grad]", "angle (°)"
WORDS_OF_UNITS = {"grad": "deg", "°": "deg", "degree": "deg", "degrees": "deg", "radian": "rad", "radians": "rad"}
WORDS_OF_UNITS |= {"ampere": "a", "amps": "a"}
# where no word tells the quantity
BY_UNIT: dict[str, Kind] = {"a": "current", "nm": "torque", "n": "torque", "rad": "position", "m": "position"}
ANGLES = {unit for unit, foreign in FOREIGN.items() if foreign.si == "rad"} | {"rad"}
LISTS = {"position", "velocity", "effort"}  # of a JointState, with the names of joints behind a dot
LONGEST_RATE = 40  # exact: characters, and more: "degrees_per_sec**2]" has 19
_INDEX = re.compile(r"\d+")
_UNIT_AT_END = re.compile(r"(?:[_\s.]|[\[(])([A-Za-z°]+)[\])]?$")
_RATE_AT_END = re.compile(r"(?P<unit>[A-Za-z°]+)(?:/|_per_)(?:s|sec|min)(?P<twice>(?:\^|\*\*)?2|²|/s)?[\])]?$", re.I)


def clocks(names: Sequence[str]) -> list[str]:
    """Return the columns that may be a clock by their names; first a stamp of the measurement, then one of the log."""
    found = [name for name in names if (words := words_of(name)) and (words[0] in CLOCKS or words[-1] in STAMPS)]
    return sorted(found, key=lambda name: words_of(name)[0] == "log")


def unit_of(name: str) -> str:
    """Return the unit at the end of a name, in lower case; "" if there is none that is known."""
    end = _UNIT_AT_END.search(name)
    word = end[1].lower() if end else ""
    word = WORDS_OF_UNITS.get(word, word)
    return word if word in FOREIGN or word in SI else ""


def _rate_at_end(name: str) -> re.Match[str] | None:
    return _RATE_AT_END.search(name, max(len(name) - LONGEST_RATE, 0))  # else a long name is searched from each letter


def rate_of(name: str) -> Kind | None:
    """Return what an angle or a way by time at the end of a name tells: "A1 [deg/s]" is a velocity; None if none is."""
    rate = _rate_at_end(name)
    unit = rate["unit"].lower() if rate else ""
    unit = WORDS_OF_UNITS.get(unit, unit)
    if rate is None or BY_UNIT.get(FOREIGN[unit].si if unit in FOREIGN else unit) != "position":
        return None
    return "acceleration" if rate["twice"] else "velocity"


def families_by_name(names: Sequence[str], joints: Sequence[str]) -> list[Family]:
    """Return what names tell of columns that go by the drives; columns are listed by number of the drive.

    An angle or a way by time is a rate, whatever words say ("axis"). Else, where no word says the quantity, its unit
    does; what has neither is unknown.

    Args:
        names: Of the columns.
        joints: Names of the robot's joints, if it is known.
    """
    groups: dict[str, list[tuple[int, str]]] = {}
    others: list[str] = []
    for name in dict.fromkeys(names):
        stem, number = _stem(name, joints)
        if number is None:
            others.append(name)
        else:
            groups.setdefault(stem, []).append((number, name))
    found: dict[str, list[Family]] = {}
    first = min((number for members in groups.values() for number, _ in members), default=1)  # 0 or 1
    for stem, members in groups.items():
        members += _lettered(stem, members, others, range(first, first + len(joints)))
        unit = unit_of(members[0][1])
        words = words_of(stem)
        words = words[:-1] if unit and words and WORDS_OF_UNITS.get(words[-1], words[-1]) == unit else words
        measured = FOREIGN[unit].si if unit in FOREIGN else unit
        by_unit = BY_UNIT.get(measured, "unknown")
        by_word = next((kind for kind, known in WORDS if known & set(words) and _fits(kind, unit, by_unit)), None)
        rate = rate_of(members[0][1])
        kind = rate or by_word or by_unit
        ordered = sorted(members, key=lambda member: member[0])
        numbers = tuple(number - min(first, 1) + 1 for number, _ in ordered)
        numbers = numbers if len(set(numbers)) == len(numbers) else ()  # no numbers: in the order of the log
        sources = tuple(name for _, name in ordered)
        why = (
            "by name"
            if rate or by_word
            else f"unit {unit} in its name"
            if kind != "unknown"
            else "moves with the robot"
        )
        family = Family(kind, bool(COMMANDED & set(words)), sources, unit, why, numbers)
        bare = stem if not unit else _UNIT_AT_END.sub("", stem)
        alike = found.setdefault(bare, [])
        other = next((k for k, one in enumerate(alike) if _are_one(one, family)), None)
        if other is None:
            alike.append(family)
        else:
            alike[other] = _joined(alike[other], family)
    return [family for alike in found.values() for family in alike]


def _are_one(one: Family, other: Family) -> bool:
    """Return whether two families are one whose slides have another unit than its hinges: "A2 [deg]", "A3 [mm]"."""
    factors = [FOREIGN[f.unit].factor if f.unit in FOREIGN else 1.0 for f in (one, other)]
    return (
        (one.kind, one.is_command) == (other.kind, other.is_command)
        and not set(one.numbers) & set(other.numbers)
        and (one.kind not in ("torque", "current") or factors[0] == factors[1])
    )


def _joined(one: Family, other: Family) -> Family:
    pairs = [*zip(one.numbers, one.sources, strict=True), *zip(other.numbers, other.sources, strict=True)]
    numbers, sources = zip(*sorted(pairs), strict=True)
    return replace(one, numbers=numbers, sources=sources)


def _lettered(
    stem: str, members: Sequence[tuple[int, str]], others: Sequence[str], numbers: range
) -> list[tuple[int, str]]:
    """Return the one column that a family lacks and its number: of "A1_I", "A2_I", "Z_I", "A4_I" the third."""
    missing = set(numbers) - {number for number, _ in members}
    rest = stem.partition("*")[2]
    alike = [name for name in others if name.endswith(rest)] if words_of(rest) else []
    return [(missing.pop(), alike[0])] if len(missing) == len(alike) == 1 < len(members) else []


def _fits(kind: Kind, unit: str, by_unit: Kind) -> bool:
    """Return whether a quantity may have a unit: an angle is no torque, and what is not measured in angles is none."""
    if kind == "position":
        return by_unit in ("position", "unknown")
    return kind not in ("torque", "current") or unit not in ANGLES


def _stem(name: str, joints: Sequence[str]) -> tuple[str, int | None]:
    """Return a name without what tells the drive, and the drive's number; None if nothing tells it."""
    for number, joint in enumerate(joints):
        if joint and (found := re.search(rf"(?<![A-Za-z0-9]){re.escape(joint)}(?![A-Za-z0-9])", name, re.IGNORECASE)):
            return f"{name[: found.start()]}*{name[found.end() :]}", number
    rate = _rate_at_end(name)  # whose exponent is no number of a drive
    if digits := list(_INDEX.finditer(name, 0, rate.start() if rate else len(name))) or list(_INDEX.finditer(name)):
        last = digits[-1]
        return f"{name[: last.start()]}*{name[last.end() :]}", int(last[0])
    before, dot, _ = name.rpartition(".")
    return (f"{before}.*", 0) if dot and before in LISTS else (name, None)  # in the order of the log


def words_of(text: str) -> list[str]:
    """Return the words of a name: "actualQ_1" is actual, q."""
    spaced = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", text)
    return [word.lower() for word in re.findall(r"[A-Za-z]+", spaced)]
