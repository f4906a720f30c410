"""Figs. 4 to 6: what leaving K_C out costs, over the angles of two joints, and the paper's numbers beside ours."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bench.identify.complementary_map import ComplementaryMap, Grid
from bench.identify.complementary_prediction import PredictionError
from bench.report.figures.style import new_figure
from bench.report.paper.published import PublishedRow
from bench.robot.bodies import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import QuadMesh
    from matplotlib.figure import Figure

GOOD = 0.05  # relative error below which the paper calls K_C negligible
PALEST = 0.2  # of the colour map; paler colours look like none
ROW = 3.6  # [inch], height of a row of panels
ERROR_LEVELS = (0, 0.2, 0.5, 1, 2, 5, 10)  # [%]; above 10 % Fig. 4 shows no colour
POSITION_LEVELS = (0, 0.5, 1, 2, 3, 5, 7)  # [%], up to the paper's bound
ORIENTATION_LEVELS = (0, 0.25, 0.5, 1, 2, 3)  # [1e-4 rad], up to the paper's bound


def prediction_bounds(prediction: PredictionError) -> tuple[PublishedRow, ...]:
    """Return our largest prediction errors beside the paper's bounds: below 7 % and below 0.0003 rad."""
    return (
        PublishedRow("largest eps_P, Eq. (45)", "", float(np.nanmax(prediction.position)), 0.07, "less"),
        PublishedRow("largest eps_O, Eq. (46)", "rad", float(np.nanmax(prediction.orientation)), 3e-4, "less"),
    )


def figure_4(result: ComplementaryMap, joint_names: Sequence[str]) -> "Figure":
    """Return the relative error of each identified stiffness; no colour above 10 %."""
    title = r"Relative error of the stiffness identified without $K_C$; each band follows $\Gamma_j = 0$"
    columns = min(3, len(joint_names))
    figure, axes = new_figure(title, -(-len(joint_names) // columns), columns, ROW * -(-len(joint_names) // columns))
    panels = [panel for row in axes for panel in row]
    share = 100 * result.fraction(GOOD)
    for j, (panel, name) in enumerate(zip(panels, joint_names, strict=False)):
        mesh = _map(panel, result.grid, 100 * result.relative_error[..., j], ERROR_LEVELS, joint_names)
        panel.set_title(f"{name}: {share[j]:.1f} % below {100 * GOOD:.0f} %")
    for panel in panels[len(joint_names) :]:
        panel.set_visible(False)
    figure.colorbar(mesh, ax=panels, label="relative error [%], white above the scale", shrink=0.8)
    return figure


def figure_5(prediction: PredictionError, grid: Grid, joint_names: Sequence[str]) -> "Figure":
    """Return the largest error of a predicted deflection by the pose of identification; no colour outside the zone."""
    title = "Largest error of a predicted deflection, by the pose where the stiffness was identified"
    figure, ((left, right),) = new_figure(title, 1, 2, 1.5 * ROW)
    position, orientation = prediction_bounds(prediction)
    mesh = _map(left, grid, 100 * prediction.position, POSITION_LEVELS, joint_names)
    left.set_title(rf"position, $\epsilon_P$: up to {100 * position.ours:.1f} %")
    figure.colorbar(mesh, ax=left, label="[%]; ends at the paper's bound", shrink=0.8)
    mesh = _map(right, grid, 1e4 * prediction.orientation, ORIENTATION_LEVELS, joint_names)
    right.set_title(rf"orientation, $\epsilon_O$: up to {1e4 * orientation.ours:.2f}$\cdot 10^{{-4}}$ rad")
    figure.colorbar(mesh, ax=right, label=r"[$10^{-4}$ rad]; ends at the paper's bound", shrink=0.8)
    return figure


def figure_6(result: ComplementaryMap, joint_names: Sequence[str]) -> "Figure":
    """Return the optimal zone: every joint's stiffness is identified to better than 5 % without K_C."""
    zone = result.zone(GOOD)
    title = f"Optimal zone (coloured): every stiffness within {100 * GOOD:.0f} % without $K_C$"
    figure, ((panel,),) = new_figure(title, 1, 1, 2 * ROW)
    _map(panel, result.grid, np.where(zone, 1.5, np.nan), (0, 1, 2, 3), joint_names)
    panel.set_title(f"{100 * zone.mean():.1f} % of the range")
    return figure


def figure_6_for_others(grid: Grid, zones: Sequence[NDArray[np.bool_]], joint_names: Sequence[str]) -> "Figure":
    """Return in how many of several zones each pose is.

    Args:
        grid: The poses.
        zones: One for each stiffness, shape (a, b) each.
        joint_names: Length n.
    """
    count = np.sum(zones, axis=0)
    figure, ((panel,),) = new_figure("Optimal zone for other values of the stiffness", 1, 1, 2 * ROW)
    levels = np.arange(len(zones) + 2) - 0.5
    mesh = _map(panel, grid, np.where(count > 0, count, np.nan), levels.tolist(), joint_names)
    panel.set_title(f"in all {len(zones)}: {100 * np.mean(count == len(zones)):.1f} % of the range; white: in none")
    figure.colorbar(
        mesh,
        ax=panel,
        label=f"in the zone for so many of {len(zones)} stiffnesses",
        shrink=0.8,
        ticks=range(1, len(zones) + 1, 2),
    )
    return figure


def _map(panel: "Axes", grid: Grid, values: Array, levels: Sequence[float], joint_names: Sequence[str]) -> "QuadMesh":
    """Colour a panel by the level that each value lies in; above the last level, and where nan, there is no colour."""
    from matplotlib import colormaps
    from matplotlib.colors import BoundaryNorm, ListedColormap

    shown = np.ma.masked_where(~(values < levels[-1]), values)
    across, up = np.rad2deg(grid.first), np.rad2deg(grid.second)
    colours = ListedColormap(colormaps["YlGnBu"](np.linspace(PALEST, 1, len(levels) - 1)))
    panel.grid(visible=False)
    panel.set_xlabel(f"{joint_names[grid.joints[0]]} [deg]")
    panel.set_ylabel(f"{joint_names[grid.joints[1]]} [deg]")
    norm = BoundaryNorm(levels, len(levels) - 1)
    return panel.pcolormesh(across, up, shown.T, cmap=colours, norm=norm, shading="nearest", rasterized=True)
