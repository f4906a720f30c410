"""A diagnosis as a Rerun recording: runs replayed, measured against simulated, and how likely each explanation is."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from bench.diagnose.diagnose import Diagnosis
from bench.diagnose.replay.world import World
from bench.diagnose.verdict import Verdict
from bench.report.diagnosis.curves import plots_of
from bench.report.diagnosis.names import explanation_name
from bench.report.diagnosis.numbers import percent
from bench.report.diagnosis.readings import Readings
from bench.report.diagnosis.recording_clock import RecordingClock, recording_clock_of
from bench.report.diagnosis.words import words_of
from bench.report.recording.compared import log_compared
from bench.report.recording.curves import JOINT_COLOURS, Plot, log_plots
from bench.report.recording.events import log_events
from bench.report.recording.layout import event_view, robot_view, with_plots
from bench.report.recording.library import expect_rerun
from bench.report.recording.poses import Poses, elastic_poses, rigid_poses
from bench.report.recording.scene import floor_height, scene_of
from bench.report.recording.write import MAGNIFICATION, extent_of
from bench.report.recording.writer import RecordingWriter, identity_of, recording_to
from bench.robot.compiled import CompiledRobot
from bench.simulate.trace import Trace

if TYPE_CHECKING:
    from rerun.blueprint import Blueprint, View


def write_diagnosis_recording(path: Path, diagnosis: Diagnosis, readings: Readings) -> None:
    """Write the recording of a diagnosis (.rrd); an existing file is replaced, after an error nothing is left behind.

    Args:
        path: File to write.
        diagnosis: What to show.
        readings: Its readings.

    Raises:
        InputError: The file cannot be written.
        RobotError: The scene that the robot's figures name does not compile.
        NoLibraryError: Rerun's library cannot be loaded.
    """
    expect_rerun()
    compiled = diagnosis.linear.replay.compiled
    time = recording_clock_of(diagnosis.linear)
    trace, robot, ghost = _poses(diagnosis, time)
    scene = scene_of(compiled)
    plots = plots_of(readings, time)
    title = compiled.robot.figures.title
    against = "the nominal one" if readings.extended is not None else "the rigid robot"
    words = f"Robot with deflection x{MAGNIFICATION:g}: as found (colour) over {against} (translucent)"
    floor = floor_height(scene)
    blueprint = _layout(words, floor, compiled, robot, diagnosis.verdict, plots)
    identity = identity_of((readings.before, np.nan_to_num(readings.measured), trace.theta, time.seconds))
    with recording_to(path, time.seconds, identity, f"Diagnosis of {title}", blueprint) as writer:
        log_compared(writer, scene, compiled, trace, robot, ghost)
        log_plots(writer, tuple({plot.path: plot for plot in plots}.values()))
        log_events(writer, time.begins)
        _log_verdict(writer, diagnosis.verdict)


def _poses(diagnosis: Diagnosis, time: RecordingClock) -> tuple[Trace, Poses, Poses]:
    """Return the motion as found, and the poses of the robot and of what it is compared with, frame by frame."""
    linear, naming = diagnosis.linear, diagnosis.naming
    fit = diagnosis.extension or naming.null
    world = fit.world(linear)
    trace = linear.replay.trace(world)[time.frame]
    robot = elastic_poses(linear.replay.compiled, trace, MAGNIFICATION)
    if not fit.causes:
        return trace, robot, rigid_poses(linear.replay.compiled, trace)
    nominal = linear.replay.trace(World(world.deviations))[time.frame]
    return trace, robot, elastic_poses(linear.replay.compiled, nominal, MAGNIFICATION)


def _log_verdict(writer: RecordingWriter, verdict: Verdict) -> None:
    """Log the verdict in words, and one bar for each explanation that was fitted."""
    import rerun as rr

    head, *lines = words_of(verdict)
    text = "\n".join([f"## {head}", "```", *lines, "```"] if lines else [f"## {head}"])
    writer.fixed("verdict", rr.TextDocument(text, media_type="text/markdown"))
    for i, explanation in enumerate((*verdict.explanations, *verdict.rivals)):
        name = f"{i + 1}: {explanation_name(explanation)} ({percent(explanation.fitted_probability)})"
        colour = JOINT_COLOURS[i % len(JOINT_COLOURS)]
        bar = rr.BarChart([100 * explanation.fitted_probability], abscissa=[i + 1], widths=[0.8], color=colour)
        writer.fixed(f"probability/{rr.escape_entity_path_part(name)}", bar)


def _layout(
    words: str, floor: float, compiled: CompiledRobot, robot: Poses, verdict: Verdict, plots: tuple[Plot, ...]
) -> "Blueprint":
    import rerun.blueprint as rrb

    below: list[View] = [rrb.TextDocumentView(origin="verdict", name="Verdict")]
    if verdict.explanations:
        below.append(rrb.BarChartView(origin="probability", name="Probability of each explanation [%]"))
    below.append(event_view("Runs"))
    view = robot_view(words, floor, extent_of(compiled, robot, floor))
    return with_plots(rrb.Vertical(view, rrb.Tabs(*below), row_shares=[3, 2]), plots)
