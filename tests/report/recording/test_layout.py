"""The layout in which the viewer opens a recording."""

import numpy as np
import pytest
import rerun.blueprint as rrb

from bench.report.recording.curves import SINGLE, Curve, Plot, plots_of
from bench.report.recording.layout import layout
from bench.report.recording.scene import floor_height, scene_of
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from bench.simulate.session import Film
from tests.report.films import without

EXTENT = np.array([[0.0, -1.0, -0.2], [2.0, 1.0, 2.0]])


def views_of(part: rrb.Container | rrb.View) -> list[rrb.View]:
    if isinstance(part, rrb.View):
        return [part]
    return [view for content in part.contents for view in views_of(content)]


def laid_out(plots: tuple[Plot, ...], with_events: bool = True) -> list[rrb.View]:
    blueprint = layout(plots, 250.0, -0.2, EXTENT, trails=("robot/rigid/path",), with_events=with_events)
    return views_of(blueprint.root_container)


def test_one_view_per_plot_and_the_magnification_in_the_title(film: Film, compiled: CompiledRobot) -> None:
    plots = plots_of(film, compiled)
    robot, events, *series = laid_out(plots)
    assert "x250" in str(robot.name)
    assert isinstance(events, rrb.TextLogView)
    assert [view.name for view in series] == [plot.title for plot in plots]
    assert all("[" in plot.title for plot in plots), "every plot names its unit"
    assert len({plot.path for plot in plots}) == len(plots)


def test_a_legend_that_says_the_same_again_is_left_out() -> None:
    """It covered the first second of every plot, six times over."""
    names = ("measured", "predicted"), ("measured", "predicted"), ("left",), ("left",)
    plots = [
        Plot("tab", f"plot {k}", f"plot{k}", tuple(Curve(name, np.ones(9), SINGLE) for name in some))
        for k, some in enumerate(names)
    ]
    _, *series = laid_out(tuple(plots), with_events=False)
    shown = [view.properties["PlotLegend"].visible.as_arrow_array().to_pylist() for view in series]  # type: ignore[attr-defined]
    assert shown == [[True], [False], [True], [False]]


def test_no_view_for_what_there_is_not(film: Film, compiled: CompiledRobot) -> None:
    plots = plots_of(without(film, "current", "gas_pressure"), compiled)
    views = laid_out(plots, with_events=False)
    assert len(views) == 1 + len(plots)
    assert not [plot for plot in plots if plot.path in ("current", "counterbalance/pressure")]


def test_axis_leaves_rare_extremes_out() -> None:
    values = np.concatenate([np.linspace(-1, 1, 1000), [np.nan, 50.0]])
    span = Plot("tab", "title", "path", (Curve("a", values, SINGLE),)).span
    assert span
    assert -2 < span[0] < -1
    assert 1 < span[1] < 2


def test_constant_curves_leave_the_axis_to_the_viewer() -> None:
    assert Plot("tab", "title", "path", (Curve("a", np.ones(9), SINGLE),)).span is None


def test_scene_of_the_real_robot_has_a_floor(compiled: CompiledRobot) -> None:
    scene = scene_of(compile_robot(load_robot("hh150")))
    assert floor_height(scene) == pytest.approx(-0.25)
    assert scene_of(compiled) is compiled.model  # a robot without a scene
    assert floor_height(compiled.model) == 0.0
