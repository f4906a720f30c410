"""The batch driver knows the same truth as the environment, and a session made with it is a sound campaign."""

from collections.abc import Callable
from dataclasses import fields
from itertools import pairwise
from pathlib import Path
from shutil import copytree

import numpy as np
import pytest

from bench.record.check import check_campaign
from bench.record.write import write_campaign
from bench.robot.folder import load_robot
from bench.scenario.files import Experiment
from bench.simulate.bare import bare_spec
from bench.simulate.batch import course_of, follow, linear
from bench.simulate.drive import Log, drive
from bench.simulate.dwell import dwell_sittings
from bench.simulate.env import CONTROL_PERIOD, BenchEnv
from bench.simulate.loading import loading_sittings
from bench.simulate.plant import Plant
from bench.simulate.policy import Sitting
from bench.simulate.rotation import rotation_sittings
from bench.simulate.session import Session, run_session
from bench.simulate.trace import Trace
from tests.simulate.rotation_small import small_rotation
from tests.simulate.session_small import small_session
from tests.small_robot import K

ROUNDING = 1e-9  # the set point is the same number, but the sum of steps may round another way


def loading(robot: Path) -> Sitting:
    return loading_sittings(small_session(robot).loading, load_robot(robot))[0]


def rotation(robot: Path) -> Sitting:
    return rotation_sittings(small_session(robot).rotations[0], load_robot(robot))[0]


def dwell(robot: Path) -> Sitting:
    return dwell_sittings(small_session(robot).dwell, load_robot(robot))[0]


def bare_plant(robot: Path, sitting: Sitting) -> Plant:
    return Plant(load_robot(robot), sitting.edits, spec=bare_spec(load_robot(robot)))


@pytest.mark.parametrize("make", [loading, rotation, dwell])
def test_same_truth_as_the_environment(make: Callable[[Path], Sitting], small_robot: Path) -> None:
    log, sitting = Log(), make(small_robot)
    env = BenchEnv(str(small_robot), edits=sitting.edits, truth=True)
    env.reset(seed=1, options={"q": sitting.start})
    end = drive(env, sitting, 0.0, log, lambda share: None)
    expected = Trace.concatenate(log.instants)

    sitting = make(small_robot)
    course, plant = course_of(sitting), bare_plant(small_robot, sitting)
    plant.reset(course.start)
    path = linear(course.start, course.commands)
    seen = follow(plant, path, 0, course.wrenches, course.marked)
    for field in fields(Trace):
        if field.name != "time":
            values = getattr(expected, field.name)
            np.testing.assert_allclose(
                getattr(seen, field.name), values, atol=ROUNDING * max(1.0, np.abs(values).max())
            )
    np.testing.assert_allclose(course.ends[course.marked] - plant.timestep, expected.time, atol=1e-9)
    assert course.seconds == pytest.approx(end)
    assert [step.mark for step in course.steps] == [step.mark for step in log.steps]
    assert [words for _, words in course.events] == [words for _, words in log.events]


def test_reads_at_one_time_whatever_the_step(small_robot: Path) -> None:
    """At half the step the readings lie where they lay, not half a millisecond later."""
    sitting = rotation(small_robot)
    course = course_of(sitting)
    whole, half = (Plant(load_robot(small_robot), sitting.edits, step) for step in (1e-3, 5e-4))
    traces = []
    for plant in (whole, half):
        plant.reset(course.start)
        traces.append(follow(plant, course.path, 0, course.wrenches, course.marked, 1e-3))
    np.testing.assert_allclose(traces[0].time, traces[1].time, atol=1e-9)
    speed = np.abs(traces[0].q_velocity).max()
    assert np.abs(traces[0].q - traces[1].q).max() < 0.1 * speed * 5e-4  # servos differ a little with the step


def test_another_plant_takes_over(small_robot: Path) -> None:
    sitting = loading(small_robot)
    course, robot = course_of(sitting), load_robot(small_robot)
    plant, other = Plant(robot), Plant(robot)
    plant.reset(course.start)
    middle = len(course) // 2
    follow(plant, course.path, 0, course.wrenches[:middle], ())
    other.take_over(plant)
    rows = course.marked[course.marked >= middle]
    first, second = (follow(one, course.path, middle, course.wrenches[middle:], rows) for one in (plant, other))
    np.testing.assert_array_equal(first.theta, second.theta)
    np.testing.assert_array_equal(first.link_friction, second.link_friction)
    np.testing.assert_array_equal(first.time, second.time)


def test_torque_is_that_of_the_balance_also_while_it_accelerates(small_robot: Path) -> None:
    """Motor torque = J a + viscous friction + element + Coulomb friction, at every step of a sweep with its ramps."""
    sitting = rotation(small_robot)
    course, plant = course_of(sitting), bare_plant(small_robot, sitting)
    plant.reset(course.start)
    model, at = plant.model, plant.compiled.at
    substeps = round(CONTROL_PERIOD / plant.timestep)
    every = np.arange(len(course) * substeps)
    trace = plant.track(course.path.c, course.wrenches, substeps, every, course.commands[-1])
    gained = np.diff(trace.q_velocity, axis=0)
    relative = trace.q_velocity - trace.theta_velocity
    damping = np.array([0.002 * k for k in K])
    element = plant.compiled.stiffness * (trace.q - trace.theta)[:-1] + damping * relative[1:]
    inertia = model.dof_armature[at.q_dof] * gained / plant.timestep
    balance = inertia + element - trace.motor_friction[:-1]
    assert np.abs(inertia).max() > 50
    left = np.abs(trace.motor_torque[:-1] - balance).max()
    assert left < 0.02 * np.abs(inertia).max()  # bristles, too, are taken at the end of a step


@pytest.fixture(scope="module")
def session(small_robot: Path) -> Session:
    return run_session(small_session(small_robot))


def test_its_own_check_has_nothing_to_say(session: Session, tmp_path: Path) -> None:
    write_campaign(session.campaign, tmp_path / "campaign")
    assert check_campaign(tmp_path / "campaign").findings == ()


def test_runs_are_named_and_in_order(session: Session) -> None:
    names = [run.name for run in session.campaign.runs]
    sweep = "payload0-speed30"
    ends = ["pose1-from-below", f"joint1-{sweep}-up", f"joint1-{sweep}-down"]
    assert names == [
        *(f"first-{name}" for name in ends),
        *("pose1-from-below", "pose1-from-above"),
        *("joint1-payload5-speed30-up", "joint1-payload5-speed30-down"),
        *(f"joint2-{sweep}-up", f"joint2-{sweep}-down"),
        *("unloaded-out", "unloaded-back", "loaded-out", "loaded-back"),
        "dwell",
        *(f"last-{name}" for name in ends),
    ]
    for before, after in pairwise(session.campaign.runs):
        assert after.start_s > before.start_s + before.columns["time_s"][-1]
    for run in session.campaign.runs:
        assert "reflector_1_x_m" in run.columns


def test_wall_clock_time_passes_in_breaks_and_while_it_stands(session: Session) -> None:
    runs = {run.name: run for run in session.campaign.runs}
    begins, sweep = runs["pose1-from-below"], runs["first-joint1-payload0-speed30-down"]
    assert begins.start_s - sweep.start_s - sweep.columns["time_s"][-1] > 300
    dwell = runs["dwell"]
    assert len(dwell) == 30
    assert dwell.columns["time_s"][-1] == pytest.approx(9 * 60, abs=1.0)
    assert np.all(dwell.columns["load_step"] == 0)


def test_commands_are_those_of_the_instant(session: Session) -> None:
    """At constant speed, once the servo has settled, the motor is where it is told to be at that very time."""
    run = next(run for run in session.campaign.runs if run.name == "joint2-payload0-speed30-up")
    error = run.columns["q_motor_2_rad"] - run.columns["q_cmd_2_rad"]
    speed = np.gradient(run.columns["q_cmd_2_rad"], run.columns["time_s"])
    steady = speed > 0.999 * speed.max()
    assert np.abs(np.median(error[steady])) < 0.1 * 1e-3 * speed.max()


def test_same_seed_same_campaign(session: Session, small_robot: Path) -> None:
    again = run_session(small_session(small_robot))
    for run, other in zip(session.campaign.runs, again.campaign.runs, strict=True):
        for name, values in run.columns.items():
            np.testing.assert_array_equal(other.columns[name], values)


@pytest.mark.parametrize("small", [small_session, small_rotation])
def test_gas_that_was_compressed_is_warm_in_the_next_sitting(
    small: Callable[[Path], Experiment], small_robot: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Another payload is another plant; what the cylinder holds is the same gas, a pause later."""
    robot = tmp_path / "warm"
    copytree(small_robot, robot)
    file = next(robot.glob("*.xml"))
    text = file.read_text()
    warms = '<config key="heat_capacity_ratio" value="1.1"/><config key="relaxation_time" value="1000"/>'
    file.write_text(text.replace('plugin="bench.gas_spring">', f'plugin="bench.gas_spring">{warms}'))
    assert warms in file.read_text()
    began: list[float] = []
    reset = Plant.reset

    def noted(plant: Plant, q: np.ndarray, gas_rise: float = 0.0) -> None:
        began.append(gas_rise)
        reset(plant, q, gas_rise)

    monkeypatch.setattr(Plant, "reset", noted)
    run_session(small(robot))
    assert any(rise != 0.0 for rise in began[1:])
