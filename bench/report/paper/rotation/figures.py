"""Figs. 11 to 13: a counterbalance's torque over the angle, its prediction elsewhere, its share of the stiffness."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import norm

from bench.identify.balancing_torque import BalancingTorque
from bench.identify.counterbalance_check import Prediction, Spread
from bench.identify.counterbalance_fit import CounterbalanceFit
from bench.report.figures.style import COLOURS, GREY, INK, new_figure
from bench.robot.bodies import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

KILO = 1e3
MEGA = 1e6
STYLES = ("-", "--", ":", "-.")  # of the payloads; the colour is the speed
HEIGHT = 4.8  # [inch]


def figure_11(torques: Sequence[BalancingTorque], spread: Spread, fit: CounterbalanceFit, gain: float) -> "Figure":
    """Return M over the joint angle by payload and speed, and how far each traverse is from the mean of all.

    Args:
        torques: M of each traverse, Eq. (32).
        spread: The same at common angles.
        fit: The gas law through all of them.
        gain: Relative error of torque constant and current together, as the fit found it.
    """
    title = f"Balancing torque from the current: traverses differ by at most {spread.largest:.1%} of its largest value"
    figure, ((left, right),) = new_figure(title, 1, 2, HEIGHT, width_ratios=[1, 1])
    speeds, payloads = _distinct(sorted(t.speed for t in torques)), sorted({t.payload for t in torques})
    for t, apart in zip(torques, spread.torque - spread.mean, strict=True):
        colour = COLOURS[int(np.argmin(np.abs(np.array(speeds) - t.speed))) % len(COLOURS)]
        style = STYLES[payloads.index(t.payload) % len(STYLES)]
        label = f"{t.payload:g} kg, {np.rad2deg(t.speed):.3g} deg/s"
        left.plot(np.rad2deg(t.theta), t.torque / KILO, style, color=colour, label=label, linewidth=1.2)
        right.plot(np.rad2deg(spread.theta), apart, style, color=colour, linewidth=1.0)
    theta = spread.theta
    left.plot(
        np.rad2deg(theta),
        fit.counterbalance.torque(theta) / KILO,
        color=INK,
        linewidth=0.8,
        label="gas law, gain corrected",
    )
    _mark_zero(left, spread.zero)
    left.set_ylabel("restoring torque M [kNm]")
    right.set_ylabel("M less the mean of all [Nm]")
    right.axhline(0, color=GREY, linewidth=0.8)
    right.set_title(f"torque constant wrong by {gain:+.1%}, which a load makes visible", loc="left")
    _angle_axes(left, right)
    left.legend(loc="upper left", frameon=False)
    return figure


def figure_12(predictions: Sequence[Prediction], fit: CounterbalanceFit, identified: tuple[float, float]) -> "Figure":
    """Return predicted against measured M at other speeds and over another range, and the error.

    Args:
        predictions: Traverses that the fit has not seen.
        fit: Of the gas law.
        identified: Range of angles it was identified over [rad].
    """
    worst, corrected_worst = max(p.error for p in predictions), max(p.corrected_error for p in predictions)
    title = f"Balancing torque predicted elsewhere: error up to {worst:.1%} of its largest value"
    figure, ((left, right),) = new_figure(title, 1, 2, HEIGHT)
    for panel in (left, right):
        panel.axvspan(*np.rad2deg(identified), color=GREY, alpha=0.15, linewidth=0, label="range of identification")
        panel.axhline(0, color=GREY, linewidth=0.8)
    for i, (p, colour) in enumerate(zip(predictions, COLOURS, strict=False)):
        angle = np.rad2deg(p.theta)
        raw, corrected = ("as measured", "torque constant corrected") if i == 0 else (None, None)
        left.plot(angle, p.measured / KILO, color=colour, label=f"measured, {p.name}")
        right.plot(angle, p.predicted - p.measured, color=colour, linewidth=1.0, label=raw)
        right.plot(angle, p.predicted - p.corrected, ":", color=colour, linewidth=1.0, label=corrected)
    longest = max(predictions, key=lambda p: len(p.theta))
    angle = np.rad2deg(longest.theta)
    band = norm.ppf(0.5 + fit.level / 2) * fit.torque_sigma(longest.theta)
    left.plot(angle, longest.predicted / KILO, "--", color=INK, label="predicted, gas law")
    left.plot(angle, longest.by_spring / KILO, ":", color=COLOURS[3], label="predicted, best linear spring")
    right.fill_between(angle, -band, band, color=INK, alpha=0.15, linewidth=0, label=f"{fit.level:.0%} of C and l_c")
    right.set_title(f"with the torque constant corrected: up to {corrected_worst:.2%}", loc="left")
    left.set_ylabel("restoring torque M [kNm]")
    right.set_ylabel("predicted less measured [Nm]")
    _angle_axes(left, right)
    left.legend(loc="upper left", frameon=False)
    right.legend(loc="best", frameon=False)
    return figure


def figure_13(theta: Array, fit: CounterbalanceFit, stiffness: float, stiffness_sigma: float) -> "Figure":
    """Return k_b and k = k^0 + k_b over the joint angle, Eq. (12), with bands.

    Args:
        theta: Shape (T,) [rad].
        fit: Of the gas law.
        stiffness: k^0, of the elastic element alone [Nm/rad].
        stiffness_sigma: Its standard deviation [Nm/rad].
    """
    k_b, sigma = fit.counterbalance.stiffness(theta), fit.stiffness_sigma(theta)
    share = np.abs(k_b).max() / stiffness
    title = f"Stiffness of the counterbalanced joint: the counterbalance adds at most {share:.2%}"
    figure, ((left, right),) = new_figure(title, 1, 2, HEIGHT)
    angle, wide = np.rad2deg(theta), norm.ppf(0.5 + fit.level / 2)
    left.fill_between(angle, (k_b - wide * sigma) / KILO, (k_b + wide * sigma) / KILO, color=COLOURS[0], alpha=0.25)
    left.plot(angle, k_b / KILO, color=COLOURS[0])
    left.set_ylabel(r"$k_b$ [kNm/rad]")
    left.set_title(r"(a) the counterbalance's share, $k_b$", loc="left")
    total, error = stiffness + k_b, np.hypot(sigma, stiffness_sigma)
    lower, upper = (total - wide * error) / MEGA, (total + wide * error) / MEGA
    right.fill_between(
        angle, lower, upper, color=COLOURS[1], alpha=0.25, label=f"{fit.level:.0%} band, mostly of $k^0$"
    )
    right.plot(angle, total / MEGA, color=COLOURS[1], label="$k = k^0 + k_b$")
    right.axhline(stiffness / MEGA, color=GREY, linewidth=0.8, label="$k^0$ alone")
    right.set_ylabel("$k$ [MNm/rad]")
    right.set_title("(b) the joint's stiffness", loc="left")
    right.legend(loc="lower left", frameon=False)
    _angle_axes(left, right)
    return figure


def _distinct(speeds: Sequence[float]) -> list[float]:
    """Return speeds without those that differ by rounding only."""
    return [s for i, s in enumerate(speeds) if i == 0 or not np.isclose(s, speeds[i - 1], rtol=1e-3)]


def _mark_zero(panel: "Axes", zero: float) -> None:
    panel.axhline(0, color=GREY, linewidth=0.8)
    if np.isfinite(zero):
        panel.axvline(np.rad2deg(zero), color=GREY, linewidth=0.8)
        panel.annotate(
            f"M = 0 at {np.rad2deg(zero):.2f} deg", (np.rad2deg(zero), 0), (8, -16), textcoords="offset points"
        )


def _angle_axes(*panels: "Axes") -> None:
    for panel in panels:
        panel.set_xlabel(r"joint angle $\theta$ [deg]")
