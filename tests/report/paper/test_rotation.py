"""The report on the rotation experiment: from campaigns on disk to numbers, JSON and figures."""

import json
from pathlib import Path

import numpy as np
import pytest

from bench.errors import InputError
from bench.report.paper.rotation.identification import identify_rotation
from bench.report.paper.rotation.results import RotationReport, as_json, published_rows, write_rotation
from bench.report.results import CAMPAIGN, TRUTH, write_session
from bench.report.scoring import score_counterbalance
from bench.simulate.session import run_session
from tests.simulate.loading_small import small_loading
from tests.simulate.rotation_small import small_rotation


@pytest.fixture(scope="module")
def folder(small_robot: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two sessions of the small robot, the second faster and further."""
    folder = tmp_path_factory.mktemp("rotation")
    wider = {"start_deg": [-35, 10], "end_deg": 90, "speeds_deg_per_s": [20], "payloads_kg": [10]}
    for name, scenario in (("seen", small_rotation(small_robot)), ("unseen", small_rotation(small_robot, **wider))):
        (folder / name).mkdir()
        write_session(run_session(scenario), folder / name)
    return folder


@pytest.fixture(scope="module")
def report(folder: Path) -> RotationReport:
    found = identify_rotation(folder / "seen" / CAMPAIGN, folder / "unseen" / CAMPAIGN)
    return RotationReport(found, score_counterbalance(found.fit, folder / "seen" / TRUTH))


def test_the_truth_stands_beside_the_estimate(report: RotationReport) -> None:
    assert [(score.name, score.truth) for score in report.scores] == [
        ("counterbalance.constant", 900.0),
        ("counterbalance.critical_length", 0.65),
    ]
    for score, (low, high) in zip(report.scores, report.identified.fit.intervals, strict=True):
        assert (score.low, score.high) == (low, high)
        assert score.covered == (low <= score.truth <= high)
        assert abs(score.error) < 0.05


def test_every_published_number_has_ours_and_the_difference(report: RotationReport) -> None:
    rows = published_rows(report.identified)
    assert {row.paper for row in rows} == {4771.4, 0.9112, 3.3, 0.05, 0.07}
    for row in rows:
        assert row.difference == pytest.approx(row.ours - row.paper)
        assert row.holds is (None if row.relation == "equal" else row.difference < 0)


def test_what_the_fit_learnt_helps_the_prediction(report: RotationReport) -> None:
    """The same seed is the same instruments: their gain, found in one session, corrects the other."""
    for prediction in report.identified.predictions:
        assert prediction.corrected_error < prediction.error < 0.07
    assert report.identified.corrected.largest < report.identified.spread.largest


def test_uncertain_masses_widen_the_intervals(report: RotationReport) -> None:
    exact, uncertain = report.identified.fit, report.identified.uncertain
    assert np.ptp(uncertain.intervals[0]) > np.ptp(exact.intervals[0])


def test_results_are_plain_json_and_figures(report: RotationReport, tmp_path: Path) -> None:
    write_rotation(report, tmp_path)
    content = json.loads((tmp_path / "rotation.json").read_text(), parse_constant=pytest.fail)
    assert content == json.loads(json.dumps(as_json(report)))
    assert content["fit"]["gas_constant_nm"] == report.identified.fit.gas_constant
    assert len(content["figure_11"]) == 4
    assert len(content["figure_12"]) == 1
    k_b = report.identified.fit.counterbalance.stiffness(np.array(content["figure_13"]["theta_rad"]))
    np.testing.assert_allclose(content["figure_13"]["k_b_nm_per_rad"], k_b)
    for number in (11, 12, 13):
        assert (tmp_path / f"figure-{number}.png").read_bytes().startswith(b"\x89PNG")


def test_a_campaign_of_rests_is_refused(folder: Path, small_robot: Path, tmp_path: Path) -> None:
    scenario = small_loading(small_robot, poses=[{"q_deg": [20, 10], "force_n": [100]}], approach=[1])
    write_session(run_session(scenario), tmp_path)
    with pytest.raises(InputError, match="no motion run"):
        identify_rotation(tmp_path / CAMPAIGN, folder / "unseen" / CAMPAIGN)
