"""Recordings of the arm of which nothing but a drawing is known, and of the same with what nobody stated of it."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from bench.record.campaign import Array, Campaign, Run
from bench.robot.compiled import CompiledRobot
from tests import stranger

SECONDS = 8.0  # [s], of a run
Load = tuple[float, tuple[float, float, float]]  # [kg], and where it is beside the tool [m]
PAYLOAD = 3.0  # [kg], of which nothing is stated
UNSTATED: Load = (PAYLOAD, stranger.MIDDLE)
BALANCED = 60.0  # [Nm], by a spring of which nothing is stated


def recorded(
    compiled: CompiledRobot,
    seed: int,
    more_friction: float = 0.0,
    payload: Load = UNSTATED,
    seconds: float = SECONDS,
) -> Campaign:
    """Return two runs of the real arm, with the Coulomb friction of its second joint raised by a share."""
    rng = np.random.default_rng(seed)
    real = stranger.as_filed(*payload)
    runs = []
    for number in range(2):
        motion = stranger.moved(rng, seconds, real)
        torque = motion.torque.copy()
        torque[:, 1] += more_friction * stranger.COULOMB[1] * np.tanh(motion.velocity[:, 1] / 0.01)
        columns: Mapping[str, Array] = {
            "time_s": motion.time,
            **{f"q_motor_{j + 1}_rad": motion.position[:, j] for j in range(3)},
            **{f"tau_motor_{j + 1}_nm": torque[:, j] for j in range(3)},
        }
        runs.append(Run(f"run{number}", "motion", 100.0 * number, columns))
    return Campaign(str(compiled.robot.folder), tuple(runs))


def with_ripple(campaign: Campaign) -> Campaign:
    """Return the campaign with a torque over the angle of the first joint, of which no listed cause says anything."""
    runs = []
    for run in campaign.runs:
        torque = run.columns["tau_motor_1_nm"] + 3.0 * np.sin(7 * run.columns["q_motor_1_rad"])
        runs.append(replace(run, columns={**run.columns, "tau_motor_1_nm": torque}))
    return replace(campaign, runs=tuple(runs))


def with_interplay(campaign: Campaign, share: float = 0.05) -> Campaign:
    """Return the campaign with torques over all angles at once, a share of those that are there: in no catalogue."""
    runs = []
    for run in campaign.runs:
        columns = dict(run.columns)
        angle = 4 * columns["q_motor_1_rad"] + 3 * columns["q_motor_2_rad"] - 5 * columns["q_motor_3_rad"]
        for j in range(3):
            torque = columns[f"tau_motor_{j + 1}_nm"]
            columns[f"tau_motor_{j + 1}_nm"] = torque + share * np.std(torque) * np.sin(angle + j)
        runs.append(replace(run, columns=columns))
    return replace(campaign, runs=tuple(runs))


def with_balancer(campaign: Campaign) -> Campaign:
    """Return the campaign with a spring that carries a part of what hangs on the second joint; nobody stated it."""
    runs = []
    for run in campaign.runs:
        torque = run.columns["tau_motor_2_nm"] + BALANCED * np.sin(run.columns["q_motor_2_rad"] + 0.1)
        runs.append(replace(run, columns={**run.columns, "tau_motor_2_nm": torque}))
    return replace(campaign, runs=tuple(runs))
