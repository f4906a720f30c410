"""A Rerun file that is being written: one timeline, everything on it or fixed, whole columns at a time."""

import hashlib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING
from uuid import UUID

import numpy as np

from bench.errors import InputError
from bench.report.files import replacing
from bench.robot.bodies import Array

if TYPE_CHECKING:
    from rerun import AsComponents, ComponentColumnList, RecordingStream, TimeColumn
    from rerun.blueprint import Blueprint

APPLICATION = "bench"
TIMELINE = "time"


@dataclass(frozen=True)
class RecordingWriter:
    """An open recording and the T times that everything in it shares.

    Attributes:
        stream: The recording.
        time: The T times, on the timeline `TIMELINE`.
    """

    stream: "RecordingStream"
    time: "TimeColumn"

    def fixed(self, path: str, *things: "AsComponents") -> None:
        """Log what does not change."""
        self.stream.log(path, *things, static=True)

    def moving(self, path: str, columns: "ComponentColumnList") -> None:
        """Log what has one row per time."""
        self.stream.send_columns(path, indexes=[self.time], columns=columns)

    def pose(self, path: str, position: Array, quaternion: Array) -> None:
        """Log the pose of an entity: position (T, 3) [m] and quaternion (T, 4), w x y z."""
        import rerun as rr

        self.moving(path, rr.Transform3D.columns(translation=position, quaternion=xyzw(quaternion)))


def xyzw(quaternion: Array) -> Array:
    """Return MuJoCo's quaternions w x y z, shape (..., 4), in Rerun's order."""
    return np.roll(quaternion, -1, axis=-1)


def identity_of(arrays: Iterable[Array]) -> str:
    """Return a recording id that depends on the content alone, so that the same content is the same recording."""
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(np.ascontiguousarray(array).tobytes())
    return str(UUID(bytes=digest.digest()[:16], version=4))


@contextmanager
def recording_to(
    path: Path, time: Array, recording_id: str, name: str, blueprint: "Blueprint"
) -> Iterator[RecordingWriter]:
    """Open a recording; the file appears under its name once it is complete, and not at all after an error.

    Args:
        path: File to write, replaced if it exists.
        time: Shape (T,) [s].
        recording_id: Recordings with the same one are merged by the viewer.
        name: What the viewer calls the recording.
        blueprint: Layout in which the viewer opens it.

    Raises:
        InputError: The file cannot be written, or the variable RERUN of the environment turns recording off.
    """
    import rerun as rr

    stream = rr.RecordingStream(APPLICATION, recording_id=recording_id, send_properties=False)
    if not rr.is_enabled(stream):
        raise InputError("RERUN: this environment variable turns Rerun off; unset it to write a recording.")
    with replacing(path) as partial:
        # Rerun's own writer waits for ever, or says nothing, where a disk is full
        memory = stream.memory_recording()
        try:
            stream.send_blueprint(blueprint, make_active=True, make_default=True)
            stream.send_recording_name(name)
            yield RecordingWriter(stream, rr.TimeColumn(TIMELINE, duration=time))
            partial.write_bytes(memory.drain_as_bytes())
        finally:
            stream.disconnect()
