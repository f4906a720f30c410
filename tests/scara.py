"""A SCARA with a quill: its MJCF, and logs of it with a payload that hangs beside its last axis.

All axes are upright, so only the weight of the quill tells which way it counts. Torques are those of Pinocchio's
recursive Newton-Euler on an arm that is put together here; nothing of the bench has a part in it.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pinocchio as pin

from bench.record.campaign import Array

N = 4
NAMES = ("J1", "J2", "J3", "J4")
MASS = (6.0, 5.0, 1.2, 0.4)  # [kg]
COM = ((0.17, 0.0, 0.03), (0.11, 0.0, 0.06), (0.0, 0.0, 0.05), (0.0, 0.0, -0.02))  # [m]
INERTIA = ((0.02, 0.07, 0.08), (0.02, 0.05, 0.05), (0.009, 0.009, 4e-4), (3e-4, 3e-4, 2e-4))  # [kg m^2]
PLACE = ((0.0, 0.0, 0.22), (0.35, 0.0, 0.06), (0.25, 0.0, 0.0), (0.0, 0.0, -0.1))  # [m]
AXIS = ((0.0, 0.0, 1.0), (0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (0.0, 0.0, 1.0))
RANGE = ("-2.3 2.3", "-2.5 2.5", "0 0.18", "-6.2 6.2")
LIMIT = (180.0, 90.0, 400.0, 12.0)  # [Nm], [N]
ROTOR = (0.36, 0.11, 3.2, 0.006)  # [kg m^2], [kg]
TOOL = (0.0, 0.0, -0.04)  # [m], in the last link
COULOMB, VISCOUS = (7.0, 3.0, 12.0, 0.35), (4.0, 1.5, 25.0, 0.08)
SIGMA = (0.6, 0.3, 2.0, 0.05)  # [Nm], [N]
CONSTANT = (32.0, 17.0, 125.0, 3.0)  # [Nm/A], [N/A]
SWING = (0.5, 0.5, 0.03, 1.0)  # [rad], [m], of each sine
RATE = 250.0  # [Hz]
UP = (1.0, 1.0, -1.0, 1.0)  # signs of a controller that counts height


def mjcf() -> str:
    """Return the robot as its drawing has it."""
    links = "".join(
        f'<body name="l{i}" pos="{_words(PLACE[i])}"><inertial mass="{MASS[i]}" pos="{_words(COM[i])}" '
        f'diaginertia="{_words(INERTIA[i])}"/><joint name="{NAMES[i]}" type="{"slide" if i == 2 else "hinge"}" '
        f'axis="{_words(AXIS[i])}" range="{RANGE[i]}" armature="{ROTOR[i]}"/><geom size="0.03" mass="0"/>'
        for i in range(N)
    )
    drives = "".join(f'<motor joint="{NAMES[i]}" ctrlrange="{-LIMIT[i]} {LIMIT[i]}"/>' for i in range(N))
    tool = f'<site name="tool0" pos="{_words(TOOL)}"/>'
    return (
        f'<mujoco model="scara"><compiler angle="radian" autolimits="true"/><worldbody>{links}{tool}'
        f"{'</body>' * N}</worldbody><actuator>{drives}</actuator></mujoco>"
    )


def _words(values: tuple[float, ...]) -> str:
    return " ".join(f"{value:g}" for value in values)


@dataclass(frozen=True)
class Load:
    """A payload [kg], its centre beside the tool [m] and its inertia about that [kg m^2]."""

    mass: float
    beside: tuple[float, float, float]
    inertia: tuple[float, float, float] = (1.2e-3, 1e-3, 1.4e-3)


BESIDE = Load(1.1, (0.036, 0.018, -0.035))


@dataclass(frozen=True)
class Log:
    """What really happened; T samples.

    Attributes:
        time: Shape (T,) [s].
        position: Shape (T, 4) [rad] or [m].
        current: Shape (T, 4) [A].
    """

    time: Array
    position: Array
    current: Array

    def written(self, file: Path, signs: tuple[float, ...] = (1.0,) * N) -> Path:
        """Write the log with axes that count the other way round, position and current alike."""
        names = ["t", *(f"{name}_{unit}" for unit in ("pos", "current_A") for name in NAMES)]
        rows = np.column_stack([self.time, self.position * signs, self.current * signs])
        np.savetxt(file, rows, delimiter=",", header=",".join(names), comments="", fmt="%.9g")
        return file


def moved(
    rng: np.random.Generator,
    load: Load | None,
    coulomb: tuple[float, ...] = COULOMB,
    moves: tuple[int, ...] = (1, 1, 1, 1),
    seconds: float = 20.0,
) -> Log:
    """Move the robot along Fourier series of 0.2 to 1 Hz.

    Args:
        rng: Of phases and noise.
        load: That hangs at the tool.
        coulomb: Friction of the drives [Nm], [N].
        moves: 1 for axes that move, 0 for those that stand.
        seconds: Length of the log.
    """
    arm = pin.Model()
    for i in range(N):
        axis = np.array(AXIS[i])
        joint = pin.JointModelPrismaticUnaligned(axis) if i == 2 else pin.JointModelRevoluteUnaligned(axis)
        number = arm.addJoint(i, joint, pin.SE3(np.eye(3), np.array(PLACE[i])), NAMES[i])
        body = pin.Inertia(MASS[i], np.array(COM[i]), np.diag(INERTIA[i]))
        arm.appendBodyToJoint(number, body, pin.SE3.Identity())
    if load:
        place = pin.SE3(np.eye(3), np.array(TOOL) + load.beside)
        arm.appendBodyToJoint(N, pin.Inertia(load.mass, np.zeros(3), np.diag(load.inertia)), place)
    time = np.arange(round(seconds * RATE)) / RATE
    waves = 2 * np.pi * 0.2 * np.arange(1, 6)
    angle = waves[None, :, None] * time[:, None, None] + rng.uniform(0, 2 * np.pi, size=(5, N))
    sines = np.array(SWING) * moves / np.arange(1, 6)[:, None] ** 0.5
    position = np.sum(sines * np.sin(angle), axis=1) + np.array([0, 0, 0.09, 0])
    velocity = np.sum(sines * waves[:, None] * np.cos(angle), axis=1)
    acceleration = -np.sum(sines * waves[:, None] ** 2 * np.sin(angle), axis=1)
    data = arm.createData()
    torque = np.array([pin.rnea(arm, data, *s) for s in zip(position, velocity, acceleration, strict=True)])
    turning = np.tanh(velocity / (0.02 * np.maximum(np.max(np.abs(velocity), axis=0), 1e-9)))
    torque += np.array(ROTOR) * acceleration + np.array(coulomb) * turning + np.array(VISCOUS) * velocity
    torque += rng.normal(size=torque.shape) * np.array(SIGMA)
    return Log(time, position, torque / np.array(CONSTANT))
