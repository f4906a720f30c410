"""Loads that were forgotten at rest are told by tracker and drives, though no force sensor says so."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.plausibility.channels import doubts_of
from bench.diagnose.plausibility.unstated_loads import _shown, _Visit
from bench.diagnose.replay.quantities import Quantity
from bench.effects.places import torque_limit
from bench.record.campaign import Array, Campaign
from bench.robot.compiled import CompiledRobot
from tests.diagnose.sweeps import nominal
from tests.diagnose.test_one_more_number import session, without_force

Change = Callable[[Mapping[str, Array]], dict[str, Array]]
HIDDEN = (
    *("joint_compliance@2=-0.6", "backlash@2=0.00044"),
    *(pytest.param(one, marks=pytest.mark.study) for one in ("hysteresis@2=300", "base_compliance=2e-7")),
)


@pytest.fixture(scope="module")
def compiled() -> CompiledRobot:
    return nominal()


@pytest.fixture(scope="module")
def campaign() -> Campaign:
    return without_force(session(41))


def zero(columns: Mapping[str, Array]) -> dict[str, Array]:
    return {name: 0 * values for name, values in columns.items() if name.startswith("load_") and name.endswith("_n")}


def zero_in_step_2(columns: Mapping[str, Array]) -> dict[str, Array]:
    kept = columns["load_step"] != 2
    return {name: np.where(kept, columns[name], 0.0) for name in zero(columns)}


def one_for_all(columns: Mapping[str, Array]) -> dict[str, Array]:
    hangs = columns["load_z_n"] != 0
    return zero(columns) | {"load_z_n": np.where(hangs, -1000.0, 0.0)}


def changed(campaign: Campaign, runs: tuple[str, ...], change: Change, without: str = "-") -> Campaign:
    """Return a campaign with loads of some static runs changed, and without some channel."""
    found = []
    for run in campaign.runs:
        columns = dict(run.columns)
        if run.kind == "static" and run.name.startswith(runs):
            columns |= change(columns)
        found.append(replace(run, columns={k: v for k, v in columns.items() if not k.startswith(without)}))
    return replace(campaign, runs=tuple(found))


def told(campaign: Campaign, compiled: CompiledRobot) -> list[str]:
    return [str(finding) for finding in doubts_of(campaign, compiled)]


@pytest.mark.parametrize(
    ("runs", "change", "without", "words"),
    [
        (("pose3-from-below", "pose3-from-above"), zero, "-", "in run 'pose3-from-below', and likewise in 1 other run"),
        (
            ("pose3-from-below", "pose3-from-above"),
            zero,
            "reflector",
            "run 'pose3-from-below', and likewise in 1 other",
        ),
        (("",), zero, "-", "likewise in 9 other runs"),
        (("",), zero, "reflector", "likewise in 9 other runs"),
        # drives pay for what changes between two loads with what friction may hold as well
        (("pose",), one_for_all, "-", "from load step 1 to 2 while no load is stated to change"),
    ],
)
def test_loads_that_were_forgotten_are_told(
    campaign: Campaign, compiled: CompiledRobot, runs: tuple[str, ...], change: Change, without: str, words: str
) -> None:
    (said,) = told(changed(campaign, runs, change, without), compiled)
    assert words in said
    assert ("current_" if without == "reflector" else "reflector_1") in said


def test_one_load_that_was_forgotten_between_others_is_told(campaign: Campaign, compiled: CompiledRobot) -> None:
    (said,) = told(changed(campaign, ("pose2-from-below",), zero_in_step_2), compiled)
    assert "against what is stated to hang, into load step 2 and out of it again, in run 'pose2-from-below'" in said


def test_loads_that_were_written_down_are_believed(campaign: Campaign, compiled: CompiledRobot) -> None:
    assert not told(campaign, compiled)
    assert not told(changed(campaign, (), zero, "reflector"), compiled)


@pytest.mark.parametrize("effect", HIDDEN)
def test_a_joint_that_gives_more_is_no_load_that_was_forgotten(effect: str, compiled: CompiledRobot) -> None:
    assert not told(without_force(session(42, effect)), compiled)


@pytest.mark.parametrize(("share", "is_told"), [(0.14, False), (0.20, True)])
def test_friction_that_the_model_states_is_no_load_that_was_forgotten(
    share: float, *, is_told: bool, compiled: CompiledRobot
) -> None:
    """Joint 5 slides at 9 % of its limit, and at rest it may hold half more: everything beyond 10 % was doubted."""
    joint = 4
    held = share * torque_limit(compiled, joint) / abs(compiled.torque_constant[joint])
    visit = _Visit("run", np.arange(2.0), np.zeros((2, 3)), np.array([[0.0], [held]]), {})
    assert bool(_shown(visit, compiled, (Quantity("current_5_a", "current", "A", joint),))) == is_told
