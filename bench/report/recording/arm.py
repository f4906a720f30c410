"""A robot in a Rerun recording: one entity per body with its pose over time, its geoms fixed under it."""

import mujoco

from bench.report.recording.poses import Poses
from bench.report.recording.shapes import Rgba, colour_of, shape_of, visible_geoms
from bench.report.recording.writer import RecordingWriter, xyzw
from bench.robot.compiled import CompiledRobot

TINTED_SCALE = 0.985


def log_arm(
    writer: RecordingWriter, root: str, compiled: CompiledRobot, poses: Poses, tint: Rgba | None = None
) -> None:
    """Log the bodies that the joints move, under the entity `root`.

    Args:
        writer: Where to.
        root: Entity path, such as "robot/elastic".
        compiled: The robot.
        poses: T instants.
        tint: Shape (4,), one colour for all; None keeps the colours of the MJCF. A tinted arm is drawn a hair smaller,
            so that one in its own colours hides it where the two coincide and no surfaces flicker.
    """
    model = compiled.model
    geoms = [geom for geom in visible_geoms(model) if model.body_weldid[model.geom_bodyid[geom]] != 0]
    for body in _bodies_of(model, geoms):
        path = f"{root}/{_body_name(model, body)}"
        writer.pose(path, poses.body_position[:, body], poses.body_quaternion[:, body])
    _log_geoms(writer, root, model, geoms, tint)


def log_standing_bodies(writer: RecordingWriter, root: str, model: mujoco.MjModel) -> None:
    """Log the bodies of a model that no joint moves, under the entity `root`."""
    import rerun as rr

    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    geoms = [geom for geom in visible_geoms(model) if model.body_weldid[model.geom_bodyid[geom]] == 0]
    for body in _bodies_of(model, geoms):
        pose = rr.Transform3D(translation=data.xpos[body], quaternion=rr.Quaternion(xyzw=xyzw(data.xquat[body])))
        writer.fixed(f"{root}/{_body_name(model, body)}", pose)
    _log_geoms(writer, root, model, geoms, None)


def _bodies_of(model: mujoco.MjModel, geoms: list[int]) -> list[int]:
    return sorted({int(model.geom_bodyid[geom]) for geom in geoms})


def _log_geoms(writer: RecordingWriter, root: str, model: mujoco.MjModel, geoms: list[int], tint: Rgba | None) -> None:
    import rerun as rr

    for geom in geoms:
        name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_GEOM, geom) or f"geom{geom}"
        path = f"{root}/{_body_name(model, int(model.geom_bodyid[geom]))}/{_part(name)}"
        pose = rr.Transform3D(
            translation=model.geom_pos[geom],
            quaternion=rr.Quaternion(xyzw=xyzw(model.geom_quat[geom])),
            scale=1.0 if tint is None else TINTED_SCALE,
        )
        writer.fixed(path, pose, shape_of(model, geom, colour_of(model, geom) if tint is None else tint))


def _body_name(model: mujoco.MjModel, body: int) -> str:
    return _part(mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, body) or f"body{body}")


def _part(name: str) -> str:
    """Return a name as one part of an entity path."""
    import rerun as rr

    return rr.escape_entity_path_part(name)
