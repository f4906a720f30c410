"""The study of methods over protocols: what each does to a scenario, and what friction then does to the methods."""

from dataclasses import replace

import numpy as np
import pytest

from bench.executor.serial import SERIAL
from bench.identify.arm import Arm
from bench.report.paper.methods.protocols import PROTOCOLS, Protocol, in_words, sides_of_load
from bench.report.paper.methods.study import METHODS, Condition, ConditionResult, study_methods
from bench.report.paper.methods.survival import SIDES, UnderProtocol, lab_advice, survivals
from bench.report.paper.methods.table6 import NeededFriction, needed_friction
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.robot.links import rigid_bodies
from bench.scenario.files import read_as
from bench.scenario.loading import Loading
from bench.simulate.loading import load_steps, loading_sittings

BY_NAME = {protocol.name: protocol for protocol in PROTOCOLS}
NO_NOISE = 0  # seeds: ideal instruments
EXACT = 0.005  # issue 1: noise free, the right method recovers every observable stiffness within 0.5 %


def nothing(done: float) -> None:
    assert 0 <= done <= 1


@pytest.fixture(scope="module")
def scenario() -> Loading:
    return read_as(Loading, "loading")


@pytest.fixture(scope="module")
def arm() -> Arm:
    return Arm(rigid_bodies(compile_robot(load_robot("hh150"))))


def study(scenario: Loading, name: str, share: float) -> ConditionResult:
    condition = Condition(link_share=share, protocol=BY_NAME[name])
    return study_methods(scenario, [condition], NO_NOISE, nothing, SERIAL)[0]


def test_protocols_say_which_loads_come_in_which_order(scenario: Loading, arm: Arm) -> None:
    def forces(name: str, pose: int) -> list[float]:
        done = BY_NAME[name].of(scenario, arm, "load_point")
        return [float(np.linalg.norm(wrench)) for wrench in load_steps(done.poses[pose], done.unload)]

    rising = [0, *scenario.poses[0].force_n]
    np.testing.assert_allclose(forces("below", 0), rising)
    np.testing.assert_allclose(forces("both-unloading", 0), rising + rising[-2::-1])
    np.testing.assert_allclose(forces("below-falling", 0), [0, *rising[:0:-1]])
    np.testing.assert_allclose(forces("table-5", 0), rising)
    np.testing.assert_allclose(forces("table-5", 4), [0, scenario.poses[4].force_n[-1]])


def test_joints_come_from_the_side_from_which_the_load_pushes_them(scenario: Loading, arm: Arm) -> None:
    robot = load_robot("hh150")
    done = BY_NAME["with-load"].of(scenario, arm, robot.figures.load_point)
    for pose in done.poses:
        q, wrench = np.deg2rad(pose.q_deg), np.r_[pose.direction, np.zeros(3)]
        torque = arm.jacobian(q[None], robot.figures.load_point)[0].T @ wrench
        assert np.all(np.array(pose.sides) * torque >= 0)
    (sitting,) = loading_sittings(done, robot)
    first = done.poses[0]
    np.testing.assert_allclose(np.deg2rad(first.q_deg) - sitting.start, np.deg2rad(3.0) * np.array(first.sides))
    marked = [step.mark for step in sitting.steps if step.mark]
    assert all("approach" not in mark.labels for mark in marked), "one label cannot say where six joints came from"
    assert sides_of_load(first, arm, robot.figures.load_point) == first.sides


def test_with_the_load_friction_cancels_wherever_it_sits(scenario: Loading) -> None:
    """It slides the same way at the unloaded reading and under every load: its level drops out of each difference."""
    for share in SIDES.values():
        result = study(scenario, "with-load", share)
        for method in ("current", "force"):
            assert result.typical(method) < EXACT


def test_against_the_load_friction_turns_round_and_misleads(scenario: Loading) -> None:
    link, motor = study(scenario, "against-load", 1.0), study(scenario, "against-load", 0.0)
    assert np.nanmedian(link.bias("force")) > 0.2, "the link's friction carries load past the spring: too stiff"
    assert link.typical("current") < EXACT
    assert np.nanmedian(motor.bias("current")) < -0.1, "the motor is spared what its friction carries: too soft"
    assert motor.typical("force") < EXACT


def result_of(errors: dict[str, float], protocol: Protocol = PROTOCOLS[0], **condition: float) -> ConditionResult:
    return ConditionResult(
        Condition(protocol=protocol, **condition),
        {name: np.full((1, 2), error) for name, error in errors.items()},
    )


def test_friction_that_table_6_needs_is_read_off_between_amounts() -> None:
    found = [
        result_of({"force": amount * share, "current": 0.0}, friction=amount, link_share=share)
        for amount in (0.0, 1.0, 2.0)
        for share in (0.0, 1.0)
    ]
    needed = needed_friction(found, np.array([1.5, 4.0]), "force", "current")
    np.testing.assert_allclose(needed.level, [0.5, np.nan])
    assert needed.by_link == 1
    assert not needed.by_motor.any()


def test_claims_name_the_protocols_under_which_they_hold() -> None:
    needed = NeededFriction(np.array([np.nan, 1.0]), np.array([False, False]), 2.0)
    fine = dict.fromkeys([*METHODS, *(f"{m}, from the first load" for m in ("force", "current"))], 0.001)
    fine |= {"force, plain Eq. (25)": 0.4, "force, plain Eq. (35)": 0.01}
    good = UnderProtocol(BY_NAME["with-load"], dict.fromkeys(SIDES, result_of(fine)), needed, needed)
    bad_force = result_of(fine | {"force": 0.3})
    bad = replace(good, protocol=BY_NAME["both-unloading"], by_side=dict.fromkeys(SIDES, bad_force), plain=needed)
    text = "\n".join(survivals([good, bad]))
    assert "friction on the link side: currents right: under all 2 protocols." in text
    assert "friction on the link side: force wrong: under 1 of 2 protocols (both-unloading)." in text
    assert "friction on the motor side, servo gives: currents wrong: under none of 2 protocols." in text
    advice = "\n".join(lab_advice([good, bad]))
    assert "both right: each joint moving as the load will push it" in advice
    assert "30.0 to 0.1 % (both-unloading)" in advice


def test_a_scenario_says_its_protocol(scenario: Loading) -> None:
    assert in_words(scenario) == "from both sides in turn, loads put on and taken off"
    assert in_words(scenario.model_copy(update={"approach": (1,), "unload": False})) == (
        "all joints from below, loads only put on"
    )


def test_the_scenario_with_the_load_is_what_the_protocol_makes_of_the_plain_one(scenario: Loading, arm: Arm) -> None:
    load_point = load_robot("hh150").figures.load_point
    wanted = BY_NAME["with-load"].of(scenario, arm, load_point)
    found = read_as(Loading, "loading-with-load")
    assert [pose.sides for pose in found.poses] == [pose.sides for pose in wanted.poses]
    assert [pose.force_n for pose in found.poses] == [pose.force_n for pose in wanted.poses]
    assert (found.approach, found.unload) == (wanted.approach, wanted.unload)
