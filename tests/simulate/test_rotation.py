"""Rotations become campaigns: there and back at steady speed, the payload a real mass."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bench.record.check import check_campaign
from bench.record.write import write_campaign
from bench.report.campaigns import plain_arm
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.robot.links import rigid_bodies
from bench.robot.payload import with_payload
from bench.simulate.payload import bolt_on
from bench.simulate.rotation import traverse_deg
from bench.simulate.session import Session, run_session
from tests.simulate.rotation_small import small_rotation

PERIOD = 0.004  # [s]


@pytest.fixture(scope="module")
def session(small_robot: Path) -> Session:
    return run_session(small_rotation(small_robot, speeds_deg_per_s=[25], repeats=2))


def test_one_run_for_each_way(session: Session) -> None:
    names = [run.name for run in session.campaign.runs]
    ways = [f"speed25-{way}" for way in ("up", "down", "up-2", "down-2")]
    assert names == [f"payload{mass}-{way}" for mass in (5, 20) for way in ways]
    assert {run.kind for run in session.campaign.runs} == {"motion"}


def test_its_own_check_has_nothing_to_say(session: Session, tmp_path: Path) -> None:
    write_campaign(session.campaign, tmp_path / "campaign")
    assert check_campaign(tmp_path / "campaign", plain_arm(session.compiled)).findings == ()


def test_payload_is_written_down_and_felt(session: Session) -> None:
    """Between 5 and 20 kg the torque differs by what 15 kg weigh at their lever arm, theta = twist aside."""
    light, heavy = session.ideal[0], session.ideal[4]
    for run, mass in ((light, 5), (heavy, 20)):
        np.testing.assert_array_equal(run.columns["load_mass_kg"], mass)
        np.testing.assert_allclose(run.columns["load_z_n"], -mass * 9.81)
    middle = len(light) // 2
    shoulder, elbow = (heavy.columns[f"q_link_{j}_rad"][middle] for j in (1, 2))
    lever = 0.8 * np.sin(shoulder) + 0.7 * np.cos(shoulder + elbow)
    more = 100.0 * (heavy.columns["current_1_a"] - light.columns["current_1_a"])[middle]
    assert more == pytest.approx(-15 * 9.81 * lever, rel=0.02)


def test_payload_of_both_engines_is_the_same(small_robot: Path) -> None:
    robot = load_robot(small_robot)
    simulated = rigid_bodies(compile_robot(robot, (bolt_on(12.5),)))
    added = with_payload(rigid_bodies(compile_robot(robot)), 12.5, robot.figures.load_point)
    for name in ("mass", "com", "inertia"):
        np.testing.assert_allclose(getattr(added, name), getattr(simulated, name), rtol=1e-12, atol=1e-12)


@given(
    first=st.floats(-90, 90),
    way=st.floats(1, 180),
    sign=st.sampled_from([-1, 1]),
    speed=st.floats(1, 60),
    ramp=st.floats(0.1, 3),
)
def test_full_speed_all_the_way(first: float, way: float, sign: int, speed: float, ramp: float) -> None:
    """Never turns back, never too fast, at full speed between both angles, as far behind as before."""
    last = first + sign * way
    angle = traverse_deg(first, last, speed, ramp)
    velocity = sign * np.diff(angle) / PERIOD
    assert velocity.min() > -1e-6
    assert velocity.max() < speed * (1 + 1e-6)
    inside = (sign * (angle[:-2] - first) >= 0) & (sign * (angle[1:-1] - last) <= 0)
    np.testing.assert_allclose(velocity[:-1][inside], speed, rtol=1e-6)
    assert sign * (first - angle[0]) == pytest.approx(speed * ramp / 2)
    assert sign * (angle[-1] - last) == pytest.approx(speed * ramp / 2)
