"""Weights that are not what was written down: the drives paid for others."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.plausibility.hints import hints_of
from bench.hide.campaign import hide_campaign
from bench.identify.arm import Arm
from bench.identify.from_campaign import static_readings
from bench.identify.weights_by_drives import CHANCE, WeightsByDrives, weights_by_drives
from bench.record.campaign import Array, Campaign
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from bench.robot.links import rigid_bodies
from bench.scenario.loading import Loading

WEIGHTS = (500.0, 1000.0, 1500.0)
POSES = (
    (0, 0, 0, 0, 60, 0),
    (20, 30, -30, 40, 60, 10),
    (-30, 50, -20, -60, 40, 30),
    (40, -10, 30, 100, -50, 0),
    (10, 60, -60, 20, 80, -40),
)
LOADS = Loading.model_validate(
    {
        "experiment": "loading",
        "robot": "hh150",
        "repeats": 3,
        "poses": [{"q_deg": pose, "force_n": WEIGHTS} for pose in POSES],
    }
)
SAID = 1.15  # times the true weight of 1000 N


@pytest.fixture(scope="module")
def compiled() -> CompiledRobot:
    return compile_robot(load_robot("hh150"))


@pytest.fixture(scope="module")
def sound() -> Campaign:
    """Return loads without a force sensor, as an owner of weights alone has them."""
    robot = load_robot("hh150")
    return hide_campaign(robot, LOADS, [], np.random.default_rng(50), without=("force",)).campaign


def changed(campaign: Campaign, change: Callable[[dict[str, Array], Array], None], runs: int = len(POSES)) -> Campaign:
    """Return a campaign with columns changed in its first runs; `change` is told where the weight of 1000 N hangs."""
    found = []
    first = {run.name.split("-")[0] for run in campaign.runs[: 2 * runs]}
    for run in campaign.runs:
        columns = dict(run.columns)
        if run.name.split("-")[0] in first:
            change(columns, np.abs(columns["load_z_n"] + WEIGHTS[1]) < 20)
        found.append(replace(run, columns=columns))
    return replace(campaign, runs=tuple(found))


def said_of(campaign: Campaign, compiled: CompiledRobot) -> WeightsByDrives:
    known = compiled.robot.figures.uncertainty.load
    readings = static_readings(campaign, compiled.robot.figures)
    found = weights_by_drives(Arm(rigid_bodies(compiled)), compiled.counterbalance, readings, known)
    assert found
    print(f"chance {found.chance:.1e}: {found.words}")
    return found


def mislabelled(columns: dict[str, Array], there: Array) -> None:
    columns["load_z_n"] = np.where(there, SAID * columns["load_z_n"], columns["load_z_n"])


def test_sound_weights_are_not_doubted(compiled: CompiledRobot, sound: Campaign) -> None:
    found = said_of(sound, compiled)
    assert found.chance > 1e-2
    assert len(found.weights) == len(WEIGHTS)
    assert np.all(np.abs(found.heavier) < 3 * found.sigma)


def test_one_weight_that_is_wrong_in_all_poses(compiled: CompiledRobot, sound: Campaign) -> None:
    """90 kg in place of 100 all day gave one of six right stiffnesses, without a word."""
    wrong = changed(sound, mislabelled)
    found = said_of(wrong, compiled)
    assert found.are_wrong
    other = (1 + found.heavier[1]) / (1 + found.heavier[0])
    assert other == pytest.approx(1 / SAID, abs=3 * found.apart_sigma.max())
    hints = [hint for hint in hints_of(wrong, compiled) if "other weights hung" in hint.message]
    assert [(hint.level, hint.column) for hint in hints] == [("warning", "load_z_n")]
    assert not any("other weights hung" in hint.message for hint in hints_of(sound, compiled))


def test_all_weights_that_are_wrong_alike(compiled: CompiledRobot, sound: Campaign) -> None:
    wrong = changed(sound, lambda columns, _: columns.update(load_z_n=1.4 * columns["load_z_n"]))
    assert said_of(wrong, compiled).are_wrong


def test_what_one_joint_or_one_pose_alone_says_is_not_believed(compiled: CompiledRobot, sound: Campaign) -> None:
    def current(columns: dict[str, Array], there: Array) -> None:
        columns["current_2_a"] = np.where(there, 1.1 * columns["current_2_a"], columns["current_2_a"])

    for one in (changed(sound, current), changed(sound, mislabelled, runs=1)):
        assert said_of(one, compiled).chance > 100 * CHANCE


def test_weights_that_hang_in_one_pose_each_are_not_judged(compiled: CompiledRobot) -> None:
    """Friction of that pose alone would make them wrong."""
    poses = [{"q_deg": pose, "force_n": (400 + 60 * i, 1000 + 100 * i)} for i, pose in enumerate(POSES)]
    loading = Loading.model_validate(LOADS.model_dump() | {"poses": poses})
    campaign = hide_campaign(load_robot("hh150"), loading, [], np.random.default_rng(1)).campaign
    readings = static_readings(campaign, compiled.robot.figures)
    assert weights_by_drives(Arm(rigid_bodies(compiled)), compiled.counterbalance, readings, 0.001) is None
