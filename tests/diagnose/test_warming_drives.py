"""Friction that falls as a drive warms up, no thermometer: it settles, where the bench has a steady fall."""

from pathlib import Path

import numpy as np
import pytest

from bench.diagnose.diagnose import Diagnosis, diagnose
from bench.effects.catalogue import LEFT_OUT, catalogue
from bench.identify.dynamics.first_pass import first_pass
from bench.predict.predict import predict
from bench.record.campaign import Array, Campaign, Run
from bench.report.diagnosis.write import write_diagnosis
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from bench.robot.nominal_dynamics import nominal_dynamics
from bench.robot.starter.folder import start_robot
from bench.robot.starter.source import read_source
from tests.stranger import COULOMB, VISCOUS, mjcf, moved

LISTED = (*LEFT_OUT, "rolling_friction", "load_friction", "stribeck", "torque_constant", "friction_warming")
RUNS = 5
APART = 300.0  # [s], from run to run
SETTLES = 900.0  # [s]


@pytest.fixture
def compiled(tmp_path: Path) -> CompiledRobot:
    (tmp_path / "arm.xml").write_text(mjcf())
    return start_robot("arm", read_source(tmp_path / "arm.xml"), tmp_path / "arm").compiled


def warmed_up(share: float, seed: int = 4) -> Campaign:
    """Return runs of an arm, cold at first, whose second drive has lost a share of its friction in the end."""
    rng, every = np.random.default_rng(seed), []
    for k in range(RUNS):
        motion = moved(rng, seconds=12.0, swing=2.0)
        torque = motion.torque.copy()
        torque[:, 1] += (level(k * APART + motion.time, share) - 1) * friction(motion.velocity[:, 1])
        columns = {"time_s": motion.time}
        columns |= {f"q_motor_{j + 1}_rad": motion.position[:, j] for j in range(3)}
        columns |= {f"tau_motor_{j + 1}_nm": torque[:, j] for j in range(3)}
        every.append(Run(f"run{k}", "motion", APART * k, columns))
    return Campaign("warming", tuple(every))


def diagnosed(compiled: CompiledRobot, campaign: Campaign) -> Diagnosis:
    first = first_pass(campaign, nominal_dynamics(compiled))
    effects = {name: catalogue()[name] for name in LISTED}
    return diagnose(campaign, compiled, effects, first=first)


def level(since: Array, share: float) -> Array:
    return np.asarray(1 - share * (1 - np.exp(-since / SETTLES)))


def friction(velocity: Array) -> Array:
    return np.asarray(COULOMB[1] * np.tanh(velocity / 0.01) + VISCOUS[1] * velocity)


LEFT = {(name, f"joint {j}") for name in ("coulomb_friction", "viscous_friction") for j in (1, 2, 3)}


def test_it_is_named_at_its_drive_and_friction_of_the_middle_is_handed_over(
    compiled: CompiledRobot, tmp_path: Path
) -> None:
    """Of drives that warmed up by a tenth, "nothing that was tried explains that" was all that a verdict said."""
    campaign = warmed_up(0.2)
    found = diagnosed(compiled, campaign)
    best = found.verdict.explanations[0]
    assert {cause.name for cause in best.causes} == {*LEFT, ("friction_warming", "joint 2")}
    (rate,) = next(cause for cause in best.causes if cause.effect == "friction_warming").parameters
    times = APART * np.arange(RUNS) + 6.0
    true = -3600 * np.polyfit(times, np.log(level(times, 0.2)), 1)[0]  # [1/h], the steady fall that is nearest
    assert rate.low < true < rate.high
    (out := tmp_path / "out").mkdir()
    write_diagnosis(found, out, campaign)
    handed = compile_robot(load_robot(out / "robot"))
    middle = np.exp(np.mean(np.log(level(times, 0.2))))
    assert handed.motor_coulomb[1] == pytest.approx(middle * COULOMB[1], rel=0.03)  # it began with a tenth more


@pytest.mark.parametrize("share", [0.2, pytest.param(0.5, marks=pytest.mark.study)])
def test_a_promise_counts_with_how_warm_drives_will_be(compiled: CompiledRobot, tmp_path: Path, share: float) -> None:
    """A robot is handed over with friction of the middle: what fell around that comes again in the next recording."""
    campaign = warmed_up(share)
    found = diagnosed(compiled, campaign)
    (out := tmp_path / "out").mkdir()
    write_diagnosis(found, out, campaign)
    handed = compile_robot(load_robot(out / "robot"))
    runs = [Campaign("next", (run,)) for seed in (9, 10) for run in warmed_up(share, seed=seed).runs]
    channels = [predict(one, handed, compiled, found.verdict.predicted).recordings[0].channels[1] for one in runs]
    assert {one.channel for one in channels} == {"tau_motor_2_nm"}
    assert np.mean([one.answer == "kept" for one in channels]) >= 0.9
    left = [one.rms for one in channels]
    assert max(left) > 3 * np.median(left)  # a cold drive is not what a session has most of the time


def test_friction_that_stays_is_said_to_stay(compiled: CompiledRobot) -> None:
    best = diagnosed(compiled, warmed_up(0.0)).verdict.explanations[0]
    assert {cause.name for cause in best.causes} == LEFT
