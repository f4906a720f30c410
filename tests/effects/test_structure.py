"""Compliance of the structure: rotation is compliance times moment, and the reflectors move with it."""

import mujoco
import numpy as np
import pytest

from bench.effects.conditions import Conditions
from bench.effects.effect import Place
from bench.effects.passive_hinges import SETTLING, add_hinges
from bench.errors import RobotError
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import Robot, load_robot
from bench.simulate.plant import Plant
from tests.effects.rest import CATALOGUE, PERIOD, Rest, edit_of, rest

Q = np.array([0.3, 0.2])
LOAD = np.array([40.0, 60.0, -250.0, 0, 0, 0])


def hinge_angles(found: Rest) -> dict[str, float]:
    """Angles of the passive hinges by name [rad]."""
    model, data = found.equilibrium.compiled.model, found.equilibrium.data
    named = {str(model.joint(j).name): j for j in range(model.njnt)}
    return {name: float(data.qpos[model.jnt_qposadr[j]]) for name, j in named.items() if name.startswith("effect/")}


def moments_about(found: Rest, joints: list[str], bodies_from: str) -> dict[str, float]:
    """Moment about each hinge of the load and the weight of a body and all that it carries: mechanics by hand [Nm]."""
    model, data = found.equilibrium.compiled.model, found.equilibrium.data
    first = model.body(bodies_from).id
    carried = [b for b in range(model.nbody) if _is_below(model, b, first)]
    hook, push = data.site_xpos[found.equilibrium.compiled.at.load_point], data.xfrc_applied
    moments = {}
    for joint in joints:
        j = model.joint(joint).id
        anchor, axis = data.xanchor[j], data.xaxis[j]
        moment = np.cross(hook - anchor, push[found.equilibrium.compiled.at.load_body, :3])
        for b in carried:
            moment = moment + np.cross(data.xipos[b] - anchor, model.body_mass[b] * model.opt.gravity)
        moments[joint] = float(axis @ moment)
    return moments


def _is_below(model: mujoco.MjModel, body: int, other: int) -> bool:
    while body and body != other:
        body = int(model.body_parentid[body])
    return body == other


def test_bending(small: Robot, small_compiled: CompiledRobot) -> None:
    compliance = 2e-7
    found = rest(small, [edit_of("link_bending", small_compiled, {"compliance": compliance})], Q, LOAD)
    angles = hinge_angles(found)
    assert len(angles) == 2
    for name, moment in moments_about(found, list(angles), "fore").items():
        np.testing.assert_allclose(angles[name], compliance * moment, rtol=1e-9)
    assert max(abs(angle) for angle in angles.values()) > 1e-5


def test_bending_sits_in_the_middle_of_the_link(small: Robot, small_compiled: CompiledRobot) -> None:
    model = compile_robot(small, [edit_of("link_bending", small_compiled, {"compliance": 1e-7})]).model
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    for j in range(model.njnt):
        if str(model.joint(j).name).startswith("effect/"):
            np.testing.assert_allclose(data.xanchor[j], [0, 0, 0.4], atol=1e-12)
            assert abs(data.xaxis[j][2]) < 1e-12


def test_bearing_tilts_across_its_axis_only(small: Robot, small_compiled: CompiledRobot) -> None:
    compliance = 2e-7
    found = rest(small, [edit_of("bearing_tilt", small_compiled, {"compliance": compliance}, 1)], Q, LOAD)
    angles = hinge_angles(found)
    model, data = found.equilibrium.compiled.model, found.equilibrium.data
    for name, moment in moments_about(found, list(angles), "fore").items():
        assert abs(data.xaxis[model.joint(name).id] @ data.xaxis[model.joint("hinge_b").id]) < 1e-6
        np.testing.assert_allclose(angles[name], compliance * moment, rtol=1e-9)


def test_base_moves_the_reflectors(hh150: Robot, hh150_compiled: CompiledRobot) -> None:
    """The tracker sees the rotation of the foot times the distance from it."""
    compliance = 2e-8
    q = np.array([0.4, 0.2, -0.1, 0.3, 0.2, 0.1])
    plain = rest(hh150, [], q, LOAD)
    rocking = rest(hh150, [edit_of("base_compliance", hh150_compiled, {"compliance": compliance})], q, LOAD)
    angles = hinge_angles(rocking)
    moments = moments_about(rocking, list(angles), "base")
    for name, angle in angles.items():
        np.testing.assert_allclose(angle, compliance * moments[name], rtol=1e-9)
    x, y = angles.values()
    shift = np.cross([x, y, 0.0], plain.reflectors)
    np.testing.assert_allclose(rocking.reflectors - plain.reflectors, shift, atol=1e-6, rtol=1e-2)
    assert np.linalg.norm(shift[0]) > 1e-4


def test_a_base_without_mass_rocks_too() -> None:
    """A base that is fixed needs no mass in a file; on such arms rocking was not looked for."""
    spec = mujoco.MjSpec.from_string("""
        <mujoco><worldbody><body name="base"><body name="link" pos="0 0 1"><joint name="j" axis="0 0 1"/>
        <inertial mass="3" pos="0.5 0 0" diaginertia="1 1 1"/></body></body></worldbody></mujoco>""")
    add_hinges(spec, "base", "rocking", np.zeros(3), [np.array([0.0, 1.0, 0.0])], 1e-3, before=True)
    model = spec.compile()
    data = mujoco.MjData(model)
    for _ in range(20000):
        mujoco.mj_step(model, data)
    np.testing.assert_allclose(data.qpos[0], 1e-3 * 3 * 9.81 * 0.5, rtol=0.05)


def test_torsion_of_the_base_is_a_twin_of_the_first_joint(hh150: Robot, hh150_compiled: CompiledRobot) -> None:
    """With a vertical first axis both turn the arm by the same angle, so no tracker can tell them apart."""
    compliance = 5e-7
    k = hh150_compiled.stiffness[0]
    q = np.array([0.4, 0.2, -0.1, 0.3, 0.2, 0.1])
    base = rest(hh150, [edit_of("base_torsion", hh150_compiled, {"compliance": compliance})], q, LOAD)
    joint = rest(hh150, [edit_of("joint_compliance", hh150_compiled, {"change": compliance * k}, 0)], q, LOAD)
    np.testing.assert_allclose(base.reflectors, joint.reflectors, atol=1e-9)
    np.testing.assert_allclose(base.torque, joint.torque, atol=1e-3)


def test_hinges_are_stable_at_a_millisecond(hh150: Robot, hh150_compiled: CompiledRobot) -> None:
    """The stiffest and the softest hinges that are plausible, at every place, at once, pushed by a sudden load."""
    edits = []
    for name in ("link_bending", "bearing_tilt", "base_compliance", "base_torsion"):
        effect = CATALOGUE[name]
        for i, place in enumerate(effect.places(hh150_compiled)):
            parameter = effect.parameters_at(hh150_compiled, place)[0]
            edits.append(edit_of(name, hh150_compiled, {"compliance": (parameter.low, parameter.high)[i % 2]}, i))
    plant = Plant(hh150, edits)
    assert plant.timestep <= SETTLING
    q = np.array([0.1, 0.2, -0.1, 0.3, 0.2, 0.1])
    plant.reset(q)
    trace = plant.advance(np.tile(q, (500, 1)), np.tile(LOAD, (500, 1)), PERIOD)
    early, late = (np.max(np.abs(trace.theta_velocity[rows])) for rows in (slice(0, 400), slice(-200, None)))
    assert late < 0.05 * early


def test_order_of_joints_keeps_the_drives(hh150: Robot, hh150_compiled: CompiledRobot) -> None:
    """Driven joints keep name, axis, range and everything else when hinges come before them."""
    changed = compile_robot(hh150, [edit_of("link_bending", hh150_compiled, {"compliance": 1e-7}, 1)])
    for drive in hh150.figures.drives:
        old, new = hh150_compiled.model.joint(drive.joint), changed.model.joint(drive.joint)
        for attribute in ("axis", "range", "pos", "stiffness", "qpos0"):
            np.testing.assert_array_equal(getattr(old, attribute), getattr(new, attribute))
    np.testing.assert_array_equal(changed.limits, hh150_compiled.limits)


def test_a_robot_that_the_engine_refuses_while_geometry_is_read_is_refused_in_plain_words() -> None:
    """A fit's derivative may step beyond what an effect means; what reads geometry after it compiles the robot."""
    robot = load_robot("hh150")
    place, conditions = Place("robot"), Conditions.reference(robot.n_joints)
    seal = CATALOGUE["seal_friction"].edit(place, {"share": -0.002}, conditions)
    bending = CATALOGUE["link_bending"]
    first = bending.places(compile_robot(robot))[0]
    bent = bending.edit(first, {p.name: p.typical for p in bending.parameters}, conditions)
    assert seal
    assert bent
    with pytest.raises(RobotError, match="seal_friction"):
        compile_robot(robot, (seal, bent))
