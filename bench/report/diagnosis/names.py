"""How channels, causes and values are called on the page and on the terminal."""

from collections.abc import Sequence
from functools import cache

import numpy as np

from bench.diagnose.verdict import (
    AmbiguityGroup,
    DetectionLimit,
    Explanation,
    NamedCause,
    ParameterValue,
    PredictedError,
    Unlisted,
)
from bench.effects.catalogue import catalogue
from bench.effects.effect import IN_RECORDING
from bench.report.diagnosis.numbers import percent, shown, unit_name

KINDS = {
    "current": "motor current",
    "tau_motor": "motor torque",
    "reflector": "reflector",
    "q_link": "link angle",
    "force": "force",
    "moment": "moment",
    "gas_pressure": "gas pressure",
    "gas_temperature": "gas temperature",
    "known_earlier": "earlier diagnosis",
    "known_payload": "payload as known",
    "known_stiffness": "stiffness as known, joint",
    "known_gas_pressure": "gas pressure as known",
    "known_gas_temperature": "gas temperature as known",
}
BEFORE = ", as found before"  # after the name of a finding of an earlier diagnosis, which is a figure of the next one
SINCE = " from run "  # before the run with which something sets in
ACTS = {
    "link torque": "a torque on the link of {place}",
    "motor torque": "a torque on the motor of {place}",
    "gear angle": "an error of the gear of {place}",
    "compliance": "a compliance of the gear of {place}",
    "reading": "an error of the readings of {place}",
}
UNTOLD = "these data do not tell it"  # of a parameter of which its prior says more than they do
PART_OF_UNLISTED = "a part of what is unlisted, which could hold it as well"
SLIDES = {"torque": "force", "angle": "position"}  # what a turning drive has -> what a sliding one has


def channel_name(column: str) -> str:
    """Return what people call a column: "current_2_a" is motor current 2, "tau_motor_1_n" motor force 1."""
    for kind, words in KINDS.items():
        if column.startswith(f"{kind}_"):
            *parts, unit = column.removeprefix(f"{kind}_").split("_")
            slides = (kind, unit) in (("tau_motor", "n"), ("q_link", "m"))
            return " ".join([of_slide(words) if slides else words, *parts])
    return column


def of_slide(words: str) -> str:
    """Return words on a turning drive as they are said of a sliding one."""
    for turning, sliding in SLIDES.items():
        words = words.replace(turning, sliding)
    return words


def unlisted_name(unlisted: Unlisted) -> str:
    """Return where an unlisted cause acts, and on what it depends."""
    acts = ACTS.get(unlisted.kind, unlisted.kind + " at {place}")
    words = f"{acts} that depends on {unlisted.depends_on}"
    slides = unlisted.kind != "reading" and any(p.unit in ("N", "m") for p in unlisted.parameters)
    return (of_slide(words) if slides else words).format(place=unlisted.place)


def effect_name(effect: str) -> str:
    """Return what people call an effect: its title in the catalogue; of one of their own, its name in words."""
    return _titles().get(effect, effect.replace("_", " "))


def motion_of(effect: str) -> str:
    """Return which motion shows an effect where a campaign does not; "" where that depends, or of one of their own."""
    known = catalogue()
    return known[effect].motion if effect in known else ""


@cache
def _titles() -> dict[str, str]:
    return {name: effect.title for name, effect in catalogue().items()}


def cause_name(cause: NamedCause) -> str:
    """Return the title of a cause with its place, but for the robot as a whole."""
    place = place_name(cause.place)
    return f"{cause.title} ({place})" if place else cause.title


def place_name(place: str) -> str:
    """Return what people call a place: "motor current 2 in recording may"; "" for the robot as a whole."""
    where, within, recording = place.partition(IN_RECORDING)
    where, since, run = where.partition(SINCE)
    name = "" if where == "robot" else where
    if not where.startswith("run "):
        name = channel_name(name.removeprefix("robot ")).replace("_", " ")
    return f"{name}{since}{run}{within}{recording}".strip()


def title_of(figure: str) -> tuple[str, str]:
    """Return what a fitted figure is, and where: "viscous friction of J2" is viscous friction, J2."""
    title, _, place = figure.rpartition(" of ")
    found_before = figure.endswith(BEFORE)
    return (title, place) if title and not found_before else (figure.removesuffix(BEFORE), "")


def remark_text(cause: NamedCause, group: AmbiguityGroup) -> str:
    """Return what is to be said beside a name of a finding: that it is small, that only some runs show it, or ""."""
    hangs = cause is group.names[0].cause and not group.is_confirmed
    return ", ".join(filter(None, (small_text(cause), "not confirmed" if hangs else "")))


def small_text(cause: NamedCause) -> str:
    """Return that a finding is small, "" for one that is not."""
    return f"small: {percent(cause.share)} of the largest plausible size" if cause.is_small else ""


def explanation_name(explanation: Explanation) -> str:
    """Return the causes of an explanation in a row."""
    return " with ".join(cause_names(explanation.causes))


def name_beside(explanation: Explanation, best: Explanation) -> str:
    """Return an explanation by what it has otherwise than the best, where they share two causes or more."""
    mine, its = ({(c.effect, c.place): c for c in e.causes} for e in (explanation, best))
    if len(mine.keys() & its.keys()) < 2 or mine.keys() == its.keys():
        return explanation_name(explanation)
    more = cause_names([cause for key, cause in mine.items() if key not in its])
    less = cause_names([cause for key, cause in its.items() if key not in mine])
    if not more:
        return f"the same without {listed(less, 'and')}"
    return f"the same with {listed(more, 'and')}" + (f" in place of {listed(less, 'and')}" if less else " too")


def cause_names(causes: Sequence[NamedCause]) -> list[str]:
    """Return the names of causes that act together; the same one in several joints is named once."""
    joints: dict[str, list[str]] = {}
    for cause in causes:
        if cause.place.startswith("joint "):
            joints.setdefault(cause.title, []).append(cause.place.removeprefix("joint "))
    found: dict[str, None] = {}
    for cause in causes:
        numbers = sorted(joints.get(cause.title, []), key=int)
        several = len(numbers) > 1 and cause.place.startswith("joint ")
        found[f"{cause.title} (joints {listed(numbers, 'and')})" if several else cause_name(cause)] = None
    return list(found)


def listed(names: Sequence[str], last: str) -> str:
    """Return names in a row, the last after a word: "a, b and c"."""
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} {last} {names[-1]}"


def in_short(names: Sequence[str], count: int = 1) -> str:
    """Return the first names, and how many others there are: "a or 2 others"."""
    others = len(names) - count
    return listed(names, "or") if others < 1 else f"{', '.join(names[:count])} or {others} other{'s' * (others > 1)}"


def fitting(names: Sequence[str], last: str, room: int) -> str:
    """Return names in a row, as many as there is room for and "others"; "" where there is room for none."""
    for count in range(len(names), 0, -1):
        some = listed([*names[:count], *["others"] * (count < len(names))], last)
        if len(some) <= room:
            return some
    return ""


def places_text(places: Sequence[str]) -> str:
    """Return places in words: "joints 1, 3, upper arm"; "" for the robot as a whole."""
    joints = sorted((p.removeprefix("joint ") for p in places if p.startswith("joint ")), key=int)
    within = [place.partition(IN_RECORDING)[2] for place in places if place.startswith(f"robot{IN_RECORDING}")]
    others = [name for p in places if not p.startswith(("joint ", f"robot{IN_RECORDING}")) and (name := place_name(p))]
    others += [f"{IN_RECORDING.strip()}{'s' * (len(within) > 1)} {listed(within, 'and')}"] if within else []
    return ", ".join(([f"joint{'s' * (len(joints) > 1)} {', '.join(joints)}"] if joints else []) + others)


def effect_at(effect: str, places: Sequence[str]) -> str:
    """Return what acts, and where: "Coulomb level (joints 1, 3)", "gain of the force sensor (in recording may)"."""
    where = places_text(places)
    return f"{effect_name(effect)} ({where})" if where else effect_name(effect)


def capital(words: str) -> str:
    """Return words with a capital letter in front."""
    return words[:1].upper() + words[1:]


def interval_of(parameter: ParameterValue) -> tuple[str, str, str]:
    """Return value, low and high of a parameter as they are shown."""
    half = (parameter.high - parameter.low) / 2
    value, low, high = shown((parameter.value, parameter.low, parameter.high), parameter.unit, half)
    return value, low, high


def parameter_text(parameter: ParameterValue) -> str:
    """Return a parameter in a line: "offset -38 K (-44 to -33)", without a value where the data tell none."""
    name = parameter.name.replace("_", " ")
    if not parameter.is_told:
        return f"{name}: {UNTOLD}"
    value, low, high = interval_of(parameter)
    return " ".join(filter(None, (name, value, unit_name(parameter.unit), f"({low} to {high})")))


def meaning_of(parameter: ParameterValue) -> str:
    """Return what a parameter is, in the words of the catalogue."""
    return without_range(parameter.words)


def without_range(words: str) -> str:
    """Return words of the catalogue without the range that they state for some other drive ("of 10 kNm")."""
    return "; ".join(part for part in words.split("; ") if not part.startswith("range "))


def limit_of(limit: DetectionLimit) -> str:
    """Return the smallest size that would have been found, without its unit: of the best shape to the worst."""
    best, worst = shown((limit.limit, limit.worst), limit.unit, limit.limit)
    return worst if best == worst else f"{best} to {worst}, by its shape"


def limit_text(limit: DetectionLimit) -> str:
    """Return it with its parameter and unit: "offset 0.012 deg", "sin 0.02 to 0.05 Nm, by its shape"."""
    size, comma, by_shape = limit_of(limit).partition(",")
    return f"{limit.parameter.replace('_', ' ')} {size} {unit_name(limit.unit)}".rstrip() + comma + by_shape


def error_of(error: PredictedError) -> tuple[str, str, str]:
    """Return the expected error and its interval as they are shown, in the unit that `unit_name` gives."""
    rms, low, high = shown((error.rms, error.low, error.high), error.unit, error.rms / 10)  # three digits
    return rms, low, high


def error_text(error: PredictedError) -> str:
    """Return an error in a line: "link angle 1: 0.0082 deg, and 0.0041 to 0.0170 deg in the next recording"."""
    rms, low, high = error_of(error)
    unit = unit_name(error.unit)
    interval = f", and {low} to {high} {unit} in the next recording" if np.isfinite(error.low) else ""
    return f"{channel_name(error.channel)}: {rms} {unit}{interval}"
