"""An arm of seven hinges, rolls and pitches in turn, and logs of it: a clock, angles, currents."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.identify.drive_model import Motion
from bench.record.campaign import Array
from bench.robot.nominal_dynamics import NominalDynamics, nominal_dynamics
from bench.robot.starter.folder import start_robot
from bench.robot.starter.source import read_source
from tests.rigid_links import link_torque

N = 7
MASS = (6.0, 6.0, 4.0, 4.0, 2.5, 2.5, 1.0)  # [kg]
CONSTANT = (24.0, 24.0, 20.0, 20.0, 14.0, 9.0, 9.0)  # [Nm/A], at the joint
RATE, SECONDS = 200.0, 20.0  # [Hz], [s]
COULOMB = 0.05  # of the torque of the links
NOISE = 0.01  # [A]


def mjcf(without_range: tuple[int, ...] = ()) -> str:
    """Return the arm; joints of some numbers have no range."""
    body = (
        '<body name="l{i}" pos="0 0 0.2"><inertial mass="{mass}" pos="{com} 0.1" diaginertia="0.03 0.03 0.01"/>'
        '<joint name="j{i}" axis="{axis}"{range}/>'
    )
    links = "".join(
        body.format(
            i=i,
            mass=MASS[i - 1],
            com="0.02 0.03" if i % 2 else "0.03 -0.02",
            axis="0 0 1" if i % 2 else "0 1 0",
            range="" if i in without_range else ' range="-2.9 2.9"',
        )
        for i in range(1, N + 1)
    )
    tool = '<site name="attachment_site" pos="0 0 0.1"/>'
    return (
        f'<mujoco model="seven"><compiler angle="radian"/><worldbody>{links}{tool}{"</body>" * N}</worldbody></mujoco>'
    )


def started(folder: Path, without_range: tuple[int, ...] = ()) -> NominalDynamics:
    """Return its nominal dynamics as `bench new-robot` starts it; the folder is there."""
    (folder / "seven.xml").write_text(mjcf(without_range))
    return nominal_dynamics(start_robot("seven", read_source(folder / "seven.xml"), folder / "seven").compiled)


@dataclass(frozen=True)
class Log:
    """What is logged; T samples.

    Attributes:
        time: Shape (T,) [s].
        angle, current: Shape (T, 7) [rad], [A].
    """

    time: Array
    angle: Array
    current: Array

    def written(self, file: Path, angle: str = "A{}.pos", current: str = "A{}.Iq[A]") -> Path:
        """Write it as text, columns named by patterns."""
        names = ["t_s", *(angle.format(j) for j in range(1, N + 1)), *(current.format(j) for j in range(1, N + 1))]
        rows = np.column_stack([self.time, self.angle, self.current])
        np.savetxt(file, rows, delimiter=";", header=";".join(names), comments="", fmt="%.7g")
        return file


def moved(arm: NominalDynamics, rng: np.random.Generator, size: float = 0.4) -> Log:
    """Move along Fourier series of 0.1 to 0.3 Hz and some size [rad] about a bent pose."""
    time = np.arange(round(RATE * SECONDS)) / RATE
    waves = 2 * np.pi * 0.1 * np.arange(1, 4)
    sines, phases = rng.normal(size=(2, 3, N))
    angle = np.sum(size * sines * np.sin(waves[:, None] * time[:, None, None] + 3 * phases), axis=1)
    motion = Motion.along(time, angle + np.array([0.0, 0.5, 0.0, -0.6, 0.0, 0.4, 0.0]))
    links = link_torque(arm.bodies, motion) + arm.rotor_inertia * motion.acceleration
    friction = COULOMB * np.max(np.abs(links), axis=0) * np.tanh(motion.velocity / 0.01)
    current = (links + friction) / np.array(CONSTANT) + NOISE * rng.normal(size=links.shape)
    return Log(time, motion.position, current)
