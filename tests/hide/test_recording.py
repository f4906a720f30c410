"""Errors of the recording that are hidden: the truth stays what it is, what is read or written down is wrong."""

from pathlib import Path

import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.effects.recorded import recorded_in
from bench.hide.campaign import Hidden, hide_campaign
from bench.hide.recorded import recorded_of
from bench.hide.request import effects_of
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from tests.simulate.session_small import small_session

RESOLUTION = 0.01  # [A], of the small robot's current sensors, as `instruments.py` has it; each of three is rounded
SAME = 1e-4  # of the travel; noise follows the distance from the tracker, by some millionths of it


def hide(folder: Path, *words: str, without: tuple[str, ...] = ()) -> Hidden:
    robot, session = load_robot(folder), small_session(folder)
    recorded = recorded_of(robot, session, without)
    acting = effects_of(words, compile_robot(robot), catalogue(), None, recorded)
    return hide_campaign(robot, session, acting, np.random.default_rng(1), without=without)


@pytest.fixture(scope="module")
def null(small_robot: Path) -> Hidden:
    return hide(small_robot)


def test_places_are_known_before_anything_is_simulated(null: Hidden, small_robot: Path) -> None:
    robot = load_robot(small_robot)
    known = recorded_of(robot, small_session(small_robot))
    made = recorded_in(null.campaign.runs, compile_robot(robot).model.opt.gravity)
    for effect in catalogue().values():
        compiled = compile_robot(robot)
        expected, found = effect.places_in(compiled, made), effect.places_in(compiled, known)
        assert [str(place) for place in found] == [str(place) for place in expected]
        np.testing.assert_allclose([p.since_s for p in found], [p.since_s for p in expected], atol=1e-9)


def test_a_late_tracker_shows_where_the_arm_was(null: Hidden, small_robot: Path) -> None:
    """Late by two samples: what noise is taken off it is the truth two rows before."""
    run = next(run for run in null.campaign.runs if run.kind == "motion" and len(run) > 20)
    period = float(np.median(np.diff(run.columns["time_s"])))
    late = hide(small_robot, f"channel_delay@tracker={2 * period}")
    assert late.truth.effects == ("channel_delay tracker",)
    names = [f"reflector_1_{axis}_m" for axis in "xyz"]
    travel = max(float(np.ptp(run.columns[name])) for name in names)
    for name in names:
        shown = next(one for one in late.campaign.runs if one.name == run.name).columns[name] - run.columns[name]
        true = null.truth.runs[run.name][name]
        moved = true[:-2] - true[2:]
        np.testing.assert_allclose(shown[2:], moved, atol=SAME * travel)
    for before, after in zip(null.campaign.runs, late.campaign.runs, strict=True):
        np.testing.assert_array_equal(after.columns["current_1_a"], before.columns["current_1_a"])


def test_a_late_current_shows_an_earlier_torque(null: Hidden, small_robot: Path) -> None:
    """Half a control period late: half of what it showed a period before, for between two of them it is straight."""
    late = hide(small_robot, "channel_delay@current_1_a=0.002")
    whole = hide(small_robot, "channel_delay@current_1_a=0.004")
    for at_once, half, full in zip(null.campaign.runs, late.campaign.runs, whole.campaign.runs, strict=True):
        now, earlier = at_once.columns["current_1_a"], full.columns["current_1_a"]
        np.testing.assert_allclose(half.columns["current_1_a"], (now + earlier) / 2, atol=1.01 * RESOLUTION)
        np.testing.assert_array_equal(half.columns["current_2_a"], at_once.columns["current_2_a"])


def test_a_weight_is_written_down_wrong(null: Hidden, small_robot: Path) -> None:
    """A hundred written for fifty; the force sensor and everything else say what was there."""
    name = next(run.name for run in null.campaign.runs if run.kind == "static" and np.any(run.columns["load_z_n"]))
    wrong = hide(small_robot, f"hung_load@{name}=-0.5")
    for before, after in zip(null.campaign.runs, wrong.campaign.runs, strict=True):
        for column, values in before.columns.items():
            factor = 2.0 if before.name == name and column in ("load_x_n", "load_y_n", "load_z_n") else 1.0
            np.testing.assert_allclose(after.columns[column], factor * values, rtol=1e-12)


def test_a_payload_is_written_down_wrong(null: Hidden, small_robot: Path) -> None:
    runs = [run for run in null.campaign.runs if "load_mass_kg" in run.columns]
    name = f"{runs[0].name} to {runs[-1].name}"
    wrong = {run.name: run for run in hide(small_robot, f"bolted_load@{name}=-0.2").campaign.runs}
    for run in runs:
        np.testing.assert_allclose(wrong[run.name].columns["load_mass_kg"], run.columns["load_mass_kg"] / 0.8)
        np.testing.assert_allclose(wrong[run.name].columns["load_z_n"], run.columns["load_z_n"] / 0.8)
        np.testing.assert_array_equal(wrong[run.name].columns["current_2_a"], run.columns["current_2_a"])


def test_gas_that_is_let_out_is_missing_from_its_run_on(null: Hidden, small_robot: Path) -> None:
    runs = null.campaign.runs
    since = runs[-2].name
    robot = load_robot(small_robot)
    known = recorded_of(robot, small_session(small_robot))
    assert since in [run.name for run in known.after_breaks]
    less = hide(small_robot, f"gas_step@{since}=0.1")
    for run in runs:
        before, after = (one.truth.runs[run.name]["gas_pressure_pa"] for one in (null, less))
        share = 0.1 if run.start_s >= null.campaign.runs[-2].start_s else 0.0
        np.testing.assert_allclose(after, (1 - share) * before, rtol=1e-3)


def test_a_leak_goes_on_all_day(null: Hidden, small_robot: Path) -> None:
    """The pull falls by the rate times the time in the middle of each piece, none of them longer than a minute."""
    leaking = hide(small_robot, "gas_leak=0.3")
    for run in null.campaign.runs:
        before, after = (one.truth.runs[run.name]["gas_pressure_pa"] for one in (null, leaking))
        hours = (run.start_s + run.columns["time_s"]) / 3600
        np.testing.assert_allclose(after / before, 1 - 0.3 * hours, atol=0.3 * 35 / 3600)
