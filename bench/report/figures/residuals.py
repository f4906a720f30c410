"""Residuals of a fit by channel, in units of that channel's standard deviation."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from bench.errors import InputError
from bench.report.figures.style import COLOURS, GREY, INK, PALE, new_figure
from bench.robot.bodies import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ROW_HEIGHT = 0.8  # [inch]
ROW_PADDING = 0.04  # [inch]
BAND = 2.0  # [sigma], holds 95 % of what is normally distributed
REACH = 4.5  # [sigma], of the axis; what lies farther out is drawn at the edge as a triangle
BINS = np.linspace(-REACH, REACH, 19)


def residual_figure(residuals: Mapping[str, Array], title: str = "Residuals by channel") -> "Figure":
    """Return the figure: per channel its residuals in the order of the readings, and their distribution beside N(0, 1).

    Args:
        residuals: Channel -> residuals in units of its standard deviation, any shape; nan is left out.
        title: Stands above.

    Raises:
        InputError: There is no channel with a residual.
    """
    channels = {name: values.ravel()[np.isfinite(values.ravel())] for name, values in residuals.items()}
    channels = {name: values for name, values in channels.items() if len(values)}
    if not channels:
        raise InputError("residual figure: no channel has a residual.")
    figure, axes = new_figure(
        title,
        rows=len(channels),
        columns=2,
        height=1.3 + ROW_HEIGHT * len(channels),
        row_padding=ROW_PADDING,
        width_ratios=[4.2, 1],
        sharey=True,
        sharex="col",
    )
    for (name, values), (strip, histogram) in zip(channels.items(), axes, strict=True):
        _draw_strip(strip, values)
        strip.set_ylabel(f"{name}\nrms {np.sqrt(np.mean(values**2)):.2f}", rotation=0, ha="right", va="center")
        _draw_histogram(histogram, values)
    axes[-1][0].set_xlabel("reading")
    axes[-1][1].set_xlabel("density")
    axes[0][0].set_title(r"residual [$\sigma$], band $\pm 2\,\sigma$", loc="left")
    axes[0][1].set_title("against N(0, 1)", loc="left")
    return figure


def _draw_strip(panel: "Axes", values: Array) -> None:
    reading = np.arange(1, len(values) + 1)
    inside = np.abs(values) <= REACH
    panel.axhspan(-BAND, BAND, color=PALE, alpha=0.6, linewidth=0, zorder=0.5)
    panel.axhline(0.0, color=GREY, linewidth=0.8)
    panel.plot(reading[inside], values[inside], "o", color=COLOURS[0], markersize=3.5)
    for marker, beyond in (("^", values > REACH), ("v", values < -REACH)):
        panel.plot(reading[beyond], np.clip(values[beyond], -REACH, REACH), marker, color=COLOURS[1])
    panel.set_ylim(-REACH - 0.8, REACH + 0.8)
    panel.set_yticks([-BAND, BAND])


def _draw_histogram(panel: "Axes", values: Array) -> None:
    grid = np.linspace(-REACH, REACH, 121)
    panel.hist(
        np.clip(values, -REACH, REACH),
        bins=list(BINS),
        density=True,
        orientation="horizontal",
        color=COLOURS[0],
        alpha=0.55,
    )
    panel.plot(np.exp(-(grid**2) / 2) / np.sqrt(2 * np.pi), grid, color=INK, linewidth=1.2)
