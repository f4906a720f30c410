"""The house style of the figures, and how they are saved. Matplotlib's object interface only: no global state."""

from collections.abc import Sequence
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bench.report.files import replacing

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Okabe and Ito (2008), colours that stay apart for colour-blind readers; yellow is left out, it is too light on white
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00")
MARKERS = ("o", "s", "D", "^", "v", "P")  # so that no meaning hangs on colour alone
INK, GREY, PALE = "#222222", "#8A8A8A", "#E4E4E4"

WIDTH = 12.0  # [inch], 1200 px at the resolution that the text sizes are made for
PIXELS_PER_INCH = 150
RASTER_DPI = 220  # of what an SVG holds as an image; lines and words stay sharp
TEXT = 10.5  # [pt]
SMALL_TEXT = 9.0  # [pt], of figures for a narrow column
PADDING = 0.09  # [inch], around every axes

_STYLE: dict[Any, Any] = {
    "font.size": TEXT,
    "axes.titlesize": TEXT + 1,
    "axes.labelsize": TEXT,
    "axes.edgecolor": GREY,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.8,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.color": PALE,
    "grid.linewidth": 0.8,
    "legend.frameon": False,
    "legend.fontsize": TEXT,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "xtick.labelsize": TEXT - 1,
    "ytick.labelsize": TEXT - 1,
    "lines.linewidth": 1.6,
    "lines.markersize": 5.0,
}


def new_figure(
    title: str, rows: int, columns: int, height: float, row_padding: float = PADDING, **layout: Any
) -> tuple["Figure", Sequence[Sequence["Axes"]]]:
    """Return a figure of `WIDTH` by `height` inches in the house style, with its axes by row and column.

    Args:
        title: Stands above, on the left.
        rows: Number of rows of axes.
        columns: Number of columns of axes.
        height: [inch].
        row_padding: [inch], above and below every row.
        layout: Further arguments of `Figure.subplots`.
    """
    import matplotlib
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    with matplotlib.rc_context(_STYLE):
        figure = Figure(figsize=(WIDTH, height), layout=ConstrainedLayoutEngine(w_pad=PADDING, h_pad=row_padding))
        figure.suptitle(title, x=0.01, ha="left", fontsize=TEXT + 3, fontweight="bold")
        axes: Sequence[Sequence[Axes]] = figure.subplots(rows, columns, squeeze=False, **layout)
    return figure, axes


def small_figure(
    rows: int, columns: int, width: float, height: float, **layout: Any
) -> tuple["Figure", Sequence[Sequence["Axes"]]]:
    """Return a figure without a title for a narrow column of text, with its axes by row and column.

    Args:
        rows: Number of rows of axes.
        columns: Number of columns of axes.
        width: [inch].
        height: [inch].
        layout: Further arguments of `Figure.subplots`.
    """
    import matplotlib
    from matplotlib.figure import Figure

    sizes = {key: SMALL_TEXT for key in _STYLE if key.endswith(("size", "fontsize")) and key != "lines.markersize"}
    with matplotlib.rc_context({**_STYLE, **sizes}):
        figure = Figure(figsize=(width, height), layout="constrained")
        axes: Sequence[Sequence[Axes]] = figure.subplots(rows, columns, squeeze=False, **layout)
    return figure, axes


def legend_below(figure: "Figure", handles: Sequence[Any] | None = None) -> None:
    """Put one legend for the whole figure below it, in one row; without `handles` it takes the labelled lines."""
    more = {} if handles is None else {"handles": handles}
    figure.legend(loc="outside lower center", ncols=8, frameon=False, fontsize=TEXT, **more)


def save(figure: "Figure", path: Path) -> None:
    """Write a figure as PNG; the file appears whole or not at all.

    Raises:
        InputError: The folder does not exist or cannot be written to.
    """
    with replacing(path) as partial:
        figure.savefig(partial, format="png", dpi=PIXELS_PER_INCH)


def svg_of(figure: "Figure", salt: str) -> str:
    """Return a figure as SVG; the same figure gives the same text: no date, and ids that depend on `salt` alone."""
    import matplotlib

    file = BytesIO()
    with matplotlib.rc_context({"svg.hashsalt": salt}):
        figure.savefig(file, format="svg", dpi=RASTER_DPI, metadata={"Date": None})
    return file.getvalue().decode()
