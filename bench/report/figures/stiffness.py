"""Joint stiffness by method: estimates with their intervals beside what is known, one panel per joint."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from bench.errors import InputError
from bench.identify.estimate import StiffnessEstimate
from bench.report.figures.style import COLOURS, GREY, INK, MARKERS, new_figure
from bench.robot.bodies import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

UNIT = 1e6  # [Nm/rad], of the axes
ROW_HEIGHT = 0.24  # [inch]
COLUMNS = 3
MARGIN = 0.07  # of the span of an axis, at either end
LONGEST_INTERVAL = 1.6  # of the largest value; longer intervals leave the panel and end in an arrow


@dataclass(frozen=True)
class StiffnessSource:
    """One set of data, its estimates and what is known about it.

    Attributes:
        title: Such as "real robot, Table 5".
        estimates: Method as the reader knows it -> estimate; all sources use the same names for the same method.
        references: What the estimates are held against, such as "paper, current" -> shape (n,) [Nm/rad].
        truth: Shape (n,) [Nm/rad]; None where nobody knows it.
    """

    title: str
    estimates: Mapping[str, StiffnessEstimate]
    references: Mapping[str, Array]
    truth: Array | None = None


def stiffness_figure(sources: Sequence[StiffnessSource]) -> "Figure":
    """Return the figure: per joint, the sources below each other, and in each its methods with their intervals.

    Args:
        sources: At least one; all over the same joints.

    Raises:
        InputError: There is no estimate, or the sources are of different robots.
    """
    robots = {estimate.joint_names for source in sources for estimate in source.estimates.values()}
    if len(robots) != 1:
        raise InputError(f"stiffness figure: needs estimates over one set of joints, and was given {len(robots)} sets.")
    joints = robots.pop()
    methods = dict.fromkeys(name for source in sources for name in source.estimates)
    style = {name: (COLOURS[i % len(COLOURS)], MARKERS[i % len(MARKERS)]) for i, name in enumerate(methods)}
    panel_rows, rows = -(-len(joints) // COLUMNS), _rows(sources)
    figure, axes = new_figure(
        "Joint stiffness by method, 95 % intervals",
        rows=panel_rows,
        columns=min(COLUMNS, len(joints)),
        height=0.6 + panel_rows * (0.85 + ROW_HEIGHT * len(rows)),
        sharey=True,
    )
    panels = [panel for line in axes for panel in line]
    for joint, panel in enumerate(panels[: len(joints)]):
        _draw_panel(panel, sources, joint, style)
        panel.set_title(joints[joint], loc="left")
        panel.set_xlabel("stiffness [10$^6$ Nm/rad]")
    for panel in panels[len(joints) :]:
        panel.set_axis_off()
    for line in axes:
        _label_rows(line[0], rows)
    return figure


def _rows(sources: Sequence[StiffnessSource]) -> list[tuple[str, bool]]:
    """Return the lines of text on the left, each with whether it is a heading."""
    rows = []
    for source in sources:
        rows += [(source.title, True), *((name, False) for name in (*source.estimates, *source.references))]
    return rows


def _label_rows(panel: "Axes", rows: Sequence[tuple[str, bool]]) -> None:
    panel.set_yticks(range(len(rows)), [label for label, _ in rows])
    panel.set_ylim(len(rows) - 0.4, -0.7)
    for text, (_, is_heading) in zip(panel.get_yticklabels(), rows, strict=True):
        text.set_fontweight("bold" if is_heading else "normal")


def _draw_panel(
    panel: "Axes", sources: Sequence[StiffnessSource], joint: int, style: Mapping[str, tuple[str, str]]
) -> None:
    low, high = _span(sources, joint)
    panel.set_xlim(low, high)
    panel.grid(visible=False, axis="y")
    panel.tick_params(axis="y", length=0)
    y = 0
    for source in sources:
        first = y
        if first:
            panel.axhline(first - 0.5, color=GREY, linewidth=0.6)
        for name, estimate in source.estimates.items():
            y += 1
            _draw_estimate(panel, y, estimate.stiffness[joint] / UNIT, estimate.interval()[joint] / UNIT, *style[name])
        for value in source.references.values():
            y += 1
            panel.plot(value[joint] / UNIT, y, "D", color=GREY, markerfacecolor="white", markersize=6)
        if source.truth is not None:
            panel.vlines(source.truth[joint] / UNIT, first + 0.4, y + 0.45, color=INK, linewidth=1.4, zorder=1.5)
            panel.text(
                source.truth[joint] / UNIT, first + 0.35, "truth", ha="center", va="bottom", color=INK, fontsize="small"
            )
        y += 1


def _draw_estimate(panel: "Axes", y: int, value: float, interval: Array, colour: str, marker: str) -> None:
    if np.isnan(value):
        panel.text(0.02, y, "these data cannot tell", transform=panel.get_yaxis_transform(), va="center", color=GREY)
        return
    right_end = panel.get_xlim()[1]
    panel.hlines(y, interval[0], min(interval[1], right_end), color=colour, linewidth=2.2)
    panel.plot(value, y, marker, color=colour, markersize=6.5)
    if interval[1] > right_end:
        panel.plot(right_end, y, ">", color=colour, markersize=6, clip_on=False)


def _span(sources: Sequence[StiffnessSource], joint: int) -> tuple[float, float]:
    """Return the limits of the axis [10^6 Nm/rad]: all values, and intervals as far as they are not endless."""
    estimates = [estimate for source in sources for estimate in source.estimates.values()]
    known = [value for source in sources for value in (*source.references.values(), source.truth) if value is not None]
    values = np.array([estimate.stiffness[joint] for estimate in estimates] + [value[joint] for value in known]) / UNIT
    ends = np.stack([estimate.interval()[joint] for estimate in estimates]) / UNIT
    low = np.nanmin([*values, *ends[:, 0]])
    high = np.nanmax([*values, *np.minimum(ends[:, 1], LONGEST_INTERVAL * np.nanmax(values))])
    margin = MARGIN * (high - low)
    return float(low - margin), float(high + margin)
