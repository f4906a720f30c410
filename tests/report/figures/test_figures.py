"""Figures say what they show, with units, and are drawn without a warning (an overfull layout is one)."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bench.errors import InputError
from bench.identify.estimate import StiffnessEstimate
from bench.report.figures.residuals import residual_figure
from bench.report.figures.stiffness import StiffnessSource, stiffness_figure
from bench.report.figures.style import PIXELS_PER_INCH, WIDTH, save, svg_of

JOINTS = tuple(f"joint{i}" for i in range(1, 7))
K = np.array([0.559, 1.435, 1.829, 0.184, 0.171, 0.070]) * 1e6  # Table 6, current method
FORCE = np.array([0.0, 467, 641, 814, 1078, 814, 641, 467, 0])


def estimate(scale: float, relative_error: float, unknown: int | None = None, n: int = 6) -> StiffnessEstimate:
    compliance = 1 / (scale * K[:n])
    covariance = np.diag((relative_error * compliance) ** 2)
    if unknown is not None:
        compliance[unknown] = covariance[unknown] = covariance[:, unknown] = np.nan
    return StiffnessEstimate("current", JOINTS[:n], compliance, covariance, 20.0, 3.0, np.isfinite(compliance), {}, ())


def sources(n: int = 6) -> list[StiffnessSource]:
    """Real data with a joint that they cannot tell and endless intervals, and a virtual robot."""
    return [
        StiffnessSource(
            "real robot", {"current": estimate(1.0, 0.1, 0, n), "force": estimate(1.2, 0.6, n=n)}, {"paper": K[:n]}
        ),
        StiffnessSource("virtual robot", {"current": estimate(0.98, 0.03, n=n)}, {}, truth=K[:n]),
    ]


def residuals(rng: np.random.Generator) -> dict[str, np.ndarray]:
    channels = {f"current {i}": rng.standard_normal((6, 10)) for i in range(1, 7)}
    channels["current 1"][0, 0] = 99.0
    channels["current 2"][:, 3] = np.nan
    return channels | {"nothing": np.full(3, np.nan)}


@pytest.fixture(params=["stiffness", "residual", "one joint", "one channel"])
def figure(request: pytest.FixtureRequest, rng: np.random.Generator) -> Figure:
    return {
        "stiffness": lambda: stiffness_figure(sources()),
        "residual": lambda: residual_figure(residuals(rng)),
        "one joint": lambda: stiffness_figure(sources(1)),
        "one channel": lambda: residual_figure({"current": rng.standard_normal(5)}),
    }[request.param]()


def test_drawn_at_full_width_with_a_unit_on_every_quantity(figure: Figure, tmp_path: Path) -> None:
    save(figure, tmp_path / "figure.png")
    header = (tmp_path / "figure.png").read_bytes()[:24]
    assert int.from_bytes(header[16:20]) == WIDTH * PIXELS_PER_INCH
    assert [path.name for path in tmp_path.iterdir()] == ["figure.png"]
    without_unit = {"reading", "density"}
    labels = {
        label.splitlines()[-1] for panel in figure.axes for label in (panel.get_xlabel(), panel.get_ylabel()) if label
    }
    assert labels
    assert all("[" in label or label in without_unit or label.startswith("rms") for label in labels), labels


def test_no_text_runs_into_other_text(figure: Figure) -> None:
    """Titles, labels and tick labels of all panels, as they are laid out."""
    figure.draw_without_rendering()
    boxes = []
    for panel in (panel for panel in figure.axes if panel.axison):
        texts = [panel.xaxis.label, panel.yaxis.label, panel._left_title, *panel.texts]
        texts += [*shown_ticks(panel)]
        boxes += [(text.get_text(), text.get_window_extent().padded(-1)) for text in texts if text.get_text()]
    clashes = [(a, b) for i, (a, box) in enumerate(boxes) for b, other in boxes[i + 1 :] if box.overlaps(other)]
    assert not clashes


def shown_ticks(panel: Axes) -> list[object]:
    ticks = []
    for axis, limits in ((panel.xaxis, panel.get_xlim()), (panel.yaxis, panel.get_ylim())):
        low, high = sorted(limits)
        ticks += [
            tick.label1
            for tick in axis.get_major_ticks()
            if low <= tick.get_loc() <= high and tick.label1.get_visible()
        ]
    return ticks


def test_panels_of_the_stiffness_figure() -> None:
    figure = stiffness_figure(sources())
    assert [panel.get_title(loc="left") for panel in figure.axes] == list(JOINTS)
    rows = [label.get_text() for label in figure.axes[0].get_yticklabels()]
    assert rows == ["real robot", "current", "force", "paper", "virtual robot", "current"]
    assert [text.get_text() for text in figure.axes[0].texts] == ["these data cannot tell", "truth"]
    assert [text.get_text() for text in figure.axes[1].texts] == ["truth"]
    points = {line.get_xdata()[0] for line in figure.axes[1].lines if len(line.get_xdata()) == 1}
    assert {1.435, 1.435 * 1.2} <= {round(point, 9) for point in points}  # [1e6 Nm/rad]


def test_unusable_data_are_refused() -> None:
    with pytest.raises(InputError, match="one set of joints"):
        stiffness_figure([])
    with pytest.raises(InputError, match="one set of joints"):
        stiffness_figure([*sources(6), *sources(2)])
    with pytest.raises(InputError, match="no channel"):
        residual_figure({"current": np.array([np.nan])})


def test_the_same_figure_is_the_same_svg() -> None:
    first, second = (svg_of(stiffness_figure(sources(1)), "figure") for _ in range(2))
    assert first == second


def test_nothing_is_left_where_saving_fails(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be written"):
        save(stiffness_figure(sources(1)), tmp_path / "nowhere" / "figure.png")
    assert not list(tmp_path.iterdir())


def test_settings_of_the_user_stay_as_they_are() -> None:
    probe = (
        "import sys, matplotlib; before = matplotlib.rcParams.copy(); import numpy as np;"
        "from bench.report.figures.residuals import residual_figure; residual_figure({'a': np.ones(3)});"
        "assert matplotlib.rcParams.copy() == before; assert 'matplotlib.pyplot' not in sys.modules"
    )
    subprocess.run([sys.executable, "-W", "error", "-c", probe], check=True)
