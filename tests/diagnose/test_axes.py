"""Axes of joints that lean: on every real arm by some tenths of a milliradian, and no cause."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from bench.diagnose.replay.nuisances import nuisances_of
from bench.diagnose.replay.quantities import quantities_of
from bench.effects.nominal import nominal_parameters
from bench.hide.campaign import hide_campaign
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from bench.scenario.files import read_scenario
from tests.diagnose.noise_free import linearised
from tests.diagnose.small_models import chi_square_left
from tests.diagnose.sweeps import LOADS, made

LEAN = 3e-4  # [rad]


@pytest.fixture(scope="module")
def leaning() -> CompiledRobot:
    """Return the HH-150 as a robot whose axes are not known to be as drawn."""
    robot = load_robot("hh150")
    known = robot.figures.uncertainty.model_copy(update={"axis_rad": LEAN})
    return compile_robot(replace(robot, figures=robot.figures.model_copy(update={"uncertainty": known})))


def test_an_axis_leans_and_all_stays_where_it_is_at_zero(leaning: CompiledRobot) -> None:
    axes = {one.name: one for one in nominal_parameters(leaning) if one.name.startswith("direction of the axis")}
    assert len(axes) == 2 * leaning.n_joints
    pair = [axes[f"direction of the axis of joint2, across {i}"] for i in (1, 2)]
    for one in pair:
        turned = compile_robot(leaning.robot, [one.edit(LEAN)])
        found, data = [], mujoco.MjData(leaning.model)
        for model in (leaning.model, turned.model):
            data = mujoco.MjData(model)
            mujoco.mj_kinematics(model, data)
            found.append((data.xaxis[leaning.at.joint[1]].copy(), data.site_xpos.copy()))
        (before, there), (after, still_there) = found
        assert np.arccos(before @ after) == pytest.approx(LEAN, rel=1e-3)
        np.testing.assert_allclose(still_there, there, atol=1e-12)
    leans = [compile_robot(leaning.robot, [one.edit(LEAN)]).model.jnt_axis[leaning.at.joint[1]] for one in pair]
    drawn = leaning.model.jnt_axis[leaning.at.joint[1]]
    assert (leans[0] - drawn) @ (leans[1] - drawn) == pytest.approx(0, abs=1e-9)


def test_without_a_tracker_nothing_shows_them(leaning: CompiledRobot) -> None:
    names = [
        {one.name for one in nuisances_of(leaning, quantities_of(made(LOADS, 5, without=without).runs, leaning))}
        for without in ((), ("tracker",))
    ]
    seen = [sum(name.startswith("direction of the axis") for name in some) for some in names]
    assert seen == [2 * leaning.n_joints, 0]


def test_axes_that_lean_are_told_by_these_figures(leaning: CompiledRobot) -> None:
    """Of a stranger's arm whose axes leaned by 0.3 mrad, jumps of the tracker and eccentric encoders were named."""
    session = read_scenario("session-short")
    campaign = hide_campaign(leaning.robot, session, [], np.random.default_rng(11)).campaign
    linear = linearised(campaign, leaning)
    without, with_them = (chi_square_left(linear, linear.white, *names) for names in (("direction of the axis",), ()))
    print(f"chi-square {without:.0f} without, {with_them:.0f} with directions of axes, of {len(linear.white)} readings")
    assert without - with_them > 2 * np.log(1e6)  # what a cause would have had to explain
    assert with_them < 1.2 * len(linear.white)
