"""Figures of the method study: where each method is right, and what the ratio of two methods says about friction."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from bench.report.figures.style import COLOURS, GREY, INK, MARKERS, legend_below, new_figure
from bench.report.paper.methods.study import METHODS, ConditionResult
from bench.report.paper.methods.survival import SIDES, UnderProtocol
from bench.robot.bodies import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.image import AxesImage

BIAS_LEVELS = (0, 1, 2, 5, 10, 20, 50, 100)  # [%]
DARK = 4  # from this level on the background asks for white text
COLUMNS = 3


def trust_figure(results: Sequence[ConditionResult], protocol: str) -> "Figure":
    """Return one map per method over amount and side of friction: median over the joints of |bias| [%].

    Args:
        results: A full grid over `friction` and `link_share`.
        protocol: Of the experiment, in words.
    """
    amounts = sorted({result.condition.friction for result in results})
    shares = sorted({result.condition.link_share for result in results})
    at = {(result.condition.friction, result.condition.link_share): result for result in results}
    title = f"Error by method, side and amount of friction: {protocol}"
    figure, (panels,) = new_figure(title, 1, len(METHODS), 4.6)
    for panel, method in zip(panels, METHODS, strict=True):
        bias = np.array([[100 * np.nanmedian(np.abs(at[a, s].bias(method))) for s in shares] for a in amounts])
        image = _error_map(panel, bias)
        panel.set_title(f"{method} method")
        panel.set_xticks(range(len(shares)), [f"{100 * share:g}" for share in shares])
        panel.set_yticks(range(len(amounts)), [f"{amount:g}" for amount in amounts])
        panel.set_xlabel("share on the link side [%]")
    panels[0].set_ylabel("friction, relative to the robot's figures")
    figure.colorbar(image, ax=list(panels), label="median over the joints of |bias| [%]", shrink=0.9)
    return figure


def protocol_figure(found: Sequence[UnderProtocol]) -> "Figure":
    """Return one map per side of friction over protocol and analysis: median over the joints of |bias| [%]."""
    analyses = list(next(iter(found[0].by_side.values())).error)
    figure, (panels,) = new_figure("Error of the stiffness by protocol and analysis", 1, len(SIDES), 6.4, sharey=True)
    for panel, side in zip(panels, SIDES, strict=True):
        image = _error_map(panel, np.array([[100 * each.off(name, side) for name in analyses] for each in found]))
        panel.set_title(f"friction on the {side}" if side != "both sides" else "friction shared evenly")
        panel.set_xticks(range(len(analyses)), analyses, rotation=60, ha="right")
    panels[0].set_yticks(range(len(found)), [each.protocol.name for each in found])
    panels[0].invert_yaxis()
    figure.colorbar(image, ax=list(panels), label="median over the joints of |bias| [%]", shrink=0.9)
    return figure


def ratio_figure(
    results: Sequence[ConditionResult], joint_names: Sequence[str], published: Mapping[str, Array], protocol: str
) -> "Figure":
    """Return, per joint, stiffness by the force method over that by the current method, against friction, by its side.

    Args:
        results: A grid over `friction` and `link_share`.
        joint_names: Length n.
        published: Label -> shape (n,), ratios to compare with.
        protocol: Of the experiment, in words.
    """
    shares = sorted({result.condition.link_share for result in results})
    rows = -(-len(joint_names) // COLUMNS)
    title = (
        f"Force method over current method: {protocol}\n(from 0.5 to 2; a line ends where a method tells no stiffness)"
    )
    figure, axes = new_figure(title, rows, COLUMNS, 0.8 + 2.9 * rows)
    panels = [panel for row in axes for panel in row]
    for j, (panel, name) in enumerate(zip(panels, joint_names, strict=False)):
        for i, share in enumerate(shares):
            line = sorted(
                (result.condition.friction, result.ratio()[j])
                for result in results
                if result.condition.link_share == share
            )
            label = f"{100 * share:g} % on the link side"
            panel.plot(*zip(*line, strict=True), MARKERS[i] + "-", color=COLOURS[i], label=label)
        for label, ratio in published.items():
            panel.axhline(ratio[j], color=INK, linestyle="--", linewidth=1.2, label=label)
        panel.axhline(1, color=GREY, linewidth=0.8)
        panel.set_title(name, loc="left")
        panel.set_ylim(0.5, 2.0)
        panel.set_ylabel("ratio [1]")
        panel.set_xlabel("friction, relative to the robot's figures")
    for panel in panels[len(joint_names) :]:
        panel.set_axis_off()
    handles, _ = panels[0].get_legend_handles_labels()
    legend_below(figure, handles)
    return figure


def _error_map(panel: "Axes", errors: Array) -> "AxesImage":
    """Colour a panel by errors in percent, shape (rows, columns), with their numbers."""
    from matplotlib import colormaps
    from matplotlib.colors import BoundaryNorm, ListedColormap

    colours = ListedColormap(colormaps["YlOrRd"](np.linspace(0, 1, len(BIAS_LEVELS) - 1)))
    norm = BoundaryNorm(BIAS_LEVELS, len(BIAS_LEVELS) - 1)
    image = panel.imshow(errors, cmap=colours, norm=norm, origin="lower", aspect="auto")
    for i, row in enumerate(errors):
        for j, value in enumerate(row):
            light = value < BIAS_LEVELS[DARK]
            panel.text(j, i, f"{value:.1f}", ha="center", va="center", color=INK if light else "white")
    panel.grid(visible=False)
    return image
