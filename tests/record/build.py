"""Healthy recordings to break: a sweep of one joint with gravity and friction, and loading at two poses."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from bench.record.campaign import Arm, Array, Campaign, Run
from bench.record.check import examine_all
from bench.record.csv_table import write as write_csv
from bench.record.finding import Finding
from bench.record.rules.sheet import Sheet

ARM = Arm(is_slide=(False, False), limits=((-3.0, 3.0), (-1.5, 2.5)))
STEP_S = 0.004
FOLLOWING_S = 0.03  # an ordinary servo is this far behind its command

MANIFEST = "format: 1\nrobot: small\nruns:\n  - {name: a, kind: KIND, start_s: 0}\n"


def sweep(seed: int | None = 1) -> dict[str, Array]:
    """Drive 2 goes there and back, drive 1 stands; with noise unless the seed is None."""
    time = np.arange(2500) * STEP_S
    rng = np.random.default_rng(seed)

    def read(values: Array, sigma: float, resolution: float) -> Array:
        noise = rng.normal(0, sigma, len(time)) if seed is not None else 0.0
        return np.round((values + noise) / resolution) * resolution

    angle = 0.4 * (1 - np.cos(2 * np.pi * time / time[-1]))
    behind = np.interp(time - FOLLOWING_S, time, angle)
    speed = np.gradient(behind, STEP_S)
    torque = 900.0 * np.cos(behind) + 80.0 * np.tanh(speed / 1e-3) + 200.0 * np.gradient(speed, STEP_S)
    return {
        "time_s": time,
        "q_cmd_1_rad": np.zeros_like(time),
        "q_cmd_2_rad": angle,
        "q_motor_1_rad": read(np.zeros_like(time), 1e-7, 2e-7),
        "q_motor_2_rad": read(behind, 1e-7, 2e-7),
        "q_link_2_rad": read(behind - torque / 2e5, 1e-6, 1e-7),
        "current_1_a": read(np.zeros_like(time), 0.02, 0.01),
        "current_2_a": read(torque / 100, 0.02, 0.01),
        "tau_motor_2_nm": read(torque, 0.5, 1e-3),
        "reflector_1_x_m": read(1.9 * np.cos(behind), 2e-5, 1e-6),
        "reflector_1_y_m": np.zeros_like(time),
        "reflector_1_z_m": read(1.9 * np.sin(behind), 2e-5, 1e-6),
        "gas_pressure_pa": read(1.2e7 + 1e6 * behind, 1e4, 1e5),
        "gear_temperature_1_k": np.full_like(time, 301.5),
        "gear_temperature_2_k": np.full_like(time, 301.5),
    }


def loading(seed: int | None = 1) -> dict[str, Array]:
    """Two poses, both approaches, three loads up and down, three repeats; with noise unless the seed is None."""
    force = [0.0, 300.0, 600.0, 900.0, 600.0, 300.0, 0.0]
    rows = np.array(
        [
            (pose, approach, step, repeat, load)
            for pose in (1, 2)
            for approach in (1, -1)
            for step, load in enumerate(force)
            for repeat in (1, 2, 3)
        ],
        dtype=np.float64,
    )
    pose, approach, step, repeat, load = rows.T
    rng = np.random.default_rng(seed)

    def noise(sigma: float) -> Array:
        return rng.normal(0, sigma, len(rows)) if seed is not None else np.zeros(len(rows))

    torque = 900 + 1.5 * load + 60 * approach
    return {
        "time_s": 5.0 * np.arange(len(rows)),
        "pose": pose,
        "approach": approach,
        "load_step": step,
        "repeat": repeat,
        "q_cmd_1_rad": np.zeros(len(rows)),
        "q_cmd_2_rad": 0.3 * pose,
        "q_motor_1_rad": noise(1e-7),
        "q_motor_2_rad": 0.3 * pose + noise(1e-7),
        "current_1_a": noise(0.02),
        "current_2_a": torque / 100 + noise(0.02),
        "tau_motor_2_nm": torque + noise(0.1),
        "load_x_n": np.zeros(len(rows)),
        "load_z_n": -load,
        "force_x_n": np.zeros(len(rows)),
        "force_z_n": -load + noise(0.5),
        "moment_x_nm": np.zeros(len(rows)),
        "reflector_1_x_m": 2.0 + noise(2e-5),
        "reflector_1_y_m": np.zeros(len(rows)),
        "reflector_1_z_m": 1.0 - 0.5 * pose - 1e-6 * load + noise(2e-5),
    }


def motion(columns: Mapping[str, Array], name: str = "a", start_s: float = 0.0) -> Run:
    return Run(name, "motion", start_s, columns)


def static(columns: Mapping[str, Array], name: str = "a", start_s: float = 0.0) -> Run:
    return Run(name, "static", start_s, columns)


def session(seed: int | None = 1) -> Campaign:
    return Campaign("small", (static(loading(seed), "loading"), motion(sweep(seed), "sweep", 3600.0)))


def examine(run: Run, arm: Arm | None = None) -> list[Finding]:
    """Put one run through the rules, as if it stood in runs/<name>.csv."""
    return examine_all([Sheet(run, f"runs/{run.name}.csv", tuple(run.columns), arm)])


def only(findings: list[Finding]) -> Finding:
    """Return the one finding there is; the message of the assertion lists them."""
    assert len(findings) == 1, "\n".join(map(str, findings)) or "nothing found"
    return findings[0]


def write_folder(folder: Path, run: Run) -> Path:
    """Write a run by other means than `write_campaign`, which would refuse a faulty one."""
    (folder / "runs").mkdir(parents=True)
    (folder / "campaign.yaml").write_text(MANIFEST.replace("KIND", run.kind))
    write_csv(folder / "runs" / "a.csv", run.columns)
    return folder
