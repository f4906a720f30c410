"""A search begins with what a first pass has: a cable at a wrist, of any size that the first pass found."""

from pathlib import Path

import numpy as np
import pytest

from bench.diagnose.diagnose import diagnose
from bench.diagnose.linearise.candidates import LARGER, as_far_as_told, causes_of
from bench.effects.catalogue import LEFT_OUT, catalogue
from bench.effects.geometry import DressPack
from bench.identify.dynamics.first_pass import first_pass
from bench.record.campaign import Campaign, Run
from bench.robot.compiled import CompiledRobot
from bench.robot.nominal_dynamics import nominal_dynamics
from bench.robot.starter.folder import start_robot
from bench.robot.starter.source import read_source
from tests.stranger import mjcf, moved

LISTED = (*LEFT_OUT, "dress_pack", "load_friction", "rolling_friction", "torque_constant", "torque_offset")
STIFFNESS, NEUTRAL = 2.5, 0.4  # [Nm/rad], [rad]; of a joint whose drive has 80 Nm, 0.8 are plausible


@pytest.fixture
def compiled(tmp_path: Path) -> CompiledRobot:
    (tmp_path / "arm.xml").write_text(mjcf())
    return start_robot("arm", read_source(tmp_path / "arm.xml"), tmp_path / "arm").compiled


def with_a_cable(rng: np.random.Generator) -> Campaign:
    """Return two motions of the arm of the file, with a cable at its third joint."""
    runs = []
    for k in range(2):
        motion = moved(rng, seconds=12.0)
        torque = motion.torque.copy()
        torque[:, 2] += STIFFNESS * (motion.position[:, 2] - NEUTRAL)
        columns = {"time_s": motion.time}
        columns |= {f"q_motor_{j + 1}_rad": motion.position[:, j] for j in range(3)}
        columns |= {f"tau_motor_{j + 1}_nm": torque[:, j] for j in range(3)}
        runs.append(Run(f"run{k}", "motion", 60.0 * k, columns))
    return Campaign("cable", tuple(runs))


def test_a_cable_that_is_stiffer_than_plausible_is_named(compiled: CompiledRobot) -> None:
    """A stranger's wrist had one of 0.94 Nm/rad where 0.56 are plausible: a jump of its current, at > 99.9 %."""
    effects = {name: catalogue()[name] for name in LISTED}
    said: list[str] = []
    campaign = with_a_cable(np.random.default_rng(3))
    first = first_pass(campaign, nominal_dynamics(compiled))
    verdict = diagnose(campaign, compiled, effects, progress=said.append, proposes=False, first=first).verdict
    assert not [words for words in said if "once more" in words]  # with all causes, everywhere
    causes = {cause.name: cause for cause in verdict.explanations[0].causes}
    cable = causes["dress_pack", "joint 3"]
    stiffness, _ = cable.parameters
    assert stiffness.low < STIFFNESS < stiffness.high
    assert "times the largest plausible size" in cable.advice
    assert ("torque_constant", "joint 3") not in causes


def test_only_what_is_told_to_be_larger_goes_farther(compiled: CompiledRobot) -> None:
    causes = causes_of([DressPack()], compiled, frozenset({"tau_motor", "q_motor"}))
    most = causes[2].sizes[0].high
    told = {(DressPack.name, 1): 0.5 * causes[1].sizes[0].high, (DressPack.name, 2): 1.5 * most}
    assert [cause.reach for cause in as_far_as_told(causes, told, LARGER)] == [1.0, 1.0, LARGER]
