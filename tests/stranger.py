"""A stranger's robot and logs: a three-hinge arm as MJCF with position actuators and as URDF, logs of a moving one.

Torques are those of Pinocchio's recursive Newton-Euler on an arm that is put together here number by number; nothing of
the bench has a part in it. The logs know what files do not: rotors, friction, noise, sign and gear of each drive.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pinocchio as pin

from bench.record.campaign import Array

MASS = (12.0, 8.0, 3.0)  # [kg]
COM = ((0.0, 0.0, 0.1), (0.0, 0.0, 0.22), (0.12, 0.0, 0.0))  # [m]
INERTIA = ((0.08, 0.08, 0.05), (0.15, 0.15, 0.02), (0.01, 0.03, 0.03))  # [kg m^2]
PLACE = ((0.0, 0.0, 0.1), (0.0, 0.0, 0.2), (0.0, 0.0, 0.45))  # [m]
AXIS = ("0 0 1", "0 1 0", "0 1 0")
LIMIT, SPEED = (200.0, 250.0, 80.0), (2.5, 2.0, 3.0)  # [Nm], [rad/s]
ROTOR = (1.2, 1.6, 0.3)  # [kg m^2]
COULOMB, VISCOUS = (9.0, 12.0, 3.0), (4.0, 6.0, 1.5)  # [Nm], [Nm s/rad]
SIGMA = (0.5, 0.6, 0.2)  # [Nm]
CONSTANT = (12.0, -14.0, 8.0)  # [Nm/A], at the joint; the second drive counts the other way round
RATE = 500.0  # [Hz]

_LINK = (
    '<body name="l{i}" pos="{place}"><inertial mass="{mass}" pos="{com}" diaginertia="{inertia}"/>'
    '<joint name="j{i}" axis="{axis}" range="-2.6 2.6" damping="350" armature="{rotor}"/><geom size="0.05" mass="0"/>'
)


def _words(values: tuple[float, ...]) -> str:
    return " ".join(f"{value:g}" for value in values)


def mjcf(damping: str = "350", actuators: bool = True) -> str:
    """Return the arm as menagerie writes it: position actuators, and a servo's damping at the joints."""
    links = "".join(
        _LINK.format(
            i=i + 1,
            place=_words(PLACE[i]),
            mass=MASS[i],
            com=_words(COM[i]),
            inertia=_words(INERTIA[i]),
            axis=AXIS[i],
            rotor=ROTOR[i],
        )
        for i in range(3)
    ).replace('damping="350"', f'damping="{damping}"')
    drives = "".join(
        f'<general joint="j{i + 1}" biastype="affine" gainprm="5000" biasprm="0 -5000 0" ctrlrange="-2.6 2.6" '
        f'forcerange="{-LIMIT[i]} {LIMIT[i]}"/>'
        for i in range(3)
    )
    tool = '<site name="attachment_site" pos="0.3 0 0"/>'
    return (
        f'<mujoco model="stranger"><compiler angle="radian"/><worldbody>{links}{tool}{"</body>" * 3}</worldbody>'
        f"{f'<actuator>{drives}</actuator>' if actuators else ''}</mujoco>"
    )


def pinocchio_arm() -> pin.Model:
    """Return the arm, joint by joint."""
    model = pin.Model()
    for i in range(3):
        axis = np.array([float(x) for x in AXIS[i].split()])
        joint = pin.JointModelRevoluteUnaligned(axis)
        number = model.addJoint(i, joint, pin.SE3(np.eye(3), np.array(PLACE[i])), f"j{i + 1}")
        inertia = pin.Inertia(MASS[i], np.array(COM[i]), np.diag(INERTIA[i]))
        model.appendBodyToJoint(number, inertia, pin.SE3.Identity())
    return model


@dataclass(frozen=True)
class Motion:
    """What really happened; T samples.

    Attributes:
        time: Shape (T,) [s].
        position, velocity: Shape (T, 3) [rad], [rad/s].
        torque: Shape (T, 3) [Nm], of the drives at the joints, with friction and rotors.
    """

    time: Array
    position: Array
    velocity: Array
    torque: Array


def moved(rng: np.random.Generator, seconds: float = 20.0, payload: float = 0.0, torque_delay: float = 0.0) -> Motion:
    """Move the arm along Fourier series of 0.1 to 0.5 Hz; a payload is a point mass at the tool."""
    model = pinocchio_arm()
    if payload:
        model.appendBodyToJoint(3, pin.Inertia(payload, np.zeros(3), np.zeros((3, 3))), pin.SE3(np.eye(3), _tool()))
    data = model.createData()
    time = np.arange(round(seconds * RATE)) / RATE
    sines = rng.normal(size=(5, 3)) * np.array([0.28, 0.2, 0.3])
    phases = rng.uniform(0, 2 * np.pi, size=(5, 3))

    def along(clock: Array) -> tuple[Array, Array, Array]:
        waves = 2 * np.pi * 0.1 * np.arange(1, 6)
        angle = waves[None, :, None] * clock[:, None, None] + phases
        return (
            np.sum(sines * np.sin(angle), axis=1),
            np.sum(sines * waves[:, None] * np.cos(angle), axis=1),
            -np.sum(sines * waves[:, None] ** 2 * np.sin(angle), axis=1),
        )

    late = along(time - torque_delay)
    torque = np.array([pin.rnea(model, data, *state) for state in zip(*late, strict=True)])
    torque += np.array(ROTOR) * late[2] + np.array(VISCOUS) * late[1] + np.array(COULOMB) * np.tanh(late[1] / 0.01)
    position, velocity, _ = along(time)
    return Motion(time, position, velocity, torque + rng.normal(size=torque.shape) * np.array(SIGMA))


def _tool() -> Array:
    return np.array([0.3, 0.0, 0.0])


def ur_log(file: Path, motion: Motion, separator: str = ",", decimal: str = ".") -> Path:
    """Write a log as a controller does: 500 Hz, no header, clock, angles, speeds, currents, a counter and zeros."""
    rows = np.column_stack(
        [
            motion.time + 1234.5,
            motion.position.round(6),
            motion.velocity.round(5),
            (motion.torque / np.array(CONSTANT)).round(4),
            np.arange(len(motion.time)),
            np.zeros((len(motion.time), 2)),
        ]
    )
    text = "\n".join(separator.join(f"{x:.10g}".replace(".", decimal) for x in row) for row in rows)
    file.write_text(text + "\n")
    return file


def urdf(mesh: str = "") -> str:
    """Return another arm as URDF: two hinges, limits, a visual shape, a collision shape."""
    shape = f'<mesh filename="{mesh}"/>' if mesh else '<cylinder radius="0.04" length="0.4"/>'
    return f"""<?xml version="1.0"?>
<robot name="other">
  <link name="base_link"/>
  <link name="upper">
    <inertial><origin xyz="0 0 0.2"/><mass value="6"/>
      <inertia ixx="0.1" iyy="0.1" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><origin xyz="0 0 0.2"/><geometry>{shape}</geometry></visual>
    <collision><origin xyz="0 0 0.2"/><geometry><box size="0.1 0.1 0.4"/></geometry></collision>
  </link>
  <link name="fore">
    <inertial><origin xyz="0.15 0 0"/><mass value="2"/>
      <inertia ixx="0.003" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><sphere radius="0.05"/></geometry></visual>
  </link>
  <joint name="shoulder" type="revolute"><parent link="base_link"/><child link="upper"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="120" velocity="1.7"/><dynamics damping="1.5" friction="2"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/><origin xyz="0 0 0.4"/>
    <axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="40" velocity="3.1"/></joint>
</robot>
"""
