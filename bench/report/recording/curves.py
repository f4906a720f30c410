"""The time series of a recording: which there are, in which plot and under which tab."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.report.recording.deflection import deflection_of
from bench.report.recording.writer import RecordingWriter
from bench.robot.bodies import Array
from bench.robot.compiled import CompiledRobot
from bench.simulate.session import Film

Colour = tuple[int, int, int]

# Okabe and Ito (2008), colours that stay apart for colour-blind readers; those that show on black and on white
JOINT_COLOURS: tuple[Colour, ...] = (
    (230, 159, 0),
    (86, 180, 233),
    (0, 158, 115),
    (204, 121, 167),
    (213, 94, 0),
    (0, 114, 178),
)
AXIS_COLOURS: tuple[Colour, ...] = ((213, 94, 0), (0, 158, 115), (86, 180, 233))
SINGLE: Colour = (230, 159, 0)
RARE = 1.0  # [%], share of the values at either end that may lie outside a plot when it opens
SPAN_MARGIN = 0.25  # of the span, above and below
TRUE_WIDTH, MEASURED_WIDTH = 2.0, 1.0  # [px]


@dataclass(frozen=True)
class Curve:
    """One line of a plot.

    Attributes:
        name: What the legend calls it; also the last part of its entity path.
        values: Shape (T,), in the unit of its plot; nan leaves a gap.
        colour: Red, green, blue, 0 to 255.
        width: [px].
    """

    name: str
    values: Array
    colour: Colour
    width: float = TRUE_WIDTH


@dataclass(frozen=True)
class Plot:
    """Curves over one axis.

    Attributes:
        tab: Title of the tab it stands under.
        title: What it shows, with the unit.
        path: Entity path of its curves.
        curves: The curves; none is nan throughout.
    """

    tab: str
    title: str
    path: str
    curves: tuple[Curve, ...]

    @property
    def span(self) -> tuple[float, float] | None:
        """Ends of the axis: all but rare extremes, such as the ringing after a move; None for constant curves."""
        low, high = np.nanpercentile(np.concatenate([curve.values for curve in self.curves]), [RARE, 100 - RARE])
        margin = SPAN_MARGIN * (high - low)
        return (float(low - margin), float(high + margin)) if margin > 0 else None


def plots_of(film: Film, compiled: CompiledRobot) -> tuple[Plot, ...]:
    """Return the plots for a film; a curve without any value, and a plot without any curve, is left out."""
    plots = (replace(plot, curves=tuple(_with_values(plot.curves))) for plot in _all_plots(film, compiled))
    return tuple(plot for plot in plots if plot.curves)


def log_plots(writer: RecordingWriter, plots: Sequence[Plot]) -> None:
    """Log the curves of all plots, with their names and colours."""
    import rerun as rr

    for plot in plots:
        for curve in plot.curves:
            path = f"{plot.path}/{rr.escape_entity_path_part(curve.name)}"
            writer.fixed(path, rr.SeriesLines(names=[curve.name], colors=[curve.colour], widths=[curve.width]))
            writer.moving(path, rr.Scalars.columns(scalars=curve.values))


def _all_plots(film: Film, compiled: CompiledRobot) -> Iterator[Plot]:
    trace, reading = film.trace, film.reading
    joints = [drive.joint for drive in compiled.robot.figures.drives]
    deflection = deflection_of(film)

    def per_joint(values: Array) -> tuple[Curve, ...]:
        return tuple(Curve(name, values[:, i], JOINT_COLOURS[i % len(JOINT_COLOURS)]) for i, name in enumerate(joints))

    def per_axis(true: Array, measured: Array) -> tuple[Curve, ...]:
        true_curves = (Curve(f"true {axis}", true[:, i], AXIS_COLOURS[i]) for i, axis in enumerate("xyz"))
        measured_curves = (
            Curve(f"measured {axis}", measured[:, i], _darker(AXIS_COLOURS[i]), MEASURED_WIDTH)
            for i, axis in enumerate("xyz")
        )
        return (*measured_curves, *true_curves)

    def alone(name: str, values: Array) -> tuple[Curve, ...]:
        return (Curve(name, values, SINGLE),)

    tab = "Load and deflection"
    yield Plot(
        tab,
        "Deflection of the reference point against unloaded [mm]",
        "deflection",
        per_axis(1e3 * deflection.true, 1e3 * deflection.measured),
    )
    yield Plot(tab, "Applied force [N]", "force", per_axis(trace.wrench[:, :3], reading.force))
    yield Plot(tab, "Motor current, measured [A]", "current", per_joint(reading.current))
    tab = "Joints"
    yield Plot(
        tab, "Wind-up of the elastic elements, theta - q [mrad]", "wind_up", per_joint(1e3 * (trace.theta - trace.q))
    )
    yield Plot(tab, "Motor torque [Nm]", "motor_torque", per_joint(trace.motor_torque))
    yield Plot(tab, "Friction on the motor side [Nm]", "motor_friction", per_joint(trace.motor_friction))
    yield Plot(tab, "Friction on the link side [Nm]", "link_friction", per_joint(trace.link_friction))
    tab = "Counterbalance"
    yield Plot(
        tab, "Pull of the cylinder [kN]", "counterbalance/pull", alone("pull", 1e-3 * trace.counterbalance_force)
    )
    yield Plot(
        tab, "Length of the cylinder [mm]", "counterbalance/length", alone("length", 1e3 * trace.counterbalance_length)
    )
    yield Plot(
        tab, "Gas pressure, measured [bar]", "counterbalance/pressure", alone("pressure", 1e-5 * reading.gas_pressure)
    )


def _with_values(curves: Sequence[Curve]) -> Iterator[Curve]:
    return (curve for curve in curves if not np.all(np.isnan(curve.values)))


def _darker(colour: Colour) -> Colour:
    red, green, blue = (2 * channel // 3 for channel in colour)
    return red, green, blue
