"""A scenario becomes a campaign: complete, reproducible, accepted by the check, the truth apart."""

from pathlib import Path

import numpy as np
import pytest

from bench.errors import InputError
from bench.record.campaign import Campaign
from bench.record.check import check_campaign
from bench.record.write import write_campaign
from bench.simulate.session import Session, run_session
from tests.simulate.loading_small import small_loading


@pytest.fixture(scope="module")
def session(small_robot: Path) -> Session:
    return run_session(small_loading(small_robot))


def tables(campaign: Campaign) -> dict[str, dict[str, np.ndarray]]:
    return {run.name: dict(run.columns) for run in campaign.runs}


def test_every_reading_is_there(session: Session) -> None:
    """Two poses, two directions; unloaded, two loads up, one down, unloaded; three repeats."""
    assert [run.name for run in session.campaign.runs] == [
        f"pose{pose}-from-{side}" for pose in (1, 2) for side in ("below", "above")
    ]
    for run in session.campaign.runs:
        assert len(run) == 5 * 3
        np.testing.assert_array_equal(run.columns["load_step"], np.repeat(np.arange(5), 3))
        np.testing.assert_array_equal(run.columns["repeat"], np.tile([1, 2, 3], 5))
    loads = np.array([0, 100, 250, 100, 0]).repeat(3)
    np.testing.assert_allclose(session.campaign.runs[0].columns["load_z_n"], -loads)
    np.testing.assert_allclose(session.campaign.runs[2].columns["load_x_n"], loads / np.sqrt(2))


def test_its_own_check_has_nothing_to_say(session: Session, tmp_path: Path) -> None:
    write_campaign(session.campaign, tmp_path / "campaign")
    assert check_campaign(tmp_path / "campaign").findings == ()


def test_same_seed_same_campaign(session: Session, small_robot: Path) -> None:
    again, other = run_session(small_loading(small_robot)), run_session(small_loading(small_robot, seed=4))
    for name, columns in tables(session.campaign).items():
        for column, values in columns.items():
            np.testing.assert_array_equal(tables(again.campaign)[name][column], values)
    first = session.campaign.runs[0].name
    different = tables(other.campaign)[first]["reflector_1_x_m"]
    assert not np.array_equal(different, tables(session.campaign)[first]["reflector_1_x_m"])
    np.testing.assert_array_equal(other.instants.theta, session.instants.theta)  # noise does not touch the physics


def test_campaign_holds_no_truth(session: Session) -> None:
    for run in session.campaign.runs:
        assert not any(name.startswith("q_link") for name in run.columns)
    for run, ideal in zip(session.campaign.runs, session.ideal, strict=True):
        assert set(ideal.columns) == set(run.columns) | {"q_link_1_rad", "q_link_2_rad"}


def test_approach_direction_decides_the_friction(session: Session) -> None:
    """Unloaded, friction points down after coming from below and up after coming from above: twice the level apart."""
    friction = {}
    for mark, held in zip(session.marks, session.instants.link_friction, strict=True):
        if mark.labels["load_step"] == 0 and mark.labels["pose"] == 1:
            friction[mark.run] = held
    difference = friction["pose1-from-above"] - friction["pose1-from-below"]
    np.testing.assert_allclose(difference, [120, 60], rtol=0.1)


def test_orientation_needs_the_other_nests(small_robot: Path) -> None:
    session = run_session(small_loading(small_robot, orientation=True, poses=[{"q_deg": [20, 10], "force_n": [100]}]))
    columns = session.campaign.runs[0].columns
    assert {f"reflector_{k}_z_m" for k in (1, 2, 3)} <= set(columns)
    seen = np.stack([columns[f"reflector_2_{axis}_m"] for axis in "xyz"], axis=1).reshape(3, 3, 3).mean(axis=1)
    ideal = session.ideal[0].columns
    true = np.stack([ideal[f"reflector_2_{axis}_m"] for axis in "xyz"], axis=1).reshape(3, 3, 3).mean(axis=1)
    misplaced = (seen - true) - (seen - true)[0]
    assert np.all(np.abs(misplaced[1:]).max(axis=1) > 1e-7), "the reflector sits a little differently each time"


def test_what_does_not_fit_the_robot_is_refused(small_robot: Path) -> None:
    with pytest.raises(InputError, match="above the rating"):
        run_session(small_loading(small_robot, poses=[{"q_deg": [0, 0], "force_n": [999]}]))
