"""Every kind of geom becomes the right shape; colours and visibility follow the MuJoCo viewer."""

from typing import Any

import mujoco
import numpy as np
import pytest
import rerun as rr

from bench.report.recording.shapes import colour_of, shape_of, visible_geoms

RED = np.array([255, 0, 0, 255], dtype=np.uint8)
SINGLE_PRECISION = 1e-6  # Rerun stores float32

MJCF = """
<mujoco>
  <asset>
    <mesh name="wedge" vertex="0 0 0  1 0 0  0 2 0  0 0 3"/>
    <material name="paint" rgba="0 1 0 1"/>
  </asset>
  <worldbody>
    <geom name="plane" type="plane" size="1 2 0.1"/>
    <geom name="floor" type="plane" size="0 0 0.1"/>
    <geom name="sphere" type="sphere" size="0.1"/>
    <geom name="capsule" type="capsule" size="0.1 0.4"/>
    <geom name="ellipsoid" type="ellipsoid" size="0.1 0.2 0.3"/>
    <geom name="cylinder" type="cylinder" size="0.1 0.4"/>
    <geom name="box" type="box" size="0.1 0.2 0.3"/>
    <geom name="mesh" type="mesh" mesh="wedge"/>
    <geom name="painted" type="sphere" size="0.1" material="paint"/>
    <geom name="repainted" type="sphere" size="0.1" material="paint" rgba="0 0 1 1"/>
    <geom name="hidden" type="sphere" size="0.1" group="3"/>
    <geom name="clear" type="sphere" size="0.1" rgba="1 1 1 0"/>
  </worldbody>
</mujoco>
"""


@pytest.fixture(scope="module")
def model() -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(MJCF)


def floats(batch: Any) -> np.ndarray:
    return np.array(batch.as_arrow_array().to_pylist(), dtype=np.float64)


@pytest.mark.parametrize(
    ("name", "kind", "component", "expected"),
    [
        ("plane", rr.Boxes3D, "half_sizes", [[1, 2, 5e-4]]),
        ("sphere", rr.Ellipsoids3D, "half_sizes", [[0.1, 0.1, 0.1]]),
        ("capsule", rr.Capsules3D, "lengths", [0.8]),
        ("capsule", rr.Capsules3D, "radii", [0.1]),
        ("capsule", rr.Capsules3D, "translations", [[0, 0, -0.4]]),  # centred on the geom, as in MuJoCo
        ("ellipsoid", rr.Ellipsoids3D, "half_sizes", [[0.1, 0.2, 0.3]]),
        ("cylinder", rr.Cylinders3D, "lengths", [0.8]),
        ("cylinder", rr.Cylinders3D, "radii", [0.1]),
        ("box", rr.Boxes3D, "half_sizes", [[0.1, 0.2, 0.3]]),
    ],
)
def test_primitive(model: mujoco.MjModel, name: str, kind: type, component: str, expected: list[object]) -> None:
    shape = shape_of(model, model.geom(name).id, RED)
    assert isinstance(shape, kind)
    np.testing.assert_allclose(floats(getattr(shape, component)), expected, rtol=SINGLE_PRECISION)


def test_mesh_has_its_volume_and_outward_normals(model: mujoco.MjModel) -> None:
    shape = shape_of(model, model.geom("mesh").id, RED)
    assert isinstance(shape, rr.Mesh3D)
    corners = floats(shape.vertex_positions).reshape(-1, 3, 3)
    normals = floats(shape.vertex_normals).reshape(-1, 3, 3)
    volume = np.sum(np.linalg.det(corners)) / 6
    np.testing.assert_allclose(volume, 1.0, rtol=SINGLE_PRECISION)  # 1 * 2 * 3 / 6, corners counter-clockwise
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.all(np.einsum("fi,fci->fc", faces, normals) > 0)


def test_visible_are_the_geoms_that_the_viewer_shows(model: mujoco.MjModel) -> None:
    names = {model.geom(geom).name for geom in visible_geoms(model)}
    assert {"plane", "sphere", "capsule", "ellipsoid", "cylinder", "box", "mesh", "painted", "repainted"} == names


@pytest.mark.parametrize(
    ("name", "rgba"), [("painted", [0, 255, 0, 255]), ("repainted", [0, 0, 255, 255]), ("box", [128, 128, 128, 255])]
)
def test_colour(model: mujoco.MjModel, name: str, rgba: list[int]) -> None:
    assert colour_of(model, model.geom(name).id).tolist() == rgba
