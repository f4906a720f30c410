"""Files that somebody may have of a robot, from which `bench new-robot` starts."""

from pathlib import Path

import pytest

STICK = """
<mujoco>
  <worldbody>
    <body name="upper">
      <joint name="j1" axis="0 1 0" range="-60 90"/><geom type="capsule" size="0.08" fromto="0 0 0 0 0 0.8" mass="40"/>
      <body name="lower" pos="0 0 0.8">
        <joint name="j2" axis="0 1 0" range="-90 90"/>
        <geom type="capsule" size="0.06" fromto="0 0 0 0.7 0 0" mass="20"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""
# The habits of mujoco_menagerie: nested default classes, meshes in a folder, included files, position actuators, a
# gripper of two fingers coupled by an equality, contact exclusions, a keyframe.
MENAGERIE = """
<mujoco model="twig">
  <compiler angle="radian" meshdir="assets" autolimits="true"/>
  <include file="defaults.xml"/>
  <asset><mesh file="tri.obj"/></asset>
  <worldbody>
    <light pos="0 0 2"/>
    <body name="base" childclass="arm">
      <geom class="visual" mesh="tri"/>
      <body name="l1" pos="0 0 0.2">
        <inertial mass="4" pos="0 0 0.1" diaginertia="0.02 0.02 0.02"/>
        <joint name="j1" axis="0 0 1"/>
        <geom size="0.05"/>
        <body name="l2" pos="0 0 0.2">
          <inertial mass="3" pos="0 0 0.2" diaginertia="0.03 0.03 0.01"/>
          <joint name="j2"/>
          <body name="l3" pos="0 0 0.4">
            <inertial mass="1" pos="0 0 0.1" diaginertia="0.002 0.002 0.0005"/>
            <joint name="j3" class="small"/>
            <site name="attachment_site" pos="0 0 0.2"/>
            <body name="hand" pos="0 0 0.2">
              <inertial mass="0.3" pos="0 0 0" diaginertia="1e-4 1e-4 1e-4"/>
              <body name="f1" pos="0 0.02 0.05">
                <joint name="finger1" type="slide" axis="0 1 0" range="0 0.04"/><geom size="0.01" mass="0.02"/>
              </body>
              <body name="f2" pos="0 -0.02 0.05">
                <joint name="finger2" type="slide" axis="0 -1 0" range="0 0.04"/><geom size="0.01" mass="0.02"/>
              </body>
            </body>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
  <contact><exclude body1="l1" body2="l2"/></contact>
  <equality><joint joint1="finger1" joint2="finger2"/></equality>
  <actuator>
    <position name="a1" joint="j1" class="arm"/>
    <position name="a2" joint="j2" class="arm"/>
    <position name="a3" joint="j3" class="small"/>
    <position name="grip" joint="finger1" class="small" ctrlrange="0 0.04"/>
  </actuator>
  <sensor><jointpos joint="finger1"/></sensor>
  <keyframe><key name="home" qpos="0 0.5 0 0 0" ctrl="0 0.5 0 0"/></keyframe>
</mujoco>
"""
DEFAULTS = """
<mujocoinclude>
  <default>
    <joint damping="9" frictionloss="9" armature="9"/>
    <default class="arm">
      <joint axis="0 1 0" range="-2 2" armature="0.1" damping="1" frictionloss="2"/>
      <position ctrlrange="-2 2" forcerange="-150 150" kp="2000"/>
      <default class="small"><position forcerange="-30 30" kp="500"/><joint armature="0.05"/></default>
      <default class="visual"><geom type="mesh" group="2" contype="0" conaffinity="0"/></default>
    </default>
  </default>
</mujocoinclude>
"""
TETRAHEDRON = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
URDF = """
<robot name="lift">
  <link name="base"/>
  <link name="a">
    <inertial><origin xyz="0 0 0.2"/><mass value="6"/>
      <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision>
  </link>
  <link name="b">
    <inertial><origin xyz="0.2 0 0"/><mass value="2"/>
      <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <link name="tool0"/>
  <joint name="lift" type="prismatic"><parent link="base"/><child link="a"/><origin xyz="0 0 0.1"/><axis xyz="0 0 1"/>
    <limit lower="-0.2" upper="1" effort="500" velocity="2"/></joint>
  <joint name="turn" type="continuous"><parent link="a"/><child link="b"/><origin xyz="0 0 0.1"/><axis xyz="0 1 0"/>
    <dynamics damping="0.5" friction="0.2"/></joint>
  <joint name="fixed" type="fixed"><parent link="b"/><child link="tool0"/><origin xyz="0.4 0 0"/></joint>
</robot>
"""


@pytest.fixture
def stick(tmp_path: Path) -> Path:
    """Return an MJCF with masses in its shapes alone."""
    (tmp_path / "stick.xml").write_text(STICK)
    return tmp_path / "stick.xml"


@pytest.fixture
def menagerie(tmp_path: Path) -> Path:
    """Return an MJCF as mujoco_menagerie has them, with the files that it names."""
    folder = tmp_path / "twig_arm"
    (folder / "assets").mkdir(parents=True)
    (folder / "assets" / "tri.obj").write_text(TETRAHEDRON)
    (folder / "defaults.xml").write_text(DEFAULTS)
    (folder / "twig.xml").write_text(MENAGERIE)
    return folder / "twig.xml"


@pytest.fixture
def urdf(tmp_path: Path) -> Path:
    """Return a URDF of a slide with a hinge on it."""
    (tmp_path / "lift.urdf").write_text(URDF)
    return tmp_path / "lift.urdf"
