"""How changes and their sizes are called on the page and on the terminal."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bench.compare.comparison import (
    Change,
    ChangedFinding,
    ChangedSize,
    Comparison,
    Component,
    Explanation,
    Interval,
    PossibleName,
    UnlistedChange,
)
from bench.effects.effect import Level
from bench.report.diagnosis.names import ACTS, channel_name, places_text
from bench.report.diagnosis.numbers import percent, shown, unit_name

NOT_THE_MACHINES: Mapping[Level, str] = {  # what a change of another level than the machine's is
    "recording": "an error of the recording, not of the machine",
    "run": "not there in the whole recording: something that happened in it, or an error of it",
}


def title_of(effect_title: str, place: str) -> str:
    """Return the title of a cause with its place in words."""
    return effect_title.replace(place, channel_name(place).replace("_", " "))


def names_together(names: Sequence[PossibleName | Change]) -> list[str]:
    """Return the names of causes that act together; the same one at several places is named once."""
    places: dict[str, list[PossibleName | Change]] = {}
    for name in names:
        places.setdefault(name.title.removesuffix(f" ({name.place})"), []).append(name)
    return [
        f"{title} ({places_text([one.place for one in same])})"
        if len(same) > 1
        else title_of(same[0].title, same[0].place)
        for title, same in places.items()
    ]


def explanation_name(explanation: Explanation) -> str:
    """Return what changed together; the same at several places is named once."""
    return " with ".join(names_together(explanation.changes))


@dataclass(frozen=True)
class NameTold:
    """One of the causes that may be behind a change, as it is shown.

    Attributes:
        name: With its place.
        amount: By how much, "" where no explanation has it.
        when: Since when; "" with one recording after only.
        probability: That it changed, in words.
        remark: What to look at, or what it is if no change of the machine; "" for nothing.
    """

    name: str
    amount: str
    when: str
    probability: str
    remark: str

    def __str__(self) -> str:
        whole = ", ".join(part for part in (self.name, self.amount, self.when) if part)
        return f"{whole} ({self.probability})"


def names_told(finding: ChangedFinding, comparison: Comparison) -> list[NameTold]:
    """Return the causes that may be behind a change, with sizes as of the likeliest explanation that has them."""
    told = []
    for name in finding.names:
        key, title = (name.effect, name.place), title_of(name.title, name.place)
        changes = (change for explanation in comparison.explanations for change in explanation.changes)
        change = next((one for one in changes if (one.effect, one.place) == key), None)
        amount, when, remark = "", "", ""
        if change:
            amount, when = amount_text(change), course_words(change, comparison)
            remarks = f"check: {change.advice}" if change.advice else "", NOT_THE_MACHINES.get(change.level, "")
            remark = "; ".join(part for part in remarks if part)
        told.append(NameTold(title, amount, when, percent(name.probability), remark))
    return told


def change_name(change: Change) -> str:
    """Return what changed and where."""
    return title_of(change.title, change.place)


def size_name(size: ChangedSize) -> str:
    """Return the name of a size in words."""
    return size.name.replace("_", " ")


def size_text(size: ChangedSize) -> str:
    """Return by how much a parameter changed: "change +1.9 % (90 % interval 1.7 to 2.1)"."""
    words = f"{size_name(size)} {interval_text(size.change, size.unit)}"
    return f"{words}, {interval_text(size.per_week, size.unit)} a week" if size.per_week else words


def amount_text(change: Change) -> str:
    """Return by how much something changed, of several sizes each with its name."""
    texts = [size_text(size) for size in change.sizes]
    return "; ".join(texts) if len(texts) > 1 else texts[0].removeprefix(f"{size_name(change.sizes[0])} ")


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


def along_words(change: Change) -> str:
    """Return what else may have changed with a change; "" where nothing would."""
    return f"its interval allows for as large a change beside it of: {'; '.join(change.along)}" if change.along else ""


def unlisted_words(unlisted: UnlistedChange) -> str:
    """Return where an unlisted change acts, and on what it depends."""
    acts = ACTS.get(unlisted.kind, unlisted.kind + " at {place}").format(place=unlisted.place)
    return f"{acts} that depends on {unlisted.depends_on}"
