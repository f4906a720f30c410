"""A prediction as a Rerun recording: the runs replayed with the model, every channel measured and predicted."""

from pathlib import Path

import numpy as np

from bench.predict.prediction import PredictedRecording
from bench.report.diagnosis.curves import MEASURED, MEASURED_WIDTH, SIMULATED_WIDTH, WITH, WITHOUT
from bench.report.diagnosis.names import capital, channel_name
from bench.report.diagnosis.numbers import workshop
from bench.report.diagnosis.recording_clock import RecordingClock, recording_clock_of
from bench.report.recording.compared import log_compared
from bench.report.recording.curves import JOINT_COLOURS, Curve, Plot, log_plots
from bench.report.recording.events import log_events
from bench.report.recording.layout import layout
from bench.report.recording.library import expect_rerun
from bench.report.recording.poses import elastic_poses, rigid_poses
from bench.report.recording.scene import floor_height, scene_of
from bench.report.recording.write import MAGNIFICATION, extent_of
from bench.report.recording.writer import identity_of, recording_to


def write_prediction_recording(path: Path, recording: PredictedRecording) -> None:
    """Write a recording as predicted (.rrd); an existing file is replaced, after an error nothing is left behind.

    Args:
        path: File to write.
        recording: What to show.

    Raises:
        InputError: The file cannot be written.
        RobotError: The scene that the robot's figures name does not compile.
        NoLibraryError: Rerun's library cannot be loaded.
    """
    expect_rerun()
    replay = recording.linear.replay
    compiled, clock = replay.compiled, recording_clock_of(recording.linear)
    trace = replay.trace(recording.world)[clock.frame]
    robot, rigid = elastic_poses(compiled, trace, MAGNIFICATION), rigid_poses(compiled, trace)
    scene = scene_of(compiled)
    floor = floor_height(scene)
    plots = tuple(_plots(recording, clock))
    blueprint = layout(plots, MAGNIFICATION, floor, extent_of(compiled, robot, floor), (), with_events=True)
    identity = identity_of((np.nan_to_num(recording.error), np.nan_to_num(recording.measured), clock.seconds))
    title = f"Prediction of {compiled.robot.figures.title}"
    with recording_to(path, clock.seconds, identity, title, blueprint) as writer:
        log_compared(writer, scene, compiled, trace, robot, rigid)
        log_plots(writer, plots)
        log_events(writer, clock.begins)


def _plots(recording: PredictedRecording, clock: RecordingClock) -> list[Plot]:
    """Return every channel by kind, and what is left of it, all channels of a kind and unit in one plot."""
    found = []
    left: dict[tuple[str, str], list[Curve]] = {}
    for c, quantity in enumerate(recording.linear.quantities):
        if not np.any(np.isfinite(recording.error[:, c])):
            continue
        unit, scale = workshop(quantity.unit)
        measured, error = recording.measured[:, c], recording.error[:, c]
        curves = [Curve("measured", scale * clock.curve(measured), MEASURED, MEASURED_WIDTH)]
        if np.any(np.isfinite(recording.nominal_error[:, c])):
            nominal = measured - recording.nominal_error[:, c]
            curves.append(Curve("nominal", scale * clock.curve(nominal), WITHOUT, SIMULATED_WIDTH))
        curves.append(Curve("predicted", scale * clock.curve(measured - error), WITH, SIMULATED_WIDTH))
        tab, name = capital(channel_name(f"{quantity.kind}_")), channel_name(quantity.column)
        found.append(Plot(tab, f"{capital(name)} [{unit}]", f"channels/{quantity.column}", tuple(curves)))
        same = left.setdefault((quantity.kind, unit), [])
        colour = JOINT_COLOURS[len(same) % len(JOINT_COLOURS)]
        same.append(Curve(name, scale * clock.curve(error), colour, SIMULATED_WIDTH))
    for (kind, unit), some in left.items():
        title = f"{capital(channel_name(f'{kind}_'))}, left by the model [{unit}]"
        found.append(Plot("Left over", title, f"left/{kind}_{unit}", tuple(some)))
    return found
