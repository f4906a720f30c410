"""A comparison as one self-contained HTML page: what changed, and every component over the recordings."""

from dataclasses import dataclass

import numpy as np

from bench.compare.comparison import Comparison, Component
from bench.record.campaign import Array
from bench.report.comparison.names import (
    NOT_THE_MACHINES,
    along_words,
    change_name,
    course_words,
    explanation_name,
    interval_words,
    limit_words,
    names_told,
    size_text,
    title_of,
    unit_words,
)
from bench.report.comparison.words import (
    NONLINEAR,
    basis_sentence,
    diagnosed_sentence,
    drift_sentences,
    headline,
    left_before_sentence,
    unfinished_sentence,
)
from bench.report.diagnosis.names import capital, channel_name
from bench.report.diagnosis.numbers import percent
from bench.report.html import Filters, render

TEMPLATE = "comparison/page.html.j2"
FILTERS: Filters = {
    "capital": capital,
    "percent": percent,
    "channel": channel_name,
    "along_words": along_words,
    "change_name": change_name,
    "explanation_name": explanation_name,
    "size_text": size_text,
}
WIDTH, HEIGHT, EDGE = 160.0, 34.0, 4.0  # [px], of the small charts


@dataclass(frozen=True)
class Dot:
    """One recording in a small chart, in px."""

    x: float
    y: float
    low: float
    high: float


@dataclass(frozen=True)
class Line:
    """One component on the page.

    Attributes:
        name, parameter: What it is.
        last: Its change in the last recording, with unit and interval.
        limit: Smallest change that would have been found.
        zero: Height of no change in the chart [px].
        dots: One for each recording, before first.
        is_named: Whether it is part of an explanation.
        mark: What an explanation says of it, "" where none has it.
        is_seen: Whether a plausible size would have been found.
    """

    name: str
    parameter: str
    last: str
    limit: str
    zero: float
    dots: tuple[Dot, ...]
    is_named: bool
    mark: str
    is_seen: bool


def page_of(comparison: Comparison, robot: str, command: str) -> str:
    """Return the page.

    Args:
        comparison: What to show.
        robot: Title of the robot.
        command: That made it.
    """
    lines = lines_of(comparison)
    return render(
        TEMPLATE,
        FILTERS,
        c=comparison,
        robot=robot,
        command=command,
        headline=headline(comparison),
        unfinished=unfinished_sentence(comparison),
        left_before=left_before_sentence(comparison),
        diagnosed=diagnosed_sentence(comparison),
        basis=basis_sentence(comparison),
        findings=[names_told(finding, comparison) for finding in comparison.findings],
        drifts=tuple(drift_sentences(comparison)),
        course=lambda change: course_words(change, comparison),
        nonlinear=NONLINEAR,
        not_the_machines=NOT_THE_MACHINES,
        seen=[line for line in lines if line.is_seen or line.is_named],
        unseen=[line for line in lines if not line.is_seen and not line.is_named],
        width=WIDTH,
        height=HEIGHT,
    )


def lines_of(comparison: Comparison) -> list[Line]:
    """Return one line for every component."""
    n_before = sum(not one.is_after for one in comparison.recordings)
    days = np.array([one.days for one in comparison.recordings])
    time = days if np.all(np.isfinite(days)) and days[-1] > days[0] else np.arange(len(days), dtype=np.float64)
    return [_line(one, time[n_before - 1 :], _mark(one, comparison)) for one in comparison.components]


def _mark(component: Component, comparison: Comparison) -> str:
    """Return that a component changed, that it is one of several of which one changed, or ""."""
    if not component.is_named:
        return ""
    own = component.effect, component.place
    explained = [{(change.effect, change.place) for change in one.changes} for one in comparison.explanations]
    return "changed" if all(own in keys for keys in explained) else "one of these changed"


def _line(component: Component, time: Array, mark: str) -> Line:
    low = min(0.0, *(one.low for one in component.values))
    high = max(0.0, *(one.high for one in component.values))
    span = (high - low) or 1.0
    first, last = float(time[0]), float(time[-1])

    def height(value: float) -> float:
        return EDGE + (HEIGHT - 2 * EDGE) * (high - value) / span

    def across(moment: float) -> float:
        return EDGE + (WIDTH - 2 * EDGE) * (moment - first) / ((last - first) or 1.0)

    dots = [Dot(across(first), height(0.0), height(0.0), height(0.0))]
    for moment, one in zip(time[1:], component.values, strict=True):
        dots.append(Dot(across(float(moment)), height(one.value), height(one.low), height(one.high)))
    value, lowest, highest = interval_words(component.values[-1], component.unit)
    return Line(
        name=title_of(component.title, component.place),
        parameter=component.parameter.replace("_", " "),
        last=f"{value} {unit_words(component.unit)} ({lowest} to {highest})",
        limit=limit_words(component),
        zero=height(0.0),
        dots=tuple(dots),
        is_named=component.is_named,
        mark=mark,
        is_seen=component.limit < component.plausible,
    )
