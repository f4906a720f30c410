"""Deflection against load: up and down, measured and predicted, one panel per pose."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from bench.errors import InputError
from bench.report.figures.style import COLOURS, GREY, INK, MARKERS, legend_below, new_figure
from bench.robot.bodies import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLUMNS = 3
BLOCK_HEIGHT = 4.1  # [inch], of one row of poses


@dataclass(frozen=True)
class LoadCurve:
    """One series of loads at one pose, in the order in which they were put on and taken off.

    Attributes:
        pose: Title of its panel, such as "pose 1"; curves of the same pose share a panel.
        approach: What tells it from the others in the panel, such as "from below".
        force: Shape (m,) [N].
        measured: Shape (m,) [m], deflection in the direction of the load.
        predicted: Shape (m,) [m], the same by the model.
    """

    pose: str
    approach: str
    force: Array
    measured: Array
    predicted: Array


def deflection_figure(curves: Sequence[LoadCurve]) -> "Figure":
    """Return the figure: per pose the deflection, and below it what the model leaves over; friction is a loop there.

    Raises:
        InputError: There is no curve, or one whose arrays differ in length.
    """
    uneven = [c for c in curves if not len(c.force) == len(c.measured) == len(c.predicted)]
    if not curves or uneven:
        names = ", ".join(f"{curve.pose} {curve.approach}" for curve in uneven) or "no series was given"
        raise InputError(f"deflection figure: needs force, measured and predicted of one length: {names}.")
    poses = list(dict.fromkeys(curve.pose for curve in curves))
    approaches = list(dict.fromkeys(curve.approach for curve in curves))
    blocks, columns = -(-len(poses) // COLUMNS), min(COLUMNS, len(poses))
    figure, axes = new_figure(
        "Deflection against load",
        rows=2 * blocks,
        columns=columns,
        height=0.9 + BLOCK_HEIGHT * blocks,
        sharex="col",
        height_ratios=[1.7, 1] * blocks,
    )
    for i, pose in enumerate(poses):
        row, column = divmod(i, columns)
        top, bottom = axes[2 * row][column], axes[2 * row + 1][column]
        for curve in (curve for curve in curves if curve.pose == pose):
            k = approaches.index(curve.approach)
            _draw(top, bottom, curve, COLOURS[k % len(COLOURS)], MARKERS[k % len(MARKERS)])
        top.set_title(pose, loc="left")
        top.tick_params(labelbottom=False)
        bottom.axhline(0.0, color=INK, linewidth=0.8, zorder=1.5)
        bottom.tick_params(labelbottom=True)
        bottom.set_xlabel("load [N]")
        if column == 0:
            top.set_ylabel("deflection [mm]")
            bottom.set_ylabel("measured less\npredicted [µm]")
    for i in range(len(poses), blocks * columns):
        row, column = divmod(i, columns)
        axes[2 * row][column].set_axis_off()
        axes[2 * row + 1][column].set_axis_off()
    legend_below(figure, _legend(approaches))
    return figure


def _draw(top: "Axes", bottom: "Axes", curve: LoadCurve, colour: str, marker: str) -> None:
    top.plot(curve.force, 1e3 * curve.predicted, "-", color=colour, linewidth=1.2)
    for panel, values in ((top, 1e3 * curve.measured), (bottom, 1e6 * (curve.measured - curve.predicted))):
        if panel is bottom:
            panel.plot(curve.force, values, "-", color=colour, linewidth=0.9, alpha=0.6)
        for falling in (False, True):
            chosen = is_falling(curve.force) == falling
            face = "white" if falling else colour
            panel.plot(
                curve.force[chosen], values[chosen], marker, color=colour, markerfacecolor=face, linestyle="none"
            )


def is_falling(force: Array) -> Any:
    """Return which readings came after a larger load, shape (m,) bool."""
    return np.concatenate([[False], np.diff(force) < 0])


def _legend(approaches: Sequence[str]) -> list[Any]:
    from matplotlib.lines import Line2D

    handles = [
        Line2D([], [], color=COLOURS[k % len(COLOURS)], marker=MARKERS[k % len(MARKERS)], label=approach)
        for k, approach in enumerate(approaches)
    ]
    return [
        *handles,
        Line2D([], [], color=GREY, marker="o", linestyle="none", label="measured, load growing"),
        Line2D(
            [], [], color=GREY, marker="o", markerfacecolor="white", linestyle="none", label="measured, load falling"
        ),
        Line2D([], [], color=GREY, label="predicted"),
    ]
