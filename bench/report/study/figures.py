"""The picture of a study: what verdicts said of their probability, and how many were right."""

from typing import TYPE_CHECKING

import numpy as np

from bench.report.figures.style import COLOURS, GREY, small_figure
from bench.study.goals import Bin

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def calibration_figure(bins: tuple[Bin, ...]) -> "Figure":
    """Return the share of right verdicts over the probability that they were given, with 95 % intervals."""
    figure, ((axes,),) = small_figure(1, 1, 5.0, 3.6)
    axes.plot([0, 1], [0, 1], color=GREY, linewidth=1.0)
    for one in bins:
        low, high = one.right.interval
        axes.plot([one.said, one.said], [low, high], color=COLOURS[0])
        axes.plot(one.said, one.right.value, "o", color=COLOURS[0])
        axes.annotate(f" {one.right.of}", (one.said, one.right.value), va="center", color=GREY)
    axes.set(xlim=(0, 1.06), ylim=(-0.02, 1.04), xlabel="probability that the verdict gives", ylabel="share right")
    axes.set_xticks(np.linspace(0, 1, 6))
    return figure
