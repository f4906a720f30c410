"""Comparisons of an arm of which nothing but a drawing is known: friction, payload and masses are off."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.compare.as_it_was import as_it_was
from bench.compare.compare import compare
from bench.compare.comparison import Comparison
from bench.compare.recordings import recordings_of
from bench.diagnose.extend.refit import refit
from bench.effects.catalogue import catalogue
from bench.record.campaign import Array, Campaign, Run
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from tests import stranger
from tests.diagnose.noise_free import linearised
from tests.stranger_started import started

SECONDS = 15.0
Load = tuple[float, tuple[float, float, float]]  # [kg], and where it is beside the tool [m]
PAYLOAD = 3.0  # [kg], of which nothing is stated
UNSTATED: Load = (PAYLOAD, stranger.MIDDLE)
LIGHT: Load = (3.0, (0.1, 0.05, -0.05))
HEAVY: Load = (9.0, (-0.15, 0.1, 0.1))


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory) -> CompiledRobot:
    folder = tmp_path_factory.mktemp("arm")
    started(folder)
    return compile_robot(load_robot(folder / "arm"))


def recorded(compiled: CompiledRobot, seed: int, more_friction: float = 0.0, payload: Load = UNSTATED) -> Campaign:
    """Return two runs of the real arm, with the Coulomb friction of its second joint raised by a share."""
    rng = np.random.default_rng(seed)
    real = stranger.as_filed(*payload)
    runs = []
    for number in range(2):
        motion = stranger.moved(rng, SECONDS, real)
        torque = motion.torque.copy()
        torque[:, 1] += more_friction * stranger.COULOMB[1] * np.tanh(motion.velocity[:, 1] / 0.01)
        columns: Mapping[str, Array] = {
            "time_s": motion.time,
            **{f"q_motor_{j + 1}_rad": motion.position[:, j] for j in range(3)},
            **{f"tau_motor_{j + 1}_nm": torque[:, j] for j in range(3)},
        }
        runs.append(Run(f"run{number}", "motion", 100.0 * number, columns))
    return Campaign(str(compiled.robot.folder), tuple(runs))


def compared(compiled: CompiledRobot, before: Campaign, after: Campaign, folder: Path) -> Comparison:
    return compare(
        recordings_of({"before": before}, {"after": after}), as_it_was(before, compiled, folder), catalogue()
    )


def test_it_begins_with_what_the_drawing_leaves_out(arm: CompiledRobot, tmp_path: Path) -> None:
    """Figures alone left many times the noise, with torque constants in the place of friction."""
    before = recorded(arm, 1)
    by_figures = linearised(before, arm)
    alone = float(np.sqrt(np.mean(by_figures.whiten(refit(by_figures, (), {}).residual) ** 2)))
    fitted = as_it_was(before, arm, tmp_path)
    left = linearised(recorded(arm, 2), fitted).white
    assert alone > 10
    assert np.sqrt(np.mean(left**2)) < 2
    np.testing.assert_allclose(fitted.motor_coulomb, stranger.COULOMB, rtol=0.05)


@pytest.mark.parametrize(
    ("seed", "load"), [(1, LIGHT), pytest.param(4, HEAVY, marks=pytest.mark.study)], ids=["light", "heavy"]
)
def test_it_has_the_payload_wherever_that_hangs(arm: CompiledRobot, tmp_path: Path, seed: int, load: Load) -> None:
    """One fit ended with 5 kg half a metre off for 9 kg, at 76 times the noise, another with 0.05 kg for 3 kg."""
    before = recorded(arm, seed, payload=load)
    fitted = as_it_was(before, arm, tmp_path)
    assert np.sqrt(np.mean(linearised(before, fitted).white ** 2)) < 2
    assert catalogue()["unstated_payload"].there_already(fitted)["mass"] == pytest.approx(load[0], rel=0.05)


def test_an_unchanged_arm_has_not_changed_and_a_change_is_named(arm: CompiledRobot, tmp_path: Path) -> None:
    before = recorded(arm, 1)
    same = compared(arm, before, recorded(arm, 2), tmp_path)
    assert not same.has_changed
    other = compared(replace(arm), before, recorded(arm, 3, more_friction=0.2), tmp_path / "other")
    assert other.has_changed
    first = other.explanations[0].changes
    assert {(one.effect, one.place) for one in first} == {("coulomb_level", "joint 2")}


@pytest.mark.parametrize("swapped", [pytest.param(False, marks=pytest.mark.study), True], ids=["heavier", "lighter"])
def test_a_payload_that_was_swapped_is_all_that_changed(arm: CompiledRobot, tmp_path: Path, swapped: bool) -> None:
    """Signatures are linear and a payload is not small: what they miss of it was named beside it."""
    light, heavy = (recorded(arm, seed, payload=load) for seed, load in ((1, LIGHT), (4, HEAVY)))
    found = compared(arm, heavy, light, tmp_path) if swapped else compared(arm, light, heavy, tmp_path)
    (change,) = found.explanations[0].changes
    assert change.effect == "unstated_payload"
    mass = next(size for size in change.sizes if size.name == "mass").change
    more = LIGHT[0] - HEAVY[0] if swapped else HEAVY[0] - LIGHT[0]
    assert mass.low < more < mass.high
    assert change.nonlinearity < 0.02
