"""Lean steps are MuJoCo's steps: on every robot, with every effect, and where MuJoCo has to take over."""

from dataclasses import fields
from pathlib import Path

import mujoco
import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.effects.conditions import Conditions
from bench.robot.compiled import SpecEdit, compile_robot
from bench.robot.folder import Robot, load_robot
from bench.robot.starter.folder import start_robot
from bench.robot.starter.source import read_source
from bench.simulate.bare import bare_spec
from bench.simulate.plant import Plant
from bench.simulate.trace import Trace
from tests import stranger

PERIOD, SUBSTEPS = 4e-3, 8
ROUNDING = 1e-12  # of the largest angle [rad] or place [m]
# [rad/s] and relative: forces and velocities feel the rounding of angles through servos of up to 1e7 Nm/rad
STIFF_ROUNDING = 1e-8


def both(
    robot: Robot, edits: tuple[SpecEdit, ...] = (), reach: float = 0.05, push: float = -300.0, periods: int = 60
) -> tuple[Trace, Trace, Plant]:
    """Return the same motion stepped by MuJoCo and lean, and the plant of the latter."""
    spec, n = bare_spec(robot), robot.n_joints
    times = PERIOD * np.arange(1, periods + 1)
    commands = reach * np.sin(times[:, None] * (3 + np.arange(n))) * np.linspace(0, 1, periods)[:, None]
    starts = np.concatenate([np.zeros((1, n)), commands[:-1]])
    path = np.stack([(commands - starts) / PERIOD, starts])
    wrenches = np.outer(np.linspace(0, 1, periods), [0.3 * push, 0.1 * push, push, 0, 5.0, 0])
    rows = np.arange(37, periods * SUBSTEPS, 61)
    traces = []
    for is_whole in (True, False):
        plant = Plant(robot, edits, PERIOD / SUBSTEPS, spec)
        plant.reset(np.zeros(n))
        read = np.arange(periods * SUBSTEPS) if is_whole else rows
        trace = plant.track(path, wrenches, SUBSTEPS, read, commands[-1])
        traces.append(trace[rows] if is_whole else trace)
    return traces[0], traces[1], plant


def assert_same(whole: Trace, lean: Trace) -> None:
    for field in fields(Trace):
        expected, seen = getattr(whole, field.name), getattr(lean, field.name)
        share = (
            ROUNDING if field.name in ("time", "q", "theta", "reflectors", "load_point", "wrench") else STIFF_ROUNDING
        )
        scale = max(1.0, float(np.nanmax(np.abs(expected), initial=0.0)))
        np.testing.assert_allclose(seen, expected, rtol=0, atol=share * scale, err_msg=field.name)


@pytest.mark.parametrize("name", ["hh150", "kr300", "emps"])
def test_same_motion_on_every_robot(name: str) -> None:
    robot = load_robot(name)
    slow = 0.02 if name == "emps" else 1.0
    whole, lean, plant = both(robot, reach=0.05 * slow, push=-300.0 * slow)
    assert plant.tracker.is_lean
    assert plant.tracker.whole_steps < 15
    assert_same(whole, lean)


@pytest.mark.parametrize(("most", "is_reached"), [(1e6, False), (800.0, True)])
def test_same_motion_where_joints_cut_off_what_acts_on_them(most: float, is_reached: bool) -> None:
    """A URDF's `effort` is such a limit, so every robot made of one took four times as long."""

    def limited(spec: mujoco.MjSpec, robot: Robot) -> None:
        for drive in robot.figures.drives:
            for joint in (spec.joint(drive.joint), spec.joint(drive.rotor)):
                joint.actfrclimited = True
                joint.actfrcrange = (-most, most)
            spec.actuator(drive.servo).forcerange = (-most, most)

    whole, lean, plant = both(load_robot("hh150"), (limited,))
    assert plant.tracker.is_lean
    assert (plant.tracker.whole_steps > 240) is is_reached
    assert_same(whole, lean)


def test_a_robot_made_of_a_urdf_is_stepped_lean(tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(stranger.urdf())
    robot = start_robot("arm", read_source(tmp_path / "arm.urdf"), tmp_path / "arm").compiled.robot
    whole, lean, plant = both(robot, push=0.0)
    assert np.any(plant.compiled.model.jnt_actfrclimited)
    assert plant.tracker.is_lean
    assert_same(whole, lean)


def effects() -> list[tuple[str, int]]:
    return [(name, 0) for name in catalogue()] + [(name, -1) for name in catalogue()]


@pytest.mark.parametrize(("name", "where"), effects())
def test_same_motion_with_every_effect(name: str, where: int) -> None:
    robot, effect = load_robot("hh150"), catalogue()[name]
    compiled = compile_robot(robot)
    places = effect.places(compiled)
    if not places:
        pytest.skip("has no place on this robot")
    place = places[where]
    values = effect.complete({one.name: one.typical for one in effect.parameters_at(compiled, place)})
    edit = effect.edit(place, values, Conditions.reference(6))
    if edit is None:
        pytest.skip("is not in the model")
    whole, lean, plant = both(robot, (edit,))
    assert plant.tracker.is_lean
    assert plant.tracker.whole_steps < 240
    assert_same(whole, lean)


def test_a_limit_is_mujocos(small_robot: Path) -> None:
    def narrow(spec: mujoco.MjSpec, robot: Robot) -> None:
        spec.joint(robot.figures.drives[0].joint).range = [-0.02, 0.02]

    whole, lean, plant = both(load_robot(str(small_robot)), (narrow,))
    assert np.abs(whole.theta[:, 0]).max() < 0.045
    assert plant.tracker.whole_steps > 50
    assert_same(whole, lean)


def test_a_servo_at_its_limit_is_mujocos(small_robot: Path) -> None:
    robot = load_robot(str(small_robot))

    def weak(spec: mujoco.MjSpec, robot: Robot) -> None:
        spec.actuator(robot.figures.drives[0].servo).forcerange = [-20, 20]

    whole, lean, plant = both(robot, (weak,))
    assert np.abs(whole.motor_torque[:, 0]).max() <= 21
    assert plant.tracker.whole_steps > 50
    assert_same(whole, lean)


def test_what_is_not_known_is_mujocos(small_robot: Path) -> None:
    """A step of an integrator or with a constraint that the lean step does not have."""

    def euler(spec: mujoco.MjSpec, robot: Robot) -> None:
        spec.option.integrator = mujoco.mjtIntegrator.mjINT_EULER

    def rubbing(spec: mujoco.MjSpec, robot: Robot) -> None:
        spec.joint(robot.figures.drives[0].joint).frictionloss = 1.0

    for edit in (euler, rubbing):
        whole, lean, plant = both(load_robot(str(small_robot)), (edit,), periods=10)
        assert not plant.tracker.is_lean
        assert plant.tracker.whole_steps == 80
        assert_same(whole, lean)


def test_branches_slides_and_offset_rotors(small_robot: Path) -> None:
    """A second branch, a slide with a spring, and a hinge whose axis misses what it carries."""

    def branch(spec: mujoco.MjSpec, robot: Robot) -> None:
        drives = robot.figures.drives
        link = spec.body(spec.joint(drives[0].joint).parent.name)
        for place, kind in (([0.1, 0.2, 0.0], mujoco.mjtJoint.mjJNT_SLIDE), ([0, 0, 0.3], mujoco.mjtJoint.mjJNT_HINGE)):
            body = link.add_body(pos=place, quat=[0.9, 0.1, 0.3, 0.2])
            body.add_joint(type=kind, axis=[0.3, 0.5, 0.8], pos=[0.01, 0.02, 0.03], stiffness=200, damping=2)
            body.mass, body.ipos, body.inertia, body.explicitinertial = (
                1.5,
                [0.05, 0.02, 0.1],
                [0.02, 0.03, 0.025],
                True,
            )
        loose = spec.worldbody.add_body(pos=[1, 1, 1])
        loose.add_joint(axis=[0, 1, 0], stiffness=50, damping=0.5)
        loose.mass, loose.ipos, loose.inertia, loose.explicitinertial = 1.0, [0.1, 0, 0], [0.01, 0.01, 0.01], True

    whole, lean, plant = both(load_robot(str(small_robot)), (branch,))
    assert plant.tracker.is_lean
    assert_same(whole, lean)


def test_arrays_that_do_not_fit_are_refused(small_robot: Path) -> None:
    plant = Plant(load_robot(str(small_robot)))
    good = {"path": np.zeros((2, 5, 2)), "wrenches": np.zeros((6, 6)), "substeps": 4, "rows": np.arange(3)}
    plant.tracker.run(**good)
    for bad in ({"path": np.zeros((2, 5, 3))}, {"wrenches": np.zeros((5, 6))}, {"rows": np.array([20])}):
        with pytest.raises(ValueError, match=r"fit|grow"):
            plant.tracker.run(**(good | bad))
