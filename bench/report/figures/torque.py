"""What the motor pays against what the load asks for: the change of the motor torque over J_f^T W, per joint."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from bench.errors import InputError
from bench.report.figures.style import COLOURS, INK, MARKERS, legend_below, new_figure
from bench.robot.bodies import Array

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLUMNS = 3
PANEL_HEIGHT = 3.4  # [inch]


@dataclass(frozen=True)
class TorquePoints:
    """States under load, each against its unloaded state.

    Attributes:
        label: What these states have in common, such as "load growing".
        load: Shape (m, n) [Nm], torque of the load about each joint, J_f^T W of Eq. (25).
        motor: Shape (m, n) [Nm], what the motor gives more than unloaded to hold it; xi dI, Eq. (40), signed so that
            without friction it equals `load`.
    """

    label: str
    load: Array
    motor: Array


def torque_figure(groups: Sequence[TorquePoints], joint_names: Sequence[str]) -> "Figure":
    """Return the figure: one panel per joint, with the line that motors without friction would follow.

    Args:
        groups: Points of the same group share colour and marker, and get a slope of their own.
        joint_names: Length n.

    Raises:
        InputError: There is no group, or one whose shapes do not fit.
    """
    n = len(joint_names)
    odd = [group.label for group in groups if group.load.shape != group.motor.shape or group.load.shape[1:] != (n,)]
    if not groups or odd:
        raise InputError(
            f"torque figure: load and motor must both be (m, {n}): {', '.join(odd) or 'no group was given'}."
        )
    rows, columns = -(-n // COLUMNS), min(COLUMNS, n)
    figure, axes = new_figure(
        "Motor torque against the torque of the load", rows=rows, columns=columns, height=0.9 + PANEL_HEIGHT * rows
    )
    panels = [panel for row in axes for panel in row]
    for joint, (panel, name) in enumerate(zip(panels, joint_names, strict=False)):
        panel.axline((0, 0), slope=1, color=INK, linewidth=1.0, zorder=1.5, label="no friction" if joint == 0 else None)
        slopes = []
        for k, group in enumerate(groups):
            colour, marker = COLOURS[k % len(COLOURS)], MARKERS[k % len(MARKERS)]
            x, y = group.load[:, joint], group.motor[:, joint]
            panel.plot(x, y, marker, color=colour, markerfacecolor="none", label=group.label if joint == 0 else None)
            slopes.append((slope_through_origin(x, y), colour))
        panel.set_title(name, loc="left")
        panel.margins(0.08)
        panel.locator_params(nbins=6)
        for k, (slope, colour) in enumerate(slopes):
            panel.text(0.03, 0.95 - 0.085 * k, f"slope {slope:.3f}", color=colour, transform=panel.transAxes, va="top")
        panel.set_xlabel("torque of the load, $J_f^T W$ [Nm]")
        if joint % columns == 0:
            panel.set_ylabel(r"motor, $\xi\,\Delta I$ [Nm]")
    for panel in panels[n:]:
        panel.set_axis_off()
    legend_below(figure)
    return figure


def slope_through_origin(x: Array, y: Array) -> float:
    """Return the slope of the best line through the origin, both shape (m,); nan where x is zero throughout."""
    known = np.isfinite(x) & np.isfinite(y)
    weight = float(x[known] @ x[known])
    return float(x[known] @ y[known]) / weight if weight > 0 else np.nan
