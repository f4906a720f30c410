"""The counterbalance in a Rerun recording: a housing and a rod between the ends of its tendon."""

from dataclasses import dataclass

import mujoco
import numpy as np

from bench.report.recording.poses import Poses
from bench.report.recording.writer import RecordingWriter
from bench.robot.bodies import Array
from bench.robot.compiled import CompiledRobot

HOUSING_RADIUS, ROD_RADIUS = 0.055, 0.024  # [m], to look at; no figure of the robot
OVERLAP = 0.15  # of the housing's length that the rod still fills when it is out farthest
HOUSING = np.array([58, 110, 165, 255], dtype=np.uint8)
ROD = np.array([196, 202, 210, 255], dtype=np.uint8)


@dataclass(frozen=True)
class Telescope:
    """Lengths of the two parts that fit a cylinder over its whole stroke.

    Attributes:
        housing: [m], from the anchor on the fixed side; never longer than the cylinder is.
        rod: [m], from the anchor on the moving side; reaches into the housing as long as the stroke allows.
    """

    housing: float
    rod: float


def telescope(length: Array) -> Telescope:
    """Return housing and rod for a cylinder that takes the lengths `length`, shape (T,) [m]."""
    shortest, longest = float(np.min(length)), float(np.max(length))
    housing = 0.9 * shortest
    return Telescope(housing, min(shortest, longest - (1 - OVERLAP) * housing))


def anchors_of(compiled: CompiledRobot, poses: Poses) -> tuple[Array, Array]:
    """Return the ends of the counterbalance's tendon, both shape (T, 3) [m], in the order of the MJCF."""
    model, tendon = compiled.model, compiled.at.counterbalance_tendon
    wraps = range(model.tendon_adr[tendon], model.tendon_adr[tendon] + model.tendon_num[tendon])
    sites = [int(model.wrap_objid[i]) for i in wraps if model.wrap_type[i] == mujoco.mjtWrap.mjWRAP_SITE]
    return poses.site_position[:, sites[0]], poses.site_position[:, sites[-1]]


def log_cylinder(writer: RecordingWriter, root: str, compiled: CompiledRobot, poses: Poses) -> None:
    """Log housing and rod under the entity `root`; nothing for a robot without one. Arguments as in `log_arm`."""
    import rerun as rr

    if compiled.at.counterbalance < 0:
        return
    fixed, moving = anchors_of(compiled, poses)
    along = moving - fixed
    parts = telescope(np.linalg.norm(along, axis=1))
    for name, start, direction, reach, radius, colour in (
        ("housing", fixed, along, parts.housing, HOUSING_RADIUS, HOUSING),
        ("rod", moving, -along, parts.rod, ROD_RADIUS, ROD),
    ):
        writer.pose(f"{root}/{name}", start, turned_to(direction))
        shape = rr.Cylinders3D(
            lengths=[reach],
            radii=[radius],
            centers=[[0, 0, reach / 2]],
            colors=[colour],
            fill_mode="solid",
        )
        writer.fixed(f"{root}/{name}", shape)


def turned_to(direction: Array) -> Array:
    """Return quaternions, shape (T, 4), w x y z, that turn the z axis to `direction`, shape (T, 3), not zero."""
    quaternion = np.empty((len(direction), 4))
    for i, vector in enumerate(direction):
        mujoco.mju_quatZ2Vec(quaternion[i], vector / np.linalg.norm(vector))
    return quaternion
