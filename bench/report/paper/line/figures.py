"""Figs. 15 to 17: friction on the line, deflection against its predictions, error before and after compensation."""

from typing import TYPE_CHECKING, Any

import numpy as np

from bench.identify.line_deflection import measured_deflection
from bench.identify.line_passes import AXES, WAYS
from bench.report.figures.style import COLOURS, GREY, INK, legend_below, new_figure
from bench.report.paper.line.run import LineReport
from bench.robot.bodies import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SHOWN = ("x", "z")  # the line lies in this plane, as in the paper's figures
MM, UM, KNM = 1e3, 1e6, 1e-3
TWO_SIGMA = 1.959964  # 95 %
PARTS = {  # words -> parts of the error that they stand for
    "error of the stiffness": ("stiffness",),
    "error of the torque:\nfriction, currents": ("torque",),
    "frame of the tracker": ("frame",),
    "drive following,\nsecond order, noise": ("following", "rest", "noise"),
}


def busiest_joint(report: LineReport) -> int:
    """Return the index of the joint that turns most along the line."""
    return int(np.argmax(np.ptp(report.model.passes.of("loaded", "out").q_cmd, axis=0)))


def figure_15(report: LineReport) -> "Figure":
    """Return joint angles along the line, and of the busiest joint torque both ways and friction by Eq. (48)."""
    j = busiest_joint(report)
    name, place, friction = report.joint_names[j], MM * report.place, report.friction
    figure, ((left, middle, right),) = new_figure("Friction along the line, under load", 1, 3, 4.6)
    out, back = report.model.passes.of("loaded", "out"), report.model.passes.of("loaded", "back")
    for k, i in enumerate(np.flatnonzero(np.any(friction.direction, axis=0))):
        angle = np.rad2deg(out.q_cmd[:, i])
        left.plot(place, angle, color=COLOURS[k])
        left.annotate(
            report.joint_names[i], (place[-1], angle[-1]), (4, -4), textcoords="offset points", color=COLOURS[k]
        )
    left.set_title("a) joints that turn", loc="left")
    left.set_ylabel("commanded angle [deg]")
    for k, (line_pass, way) in enumerate(((out, "out"), (back, "back"))):
        middle.plot(place, KNM * line_pass.current_torque[:, j], color=COLOURS[k], label=way, linewidth=1.0)
    mean = (out.current_torque[:, j] + back.current_torque[:, j]) / 2
    middle.plot(place, KNM * mean, color=INK, linestyle="--", label="mean: without friction", linewidth=1.0)
    middle.set_title(f"b) motor torque of {name}", loc="left")
    middle.set_ylabel(r"$\xi I$ [kNm]")
    right.plot(place, friction.torque[:, j], color=GREY, linewidth=0.8, label="half the difference, Eq. (48)")
    level, sigma = friction.level[j], friction.sigma[j]
    right.axhline(level, color=COLOURS[2], label=f"mean {level:.0f} ± {sigma:.0f} Nm")
    right.axhspan(level - sigma, level + sigma, color=COLOURS[2], alpha=0.15, linewidth=0)
    right.set_ylim(0, 1.25 * float(np.nanmax(friction.torque[:, j])))
    right.set_title(f"c) friction of {name}", loc="left")
    right.set_ylabel("torque [Nm]")
    for panel in (left, middle, right):
        panel.set_xlabel("place on the line [mm]")
    handles = [handle for panel in (middle, right) for handle in panel.get_legend_handles_labels()[0]]
    legend_below(figure, handles)
    return figure


def figure_16(report: LineReport) -> "Figure":
    """Return the deflection by the load: tracker against every method, with 95 % bands, and the differences below."""
    measured, _ = measured_deflection(report.model.passes, "out")
    title = f"Deflection by {report.scenario.force_n:g} N along the line, out"
    figure, axes = new_figure(title, 2, 2, 7.4, sharex="all", height_ratios=[1.6, 1])
    for column, axis in enumerate(SHOWN):
        a = AXES.index(axis)
        top, bottom = axes[0][column], axes[1][column]
        place = MM * report.place
        top.plot(place, MM * measured[:, a], ".", color=GREY, markersize=2, label="tracker" if column == 0 else None)
        bottom.axhline(0, color=GREY, linewidth=0.8)
        for k, (name, found) in enumerate(report.methods.items()):
            predicted = found.deflection["out"]
            values, error = MM * predicted.displacement[:, a], MM * predicted.standard_error[:, a]
            smooth, smooth_error = (_smoothed(part) for part in (values, error))
            label = f"{name} method" if column == 0 else None
            top.plot(place, smooth, color=COLOURS[k], label=label)
            off = UM / MM * (_smoothed(MM * measured[:, a]) - smooth)
            half = UM / MM * TWO_SIGMA * smooth_error
            bottom.plot(place, off, color=COLOURS[k])
            bottom.fill_between(place, off - half, off + half, color=COLOURS[k], alpha=0.15, linewidth=0)
        top.set_title(axis, loc="left")
        bottom.set_xlabel("place on the line [mm]")
    axes[0][0].set_ylabel("deflection [mm]")
    axes[1][0].set_ylabel("tracker less predicted\n[µm], 95 % bands")
    legend_below(figure)
    return figure


def figure_17(report: LineReport) -> "Figure":
    """Return the error against the commanded line before and after compensation, and what is left of it."""
    figure, axes = new_figure(
        f"Error of the trajectory under {report.scenario.force_n:g} N", 2, 2, 8.4, height_ratios=[1.4, 1]
    )
    cases = [("not compensated", report.before), *((f"{name} method", m.after) for name, m in report.methods.items())]
    colours = (INK, *COLOURS)
    for column, axis in enumerate(SHOWN):
        top, a = axes[0][column], AXES.index(axis)
        top.axhline(0, color=GREY, linewidth=0.8)
        for k, (name, errors) in enumerate(cases):
            for way, style in zip(WAYS, ("-", "--"), strict=True):
                values = MM * _smoothed(errors[way].error[:, a])
                label = name if column == 0 and way == "out" else None
                top.plot(MM * report.place, values, style, color=colours[k], label=label)
        top.set_title(f"{axis}: out solid, back dashed", loc="left")
        top.set_xlabel("place on the line [mm]")
        _bars(axes[1][column], report, axis)
    axes[0][0].set_ylabel("tracker less commanded line [mm]")
    legend_below(figure)
    return figure


def _bars(panel: "Axes", report: LineReport, axis: str) -> None:
    """Draw the mean of each part of the error along the way out; with their signs they add up to the mean error."""
    width, a = 0.8 / len(report.methods), AXES.index(axis)
    for k, found in enumerate(report.methods.values()):
        parts = found.after["out"].parts
        means = [MM * sum(float(parts[name][:, a].mean()) for name in names) for names in PARTS.values()]
        at = np.arange(len(PARTS)) + (k - (len(report.methods) - 1) / 2) * width
        bars: Any = panel.barh(at, means, width, color=COLOURS[k])
        panel.bar_label(bars, [f"{mean:+.2f}" for mean in means], fontsize=8, color=COLOURS[k], padding=3)
    panel.axvline(0, color=GREY, linewidth=0.8)
    panel.set_yticks(range(len(PARTS)), list(PARTS))
    panel.invert_yaxis()
    panel.margins(x=0.12)
    panel.set_title(f"{axis}: what is left on the way out", loc="left")
    panel.set_xlabel("mean along the line [mm]; the parts add up")
    panel.grid(visible=False, axis="y")


def _smoothed(values: Array) -> Array:
    """Return a curve, shape (T,), without the noise of single readings: a parabola through a tenth of it at a time."""
    from scipy.signal import savgol_filter

    window = max(5, 2 * (len(values) // 20) + 1)
    return np.asarray(savgol_filter(values, window, polyorder=2)) if len(values) > window else values
