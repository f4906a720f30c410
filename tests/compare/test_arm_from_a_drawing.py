"""Comparisons of an arm of which nothing but a drawing is known: friction, payload and masses are off."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import bench.compare.as_it_was as as_it_was_module
from bench.compare.as_it_was import FITS, as_it_was
from bench.compare.compare import compare
from bench.compare.comparison import Comparison, LeftBefore
from bench.compare.joint import joint_of
from bench.compare.left_before import left_before
from bench.compare.recordings import recordings_of
from bench.diagnose.diagnose import Diagnosis
from bench.diagnose.extend.fit import Fit, Key, unknowns_of
from bench.diagnose.extend.refit import refit
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.replay.world import World
from bench.effects.catalogue import catalogue
from bench.effects.effect import WHOLE
from bench.errors import ConvergenceError
from bench.executor.watched import Stop, Stopped
from bench.record.campaign import Campaign
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from tests import stranger
from tests.compare.drawn_arm import PAYLOAD, Load, recorded, with_balancer, with_interplay, with_ripple
from tests.diagnose.noise_free import linearised
from tests.stranger_started import started

TOLD_APART = 10.0  # [s], of one that tells friction from a spring and torque constants
LIGHT: Load = (3.0, (0.1, 0.05, -0.05))
HEAVY: Load = (9.0, (-0.15, 0.1, 0.1))
FEW_BINS = 40  # of motion
ROUNDING = 1e-12  # of a size in steps of its signature, back in its unit


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory) -> CompiledRobot:
    folder = tmp_path_factory.mktemp("arm")
    started(folder)
    return compile_robot(load_robot(folder / "arm"))


@pytest.fixture(scope="module")
def fitted(arm: CompiledRobot, tmp_path_factory: pytest.TempPathFactory) -> CompiledRobot:
    """Return the arm as it was in the first recording, with a payload of which nothing is stated."""
    return as_it_was(recorded(arm, 1), arm, tmp_path_factory.mktemp("fitted")).robot


@pytest.fixture(scope="module")
def heavy(arm: CompiledRobot) -> Campaign:
    return recorded(arm, 4, payload=HEAVY)


@pytest.fixture(scope="module")
def fitted_to_heavy(arm: CompiledRobot, heavy: Campaign, tmp_path_factory: pytest.TempPathFactory) -> CompiledRobot:
    return as_it_was(heavy, arm, tmp_path_factory.mktemp("heavy")).robot


def compared(fitted: CompiledRobot, before: Campaign, after: Campaign) -> Comparison:
    return compare(recordings_of({"before": before}, {"after": after}), fitted, catalogue())


def test_it_begins_with_what_the_drawing_leaves_out(arm: CompiledRobot, fitted: CompiledRobot) -> None:
    """Figures alone left many times the noise, with torque constants in the place of friction."""
    before = recorded(arm, 1)
    by_figures = linearised(before, arm)
    alone = float(np.sqrt(np.mean(by_figures.whiten(refit(by_figures, (), {}).residual) ** 2)))
    left = linearised(recorded(arm, 2), fitted).white
    assert alone > 10
    assert np.sqrt(np.mean(left**2)) < 2
    np.testing.assert_allclose(fitted.motor_coulomb, stranger.COULOMB, rtol=0.05)


def assert_carried(fitted: CompiledRobot, campaign: Campaign, load: Load) -> None:
    assert np.sqrt(np.mean(linearised(campaign, fitted).white ** 2)) < 2
    assert catalogue()["unstated_payload"].there_already(fitted, WHOLE)["mass"] == pytest.approx(load[0], rel=0.05)


def test_it_has_a_payload_wherever_that_hangs(fitted_to_heavy: CompiledRobot, heavy: Campaign) -> None:
    """The fit ended with 5 kg half a metre off for 9 kg, at 76 times the noise."""
    assert_carried(fitted_to_heavy, heavy, HEAVY)


def test_no_fit_begins_where_no_machine_can_be(
    arm: CompiledRobot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With a spring that nobody stated, signatures asked for a payload of -8 kg and viscous friction that drives.

    Cut off at none, the payload left its moments, and the friction that made up for it, without a mass.
    """
    begun: list[tuple[tuple[Cause, ...], Mapping[Key, float]]] = []

    def noted(
        linear: LinearisedModel, causes: Sequence[Cause], start: Mapping[Key, float], *more: Any, **how: Any
    ) -> Fit:
        begun.append((tuple(causes), start))
        unknowns = unknowns_of(tuple(causes))  # as if the fit had found none of it
        null = np.array([unknown.parameter.null for unknown in unknowns], dtype=float)
        fit, k = refit(linear, (), {}), len(unknowns)
        jacobian = np.zeros((*fit.residual.shape, k))
        return replace(
            fit, causes=tuple(causes), unknowns=unknowns, values=null, covariance=np.eye(k), jacobian=jacobian
        )

    def diagnosed(*given: object, **how: object) -> Diagnosis:
        raise ConvergenceError("that is not asked here")

    monkeypatch.setattr(as_it_was_module, "refit", noted)
    monkeypatch.setattr(as_it_was_module, "diagnose", diagnosed)
    as_it_was(with_balancer(recorded(arm, 1)), arm, tmp_path)
    told = [(causes, start) for causes, start in begun if start]
    assert told
    for causes, start in told:
        for unknown in unknowns_of(causes):
            low, high = unknown.bounds
            assert np.clip(start[unknown.key], low, high) == pytest.approx(start[unknown.key], rel=ROUNDING), (
                unknown.words
            )


def test_a_fit_ends_when_it_is_asked_to(arm: CompiledRobot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """`--at-most` and Ctrl-C were not looked at before all was fitted, 50 s for a stranger's palletising arm."""
    now = [0.0]
    stop = Stop(60.0, clock=lambda: now[0])
    begun: list[int] = []

    def late(linear: LinearisedModel, causes: Sequence[Cause], *more: Any, **how: Any) -> Fit:
        begun.append(len(causes))
        now[0] = 61.0 if causes else 0.0
        return refit(linear, tuple(causes), *more, **how)

    monkeypatch.setattr(as_it_was_module, "refit", late)
    with pytest.raises(Stopped, match="60 s"):
        as_it_was(recorded(arm, 1), arm, tmp_path, check=stop.check)
    assert [bool(count) for count in begun] == [False, True]


def far_from_before(robot: CompiledRobot, before: Campaign, after: Campaign) -> tuple[LeftBefore, ...]:
    few = {"rotor_inertia": catalogue()["rotor_inertia"]}
    return left_before(joint_of(recordings_of({"before": before}, {"after": after}), robot, few))


def test_how_far_a_robot_is_from_before_has_no_part_of_what_changed(arm: CompiledRobot, fitted: CompiledRobot) -> None:
    """A robot without friction, and one with it, while friction doubles."""
    before, same, other = recorded(arm, 1), recorded(arm, 2), recorded(arm, 3, more_friction=1.0)
    far = [far_from_before(arm, before, after) for after in (same, other)]
    assert {one.column for one in far[0]} == {f"tau_motor_{j}_nm" for j in (1, 2, 3)}
    assert min(one.times for one in far[0]) > 10
    assert [one.column for one in far[0]] == [one.column for one in far[1]]
    np.testing.assert_allclose([one.times for one in far[0]], [one.times for one in far[1]], rtol=1e-6)
    assert far_from_before(fitted, before, other) == ()


def test_where_what_drawings_leave_out_does_not_do_the_robot_is_what_a_diagnosis_finds(
    arm: CompiledRobot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """About a robot at ten times the noise, "friction over the angle" had changed between two recordings, at 99 %."""
    before, effects = recorded(arm, 1), {}
    asked: list[object] = []

    def diagnosed(campaign: Campaign, *given: object, **how: object) -> SimpleNamespace:
        asked.append((campaign, *given))
        linear = linearised(campaign, arm)
        moved = replace(refit(linear, (), {}), nuisances=np.full(len(linear.nuisances), 0.1))
        return SimpleNamespace(linear=linear, extension=moved, naming=None)

    def left_over(linear: LinearisedModel, nominal: Fit, *given: object, **how: object) -> tuple[World, float]:
        return nominal.world(linear), FITS + 1  # what drawings leave out does not do

    monkeypatch.setattr(as_it_was_module, "diagnose", diagnosed)
    monkeypatch.setattr(as_it_was_module, "_with_what_is_left_out", left_over)
    held = as_it_was(before, arm, tmp_path, effects)
    assert held.origin == "diagnosed"
    assert asked == [(before, arm, effects)]
    sigma = {one.name: one.sigma for one in linearised(before, arm).nuisances}
    for name in ("l1", "l2"):
        heavier = held.robot.model.body(name).mass[0] / arm.model.body(name).mass[0] - 1
        assert heavier == pytest.approx(0.1 * sigma[f"mass of {name}"], rel=1e-6)


def test_a_spring_that_nobody_stated_is_not_taken_for_links_and_payload(arm: CompiledRobot, tmp_path: Path) -> None:
    """The second link came out as 8 g in place of 8 kg, at ten times the noise."""
    before, after = (with_balancer(recorded(arm, seed, seconds=TOLD_APART)) for seed in (1, 2))
    held = as_it_was(before, arm, tmp_path).robot
    assert far_from_before(held, before, after) == ()
    np.testing.assert_allclose(held.motor_coulomb, stranger.COULOMB, rtol=0.1)
    assert held.model.body("l2").mass[0] > stranger.MASS[1] / 2


def test_what_a_diagnosis_handed_over_is_not_looked_for_again(
    arm: CompiledRobot, fitted: CompiledRobot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What not even a diagnosis explains is above the noise, so friction and payload were fitted anew, eight times.

    That was two thirds of a comparison of a stranger's arm with seven joints.
    """
    before = with_ripple(recorded(arm, 1))
    fits: list[int] = []

    def counted(linear: LinearisedModel, causes: Sequence[Cause], *more: Any, **how: Any) -> Fit:
        fits.append(len(causes))
        return refit(linear, tuple(causes), *more, **how)

    monkeypatch.setattr(as_it_was_module, "refit", counted)
    handed = as_it_was(before, fitted, tmp_path / "handed", is_handed_over=True).robot
    assert fits == [0]
    left = linearised(before, handed).white
    assert np.sqrt(np.mean(left**2)) > FITS


def test_another_payload_than_that_of_the_diagnosis_is_looked_for(
    arm: CompiledRobot, fitted: CompiledRobot, heavy: Campaign, tmp_path: Path
) -> None:
    """A robot that was found with 3 kg, and carries 9 kg; the last link, of which little is known, takes the rest."""
    handed = as_it_was(heavy, fitted, tmp_path, is_handed_over=True).robot
    assert np.sqrt(np.mean(linearised(heavy, handed).white ** 2)) < 2
    assert catalogue()["unstated_payload"].there_already(handed, WHOLE)["mass"] > PAYLOAD + 2


@pytest.mark.study
def test_it_has_a_light_payload(arm: CompiledRobot, tmp_path: Path) -> None:
    """The fit ended with 0.05 kg for 3 kg."""
    before = recorded(arm, 1, payload=LIGHT)
    assert_carried(as_it_was(before, arm, tmp_path).robot, before, LIGHT)


def test_an_unchanged_arm_has_not_changed_and_a_change_is_named(arm: CompiledRobot, fitted: CompiledRobot) -> None:
    before = recorded(arm, 1)
    assert not compared(fitted, before, recorded(arm, 2)).has_changed
    other = compared(fitted, before, recorded(arm, 3, more_friction=0.2))
    assert other.has_changed
    first = other.explanations[0].changes
    assert {(one.effect, one.place) for one in first} == {("coulomb_level", "joint 2")}


@pytest.mark.parametrize("seed", [10, pytest.param(11, marks=pytest.mark.study)])
def test_what_few_readings_do_not_tell_from_noise_has_not_changed(
    arm: CompiledRobot, fitted: CompiledRobot, seed: int
) -> None:
    """Two motions of a real UR10e had a friction changed at 100 %: fits of as many sizes as readings left no noise."""
    before, after = (with_interplay(recorded(arm, one)) for one in (seed, seed + 20))
    found = compare(recordings_of({"before": before}, {"after": after}), fitted, catalogue(), most_bins=FEW_BINS)
    assert not found.has_changed
    assert all(one.times > 2 for one in found.left_before), "noise of that robot is no more than its drives'"
    assert len(found.left_before) == 3


def test_a_payload_that_was_swapped_is_all_that_changed(
    arm: CompiledRobot, fitted_to_heavy: CompiledRobot, heavy: Campaign
) -> None:
    """Signatures are linear and a payload is not small: what they miss of it was named beside it."""
    assert_changed(compared(fitted_to_heavy, heavy, recorded(arm, 1, payload=LIGHT)), LIGHT[0] - HEAVY[0])


@pytest.mark.study
def test_a_payload_that_was_swapped_for_a_heavier_one(arm: CompiledRobot, heavy: Campaign, tmp_path: Path) -> None:
    light = recorded(arm, 1, payload=LIGHT)
    assert_changed(compared(as_it_was(light, arm, tmp_path).robot, light, heavy), HEAVY[0] - LIGHT[0])


def assert_changed(found: Comparison, more: float) -> None:
    """Assert that the payload is all that changed, by so much [kg]."""
    (change,) = found.explanations[0].changes
    assert change.effect == "unstated_payload"
    mass = next(size for size in change.sizes if size.name == "mass").change
    assert mass.low < more < mass.high
    assert change.nonlinearity < 0.02
