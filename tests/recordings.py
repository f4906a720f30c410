"""Measured data that are not part of the repository, and stand-ins of the same format."""

import os
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.effects.conditions import Conditions
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.robot.logs import log_format_of
from bench.simulate.prescribed import Motion, Prescribed

ROOT = Path(__file__).parents[1]
KR300_AXES = range(1, 7)


def data_folder(name: str) -> Path:
    """Return the folder of a data set, from `BENCH_DATA` or beside the repository; skip the test where it is absent."""
    folder = Path(os.environ.get("BENCH_DATA", ROOT.parent / "shared" / "data")) / name
    if not folder.is_dir():
        pytest.skip(f"measured data {name!r} are not here; set BENCH_DATA to the folder that holds them")
    return folder


def write_emps(
    file: Path, rng: np.random.Generator, seconds: float = 6.0, rolling: float = 0.0, slow: float = 1.0
) -> dict[str, float]:
    """Write a synthetic log as the EMPS makes them; return what it was made with.

    Args:
        file: To write.
        rng: Source of noise.
        seconds: How long it lasts [s].
        rolling: Friction that grows with speed to the power 2/3 [N], at 1 m/s.
        slow: Share of the speed at which it ends.
    """
    truth = {"inertia": 90.0, "viscous": 220.0, "coulomb": 18.0, "offset": -2.0}
    time = np.arange(0, seconds, 1e-3)
    rate = 2 * np.pi / 3 * (1 - (1 - slow) * time / seconds)
    phase = np.cumsum(rate) * 1e-3
    change = -2 * np.pi / 3 * (1 - slow) / seconds
    position = 0.12 * (1 - np.cos(phase))
    velocity = 0.12 * rate * np.sin(phase)
    acceleration = 0.12 * (rate**2 * np.cos(phase) + change * np.sin(phase))
    force = truth["inertia"] * acceleration + truth["viscous"] * velocity + truth["offset"]
    force = force + truth["coulomb"] * np.sign(velocity) + 2.0 * rng.standard_normal(len(time))
    force = force + rolling * np.sign(velocity) * np.abs(velocity) ** (2 / 3)
    seen = 5e-8 * np.round(position / 5e-8)
    _write(file, {"time_s": time, "q_cmd_m": position + 1e-5, "q_m": seen, "u_V": force / 35.15065188248547})
    return truth


LATE_S = 3e-3  # of the link encoders
KR300_TRUTH: Mapping[str, Mapping[str, float | tuple[float, ...]]] = {
    "unstated_payload": {"mass": 120.0, "second_moment_x": 6.0, "second_moment_y": 6.0, "second_moment_z": 6.0},
    "counterbalance_gas": {"gas_amount": 0.9},
    "coulomb_friction": {"level": (400.0, 500.0, 450.0, 90.0, 110.0, 80.0)},
    "viscous_friction": {"coefficient": (1800.0, 1900.0, 1500.0, 320.0, 550.0, 380.0)},
    "link_encoder_delay": {"delay": LATE_S},
}


def write_kr300(file: Path, rng: np.random.Generator, seconds: float = 10.0) -> None:
    """Write a synthetic log with the columns of a KR300's: the nominal robot with `KR300_TRUTH` along slow sines."""
    robot = load_robot("kr300")
    nominal, effects = compile_robot(robot), catalogue()
    edits = []
    for name, sizes in KR300_TRUTH.items():
        effect = effects[name]
        for place in effect.places(nominal):
            values = {key: float(np.broadcast_to(size, 6)[place.index]) for key, size in sizes.items()}
            edit = effect.edit(place, effect.complete(values), Conditions.reference(6))
            edits += [edit] if edit else []
    time = np.arange(0, seconds, 4e-3)
    rate, size = np.array([0.9, 1.3, 1.1, 1.5, 1.7, 1.9]), np.array([0.4, 0.25, 0.3, 0.5, 0.3, 0.6])
    phase = rate * time[:, None] + np.arange(6)
    q, velocity = size * np.sin(phase), size * rate * np.cos(phase)
    motion = Motion(time, q, velocity, -(rate**2) * q, np.zeros((len(time), 6)), np.ones(len(time), dtype=bool))
    trace, *_ = Prescribed(compile_robot(robot, edits)).follow(motion)
    format_of = log_format_of(robot).columns
    columns = {"time_s": time}
    columns |= {f"q_cmd_{i}_rad": q[:, i - 1] for i in KR300_AXES}
    columns |= {f"q_motor_{i}_rad": 2e-6 * np.round((q[:, i - 1] + 1e-5) / 2e-6) for i in KR300_AXES}
    late = LATE_S * trace.theta_velocity
    columns |= {f"q_link_{i}_rad": (trace.theta - late)[:, i - 1] for i in (1, 2, 3)}
    columns |= {
        f"tau_motor_{i}_Nm": trace.motor_torque[:, i - 1] / format_of[f"tau_motor_{i}_nm"].factor
        + (0.5 if i < 4 else 0.05) * rng.standard_normal(len(time))
        for i in KR300_AXES
    }
    _write(file, columns)


def _write(file: Path, columns: dict[str, np.ndarray]) -> None:
    rows = zip(*columns.values(), strict=True)
    file.write_text("\n".join([",".join(columns), *(",".join(f"{x:.9g}" for x in row) for row in rows)]) + "\n")
