"""What is not listed is learned: found in the linearised model, fitted by simulation, written as a model that runs."""

import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

from bench.diagnose.conclude import verdict_of
from bench.diagnose.cross_validation.held_out import NOTICEABLE, HeldOut, held_out
from bench.diagnose.diagnose import Diagnosis, diagnose
from bench.diagnose.extension import extension_of
from bench.diagnose.linearise.generic import ANGLE_NODES, Block, blocks_of
from bench.diagnose.name import discrepancy as discrepancies
from bench.diagnose.name.discrepancy import NOT_THERE, effect_of, learn
from bench.diagnose.name.learned_shape import learned_of
from bench.diagnose.name.naming import Naming
from bench.effects.catalogue import catalogue
from bench.effects.effect import Acting
from bench.effects.learned_torques import LearnedTorque
from bench.effects.unlisted import Detent, SnappingCable
from bench.hide.campaign import hide_campaign
from bench.record.campaign import Array
from bench.report.diagnosis.write import write_diagnosis
from bench.report.handover.readme import AGREES
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from tests.diagnose.sweeps import SWEEPS

CHOICE = ("coulomb_level", "viscous_level", "torque_constant", "gas_loss", "current_offset")
BINS = 100
NEAR_FLOOR = 1.3  # design of this project asks for 1.2 of listed effects; a table is linear between nodes
SIGMAS = 3.5  # the largest of 33 values that go together
HIDDEN = {
    "detent": (Detent(), {"torque": 300.0, "angle": 0.4, "width": 0.15}),
    "snapping_cable": (SnappingCable(), {"torque": 250.0, "angle": 0.4}),
}


@dataclass(frozen=True, eq=False)
class Case:
    """A campaign with something unlisted, what the diagnosis says, and the truth over the angle."""

    name: str
    found: Diagnosis
    true: Array
    folder: Path


@pytest.fixture(scope="module", params=[pytest.param("detent", marks=pytest.mark.study), "snapping_cable"])
def case(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Case:
    robot, effects = load_robot("hh150"), catalogue()
    compiled = compile_robot(robot)
    effect, values = HIDDEN[request.param]
    acting = Acting(effect, effect.places(compiled)[1], effect.complete(values))
    campaign = hide_campaign(robot, SWEEPS, [acting], np.random.default_rng(14)).campaign
    found = diagnose(campaign, compiled, {name: effects[name] for name in CHOICE}, most_bins=BINS, proposes=False)
    learned = found.discrepancy.cause.effect if found.discrepancy and found.discrepancy.cause else None
    assert isinstance(learned, LearnedTorque)
    folder = tmp_path_factory.mktemp(request.param)
    write_diagnosis(found, folder, campaign)
    return Case(request.param, found, effect.torque(acting.values, learned.nodes), folder)


def test_the_simulated_table_follows_the_true_torque(case: Case) -> None:
    unlisted = case.found.verdict.unlisted
    assert unlisted
    assert (unlisted.place, unlisted.kind, unlisted.depends_on) == ("joint 2", "link torque", "angle")
    assert unlisted.runs
    value = np.array([p.value for p in unlisted.parameters])
    half = np.array([p.high - p.low for p in unlisted.parameters]) / 2
    assert {p.unit for p in unlisted.parameters} == {"Nm"}
    assert np.max(np.abs(value - case.true) / half) < SIGMAS / 1.96
    # and it says something: the band is narrow against the torque
    assert np.median(half) < 0.35 * np.ptp(case.true)
    assert np.corrcoef(value, case.true)[0, 1] > 0.95


def test_held_out_error_falls_near_the_floor(case: Case) -> None:
    (current,) = (gain for gain in case.found.verdict.gain if gain.channel == "current_2_a")
    assert case.found.verdict.held_out_by == "run"
    assert current.before > 3 * current.floor
    assert current.after < NEAR_FLOOR * current.floor
    assert current.low > 0.5


def test_the_extended_model_has_the_table(case: Case) -> None:
    xml = (case.folder / "robot" / "hh150.xml").read_text()
    assert "effect/learned_torque joint2" in (case.folder / "robot.diff").read_text()
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    actuator = model.actuator("effect/learned_torque joint2").id
    unlisted = case.found.verdict.unlisted
    assert unlisted
    nodes = [float(p.words.split()[1]) for p in unlisted.parameters]
    for i in (0, len(nodes) // 2, -1):
        data.joint("joint2").qpos[0] = nodes[i]
        mujoco.mj_forward(model, data)
        # words have four digits of the angle
        assert data.actuator_force[actuator] == pytest.approx(unlisted.parameters[i].value, abs=1.0)


def test_files_say_what_was_learned(case: Case) -> None:
    content = json.loads((case.folder / "verdict.json").read_text())
    assert content["unlisted"]["runs"] is True
    (curve,) = content["learned"]
    assert curve["value"] == [p["value"] for p in content["unlisted"]["parameters"]]
    assert curve["low"] == pytest.approx([p["low"] for p in content["unlisted"]["parameters"]])
    assert content["handed_over"]["disagreement"] < AGREES
    after = {channel["channel"]: channel["after"] for channel in content["channels"]}
    assert after["current_2_a"] < NEAR_FLOOR


def test_every_shape_of_a_campaign_becomes_an_effect_or_says_why_not(case: Case) -> None:
    naming: Naming = case.found.naming
    kinds = set()
    for block in blocks_of(naming.linear):
        effect = effect_of(naming.linear, block)
        kinds.add((block.kind, block.depends_on, effect is not None))
        if effect is not None:
            assert {p.unit for p in effect.parameters} == {block.unit}
            assert all(p.high == pytest.approx(np.sqrt(3) * block.prior) for p in effect.parameters)
    assert {kind[:2] for kind in kinds if not kind[2]} <= {("link torque", "load")}
    assert {("motor torque", "angle and direction", True), ("motor torque", "speed", True)} <= kinds
    assert {("gear angle", "load", True), ("reading", "place", True), ("reading", "time", True)} <= kinds


def test_what_no_model_can_do_is_said(case: Case) -> None:
    naming = case.found.naming
    block = next(b for b in blocks_of(naming.linear) if (b.kind, b.depends_on) == ("link torque", "load"))
    discrepancy = learn(naming.linear, block, naming.null)
    assert (discrepancy.fit, discrepancy.is_gain, discrepancy.words) == (None, False, NOT_THERE)


def test_a_shape_that_does_not_pay_is_refused(case: Case) -> None:
    naming, discrepancy = case.found.naming, case.found.discrepancy
    assert discrepancy
    assert discrepancy.fit
    block = _block(naming, "joint 2", "gear angle", "angle")
    again = learn(discrepancy.linear, block, discrepancy.fit)  # beside the truth there is nothing more to learn
    assert not again.is_gain
    assert extension_of(naming, again) is None
    drawn = learned_of(naming, again)
    assert drawn  # as the linearised model has it
    (curve,) = drawn.curves
    assert len(curve.at) == len(drawn.block.nodes) == ANGLE_NODES
    unlisted = verdict_of(naming, 0.01, {}, (), discrepancy=again).unlisted
    assert unlisted
    assert curve.value == tuple(p.value for p in unlisted.parameters)
    assert curve.high == pytest.approx([p.high for p in unlisted.parameters])
    assert {p.unit for p in unlisted.parameters} == {curve.unit}


def test_a_shape_that_predicts_a_channel_worse_is_not_handed_over(case: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    discrepancy = case.found.discrepancy
    assert discrepancy
    assert discrepancy.fit

    def with_a_worse_channel(*args: Any) -> HeldOut:
        gain = held_out(*args)
        return replace(gain, channels=(*gain.channels[:-1], replace(gain.channels[-1], low=-0.4, high=-0.1)))

    naming = case.found.naming
    shape = naming.unlisted
    assert shape
    beside = naming.models[0].listed_fit(naming.linear)
    assert learn(naming.linear, shape, beside).is_gain
    monkeypatch.setattr(discrepancies, "held_out", with_a_worse_channel)
    assert not learn(naming.linear, shape, beside).is_gain


@pytest.mark.parametrize(("times", "is_gain"), [(0.5, True), (2.0, False)])
def test_a_channel_has_to_lose_more_than_what_is_noticeable(
    case: Case, monkeypatch: pytest.MonkeyPatch, times: float, is_gain: bool
) -> None:
    """One of sixteen that got worse by 0.01 % for sure refused a shape by which another became seven times better."""

    def with_a_worse_channel(*args: Any) -> HeldOut:
        gain = held_out(*args)
        last = gain.channels[-1]
        squares = 1 + 2 * times * NOTICEABLE * (last.floor / last.before) ** 2 / last.readings
        return replace(gain, channels=(*gain.channels[:-1], replace(last, low=-0.4, high=1 - squares**0.5)))

    naming = case.found.naming
    shape = naming.unlisted
    assert shape
    monkeypatch.setattr(discrepancies, "held_out", with_a_worse_channel)
    assert learn(naming.linear, shape, naming.models[0].listed_fit(naming.linear)).is_gain is is_gain


def _block(naming: Naming, *what: str) -> Block:
    return next(b for b in blocks_of(naming.linear) if (b.place, b.kind, b.depends_on) == what)
