"""A diagnosis beside least squares: it says where that predicts better, and only there."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.diagnose import diagnose as diagnosing
from bench.diagnose.baseline import first_look as looking
from bench.diagnose.baseline.comparison import Baseline, chance_of
from bench.diagnose.baseline.first_look import first_look
from bench.diagnose.cross_validation.figures import fitted_figures
from bench.diagnose.diagnose import diagnose
from bench.effects.catalogue import catalogue
from bench.record.campaign import Campaign
from bench.report.diagnosis.words import words_of
from bench.report.handover.robot_folder import hand_over
from bench.robot.folder import load_robot
from tests.diagnose.sweeps import LOADS, SWEEPS, made, nominal

GAS = {"gas_loss": 0.12}
SEED = 3


def beside(campaign: Campaign, effects: Mapping[str, object]) -> Baseline:
    compiled = nominal()
    look = first_look(campaign, compiled)
    known = {name: effect for name, effect in catalogue().items() if name in effects}
    found = diagnose(campaign, compiled, known, proposes=False, first=look.found).verdict.baseline
    assert found
    return found


def test_a_cause_that_no_effect_names_is_said_to_be_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Least squares has a parameter for the gas; a diagnosis without an effect for its loss bends other figures."""
    monkeypatch.setattr(diagnosing, "beside_unknown_links", lambda task, found, signatures: found)
    found = beside(made(SWEEPS, SEED, GAS), {})
    (drive,) = found.drives  # the others stand
    assert (drive.drive, drive.unit, found.by, found.folds) == (2, "Nm", "run", 4)
    assert found.missed == (drive,)
    assert drive.least_squares < 0.5 * drive.diagnosed < drive.nominal < drive.measured


def test_where_least_squares_predicts_better_nothing_stated_of_links_is_believed(tmp_path: Path) -> None:
    compiled = nominal()
    campaign = made(SWEEPS, SEED, GAS)
    found = diagnose(campaign, compiled, {}, proposes=False, first=first_look(campaign, compiled).found)
    assert found.verdict.links * compiled.robot.figures.uncertainty.mass == pytest.approx(1.0)
    assert found.linear.replay.compiled.robot.figures.uncertainty.links == found.verdict.links
    assert found.verdict.baseline
    assert not found.verdict.baseline.missed
    assert "as certain as stated, least squares predicted better" in " ".join(words_of(found.verdict))
    handed = hand_over(found.linear, found.extension or found.naming.null, tmp_path / "robot", tmp_path / "nominal.xml")
    assert handed.disagreement < 1e-6
    assert load_robot(tmp_path / "robot").figures.uncertainty.links == found.verdict.links
    moved = [one for one in fitted_figures(found.linear, found.extension or found.naming.null) if one.has_moved]
    assert any(one.name.startswith(("mass of", "centre of mass of")) for one in moved)  # beyond what was stated


@pytest.mark.parametrize("hidden", [pytest.param({}, marks=pytest.mark.study), GAS])
def test_a_right_model_is_as_good_as_least_squares(hidden: dict[str, float]) -> None:
    found = beside(made(SWEEPS, SEED, hidden), {"gas_loss": None})
    (drive,) = found.drives
    assert not found.missed
    assert drive.diagnosed < drive.least_squares


def test_where_nothing_moves_no_first_pass_is_expected() -> None:
    look = first_look(made(LOADS, SEED), nominal())
    assert look.found is None
    assert not look.why


def test_without_torques_it_is_said_why_there_is_none() -> None:
    campaign = made(SWEEPS, SEED)
    runs = tuple(
        replace(run, columns={key: values for key, values in run.columns.items() if "current" not in key})
        for run in campaign.runs
    )
    look = first_look(replace(campaign, runs=runs), nominal())
    assert look.found is None
    assert "motor torques" in look.why


def test_of_very_long_recordings_a_part_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    campaign = made(SWEEPS, SEED)
    rows = sum(len(run) for run in campaign.of_kind("motion"))
    monkeypatch.setattr(looking, "MOST_SAMPLES", rows // 2)
    look = first_look(campaign, nominal())
    assert look.found
    assert look.share == pytest.approx(0.5, abs=1e-3)
    assert sum(len(part.samples) for part in look.found.stretches) == pytest.approx(rows / 2, abs=len(campaign.runs))


def test_chance_is_that_of_folds() -> None:
    """By Student's t: as often as declared where both are as good, and sure where each fold says so."""
    rng = np.random.default_rng(1)
    errors = rng.normal(0, 0.3, (4000, 2, 8))
    chances = np.array([chance_of(np.exp(one), np.exp(other)) for one, other in errors])
    assert np.mean(chances < 0.01) == pytest.approx(0.01, abs=4 * np.sqrt(0.01 / 4000))
    assert chance_of(np.array([1.0, 2.0, 3.0]), np.array([4.0, 8.1, 11.9])) < 1e-3
    two = np.array([[1.0, 2.0, 3.0], [1.0, 1.0, 1.0]])
    assert chance_of(two, two * [[8, 2, 4], [2, 8, 4]]) == 0.0  # a factor of four in each run, over both drives
    assert chance_of(two[0], two[0] * [8, 2, 4]) > 0.02
    assert chance_of(np.array([1.0]), np.array([100.0])) == 1.0  # one fold proves nothing
    assert chance_of(np.array([1.0, 1.0]), np.array([2.0, 2.0])) == 0.0
    assert chance_of(np.array([2.0, 2.0]), np.array([1.0, 1.0])) == 1.0
