"""The robot along a prescribed motion against equilibrium at rest."""

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.effects.conditions import Conditions
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from bench.robot.mass_matrix import link_mass_matrix
from bench.simulate.equilibrium import Equilibrium
from bench.simulate.prescribed import Motion, Prescribed

GAP = 4.4e-4  # [rad], the largest plausible of joint 1
AGREE = 1e-8  # [rad]; Prescribed stops at a millionth of the largest torque


def _motion(q: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray) -> Motion:
    length = len(q)
    return Motion(
        np.arange(length, dtype=float), q, velocity, acceleration, np.zeros((length, 6)), np.ones(length, dtype=bool)
    )


def test_rests_are_those_of_equilibrium() -> None:
    compiled = compile_robot(load_robot("hh150"))
    path = np.deg2rad([[0, 10, -20, 30, 40, 0], [0, 20, -30, 20, 50, 10], [0, 15, -25, 10, 45, 5]])
    trace, *_ = Prescribed(compiled).follow(_motion(path, 0 * path, 0 * path))
    equilibrium = Equilibrium(compiled)
    equilibrium.data.qpos[compiled.at.theta] = equilibrium.data.qpos[compiled.at.q] = path[0]
    equilibrium = Equilibrium(compiled, equilibrium.data)
    for i, q in enumerate(path):
        theta = equilibrium.solve(q, np.zeros(6))
        np.testing.assert_allclose(trace.theta[i], theta, atol=AGREE)
        np.testing.assert_allclose(trace.motor_torque[i], equilibrium.motor_torque(), atol=0.02)


def test_drag_that_falls_with_speed_is_no_trouble(small_robot: Path) -> None:
    """A learned drag may; over the time between two rests its damping once outweighed the rotor's inertia."""
    warnings: list[str] = []
    before = mujoco.get_mju_user_warning()
    compiled = compile_robot(load_robot(str(small_robot)))
    compiled.model.dof_damping[compiled.at.q_dof] = 1.0, -2 * compiled.model.dof_armature[compiled.at.q_dof[1]]
    q, zero = np.full((3, compiled.n_joints), 0.3), np.zeros((3, compiled.n_joints))
    mujoco.set_mju_user_warning(warnings.append)
    try:
        Prescribed(compiled).follow(_motion(q, zero, zero))
    finally:
        mujoco.set_mju_user_warning(before)
    assert not warnings


def test_acceleration_costs_the_mass_matrix(small_robot: Path) -> None:
    """Of two motions that differ in acceleration alone, torques differ by inertia; rigid to a part in a thousand."""
    compiled = compile_robot(load_robot(str(small_robot)))
    n = compiled.n_joints
    q, zero, speed = np.full((2, n), 0.3), np.zeros((2, n)), np.full((2, n), 0.2)
    acceleration = np.full((2, n), 0.5)
    slow, *_ = Prescribed(compiled).follow(_motion(q, speed, zero))
    fast, *_ = Prescribed(compiled).follow(_motion(q, speed, acceleration))
    link = link_mass_matrix(compiled, q[1]) @ acceleration[1]
    rotor = compiled.model.dof_armature[compiled.at.q_dof] * acceleration[1]
    np.testing.assert_allclose(fast.motor_torque[1] - slow.motor_torque[1], link + rotor, rtol=5e-3)


@pytest.mark.parametrize("torque", [0.025, 0.04, 0.08, -0.15])
def test_a_link_is_pushed_through_the_whole_gap_of_its_gear(torque: float) -> None:
    """Within a gap nothing pushes back; steps for a hardly stiff element once crept through it and ran out."""
    compiled = _with_gap(GAP)
    zero = np.zeros((2, compiled.n_joints))
    motion = replace(_motion(zero, zero, zero), wrench=np.tile([0.0, 0.0, 0.0, 0.0, 0.0, torque], (2, 1)))
    trace, *_ = Prescribed(compiled).follow(motion)
    wound = np.sign(torque) * GAP / 2 + torque / compiled.stiffness[0]
    np.testing.assert_allclose(trace.theta[:, 0], wound, atol=0.025 / compiled.stiffness[0])


@pytest.mark.parametrize("seed", range(10))
def test_links_balance_beside_others_that_cross_their_gaps(seed: int) -> None:
    """A link that had balanced was sent far away by what another one changed while it looked for its flank."""
    rng, robot = np.random.default_rng(seed), load_robot("hh150")
    nominal = compile_robot(robot)
    n, rest = nominal.n_joints, Conditions.reference(nominal.n_joints)
    play, soft = (catalogue()[name] for name in ("backlash", "softening"))
    for _ in range(12):
        first, second = rng.permutation(n)[:2]
        acting = [(play, first, {"gap": rng.uniform(1e-4, GAP)})]
        acting += [(soft, second, {"softness": rng.uniform(0.3, 0.8), "knee": rng.uniform(0.03, 0.1)})]
        edits = [effect.edit(effect.places(nominal)[j], values, rest) for effect, j, values in acting]
        compiled = compile_robot(robot, [edit for edit in edits if edit])
        moves = rng.random(n) < 0.4
        velocity = np.tile(rng.normal(0, 0.3, n) * moves, (100, 1))
        q = rng.uniform(-1, 1, n) + 0.05 * np.arange(100)[:, None] * velocity
        Prescribed(compiled).follow(_motion(q, velocity, rng.normal(0, 0.3, (100, n)) * moves))


def _with_gap(gap: float) -> CompiledRobot:
    effect = catalogue()["backlash"]
    robot = load_robot("hh150")
    edit = effect.edit(effect.places(compile_robot(robot))[0], {"gap": gap}, Conditions.reference(robot.n_joints))
    assert edit
    return compile_robot(robot, [edit])
