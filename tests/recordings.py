"""Measured data that are not part of the repository, and stand-ins of the same format."""

import os
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[1]
KR300_AXES = range(1, 7)


def data_folder(name: str) -> Path:
    """Return the folder of a data set, from `BENCH_DATA` or beside the repository; skip the test where it is absent."""
    folder = Path(os.environ.get("BENCH_DATA", ROOT.parent / "shared" / "data")) / name
    if not folder.is_dir():
        pytest.skip(f"measured data {name!r} are not here; set BENCH_DATA to the folder that holds them")
    return folder


def write_emps(file: Path, rng: np.random.Generator, seconds: float = 6.0) -> dict[str, float]:
    """Write a synthetic log as the EMPS makes them; return what it was made with."""
    truth = {"inertia": 90.0, "viscous": 220.0, "coulomb": 18.0, "offset": -2.0}
    time = np.arange(0, seconds, 1e-3)
    rate = 2 * np.pi / 3
    position = 0.12 * (1 - np.cos(rate * time))
    velocity, acceleration = 0.12 * rate * np.sin(rate * time), 0.12 * rate**2 * np.cos(rate * time)
    force = truth["inertia"] * acceleration + truth["viscous"] * velocity + truth["offset"]
    force = force + truth["coulomb"] * np.sign(velocity) + 2.0 * rng.standard_normal(len(time))
    seen = 5e-8 * np.round(position / 5e-8)
    _write(file, {"time_s": time, "q_cmd_m": position + 1e-5, "q_m": seen, "u_V": force / 35.15065188248547})
    return truth


def write_kr300(file: Path, rng: np.random.Generator, seconds: float = 4.0) -> None:
    """Write a synthetic log with the columns of a KR300's; torques are plain sines and noise."""
    time = np.arange(0, seconds, 4e-3)
    swing = [0.3 * np.sin((1 + 0.2 * i) * time) for i in KR300_AXES]
    columns = {"time_s": time}
    columns |= {f"q_cmd_{i}_rad": q for i, q in zip(KR300_AXES, swing, strict=True)}
    columns |= {
        f"q_motor_{i}_rad": q + 1e-5 * rng.standard_normal(len(time)) for i, q in zip(KR300_AXES, swing, strict=True)
    }
    columns |= {f"q_link_{i}_rad": columns[f"q_motor_{i}_rad"] - 1e-4 * np.sin(time * i) for i in (1, 2, 3)}
    columns |= {
        f"tau_motor_{i}_Nm": np.cos((1 + 0.2 * i) * time) + 0.1 * rng.standard_normal(len(time)) for i in KR300_AXES
    }
    _write(file, columns)


def _write(file: Path, columns: dict[str, np.ndarray]) -> None:
    rows = zip(*columns.values(), strict=True)
    file.write_text("\n".join([",".join(columns), *(",".join(f"{x:.9g}" for x in row) for row in rows)]) + "\n")
