"""Pictures of a diagnosis as small SVGs: what is left of the worst channels, in their own unit, and learned shapes."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.name.learned_shape import LearnedCurve
from bench.predict.errors import rms
from bench.record.campaign import Array
from bench.report.diagnosis.names import channel_name, of_slide
from bench.report.diagnosis.numbers import shown, unit_name, workshop
from bench.report.diagnosis.readings import Readings
from bench.report.figures.style import COLOURS, GREY, INK, PALE, SMALL_TEXT, small_figure, svg_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WORST = 3  # channels that are drawn at most
SIZE = (4.6, 3.5)  # [inch]; on a telephone it fills the width
BAND = 2.0  # standard deviations; holds 95 % of what cannot be predicted
LEAST_REACH = 4.0  # standard deviations, of an axis of residuals
RARE = 0.5  # [%] of residuals at either end that may lie outside
LEAST_RANGE = np.deg2rad(2.0)  # [rad]; a joint that moves less shows no dependence on its angle
BINS = 12  # of an angle, by which structure is looked for
OWN = 0.5  # of what the best joint explains, from where on a drive is drawn over its own angle
FEW = 24  # readings, below which there is no structure to look for
SALT = "diagnosis"  # of the ids in the SVGs
WAYS = ((1.0, "angle rising", "o", COLOURS[0]), (-1.0, "angle falling", "s", COLOURS[1]))


@dataclass(frozen=True)
class Picture:
    """One picture.

    Attributes:
        svg: Text of the file.
        words: What it shows, for those who cannot see it.
    """

    svg: str
    words: str


def pictures_of(readings: Readings) -> tuple[tuple[str, tuple[Picture, ...]], ...]:
    """Return the worst channels, each with its pictures: over an angle where it depends on one, and over time."""
    found = []
    for c in readings.worst(WORST):
        name = channel_name(readings.quantities[c].column)
        pictures = [_over_time(readings, c, name)]
        joint = telling_joint(readings, c)
        if joint is not None:
            pictures.insert(0, _over_angle(readings, c, joint, name))
        found.append((name, tuple(pictures)))
    return tuple(found)


def telling_joint(readings: Readings, column: int) -> int | None:
    """Return the moving joint whose angle and direction explain most of a channel's residual; None if none moves."""
    mine = readings.column == column
    reach = max(LEAST_REACH, _nearly_all(readings.before[mine]))  # one stray reading is no structure
    instant, residual = readings.instant[mine], np.clip(readings.before[mine], -reach, reach)
    explained: dict[int, float] = {}
    for j in range(readings.angle.shape[1]):
        way, angle = readings.direction[instant, j], readings.angle[instant, j]
        moves = way != 0
        if moves.sum() < FEW or np.ptp(angle[moves]) < LEAST_RANGE:
            continue
        edges = np.linspace(angle[moves].min(), angle[moves].max(), BINS + 1)[1:-1]
        group = np.digitize(angle[moves], edges) + BINS * (way[moves] > 0)
        count = np.bincount(group, minlength=2 * BINS)
        total = np.bincount(group, residual[moves], minlength=2 * BINS)
        explained[j] = float(np.sum(total[count > 0] ** 2 / count[count > 0]))
    if not explained:
        return None
    quantity = readings.quantities[column]
    best = max(explained, key=lambda j: explained[j])
    own = explained.get(quantity.index, 0.0) if quantity.is_drive else 0.0
    return quantity.index if own > OWN * explained[best] else best


def learned_picture(curve: LearnedCurve, what: str) -> Picture:
    """Return a learned shape as a curve with its 95 % band; `what` is learned, such as "motor torque"."""
    figure, ((panel,),) = small_figure(1, 1, *SIZE)
    (over, over_scale), (unit, scale) = map(workshop, (curve.over_unit, curve.unit))
    at = over_scale * np.array(curve.at)
    low, high, value = (scale * np.array(part) for part in (curve.low, curve.high, curve.value))
    panel.fill_between(at, low, high, color=COLOURS[0], alpha=0.2, linewidth=0, label="95 % interval")
    panel.plot(at, value, color=COLOURS[0], marker="o" if len(at) < BINS else "", label="learned")
    panel.axhline(0.0, color=GREY, linewidth=0.8)
    what = of_slide(what) if curve.unit in ("N", "m") else what
    panel.set_xlabel(f"{over_name(curve).removesuffix(' and direction')} [{over}]")
    panel.set_ylabel(f"{what} [{unit}]")
    _legend(figure, panel, 1.0)
    named = f", {curve.name}" if curve.name else ""
    return Picture(svg_of(figure, SALT), f"{what} as learned over {over_name(curve)}{named}, with its 95 % interval")


def over_name(curve: LearnedCurve) -> str:
    """Return what a learned curve depends on; of a slide the position."""
    return of_slide(curve.over) if curve.over_unit == "m" else curve.over


@dataclass(frozen=True, eq=False)
class _Stage:
    """What a model leaves of one channel at the k instants where it was measured, shape (k,), in the unit shown."""

    words: str
    left: Array


def _over_angle(readings: Readings, column: int, joint: int, name: str) -> Picture:
    at = _measured(readings, column)
    way = readings.direction[at, joint]
    slides = bool(readings.is_slide[joint])
    unit, scale = workshop("m" if slides else "rad")
    over = f"{'position' if slides else 'angle'} of joint {joint + 1}"
    figure, panels = _panels(readings, column, at)
    for panel, stage in panels:
        for sign, words, marker, colour in WAYS:
            moving = way == sign
            words = of_slide(words) if slides else words
            _points(panel, scale * readings.angle[at, joint][moving], stage.left[moving], marker, colour, words)
    panels[-1][0].set_xlabel(f"{over} [{unit}]")
    _legend(figure, panels[0][0])
    return Picture(svg_of(figure, SALT), f"Residual of {name} over the {over}, by direction")


def _over_time(readings: Readings, column: int, name: str) -> Picture:
    at = _measured(readings, column)
    moving = np.any(readings.direction[at] != 0, axis=1)
    seconds = readings.seconds[at]
    begins = np.flatnonzero(np.diff(readings.run[at], prepend=-1))
    figure, panels = _panels(readings, column, at)
    for panel, stage in panels:
        for begin in begins[1:]:
            panel.axvline(float(seconds[begin]), color=PALE, linewidth=0.7, zorder=0.6)
        for chosen, words, marker, colour in (
            (moving, "motion", "o", COLOURS[0]),
            (~moving, "at rest", "D", COLOURS[3]),
        ):
            _points(panel, seconds[chosen], stage.left[chosen], marker, colour, words)
        panel.grid(visible=False, axis="x")
    several = len(begins) > 1
    panels[-1][0].set_xlabel("time of the recording, runs one after another [s]" if several else "time [s]")
    _legend(figure, panels[0][0])
    return Picture(svg_of(figure, SALT), f"Residual of {name} over time, all runs one after another")


def _measured(readings: Readings, column: int) -> NDArray[np.intp]:
    return np.flatnonzero(np.isfinite(readings.nominal[:, column]))


def _stages(readings: Readings, column: int, at: NDArray[np.intp]) -> list[_Stage]:
    unit = readings.quantities[column].unit
    fitted = "with its figures fitted" if readings.after is None else "with what was found"
    found = []
    for words, left in (("nominal model", readings.nominal), (fitted, readings.left)):
        size = rms(left[at, column])
        (text,) = shown((size,), unit, size / 10)  # three digits
        scale = workshop(unit)[1]
        found.append(_Stage(f"{words}: RMS {text} {unit_name(unit)}", scale * left[at, column]))
    return found


def _panels(readings: Readings, column: int, at: NDArray[np.intp]) -> tuple["Figure", list[tuple["Axes", _Stage]]]:
    """Return a figure with one panel for each model, each with a scale of its own and the same band of noise."""
    stages = _stages(readings, column, at)
    unit = readings.quantities[column].unit
    noise = workshop(unit)[1] * float(np.median(readings.noise[at, column]))
    figure, rows = small_figure(len(stages), 1, *SIZE, sharex=True)
    panels = [(row[0], stage) for row, stage in zip(rows, stages, strict=True)]
    for panel, stage in panels:
        reach = max(LEAST_REACH * noise, _nearly_all(stage.left))
        panel.set_title(stage.words, loc="left")
        panel.set_ylabel(f"[{unit_name(unit)}]")
        panel.axhspan(-BAND * noise, BAND * noise, color=PALE, alpha=0.5, linewidth=0, zorder=0.5)
        panel.axhline(0.0, color=INK, linewidth=0.6, zorder=0.7)
        panel.set_ylim(-1.04 * reach, 1.04 * reach)
    return figure, panels


def _nearly_all(values: Array) -> float:
    """Return the size below which all but the rarest values lie, with a margin."""
    return 1.1 * float(np.percentile(np.abs(values), 100 - RARE))


def _points(panel: "Axes", x: Array, y: Array, marker: str, colour: str, words: str) -> None:
    low, high = panel.get_ylim()
    inside = np.clip(y, low / 1.04, high / 1.04)
    if len(x):
        panel.plot(x, inside, marker, color=colour, markersize=2.2, markeredgewidth=0, label=words, rasterized=True)


def _legend(figure: "Figure", panel: "Axes", markerscale: float = 2.0) -> None:
    handles, labels = panel.get_legend_handles_labels()
    figure.legend(
        handles,
        labels,
        loc="outside lower center",
        ncols=3,
        markerscale=markerscale,
        frameon=False,
        fontsize=SMALL_TEXT,
    )
