"""From the geoms of a compiled MJCF to Rerun's shapes, each in the frame of its geom."""

from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.robot.bodies import Array

if TYPE_CHECKING:
    from rerun import AsComponents

Rgba = NDArray[np.uint8]
DRAWN = {  # all but height fields
    mujoco.mjtGeom.mjGEOM_PLANE,
    mujoco.mjtGeom.mjGEOM_SPHERE,
    mujoco.mjtGeom.mjGEOM_CAPSULE,
    mujoco.mjtGeom.mjGEOM_ELLIPSOID,
    mujoco.mjtGeom.mjGEOM_CYLINDER,
    mujoco.mjtGeom.mjGEOM_BOX,
    mujoco.mjtGeom.mjGEOM_MESH,
    mujoco.mjtGeom.mjGEOM_SDF,
}

_UNSET_RGBA = (0.5, 0.5, 0.5, 1.0)  # MuJoCo's default geom colour; a geom that has it takes its material's colour
SHARP = 0.5  # cosine of the angle from the normal of a face at which an edge counts as sharp
_PLANE_THICKNESS = 1e-3  # [m], for a plane drawn as a box


def visible_geoms(model: mujoco.MjModel) -> list[int]:
    """Return the ids of the geoms to draw.

    Left out are the groups that the MuJoCo viewer hides when it opens, what is fully transparent, and what belongs to a
    scene rather than to a robot: endless planes and height fields.
    """
    shown = mujoco.MjvOption().geomgroup
    return [
        geom
        for geom in range(model.ngeom)
        if shown[model.geom_group[geom]] and colour_of(model, geom)[3] > 0 and _is_drawable(model, geom)
    ]


def shape_of(model: mujoco.MjModel, geom: int, rgba: Rgba) -> "AsComponents":
    """Return the Rerun shape of one geom, in the frame of that geom.

    Args:
        model: The compiled model.
        geom: Geom id, one of `visible_geoms`.
        rgba: Shape (4,), the colour to give it.
    """
    import rerun as rr

    size = model.geom_size[geom]
    look: dict[str, Any] = {"colors": [rgba], "fill_mode": "solid"}
    match mujoco.mjtGeom(model.geom_type[geom]):
        case mujoco.mjtGeom.mjGEOM_PLANE:
            return rr.Boxes3D(half_sizes=[[size[0], size[1], _PLANE_THICKNESS / 2]], **look)
        case mujoco.mjtGeom.mjGEOM_BOX:
            return rr.Boxes3D(half_sizes=[size], **look)
        case mujoco.mjtGeom.mjGEOM_SPHERE:
            return rr.Ellipsoids3D(half_sizes=[np.repeat(size[0], 3)], **look)
        case mujoco.mjtGeom.mjGEOM_ELLIPSOID:
            return rr.Ellipsoids3D(half_sizes=[size], **look)
        case mujoco.mjtGeom.mjGEOM_CYLINDER:
            return rr.Cylinders3D(radii=[size[0]], lengths=[2 * size[1]], **look)
        case mujoco.mjtGeom.mjGEOM_CAPSULE:  # Rerun's begins at its origin, MuJoCo's is centred on it
            return rr.Capsules3D(radii=[size[0]], lengths=[2 * size[1]], translations=[[0, 0, -size[1]]], **look)
        case _:
            return _mesh(model, model.geom_dataid[geom], rgba)


def colour_of(model: mujoco.MjModel, geom: int) -> Rgba:
    """Return the colour of a geom, shape (4,): its own, or its material's where it has none of its own."""
    own, material = model.geom_rgba[geom], model.geom_matid[geom]
    from_material = material >= 0 and np.allclose(own, _UNSET_RGBA)
    return np.asarray(np.round(255 * (model.mat_rgba[material] if from_material else own)), dtype=np.uint8)


def _is_drawable(model: mujoco.MjModel, geom: int) -> bool:
    kind = mujoco.mjtGeom(model.geom_type[geom])
    endless = kind == mujoco.mjtGeom.mjGEOM_PLANE and np.any(model.geom_size[geom, :2] == 0)
    return kind in DRAWN and not endless


def _mesh(model: mujoco.MjModel, mesh: int, rgba: Rgba) -> "AsComponents":
    import rerun as rr

    # Every corner of every face gets a vertex of its own: MuJoCo counts normals apart from vertices, Rerun does not.
    faces = slice(model.mesh_faceadr[mesh], model.mesh_faceadr[mesh] + model.mesh_facenum[mesh])
    vertices = model.mesh_vert[model.mesh_vertadr[mesh] :][: model.mesh_vertnum[mesh]]
    normals = model.mesh_normal[model.mesh_normaladr[mesh] :][: model.mesh_normalnum[mesh]]
    corners = vertices[model.mesh_face[faces]]
    return rr.Mesh3D(
        vertex_positions=corners.reshape(-1, 3),
        vertex_normals=_shading(corners, normals[model.mesh_facenormal[faces]]).reshape(-1, 3),
        albedo_factor=rgba,
    )


def _shading(corners: Array, normals: Array) -> Array:
    """Return the normals to shade with, shape (n_faces, 3, 3), from corners and MuJoCo's normals of the same shape.

    MuJoCo has one normal for all faces that meet in a vertex. At a sharp edge it belongs to one and is wrong for
    the others; these get the normal of their own plane.
    """
    planes = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(planes, axis=1, keepdims=True)
    planes = np.repeat((planes / np.where(area > 0, area, 1.0))[:, None], 3, axis=1)
    is_smooth = np.einsum("fci,fci->fc", planes, normals) > SHARP
    return np.where(is_smooth[..., None], normals, planes)
