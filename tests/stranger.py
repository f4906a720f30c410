"""A stranger's robot and logs: a three-hinge arm as MJCF with position actuators and as URDF, logs of a moving one.

Torques are those of Pinocchio's recursive Newton-Euler on an arm that is put together here number by number; nothing of
the bench has a part in it. The logs know what files do not: rotors, friction, noise, sign and gear of each drive. The
arm may differ from its file in everything else as well, as real arms do from public models.
"""

from dataclasses import dataclass, field
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
LIGHT_ROTOR = (0.36, 0.48, 0.09)  # [kg m^2], of the arm that is unlike its file: a tenth of what new-robot guesses
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


def mjcf(damping: str = "350", actuators: bool = True, armature: float | None = None) -> str:
    """Return the arm as menagerie writes it: position actuators, and a servo's damping at the joints.

    Args:
        damping: Of each joint [Nm s/rad].
        actuators: Whether there are any.
        armature: A placeholder that stands at every joint; None for the rotors [kg m^2].
    """
    links = "".join(
        _LINK.format(
            i=i + 1,
            place=_words(PLACE[i]),
            mass=MASS[i],
            com=_words(COM[i]),
            inertia=_words(INERTIA[i]),
            axis=AXIS[i],
            rotor=ROTOR[i] if armature is None else armature,
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


@dataclass(frozen=True)
class Arm:
    """What moves: links and drives.

    Attributes:
        links: Rigid, without rotors.
        rotor: Inertia of each [kg m^2].
        asymmetry: Shape (3,), friction of positive velocities by that of negative ones, square root.
        by_load: Coulomb friction by the torque of the links.
        rise: Of Coulomb friction at standstill, by its level at speed.
        exponent: Of the velocity in viscous friction.
        offset: Shape (3,) [Nm], of the torque.
        scale: Shape (3,), of the torque that is reported.
    """

    links: pin.Model
    rotor: tuple[float, ...] = ROTOR
    asymmetry: Array = field(default_factory=lambda: np.ones(3))
    by_load: float = 0.0
    rise: float = 0.0
    exponent: float = 1.0
    offset: Array = field(default_factory=lambda: np.zeros(3))
    scale: Array = field(default_factory=lambda: np.ones(3))

    def friction(self, velocity: Array, links: Array) -> Array:
        """Return the friction at velocities and torques of the links, shape (T, 3) each [rad/s], [Nm]."""
        level = np.array(COULOMB) * (1 + self.rise * np.exp(-((velocity / 0.12) ** 2))) + self.by_load * np.abs(links)
        coulomb = level * np.tanh(velocity / 0.01) * np.where(velocity > 0, self.asymmetry, 1 / self.asymmetry)
        return coulomb + np.array(VISCOUS) * np.sign(velocity) * np.abs(velocity) ** self.exponent


MIDDLE = (0.0, 0.0, 0.0)


def as_filed(payload: float = 0.0, beside: tuple[float, float, float] = MIDDLE) -> Arm:
    """Return the arm of the file, with a point mass [kg] beside the tool [m]."""
    links = pin.Model()
    for i in range(3):
        axis = np.array([float(x) for x in AXIS[i].split()])
        joint = pin.JointModelRevoluteUnaligned(axis)
        number = links.addJoint(i, joint, pin.SE3(np.eye(3), np.array(PLACE[i])), f"j{i + 1}")
        inertia = pin.Inertia(MASS[i], np.array(COM[i]), np.diag(INERTIA[i]))
        links.appendBodyToJoint(number, inertia, pin.SE3.Identity())
    if payload:
        place = pin.SE3(np.eye(3), _tool() + beside)
        links.appendBodyToJoint(3, pin.Inertia(payload, np.zeros(3), np.zeros((3, 3))), place)
    return Arm(links)


def unlike_its_file(rng: np.random.Generator) -> Arm:
    """Return an arm of which everything is off, as real ones are against public models.

    Rotors are light; masses are off by 12 %, centres by 25 mm, inertias by 30 %; Coulomb friction grows with the load
    and towards standstill, viscous friction is not quite linear, directions differ by 6 %; there are offsets, and
    torques are reported 2 % off.
    """
    links = as_filed().links
    for joint in range(1, links.njoints):
        body = links.inertias[joint]
        inertia = np.diag(np.diag(body.inertia) * np.exp(0.3 * rng.normal(size=3))) + 1e-3 * np.eye(3)
        mass, centre = body.mass * (1 + 0.12 * rng.normal()), body.lever + 0.025 * rng.normal(size=3)
        links.inertias[joint] = pin.Inertia(mass, centre, inertia)
    return Arm(
        links,
        rotor=LIGHT_ROTOR,
        asymmetry=1 + 0.06 * rng.normal(size=3),
        by_load=0.02,
        rise=0.5,
        exponent=0.9,
        offset=0.05 * np.array(COULOMB) * rng.normal(size=3),
        scale=1 + 0.02 * rng.normal(size=3),
    )


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


def moved(
    rng: np.random.Generator,
    seconds: float = 20.0,
    arm: Arm | None = None,
    torque_delay: float = 0.0,
    swing: float = 1.0,
) -> Motion:
    """Move an arm, that of the file if none is given, along Fourier series of 0.1 to 0.5 Hz, `swing` times as far."""
    arm = arm or as_filed()
    data = arm.links.createData()
    time = np.arange(round(seconds * RATE)) / RATE
    sines = rng.normal(size=(5, 3)) * np.array([0.28, 0.2, 0.3]) * swing
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
    links = np.array([pin.rnea(arm.links, data, *state) for state in zip(*late, strict=True)])
    torque = (links + np.array(arm.rotor) * late[2] + arm.friction(late[1], links) + arm.offset) * arm.scale
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


def named_log(file: Path, motion: Motion, position: str, reading: str, readings: Array) -> Path:
    """Write a log in degrees whose columns are named by patterns, drives from 1."""
    names = ["time", *(position.format(j) for j in (1, 2, 3)), *(reading.format(j) for j in (1, 2, 3))]
    rows = np.column_stack([motion.time, np.rad2deg(motion.position), readings])
    np.savetxt(file, rows, delimiter=",", header=",".join(names), comments="", fmt="%.8g")
    return file
