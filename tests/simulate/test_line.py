"""The line as sessions: the right runs at the right places, at constant speed, with a friction that slides."""

from pathlib import Path

import numpy as np
import pytest

from bench.errors import InputError
from bench.record.campaign import Run
from bench.record.check import check_campaign
from bench.record.write import write_campaign
from bench.simulate.env import CONTROL_PERIOD
from bench.simulate.line import lead_in_start, pass_distance, read_periods
from bench.simulate.session import Session, run_session
from tests.simulate.line_small import small_line
from tests.small_robot import FRICTION

ROWS = 51


@pytest.fixture(scope="module")
def session(small_robot: Path) -> Session:
    return run_session(small_line(small_robot))


def joints(run: Run, quantity: str, unit: str) -> np.ndarray:
    return run.stack(quantity, unit, ("1", "2"))


def test_the_runs_of_the_experiment(session: Session) -> None:
    names = ["unloaded-out", "unloaded-back", "loaded-out", "loaded-back"]
    assert [run.name for run in session.campaign.runs] == names
    for run in session.campaign.runs:
        assert (run.kind, len(run)) == ("motion", ROWS)
        np.testing.assert_allclose(run.columns["load_z_n"], -250 * run.name.startswith("loaded"))
        np.testing.assert_allclose(np.diff(run.columns["time_s"]), 0.04, atol=1e-9)


def test_out_and_back_are_read_at_equal_places(session: Session) -> None:
    out, back, loaded, _ = (joints(run, "q_cmd", "rad") for run in session.campaign.runs)
    np.testing.assert_allclose(back[::-1], out, atol=1e-12)
    np.testing.assert_array_equal(loaded, out)


def test_a_pass_begins_and_ends_at_rest_and_runs_at_constant_speed(small_robot: Path) -> None:
    scenario = small_line(small_robot)
    distance, reads = pass_distance(scenario), list(read_periods(scenario))
    speed = np.diff(np.append(lead_in_start(scenario), distance)) / CONTROL_PERIOD
    np.testing.assert_allclose(distance[reads], np.linspace(0, scenario.length_m, ROWS), atol=1e-12)
    np.testing.assert_allclose(speed[reads[0] - 100 : reads[-1] + 100], scenario.speed_m_per_s, rtol=1e-9)
    assert speed[[0, -1]] == pytest.approx(0, abs=1e-4 * scenario.speed_m_per_s)
    assert distance[-1] == pytest.approx(scenario.length_m - lead_in_start(scenario))


def test_friction_slides_at_its_level_all_the_way(session: Session) -> None:
    """Both joints turn one way, so link friction stands at the level, against the motion, wherever is read."""
    for run in session.campaign.runs:
        rows = [i for i, mark in enumerate(session.marks) if mark.run == run.name]
        turning = np.sign(np.diff(joints(run, "q_cmd", "rad"), axis=0)).mean(axis=0)
        expected = np.tile(-turning * FRICTION, (len(rows), 1))
        np.testing.assert_allclose(session.instants.link_friction[rows], expected, rtol=1e-6)


def test_its_own_check_has_nothing_to_say(session: Session, tmp_path: Path) -> None:
    write_campaign(session.campaign, tmp_path / "campaign")
    assert check_campaign(tmp_path / "campaign").findings == ()


def test_same_seed_same_campaign(session: Session, small_robot: Path) -> None:
    again, other = run_session(small_line(small_robot)), run_session(small_line(small_robot, seed=4))
    for run, same, different in zip(session.campaign.runs, again.campaign.runs, other.campaign.runs, strict=True):
        for column, values in run.columns.items():
            np.testing.assert_array_equal(same.columns[column], values)
        assert not np.array_equal(different.columns["reflector_1_x_m"], run.columns["reflector_1_x_m"])


def test_corrections_are_added_to_the_commands(session: Session, small_robot: Path) -> None:
    """A cubic in the place of the line, which the spline through its knots is too; another one on the way back."""
    share = np.linspace(0, 1, 5)
    out = 1e-3 * np.stack([share, 1 - share**3], axis=1)
    corrections = {"share": share.tolist(), "out_rad": out.tolist(), "back_rad": (-out).tolist()}
    corrected = run_session(small_line(small_robot, unloaded=False, corrections=corrections)).campaign.runs
    assert [run.name for run in corrected] == ["loaded-out", "loaded-back"]
    plain, fine = joints(session.campaign.runs[2], "q_cmd", "rad"), np.linspace(0, 1, ROWS)
    expected = 1e-3 * np.stack([fine, 1 - fine**3], axis=1)
    np.testing.assert_allclose(joints(corrected[0], "q_cmd", "rad") - plain, expected, atol=1e-12)
    np.testing.assert_allclose(joints(corrected[1], "q_cmd", "rad")[::-1] - plain, -expected, atol=1e-12)


def test_what_does_not_fit_the_robot_is_refused(small_robot: Path) -> None:
    with pytest.raises(InputError, match="above the rating"):
        run_session(small_line(small_robot, force_n=999))
