"""Loads that are pulled aside: their size and direction are figures, anew in each run, where the robot states them."""

from dataclasses import replace

import numpy as np
import pytest

from bench.compare.levels import is_of_machine
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.replay.fitted import figures_with
from bench.diagnose.replay.nuisances import PULL_DIRECTION, PULLED
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.world import NOMINAL, World
from bench.hide.background import Background
from bench.hide.campaign import hide_campaign
from bench.record.campaign import Campaign
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.fitted import Fitted
from bench.robot.folder import load_robot
from bench.scenario.loading import Loading
from bench.simulate.instruments import is_slanting
from tests.diagnose.noise_free import linearised
from tests.diagnose.small_models import chi_square_left
from tests.diagnose.sweeps import LOADS

SIZE, TURN = 0.004, 0.003
FIGURES = [PULLED, *(f"{PULL_DIRECTION}{axis}" for axis in "xyz")]
ASIDE = Loading.model_validate(
    LOADS.model_dump()
    | {
        "poses": [
            {"q_deg": (0, 0, 0, 0, 60, 0), "force_n": (700, 1400)},
            {"q_deg": (20, 30, -30, 40, 60, 10), "force_n": (700, 1400), "direction": (0, -1, -1)},
            {"q_deg": (-20, 20, -20, 40, 50, 10), "force_n": (700, 1400), "direction": (-1, 0, -1)},
        ]
    }
)


def stating(size: float, turn: float) -> CompiledRobot:
    robot = load_robot("hh150")
    known = robot.figures.uncertainty.model_copy(update={"pull": size, "pull_rad": turn})
    return compile_robot(replace(robot, figures=robot.figures.model_copy(update={"uncertainty": known})))


@pytest.fixture(scope="module")
def campaign() -> Campaign:
    return hide_campaign(load_robot("hh150"), ASIDE, [], np.random.default_rng(5)).campaign


@pytest.fixture(scope="module")
def linear(campaign: Campaign) -> LinearisedModel:
    return linearised(campaign, stating(SIZE, TURN))


def test_each_run_in_which_a_load_is_pulled_aside_has_errors_of_its_own(
    campaign: Campaign, linear: LinearisedModel
) -> None:
    assert not any(PULLED in one.name for one in linearised(campaign).nuisances)
    found = {one.name: i for i, one in enumerate(linear.nuisances) if PULLED in one.name}
    aside = [
        run.name
        for run in campaign.runs
        if np.any(run.columns.get("load_x_n", 0)) or np.any(run.columns.get("load_y_n", 0))
    ]
    assert 1 < len(aside) < len(campaign.runs)
    assert set(found) == {*FIGURES, *(f"{name}, in run {run}" for name in FIGURES for run in aside)}
    assert not any(is_of_machine(linear.nuisances[i]) for i in found.values())
    assert {linear.nuisances[i].between for i in found.values()} == {"anew"}
    hung = np.concatenate([~is_slanting(one.motion.wrench[one.motion.read])[:, 0] for one in linear.segments])
    vertical = np.concatenate([np.full(len(one), one.run not in aside) for one in linear.segments])
    for name in FIGURES:
        change = linear.sensitivities[:, :, found[name]]
        assert np.nanmax(np.abs(change[~hung])) > 0
        np.testing.assert_allclose(change[vertical], 0.0, atol=1e-9)
        parts = sum(linear.sensitivities[:, :, found[f"{name}, in run {run}"]] for run in aside)
        np.testing.assert_allclose(parts[~vertical], change[~vertical], atol=1e-12)


def test_a_load_cell_that_is_a_little_off_in_one_pose_is_no_wrong_load(
    campaign: Campaign, linear: LinearisedModel
) -> None:
    """Of a stranger's unchanged days "load at the hook of run pose2" was named: two other loads were pulled."""
    run = next(one for one in campaign.runs if np.any(one.columns.get("load_y_n", 0)))
    off = {name: 1.006 * run.columns[name] for name in run.columns if name.startswith("load_") and name.endswith("_n")}
    off["load_y_n"] = off["load_y_n"] - 0.004 * off["load_z_n"]
    wrong = replace(run, columns={**run.columns, **off})
    told = replace(campaign, runs=tuple(wrong if one is run else one for one in campaign.runs))
    plain, stated = linearised(told), linearised(told, stating(SIZE, TURN))
    sound = chi_square_left(linear, linear.white)
    left = [chi_square_left(one, one.white) - sound for one in (plain, stated)]
    print(
        f"chi-square {left[0]:.0f} more than of right loads where pulls have no figures, {left[1]:.0f} where they have"
    )
    assert left[0] > 2 * np.log(1e6)
    assert left[1] < 10.0


def test_figures_hold_what_was_fitted_of_them(linear: LinearisedModel) -> None:
    compiled = linear.replay.compiled
    off = {one: 0.7 * one.sigma for one in linear.nuisances if one.name in FIGURES}
    _, weights, left = figures_with(compiled, off)
    assert left == ()
    assert weights.pulled == pytest.approx(0.7 * SIZE)
    held = compiled.robot.figures.model_copy(update={"fitted": Fitted.model_validate({"weights": weights})})
    robot = compile_robot(replace(compiled.robot, figures=held))
    campaign = linear.segments, linear.quantities, 1e-9
    fitted, expected = Replay(robot, *campaign).predict(NOMINAL), Replay(compiled, *campaign).predict(World(off))
    np.testing.assert_allclose(fitted, expected, rtol=1e-6, atol=1e-9)


def test_what_is_hidden_draws_them_where_they_are_stated() -> None:
    down, aside = np.array([[0, 0, -1e3, 0, 0, 0.0]]), np.array([[0, -1e3, -1e3, 0, 0, 0.0]])
    plain = Background.draw(stating(0.0, 0.0), np.random.default_rng(1))
    stated = [Background.draw(stating(SIZE, TURN), np.random.default_rng(seed)) for seed in range(200)]
    assert plain.hung == stated[1].hung
    np.testing.assert_array_equal(plain.loads(aside), (1 + plain.hung) * aside)
    np.testing.assert_array_equal(stated[1].loads(down), (1 + stated[1].hung) * down)
    sizes = [np.linalg.norm(one.loads(aside)) / np.linalg.norm(aside) / (1 + one.hung) - 1 for one in stated]
    turns = [one.loads(aside)[0, 0] / 1e3 for one in stated]  # about y and z
    assert np.std(sizes) == pytest.approx(SIZE, rel=0.2)
    assert np.std(turns) == pytest.approx(np.sqrt(2) * TURN, rel=0.2)
