"""What acts on the robot and what watches it in a Rerun recording: load, laser tracker, single points, ways."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bench.report.recording.cylinder import turned_to
from bench.report.recording.deflection import UNLOADED_SHARE
from bench.report.recording.writer import RecordingWriter
from bench.robot.bodies import Array

Colour = tuple[int, int, int]

ARROW_LENGTH = 1.0  # [m], of the arrow for the robot's rated force
LOAD: Colour = (255, 196, 0)
TRACKER: Colour = (222, 226, 230)
STAND: Colour = (90, 96, 104)
BEAM: Colour = (255, 70, 70)
HEAD = (0.07, 0.07, 0.09)  # [m], half sizes of the tracker's head; its lens looks along z
STAND_RADIUS = 0.03  # [m]
LINE_WIDTH = 1.0  # [px]


def log_load(writer: RecordingWriter, path: str, point: Array, force: Array, rating: float) -> None:
    """Log the load as an arrow with its size in N; no arrow while there is none.

    Args:
        writer: Where to.
        path: Entity path.
        point: Shape (T, 3) [m], where it acts.
        force: Shape (T, 3) [N].
        rating: Force [N] that is drawn `ARROW_LENGTH` long.
    """
    import rerun as rr

    size = np.linalg.norm(force, axis=1)
    loaded = size > UNLOADED_SHARE * rating
    arrows = rr.Arrows3D.columns(
        vectors=force[loaded] * (ARROW_LENGTH / rating),
        origins=point[loaded],
        labels=[f"{newtons:.0f} N" for newtons in size[loaded]],
    )
    writer.fixed(path, rr.Arrows3D.from_fields(colors=[LOAD], radii=[0.025]))
    writer.moving(path, arrows.partition(loaded.astype(int)))


def log_point(writer: RecordingWriter, path: str, position: Array, colour: Colour, radius: float) -> None:
    """Log a point, shape (T, 3) [m]; it is left out where it is nan."""
    import rerun as rr

    seen = np.all(np.isfinite(position), axis=1)
    writer.fixed(path, rr.Points3D.from_fields(colors=[colour], radii=[radius]))
    writer.moving(path, rr.Points3D.columns(positions=position[seen]).partition(seen.astype(int)))


def log_path(writer: RecordingWriter, path: str, position: Array, shown: NDArray[np.bool_], colour: Colour) -> None:
    """Log the way of a point, shape (T, 3) [m], as the step since the instant before; `shown`, shape (T,), says where.

    The layout keeps the steps of the last seconds in view, so that they join to a trail.
    """
    import rerun as rr

    joined = shown & np.roll(shown, 1)
    joined[0] = False
    steps = np.stack([np.roll(position, 1, axis=0), position], axis=1)[joined]
    writer.fixed(path, rr.LineStrips3D.from_fields(colors=[colour], radii=rr.Radius.ui_points(LINE_WIDTH)))
    writer.moving(path, rr.LineStrips3D.columns(strips=steps).partition(joined.astype(int)))


def log_tracker(writer: RecordingWriter, root: str, station: Sequence[float], floor: float, target: Array) -> None:
    """Log a laser tracker that looks at `target`, shape (T, 3) [m], with its line of sight; nan: it sees nothing."""
    import rerun as rr

    seen = np.all(np.isfinite(target), axis=1)
    if not seen.any():
        return
    eye = np.array(station, dtype=np.float64)
    stand = float(eye[2]) - floor
    writer.fixed(
        f"{root}/stand",
        rr.Cylinders3D(
            lengths=[stand],
            radii=[STAND_RADIUS],
            centers=[eye - [0, 0, stand / 2]],
            colors=[STAND],
            fill_mode="solid",
        ),
    )
    writer.fixed(f"{root}/head", rr.Boxes3D(half_sizes=[HEAD], colors=[TRACKER], fill_mode="solid"))
    towards = np.where(seen[:, None], target - eye, [0.0, 0.0, 1.0])
    writer.pose(f"{root}/head", np.tile(eye, (len(target), 1)), turned_to(towards))
    writer.fixed(
        f"{root}/line_of_sight", rr.LineStrips3D.from_fields(colors=[BEAM], radii=rr.Radius.ui_points(LINE_WIDTH))
    )
    beams = rr.LineStrips3D.columns(strips=np.stack([np.tile(eye, (seen.sum(), 1)), target[seen]], axis=1))
    writer.moving(f"{root}/line_of_sight", beams.partition(seen.astype(int)))
