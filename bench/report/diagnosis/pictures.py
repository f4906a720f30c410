"""Pictures of a diagnosis as small SVGs: what the worst channels leave, before and after, and a learned shape."""

from collections.abc import Sequence
from dataclasses import dataclass
from io import BytesIO
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bench.record.campaign import Array
from bench.report.diagnosis.learned import LearnedCurve
from bench.report.diagnosis.names import WORKSHOP, channel_name, unit_name
from bench.report.diagnosis.readings import Readings
from bench.report.figures.style import COLOURS, GREY, INK, PALE, SMALL_TEXT, small_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WORST = 3  # channels that are drawn at most
SIZE = (4.6, 3.5)  # [inch]; on a telephone it fills the width
BAND = 2.0  # holds 95 % of what cannot be predicted
LEAST_REACH = 4.0  # of an axis of residuals
RARE = 0.5  # [%] of residuals at either end that may lie outside
LEAST_RANGE = np.deg2rad(2.0)  # [rad]; a joint that moves less shows no dependence on its angle
BINS = 12  # of an angle, by which structure is looked for
OWN = 0.5  # of what the best joint explains, from where on a drive is drawn over its own angle
FEW = 24  # readings, below which there is no structure to look for
RASTER_DPI = 220  # of the points; lines and words stay sharp
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
    """Return the worst channels, each with its pictures: over the runs, and over an angle where it depends on one."""
    found = []
    for c in readings.worst(WORST):
        name = channel_name(readings.quantities[c].column)
        pictures = [_over_runs(readings, c, name)]
        joint = telling_joint(readings, c)
        if joint is not None:
            pictures.insert(0, _over_angle(readings, c, joint, name))
        found.append((name, tuple(pictures)))
    return tuple(found)


def telling_joint(readings: Readings, column: int) -> int | None:
    """Return the moving joint whose angle and direction explain most of a channel's residual; None if none moves."""
    mine = readings.column == column
    reach = _reach(readings, np.flatnonzero(mine))  # one stray reading is no structure
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
    (over, over_scale), (unit, scale) = (WORKSHOP.get(u, (u, 1.0)) for u in (curve.over_unit, curve.unit))
    at = over_scale * np.array(curve.at)
    low, high, value = (scale * np.array(part) for part in (curve.low, curve.high, curve.value))
    panel.fill_between(at, low, high, color=COLOURS[0], alpha=0.2, linewidth=0, label="95 % interval")
    panel.plot(at, value, color=COLOURS[0], marker="o" if len(at) < BINS else "", label="learned")
    panel.axhline(0.0, color=GREY, linewidth=0.8)
    over_words = "angle" if curve.over.startswith("angle") else curve.over
    panel.set_xlabel(f"{over_words} [{over}]")
    panel.set_ylabel(f"{what} [{unit}]")
    _legend(figure, panel, 1.0)
    named = f", {curve.name}" if curve.name else ""
    return Picture(svg_of(figure), f"{what} as learned over {curve.over}{named}, with its 95 % interval")


def svg_of(figure: "Figure") -> str:
    """Return a figure as SVG; the same figure gives the same text."""
    import matplotlib

    file = BytesIO()
    with matplotlib.rc_context({"svg.hashsalt": "diagnosis"}):
        figure.savefig(file, format="svg", dpi=RASTER_DPI, metadata={"Date": None})
    return file.getvalue().decode()


def _over_angle(readings: Readings, column: int, joint: int, name: str) -> Picture:
    mine = np.flatnonzero(readings.column == column)
    instant = readings.instant[mine]
    way = readings.direction[instant, joint]
    unit = "rad"
    angle = WORKSHOP[unit][1] * readings.angle[instant, joint]
    figure, panels = _panels(readings)
    reach = _reach(readings, mine)
    for panel, values in zip(panels, _stages(readings), strict=True):
        for sign, words, marker, colour in WAYS:
            moving = way == sign
            _points(panel, angle[moving], values[mine][moving], reach, marker, colour, words)
    panels[-1].set_xlabel(f"angle of joint {joint + 1} [{unit_name(unit)}]")
    _legend(figure, panels[0])
    return Picture(svg_of(figure), f"Residual of {name} over the angle of joint {joint + 1}, by direction")


def _over_runs(readings: Readings, column: int, name: str) -> Picture:
    mine = np.flatnonzero(readings.column == column)
    run = readings.run[readings.instant[mine]]
    moving = np.any(readings.direction[readings.instant[mine]] != 0, axis=1)
    order = np.arange(len(mine), dtype=np.float64)
    figure, panels = _panels(readings)
    reach = _reach(readings, mine)
    begins = np.flatnonzero(np.diff(run, prepend=-1))
    for panel, values in zip(panels, _stages(readings), strict=True):
        for begin in begins[1:]:
            panel.axvline(begin - 0.5, color=PALE, linewidth=0.7, zorder=0.6)
        for chosen, words, marker, colour in (
            (moving, "motion", "o", COLOURS[0]),
            (~moving, "at rest", "D", COLOURS[3]),
        ):
            _points(panel, order[chosen], values[mine][chosen], reach, marker, colour, words)
        panel.grid(visible=False, axis="x")
    centres = (begins + np.append(begins[1:], len(mine))) / 2 - 0.5
    shown = _apart(centres, len(mine))
    panels[-1].set_xticks(centres[shown], [str(run[begins[i]] + 1) for i in shown])
    panels[-1].set_xlabel("run (number as in the list), readings in their order")
    _legend(figure, panels[0])
    return Picture(svg_of(figure), f"Residual of {name} over all runs in their order")


def _panels(readings: Readings) -> tuple["Figure", "Sequence[Axes]"]:
    stages = ("nominal model",) if readings.after is None else ("without what was found", "with what was found")
    height = SIZE[1] if len(stages) > 1 else 0.68 * SIZE[1]
    figure, rows = small_figure(len(stages), 1, SIZE[0], height, sharex=True, sharey=True)
    panels = [row[0] for row in rows]
    for panel, words in zip(panels, stages, strict=True):
        panel.set_title(words, loc="left")
    return figure, panels


def _stages(readings: Readings) -> tuple[Array, ...]:
    return (readings.before,) if readings.after is None else (readings.before, readings.after)


def _reach(readings: Readings, mine: NDArray[np.intp]) -> float:
    return max(LEAST_REACH, 1.1 * float(np.percentile(np.abs(readings.before[mine]), 100 - RARE)))


def _points(panel: "Axes", x: Array, y: Array, reach: float, marker: str, colour: str, words: str) -> None:
    panel.axhspan(-BAND, BAND, color=PALE, alpha=0.5, linewidth=0, zorder=0.5)
    panel.axhline(0.0, color=INK, linewidth=0.6, zorder=0.7)
    inside = np.clip(y, -reach, reach)
    if len(x):
        panel.plot(x, inside, marker, color=colour, markersize=2.2, markeredgewidth=0, label=words, rasterized=True)
    panel.set_ylim(-1.04 * reach, 1.04 * reach)


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


def _apart(centres: Array, length: int) -> list[int]:
    """Return the ticks that have room for a number."""
    found: list[int] = []
    for i, centre in enumerate(centres):
        if not found or centre - centres[found[-1]] > 0.045 * length:
            found.append(i)
    return found
