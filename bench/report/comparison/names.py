"""How changes and their sizes are called on the page and on the terminal."""

from collections.abc import Mapping, Sequence

import numpy as np

from bench.compare.comparison import (
    Change,
    ChangedSize,
    Comparison,
    Component,
    Interval,
    PossibleName,
    UnlistedChange,
)
from bench.effects.effect import Level
from bench.report.diagnosis.names import ACTS, channel_name, places_text
from bench.report.diagnosis.numbers import shown, unit_name

NOT_THE_MACHINES: Mapping[Level, str] = {  # what a change of another level than the machine's is
    "recording": "an error of the recording, not of the machine",
    "run": "not there in the whole recording: something that happened in it, or an error of it",
}


def title_of(effect_title: str, place: str) -> str:
    """Return the title of a cause with its place in words."""
    return effect_title.replace(place, channel_name(place).replace("_", " "))


def together(names: Sequence[PossibleName]) -> list[str]:
    """Return the names of causes that act together; the same one at several places is named once."""
    places: dict[str, list[PossibleName]] = {}
    for name in names:
        places.setdefault(name.title.removesuffix(f" ({name.place})"), []).append(name)
    return [
        f"{title} ({places_text([one.place for one in same])})"
        if len(same) > 1
        else title_of(same[0].title, same[0].place)
        for title, same in places.items()
    ]


def change_name(change: Change) -> str:
    """Return what changed and where."""
    return title_of(change.title, change.place)


def size_text(size: ChangedSize) -> str:
    """Return by how much a parameter changed: "change +1.9 % (90 % interval 1.7 to 2.1)"."""
    words = f"{size.name.replace('_', ' ')} {interval_text(size.change, size.unit)}"
    return f"{words}, {interval_text(size.per_week, size.unit)} a week" if size.per_week else words


def interval_text(interval: Interval, unit: str) -> str:
    """Return a change with its sign, its unit and its 90 % interval."""
    value, low, high = interval_words(interval, unit)
    return f"{value} {unit_words(unit)} (90 % interval {low} to {high})".replace("  ", " ")


def interval_words(interval: Interval, unit: str) -> tuple[str, str, str]:
    """Return value, low and high as they are shown; relative sizes in percent."""
    factor = 1.0 if unit else 100.0
    numbers = tuple(factor * x for x in (interval.value, interval.low, interval.high))
    value, low, high = shown(numbers, unit, (numbers[2] - numbers[1]) / 2)
    return (value if value.startswith(("-", "0")) and not interval.value > 0 else f"+{value.lstrip('+')}"), low, high


def drift_text(interval: Interval, unit: str) -> str:
    """Return by how much something drifted, with its interval in brackets: "-19.8 % (-21.0 to -18.6)"."""
    value, low, high = interval_words(interval, unit)
    return f"{value} {unit_words(unit)} ({low} to {high})"


def expected_text(sigma: float, unit: str) -> str:
    """Return a standard deviation with two digits and its unit."""
    size = sigma if unit else 100 * sigma
    return f"{shown((size,), unit, size)[0]} {unit_words(unit)}"


def limit_words(component: Component) -> str:
    """Return the smallest change that would have been found, with its unit; of the best shape to the worst."""
    factor = 1.0 if component.unit else 100.0
    best, worst = shown((factor * component.limit, factor * component.worst), component.unit, factor * component.limit)
    unit = unit_words(component.unit)
    if best == worst or not np.isfinite(component.worst):
        return f"{best} {unit}".strip()
    if component.worst > component.plausible:
        return f"{best} {unit}, in some shapes at no plausible size"
    return f"{best} to {worst} {unit}, by its shape"


def unit_words(unit: str) -> str:
    """Return the unit in which a size is shown."""
    return unit_name(unit) if unit else "%"


def course_words(change: Change | UnlistedChange, comparison: Comparison) -> str:
    """Return when a change came; "" where there is one recording after it only."""
    if sum(one.is_after for one in comparison.recordings) == 1:
        return ""
    return {
        "step": f"since {change.since}",
        "once": f"in {change.since} only",
        "trend": f"growing from {change.since} on",
    }[change.course]


def unlisted_words(unlisted: UnlistedChange) -> str:
    """Return where an unlisted change acts, and on what it depends."""
    acts = ACTS.get(unlisted.kind, unlisted.kind + " at {place}").format(place=unlisted.place)
    return f"{acts} that depends on {unlisted.depends_on}"
