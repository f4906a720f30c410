"""Figures that are a little wrong: what a deviation makes of them."""

from dataclasses import replace

import numpy as np
import pytest

from bench.effects.figure_edits import LEAST_SHARE
from bench.effects.nominal import factor_of, nominal_parameters
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot


@pytest.fixture(scope="module")
def compiled() -> CompiledRobot:
    return compile_robot(load_robot("kr300"))


@pytest.mark.parametrize("sigma", [0.02, 0.1, 3.0])
def test_one_standard_deviation_is_one_factor_up_or_down(sigma: float) -> None:
    assert factor_of(0.0, sigma) == 1
    assert factor_of(sigma, sigma) == pytest.approx(1 + sigma)
    assert factor_of(-2 * sigma, sigma) == pytest.approx((1 + sigma) ** -2)


@pytest.mark.parametrize("sigma", [0.02, 3.0])
def test_a_hopeless_fit_still_meets_numbers(sigma: float) -> None:
    """Four to the power of a thousand is none, and a gear of 3.8e11 Nm/rad none that a robot folder takes."""
    low, high = factor_of(-1e3 * sigma, sigma), factor_of(1e3 * sigma, sigma)
    assert 0 < low < 1 < high < np.inf
    assert high == pytest.approx(1 / low)
    assert high < 2e3


def test_what_is_known_to_a_few_per_cent_is_off_by_a_share() -> None:
    assert factor_of(0.03, 0.02) - 1 == pytest.approx(0.03, abs=0.02**2)


def test_a_stiffness_that_is_known_to_a_factor_of_a_few_stays_one(compiled: CompiledRobot) -> None:
    """With 1 - 3 sigma, and no less than a twentieth, a joint without a second encoder was once handed over so soft."""
    (stiffness,) = (one for one in nominal_parameters(compiled) if one.name == "stiffness of joint5")
    assert stiffness.sigma == 3.0  # else the test says nothing
    made = [
        compile_robot(compiled.robot, (stiffness.edit(x * stiffness.sigma),)).stiffness[4] / compiled.stiffness[4]
        for x in (-3.0, -1.0, 1.0)
    ]
    np.testing.assert_allclose(made, [4.0**-3, 1 / 4, 4])


def test_torques_are_linear_in_inertias_and_these_may_as_good_as_vanish(compiled: CompiledRobot) -> None:
    """As a factor, a rotor that a torque sensor does not feel was never reached, and slopes about it led nowhere."""
    (rotor,) = (one for one in nominal_parameters(compiled) if one.name == "rotor inertia of joint5")
    dof = compiled.model.joint(compiled.robot.figures.drives[4].rotor).dofadr[0]
    stated = compiled.model.dof_armature[dof]
    made = [compile_robot(compiled.robot, (rotor.edit(x),)).model.dof_armature[dof] for x in (-5.0, -0.5, 2.0)]
    np.testing.assert_allclose(made, stated * np.array([1 + LEAST_SHARE, 0.5, 3.0]))
    assert rotor.off_by(-5.0) == rotor.least == LEAST_SHARE


def test_a_deviation_says_by_how_much_a_figure_is_off(compiled: CompiledRobot) -> None:
    named = {one.name: one for one in nominal_parameters(compiled)}
    assert named["stiffness of joint2"].off_by(-3.0) == pytest.approx(-0.75)
    assert named["centre of mass of wrist, x"].off_by(0.002) == 0.002


def test_each_drive_has_the_uncertainty_that_is_stated_of_it(compiled: CompiledRobot) -> None:
    """Names are those of a robot that states one number; what is stated as known exactly is no parameter."""
    joints = [drive.joint for drive in compiled.robot.figures.drives]
    stated = {
        "friction": ("motor-side Coulomb friction of", (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)),
        "rotor_inertia": ("rotor inertia of", (0.1, 3.0, 0.1, 0.0, 0.1, 0.2)),
        "stiffness": ("stiffness of", (0.03, 0.03, 3.0, 0.0, 0.03, 1.0)),
    }
    known = compiled.robot.figures.uncertainty
    known = known.model_copy(update={key: numbers for key, (_, numbers) in stated.items()})
    figures = compiled.robot.figures.model_copy(update={"uncertainty": known})
    found = {
        one.name: one for one in nominal_parameters(replace(compiled, robot=replace(compiled.robot, figures=figures)))
    }
    assert set(found) < {one.name for one in nominal_parameters(compiled)}
    for words, numbers in stated.values():
        sigmas = [found[f"{words} {joint}"].sigma if f"{words} {joint}" in found else 0.0 for joint in joints]
        assert sigmas == list(numbers)
    for words in ("link-side Coulomb", "viscous"):
        assert [found[f"{words} friction of {joint}"].sigma for joint in joints] == list(stated["friction"][1])
    factor = found[f"stiffness of {joints[2]}"]
    stiffness = compile_robot(compiled.robot, (factor.edit(factor.sigma),)).stiffness
    np.testing.assert_allclose(stiffness / compiled.stiffness, [1, 1, 4, 1, 1, 1])


@pytest.mark.parametrize("name", ["hh150", "kr300"])  # diagonal inertias, and full ones
def test_links_that_nobody_knows_have_moments_of_inertia_that_can_exist(name: str) -> None:
    robot = load_robot(name)
    stated = {one.name: one for one in nominal_parameters(compile_robot(robot))}
    known = robot.figures.uncertainty.model_copy(update={"links": 1 / robot.figures.uncertainty.mass})
    robot = replace(robot, figures=robot.figures.model_copy(update={"uncertainty": known}))
    compiled = compile_robot(robot)
    unknown = {one.name: one for one in nominal_parameters(compiled)}
    spreads = [one for one in unknown.values() if one.name not in stated]
    assert len(spreads) >= 3 * compiled.n_joints
    for one in stated.values():
        times = known.links if one.name.startswith(("mass of", "centre of mass of")) else 1.0
        assert (unknown[one.name].sigma, unknown[one.name].widened) == pytest.approx((times * one.sigma, times))
    for one in spreads:
        body = one.name.removeprefix("spread of the mass of ").split(" along")[0]
        before = np.sort(compiled.model.body(body).inertia)
        np.testing.assert_allclose(np.sort(compile_robot(robot, [one.edit(0.0)]).model.body(body).inertia), before)
        for deviation in (one.least, -3 * one.sigma, one.sigma, 10.0):
            low, middle, high = np.sort(compile_robot(robot, [one.edit(deviation)]).model.body(body).inertia)
            assert low + middle - high > 0
            assert not np.allclose([low, middle, high], before, rtol=1e-3)
