"""A six-joint arm of which everything is a little off: crude masses and centres, placeholder rotors, unknown friction.

The file is as public models are: one armature for all drives, a servo's damping, no friction. What moves is another
arm (Pinocchio, rigid): masses off by 12 %, centres by 25 mm, inertias by 30 %; Coulomb friction that grows with the
load and towards standstill, viscous friction that is not quite linear, directions that differ, offsets, torques off by
2 %.
"""

from pathlib import Path

import numpy as np
import pinocchio as pin

from bench.record.campaign import Array

# joint, axis, place in the parent, mass, centre, inertia
LINKS = (
    ("pan", "0 0 1", "0 0 0.18", 7.8, "0 0 0", "0.03 0.03 0.022"),
    ("lift", "0 1 0", "0 0.17 0", 13.0, "0 0 0.3", "0.42 0.42 0.036"),
    ("elbow", "0 1 0", "0 -0.13 0.6", 3.9, "0 0 0.28", "0.11 0.11 0.011"),
    ("wrist1", "0 1 0", "0 0 0.57", 2.0, "0 0.13 0", "0.0055 0.0051 0.0051"),
    ("wrist2", "0 0 1", "0 0.13 0", 2.0, "0 0 0.12", "0.0055 0.0051 0.0051"),
    ("wrist3", "0 1 0", "0 0 0.12", 0.3, "0 0.09 0", "0.0004 0.0003 0.0003"),
)
TORQUE_LIMITS = (330, 330, 150, 56, 56, 56)
ROTORS = np.array([2.2, 2.2, 0.9, 0.16, 0.15, 0.14])
COULOMB, VISCOUS = np.array([8, 9, 6, 1.5, 1.3, 1.1]), np.array([9, 9, 6, 1.2, 1.0, 0.9])
NOISE = np.array([1.2, 1.2, 0.8, 0.3, 0.3, 0.3])
HOME = np.array([0, -1.4, 1.3, -1.0, 0.6, 0.3])
RATE_HZ, SWING = 500, 0.14


def mjcf() -> str:
    """Return the file that a user would have."""
    text = ""
    for name, axis, place, mass, centre, inertia in LINKS:
        text += (
            f'<body name="{name}_link" pos="{place}"><inertial mass="{mass}" pos="{centre}" diaginertia="{inertia}"/>'
        )
        text += f'<joint name="{name}" axis="{axis}" range="-6 6" armature="0.1" damping="350"/>'
    text += '<site name="attachment_site" pos="0 0.1 0"/>' + "</body>" * len(LINKS)
    servos = "".join(
        f'<position name="{link[0]}" joint="{link[0]}" kp="4000" forcerange="-{limit} {limit}"/>'
        for link, limit in zip(LINKS, TORQUE_LIMITS, strict=True)
    )
    compiler = '<compiler angle="radian" autolimits="true"/>'
    return f'<mujoco model="off">{compiler}<worldbody>{text}</worldbody><actuator>{servos}</actuator></mujoco>'


def write_logs(folder: Path, rng: np.random.Generator, runs: int, seconds: float) -> None:
    """Write `arm.xml` and logs of Fourier series, `logs/run0.csv` and so on."""
    (folder / "arm.xml").write_text(mjcf())
    (folder / "logs").mkdir()
    model = _another(pin.buildModelFromMJCF(str(folder / "arm.xml")), rng)
    rotors = ROTORS * np.exp(0.1 * rng.normal(size=6))
    asymmetry, scale = 1 + 0.06 * rng.normal(size=6), 1 + 0.02 * rng.normal(size=6)
    offset = 0.05 * COULOMB * rng.normal(size=6)
    names = [f"q_motor_{j + 1}_rad" for j in range(6)] + [f"tau_motor_{j + 1}_nm" for j in range(6)]
    for run in range(runs):
        t = np.arange(round(seconds * RATE_HZ)) / RATE_HZ
        q, v, a = _fourier(t, rng)
        data = model.createData()
        links = np.array([pin.rnea(model, data, *instant) for instant in zip(q, v, a, strict=True)])
        level = COULOMB + 0.02 * np.abs(links) + 0.5 * COULOMB * np.exp(-((v / 0.12) ** 2))
        friction = level * np.tanh(v / 0.005) * np.where(v > 0, asymmetry, 1 / asymmetry)
        friction += VISCOUS * np.sign(v) * np.abs(v) ** 0.9
        torque = (links + rotors * a + friction + offset) * scale + NOISE * rng.normal(size=q.shape)
        table = np.column_stack([t, np.round(q + 2e-6 * rng.normal(size=q.shape), 6), np.round(torque, 3)])
        file = folder / "logs" / f"run{run}.csv"
        np.savetxt(file, table, delimiter=",", fmt="%.8g", header=",".join(["time_s", *names]), comments="")


def _another(model: pin.Model, rng: np.random.Generator) -> pin.Model:
    """Return the arm that moves."""
    model.armature[:] = model.damping[:] = model.friction[:] = 0
    for joint in range(1, model.njoints):
        body = model.inertias[joint]
        values, axes = np.linalg.eigh(body.inertia)
        inertia = axes @ np.diag(values * np.exp(0.3 * rng.normal(size=3))) @ axes.T + 1e-3 * np.eye(3)
        mass, centre = body.mass * (1 + 0.12 * rng.normal()), body.lever + 0.025 * rng.normal(size=3)
        model.inertias[joint] = pin.Inertia(mass, centre, inertia)
    return model


def _fourier(t: Array, rng: np.random.Generator) -> tuple[Array, Array, Array]:
    """Return angles, velocities and accelerations of five harmonics of 0.1 Hz, shape (T, 6) each."""
    rate = 2 * np.pi * 0.1 * np.arange(1, 6)
    a, b = SWING * rng.normal(size=(2, 5, 6))
    s, c = np.sin(np.outer(t, rate)), np.cos(np.outer(t, rate))
    rate = rate[:, None]
    q = HOME + 0.2 * rng.normal(size=6) + s @ a + c @ b
    return q, c @ (rate * a) - s @ (rate * b), -s @ (rate**2 * a) - c @ (rate**2 * b)
