"""What hangs beside the axis of a light wrist, or rubs less than a file says, is no error of its channel."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.diagnose.plausibility.hints import doubts_and_hints_of
from bench.identify.drive_model import Motion
from bench.record.campaign import Array, Campaign, Run
from bench.record.finding import Finding
from bench.robot.compiled import CompiledRobot
from bench.robot.nominal_dynamics import NominalDynamics, nominal_dynamics
from bench.robot.starter.folder import start_robot
from bench.robot.starter.source import read_source
from bench.store.place import open_store
from tests import seven_joints
from tests.rigid_links import link_torque

TOOL_KG, ASIDE_M = 1.5, np.array([0.12, -0.08, 0.1])  # in the axes of the last link: as heavy as that
DAMPING = 2.0  # [Nm s/rad] of the file, for each joint; as drives have it, a tenth
LIMITS = (200.0, 200.0, 190.0, 180.0, 120.0, 110.0, 101.0)  # [Nm], alike enough for one damping to be believed
NOISE_NM = 0.02


def arm_of(folder: Path) -> CompiledRobot:
    text = seven_joints.mjcf().replace('range="-2.9 2.9"', f'range="-2.9 2.9" damping="{DAMPING}"')
    motors = "".join(f'<motor joint="j{j}" ctrlrange="-{limit} {limit}"/>' for j, limit in enumerate(LIMITS, start=1))
    (folder / "seven.xml").write_text(text.replace("</mujoco>", f"<actuator>{motors}</actuator></mujoco>"))
    return start_robot("seven", read_source(folder / "seven.xml"), folder / "seven").compiled


def with_tool(arm: NominalDynamics) -> NominalDynamics:
    mass, com = arm.bodies.mass.copy(), arm.bodies.com.copy()
    com[-1] = (mass[-1] * com[-1] + TOOL_KG * ASIDE_M) / (mass[-1] + TOOL_KG)
    mass[-1] += TOOL_KG
    return replace(arm, bodies=replace(arm.bodies, mass=mass, com=com))


def paid(arm: NominalDynamics, motion: Motion, viscous: float, rng: np.random.Generator) -> Array:
    """Return torques of an arm, shape (T, 7) [Nm]."""
    links = link_torque(arm.bodies, motion) + arm.rotor_inertia * motion.acceleration
    noise: Array = NOISE_NM * rng.normal(size=links.shape)
    return links + 0.3 * np.tanh(motion.velocity / 0.01) + viscous * motion.velocity + noise


@pytest.mark.parametrize(("tool", "viscous"), [(True, DAMPING), (False, 0.1 * DAMPING), (True, 0.1 * DAMPING)])
def test_no_channel_of_a_light_wrist_is_taken_for_another(
    tmp_path: Path, rng: np.random.Generator, *, tool: bool, viscous: float
) -> None:
    """A Panda's last drive "looked scaled 4.75 times" for a tool beside its axis, and "hardly what its drive did"."""
    assert findings(tmp_path, rng, tool=tool, viscous=viscous) == []


def findings(folder: Path, rng: np.random.Generator, *, tool: bool, viscous: float) -> list[Finding]:
    compiled = arm_of(folder)
    arm = nominal_dynamics(compiled)
    assert np.all(arm.viscous == DAMPING)
    runs = []
    for k in range(3):
        log = seven_joints.moved(arm, rng)
        motion = Motion.along(log.time, log.angle)
        torque = paid(with_tool(arm) if tool else arm, motion, viscous, rng)
        columns = {"time_s": log.time}
        columns |= {f"q_motor_{j + 1}_rad": log.angle[:, j] for j in range(seven_joints.N)}
        columns |= {f"tau_motor_{j + 1}_nm": torque[:, j] for j in range(seven_joints.N)}
        runs.append(Run(f"run{k}", "motion", 100.0 * k, columns))
    campaign = Campaign("seven", tuple(runs))
    return list(doubts_and_hints_of(campaign, compiled, store=open_store()))
