"""How the Rerun viewer lays a recording out when it opens it."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from bench.report.recording.curves import Colour, Plot
from bench.report.recording.writer import TIMELINE
from bench.robot.bodies import Array

if TYPE_CHECKING:
    from rerun.blueprint import Blueprint, Container, View

TRAIL = 60.0  # [s], how long the way of a point stays visible
PLAYBACK_SPEED = 4.0
BACKGROUND = [38, 43, 50]
AZIMUTH = -0.8  # [rad], from the robot to the eye, against x
ELEVATION = 0.25  # [rad], of the eye above the middle of the robot
DISTANCE = 0.8  # of the eye, in diagonals of what it should see


def layout(
    plots: Sequence[Plot], magnification: float, floor: float, extent: Array, trails: Sequence[str], with_events: bool
) -> "Blueprint":
    """Return the layout: the robot on the left, the plots in tabs on the right, the events below the robot.

    Args:
        plots: What the tabs show.
        magnification: Of the deflection; stands in the view's title.
        floor: Height of the grid [m].
        extent: Shape (2, 3) [m], lower and upper corner of what the 3D view should show.
        trails: Entity paths of points that leave a trail.
        with_events: Whether there are any.
    """
    import rerun.blueprint as rrb

    title = f"Joint deflection x{magnification:g} (colour) over the rigid robot (translucent)"
    robot: list[View] = [robot_view(title, floor, extent, trails)]
    if with_events:
        robot.append(event_view("Events"))
    return with_plots(rrb.Vertical(*robot, row_shares=[4, 1][: len(robot)]), plots)


def event_view(title: str) -> "View":
    """Return the text log of everything under `events`."""
    import rerun.blueprint as rrb

    return rrb.TextLogView(
        origin="events",
        name=title,
        columns=rrb.TextLogColumns(
            timeline_columns=[rrb.encodings.TimelineColumn(TIMELINE, visible=False)], text_log_columns=["Body"]
        ),
    )


def with_plots(left: "Container", plots: Sequence[Plot]) -> "Blueprint":
    """Return a layout with something on the left and the plots in tabs on the right; the panels are folded."""
    import rerun.blueprint as rrb

    tabs = [
        rrb.Vertical(*_plot_views([plot for plot in plots if plot.tab == tab]), name=tab)
        for tab in dict.fromkeys(plot.tab for plot in plots)
    ]
    return rrb.Blueprint(
        rrb.Horizontal(left, rrb.Tabs(*tabs), column_shares=[1.15, 1]),
        rrb.TimePanel(state="collapsed", timeline=TIMELINE, playback_speed=PLAYBACK_SPEED),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
    )


def robot_view(title: str, floor: float, extent: Array, trails: Sequence[str] = ()) -> "View":
    """Return the 3D view of everything under `scene`, `robot` and `tracker`.

    Args:
        title: Of the view.
        floor: Height of the grid [m].
        extent: Shape (2, 3) [m], lower and upper corner of what it should show.
        trails: Entity paths of points that leave a trail.
    """
    import rerun as rr
    import rerun.blueprint as rrb

    centre = extent.mean(axis=0)
    direction = np.cos(ELEVATION) * np.array([np.cos(AZIMUTH), np.sin(AZIMUTH), np.tan(ELEVATION)])
    eye = centre + DISTANCE * np.linalg.norm(extent[1] - extent[0]) * direction
    trail = rrb.VisibleTimeRanges(
        timeline=TIMELINE,
        start=rrb.TimeRangeBoundary.cursor_relative(seconds=-TRAIL),
        end=rrb.TimeRangeBoundary.cursor_relative(),
    )
    return rrb.Spatial3DView(
        origin="/",
        contents=["+ /scene/**", "+ /robot/**", "+ /tracker/**"],
        name=title,
        background=BACKGROUND,
        line_grid=rrb.LineGrid3D(
            spacing=0.5,
            plane=rr.components.Plane3D.XY.with_distance(floor),
            color=[120, 130, 140, 60],
            stroke_width=1.0,
        ),
        eye_controls=rrb.EyeControls3D(kind="Orbital", position=eye, look_target=centre, eye_up=[0, 0, 1]),
        overrides={path: [trail] for path in trails},
    )


def _plot_views(plots: Sequence[Plot]) -> list["View"]:
    """Return the plots of a tab; a legend covers a part of a plot, so each that says the same again is left out."""
    import rerun.blueprint as rrb

    views: list[View] = []
    told: list[tuple[str, Colour]] = []
    for plot in plots:
        before, told = told, [(curve.name, curve.colour) for curve in plot.curves]
        views.append(
            rrb.TimeSeriesView(
                origin=plot.path,
                name=plot.title,
                axis_x=rrb.TimeAxis(link="LinkToGlobal"),  # all plots show the same time
                axis_y=None if plot.span is None else rrb.ScalarAxis(range=plot.span),
                plot_legend=rrb.PlotLegend(rrb.Corner2D.LeftTop, visible=told != before),
            )
        )
    return views
