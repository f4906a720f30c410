"""Figs. 4 to 6 show the map as it is, and the published bounds stand beside our numbers."""

from pathlib import Path

import numpy as np
import pytest

from bench.identify.complementary_map import ComplementaryMap, Grid
from bench.identify.complementary_prediction import PredictionError
from bench.report.figures.style import save
from bench.report.paper.complementary.figures import figure_4, figure_5, figure_6, prediction_bounds

JOINTS = ("hinge_a", "hinge_b")


@pytest.fixture(scope="module")
def made() -> ComplementaryMap:
    """Make a map whose relative error is known: that of joint a grows along the first axis, b has none."""
    grid = Grid(np.zeros(2), (0, 1), np.linspace(-0.5, 1.0, 16), np.linspace(-1.0, 1.0, 11))
    stiffness = np.array([2e5, 1e5])
    error = np.zeros((16, 11, 2))
    error[..., 0] = np.linspace(0, 0.15, 16)[:, None]
    torque = np.full((16, 11, 2), 300.0)
    return ComplementaryMap(grid, stiffness, torque, torque / (stiffness * (1 + error)))


@pytest.fixture(scope="module")
def prediction(made: ComplementaryMap) -> PredictionError:
    position = np.where(made.zone(), 0.06, np.nan)
    return PredictionError(position, 4e-3 * position)


def colours(axes: object) -> np.ndarray:
    """Return which cells of a panel have a colour, shape (second, first)."""
    (mesh,) = axes.collections  # type: ignore[attr-defined]
    return ~np.ma.getmaskarray(mesh.get_array())


def test_figure_4_shows_no_colour_above_10_percent(made: ComplementaryMap) -> None:
    first, second = figure_4(made, JOINTS).axes[:2]
    assert np.array_equal(colours(first), (made.relative_error[..., 0] < 0.10).T)
    assert colours(second).all()
    assert first.get_title() == "hinge_a: 31.2 % below 5 %"  # 5 of 16 columns: 0, 1, 2, 3, 4 %
    assert first.get_xlabel() == "hinge_a [deg]"
    assert first.get_ylabel() == "hinge_b [deg]"


def test_figure_5_shows_no_colour_outside_the_zone(made: ComplementaryMap, prediction: PredictionError) -> None:
    position, orientation = figure_5(prediction, made.grid, JOINTS).axes[:2]
    assert np.array_equal(colours(position), made.zone().T)
    assert np.array_equal(colours(orientation), made.zone().T)
    assert "6.0 %" in position.get_title()


def test_figure_6_is_the_zone(made: ComplementaryMap) -> None:
    (axes,) = figure_6(made, JOINTS).axes
    assert np.array_equal(colours(axes), made.zone().T)


def test_bounds_stand_beside_the_paper_s(prediction: PredictionError) -> None:
    position, orientation = prediction_bounds(prediction)
    assert (position.ours, position.paper) == (pytest.approx(0.06), 0.07)
    assert position.difference == pytest.approx(-0.01)
    assert orientation.unit == "rad"
    assert orientation.difference == pytest.approx(0.06 * 4e-3 - 3e-4)


def test_figures_can_be_saved(made: ComplementaryMap, prediction: PredictionError, tmp_path: Path) -> None:
    with np.errstate(all="warn"):  # Matplotlib underflows where it fits text
        for name, figure in (
            ("4", figure_4(made, JOINTS)),
            ("5", figure_5(prediction, made.grid, JOINTS)),
            ("6", figure_6(made, JOINTS)),
        ):
            save(figure, tmp_path / f"{name}.png")
            assert (tmp_path / f"{name}.png").stat().st_size > 10_000
