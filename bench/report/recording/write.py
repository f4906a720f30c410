"""A Rerun recording of an experiment: the robot, what acts on it, what the instruments saw, and the truth."""

from dataclasses import fields
from pathlib import Path

import numpy as np

from bench.errors import InputError
from bench.report.recording.compared import ROBOT, log_compared
from bench.report.recording.curves import log_plots, plots_of
from bench.report.recording.deflection import deflection_of, is_standing
from bench.report.recording.events import log_events
from bench.report.recording.layout import layout
from bench.report.recording.library import expect_rerun
from bench.report.recording.poses import Poses, elastic_poses, rigid_poses
from bench.report.recording.scene import floor_height, scene_of
from bench.report.recording.surroundings import Colour, log_path, log_point, log_tracker
from bench.report.recording.writer import RecordingWriter, identity_of, recording_to
from bench.robot.bodies import Array
from bench.robot.compiled import CompiledRobot
from bench.simulate.session import Film

MAGNIFICATION = 100.0  # of the wind-up of the elastic elements
RIGID_POINT: Colour = (150, 190, 230)
ELASTIC_POINT: Colour = (255, 90, 90)
MEASURED_POINT: Colour = (240, 228, 66)
POINT_RADIUS = 0.02  # [m]
RIGID = "robot/rigid"
RIGID_PATH, ELASTIC_PATH = f"{RIGID}/path", f"{ROBOT}/path"


def write_recording(path: Path, compiled: CompiledRobot, film: Film, magnification: float = MAGNIFICATION) -> None:
    """Write a film as a Rerun file (.rrd), laid out for looking at it with `bench view`.

    Args:
        path: File to write; an existing one is replaced. After an error nothing is left behind.
        compiled: The robot that was filmed.
        film: The experiment, T instants.
        magnification: Of the wind-up of the elastic elements in the 3D view: theta = q + magnification (theta - q).

    Raises:
        InputError: The film is empty, or the file cannot be written.
        RobotError: The scene that the robot's figures name does not compile.
        NoLibraryError: Rerun's library cannot be loaded.
    """
    expect_rerun()
    if not len(film.trace):
        raise InputError(f"{path}: the film holds no instant, so there is nothing to write.")
    plots = plots_of(film, compiled)
    rigid, elastic = rigid_poses(compiled, film.trace), elastic_poses(compiled, film.trace, magnification)
    scene = scene_of(compiled)
    floor = floor_height(scene)
    blueprint = layout(
        plots,
        magnification=magnification,
        floor=floor,
        extent=extent_of(compiled, rigid, floor),
        trails=(RIGID_PATH, ELASTIC_PATH),
        with_events=bool(film.events),
    )
    with recording_to(path, film.trace.time, _identity(film), compiled.robot.figures.title, blueprint) as writer:
        log_compared(writer, scene, compiled, film.trace, elastic, rigid, RIGID)
        _log_points(writer, compiled, film, rigid, elastic, magnification, floor)
        log_plots(writer, plots)
        log_events(writer, film.events)


def _log_points(
    writer: RecordingWriter,
    compiled: CompiledRobot,
    film: Film,
    rigid: Poses,
    elastic: Poses,
    magnification: float,
    floor: float,
) -> None:
    """Log what hangs on the points of the two robots: reference points, and the tracker with what it measured."""
    at, figures = compiled.at, compiled.robot.figures
    site = at.reflectors[0] if len(at.reflectors) else at.load_point
    rigid_reference, reference = (poses.site_position[:, site] for poses in (rigid, elastic))
    log_point(writer, f"{RIGID}/reference_point", rigid_reference, RIGID_POINT, POINT_RADIUS)
    log_point(writer, f"{ROBOT}/reference_point", reference, ELASTIC_POINT, POINT_RADIUS)
    log_path(writer, RIGID_PATH, rigid_reference, np.full(len(film.trace), True), RIGID_POINT)
    log_path(writer, ELASTIC_PATH, reference, is_standing(film), ELASTIC_POINT)  # links ring while it moves
    tracker = figures.instruments.tracker
    if tracker is not None:
        # The error of the deflection, not of the position: what is wrong with the tracker's frame cancels in it.
        deflection = deflection_of(film)
        measured = reference + magnification * (deflection.measured - deflection.true)
        log_point(writer, "tracker/measured", measured, MEASURED_POINT, POINT_RADIUS)
        log_tracker(writer, "tracker", tracker.position_m, floor, np.where(np.isnan(measured), reference, measured))


def extent_of(compiled: CompiledRobot, poses: Poses, floor: float) -> Array:
    """Return the corners of the box that holds floor, robot and tracker, shape (2, 3) [m]."""
    tracker = compiled.robot.figures.instruments.tracker
    robot = np.concatenate([poses.body_position, poses.site_position], axis=1).reshape(-1, 3)
    station = np.reshape(tracker.position_m if tracker else (), (-1, 3))
    everything = np.concatenate([robot, [[0.0, 0.0, floor]], station])
    return np.stack([everything.min(axis=0), everything.max(axis=0)])


def _identity(film: Film) -> str:
    parts = (film.trace, film.reading)
    return identity_of(getattr(part, field.name) for part in parts for field in fields(part))
