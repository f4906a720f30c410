"""Effects of drive friction: torques of the friction elements in sliding, against their closed forms."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from bench.effects.conditions import Conditions
from bench.effects.friction_elements import coulomb, set_coulomb
from bench.effects.lubricant import viscous
from bench.effects.nominal import nominal_parameters
from bench.effects.places import drive_of, torque_limit
from bench.effects.recorded import Recorded
from bench.errors import RobotError
from bench.robot.compiled import CompiledRobot, SpecEdit, compile_robot
from bench.robot.edits import friction_on
from bench.robot.folder import Robot
from tests.effects.rest import CATALOGUE, edit_of, recorded_on, sweep
from tests.small_robot import FRICTION

START = np.array([0.1, -0.2])
SPEED = np.array([0.1, -0.1])  # [rad/s]
TAIL = slice(1500, None)  # steps after which all elements slide
SLIDING = 1e-6  # relative
ROUNDED = 2e-3  # of a side's level, in the range of what may move: three digits of a share of both sides


@pytest.fixture(params=["own", "shared"])
def robot(request: pytest.FixtureRequest) -> Robot:
    # the friction elements of the small robot have an instance each, those of the HH-150 share them
    found: Robot = request.getfixturevalue({"own": "small", "shared": "hh150"}[request.param])
    return found


def friction(robot: Robot, edits: list[SpecEdit], speed: float) -> tuple[np.ndarray, np.ndarray, CompiledRobot]:
    """Friction torques of motor and link side in sliding, shape (T, n)."""
    n = robot.n_joints
    trace = sweep(robot, edits, np.full(n, 0.1), np.full(n, speed))
    return trace.motor_friction[TAIL], trace.link_friction[TAIL], compile_robot(robot)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("which", [0, 1])
def test_level(robot: Robot, which: int, sign: int) -> None:
    compiled = compile_robot(robot)
    edit = edit_of("coulomb_level", compiled, {"change": 0.3}, which)
    motor, link, _ = friction(robot, [edit], sign * 0.1)
    factor = np.ones(robot.n_joints)
    factor[which] = 1.3
    np.testing.assert_allclose(motor, np.tile(-sign * factor * compiled.motor_coulomb, (len(motor), 1)), rtol=SLIDING)
    np.testing.assert_allclose(link, np.tile(-sign * factor * compiled.link_coulomb, (len(link), 1)), rtol=SLIDING)


def test_friction_that_drives_is_refused(robot: Robot) -> None:
    edit = edit_of("coulomb_level", compile_robot(robot), {"change": -1.5}, 1)
    with pytest.raises(RobotError, match=r"coulomb = .* must be a finite number >= 0"):
        compile_robot(robot, [edit])


@pytest.mark.parametrize("sign", [1, -1])
def test_direction(robot: Robot, sign: int) -> None:
    compiled = compile_robot(robot)
    motor, link, _ = friction(robot, [edit_of("direction_friction", compiled, {"asymmetry": 0.2}, 1)], sign * 0.1)
    factor = np.ones(robot.n_joints)
    factor[1] = 1 + sign * 0.2
    np.testing.assert_allclose(motor[-1], -sign * factor * compiled.motor_coulomb, rtol=SLIDING)
    np.testing.assert_allclose(link[-1], -sign * factor * compiled.link_coulomb, rtol=SLIDING)


@pytest.mark.parametrize("sign", [1, -1])
def test_viscous_by_direction(hh150: Robot, sign: int) -> None:
    compiled = compile_robot(hh150)
    motor, link, _ = friction(hh150, [edit_of("direction_viscous", compiled, {"asymmetry": 0.3}, 1)], sign * 0.1)
    level = compiled.motor_coulomb.copy()
    level[1] += sign * 0.3 * 0.1 * compiled.model.dof_damping[compiled.at.q_dof[1]]
    np.testing.assert_allclose(motor[-1], -sign * level, rtol=1e-3)
    np.testing.assert_allclose(link[-1], -sign * compiled.link_coulomb, rtol=SLIDING)


@pytest.mark.parametrize("sign", [1, -1])
def test_rolling_by_direction(hh150: Robot, sign: int) -> None:
    """Also where a drive has rolling friction alone: a stranger's was called the offset of a current."""
    nominal = compile_robot(hh150)
    rolls = [
        edit_of("rolling_friction", nominal, {"rolling": 300.0}, 1),
        edit_of("viscous_level", nominal, {"change": -1.0}, 1),
    ]
    edit = edit_of("direction_viscous", compile_robot(hh150, rolls), {"asymmetry": 0.3}, 1)
    motor, link, _ = friction(hh150, [*rolls, edit, edit], sign * 0.1)
    level = nominal.motor_coulomb.copy()
    level[1] += (1 + sign * 0.6) * 300.0 * 0.1 ** (2 / 3)
    np.testing.assert_allclose(motor[-1], -sign * level, rtol=2e-3)
    np.testing.assert_allclose(link[-1], -sign * nominal.link_coulomb, rtol=SLIDING)


@pytest.mark.parametrize("speed", [0.05, -0.2])
def test_rolling_friction_bends_over_speed(hh150: Robot, speed: float) -> None:
    compiled = compile_robot(hh150)
    edit = edit_of("rolling_friction", compiled, {"rolling": 300.0}, 1)
    for edits, rolling in (([edit], 300.0), ([edit, edit], 600.0)):  # it adds to what is there
        motor, link, _ = friction(hh150, edits, speed)
        level = compiled.motor_coulomb.copy()
        level[1] += rolling * abs(speed) ** (2 / 3)
        np.testing.assert_allclose(motor[-1], -np.sign(speed) * level, rtol=2e-3)
        np.testing.assert_allclose(link[-1], -np.sign(speed) * compiled.link_coulomb, rtol=SLIDING)


def test_rolling_friction_is_no_more_than_what_is_stated_to_rub(hh150_compiled: CompiledRobot) -> None:
    """A joint with 34 Nm of Coulomb friction was offered 2300 Nm of rolling friction, so 27 Nm were not believed."""
    for place in CATALOGUE["rolling_friction"].places(hh150_compiled):
        (rolling,) = CATALOGUE["rolling_friction"].parameters_at(hh150_compiled, place)
        stated = (
            hh150_compiled.motor_coulomb[place.index]
            + hh150_compiled.link_coulomb[place.index]
            + viscous(hh150_compiled)[place.index]
        )
        limit = torque_limit(hh150_compiled, place.index)
        np.testing.assert_allclose(rolling.high, min(stated, 0.2 * limit))
        np.testing.assert_allclose(rolling.low / rolling.high, 0.01)


def test_rolling_friction_that_is_there_is_more_or_less(hh150: Robot) -> None:
    """A model with rolling friction is offered its level, whether or not it has viscous friction beside it."""
    nominal = compile_robot(hh150)
    assert not CATALOGUE["rolling_level"].places(nominal)
    rolls = edit_of("rolling_friction", nominal, {"rolling": 300.0}, 1)
    there = compile_robot(hh150, [rolls, edit_of("viscous_level", nominal, {"change": -1.0}, 1)])
    (place,) = CATALOGUE["rolling_level"].places(there)
    assert place.index == 1
    assert 1 not in [one.index for one in CATALOGUE["rolling_friction"].places(there)], "else it would have two names"
    less = edit_of("rolling_level", there, {"change": -0.4})
    np.testing.assert_allclose(compile_robot(hh150, [rolls, less]).motor_rolling[1], 180.0)
    motor, _, _ = friction(hh150, [rolls, less], 0.1)
    expected = nominal.motor_coulomb[1] + 180.0 * 0.1 ** (2 / 3)
    np.testing.assert_allclose(motor[-1, 1], -expected, rtol=2e-3)
    figures = {one.name: one for one in nominal_parameters(there)}
    edit = figures[f"rolling friction of {hh150.figures.drives[1].joint}"].edit(-0.4)
    np.testing.assert_allclose(compile_robot(hh150, [rolls, edit]).motor_rolling[1], 180.0)


def test_stribeck(robot: Robot) -> None:
    compiled = compile_robot(robot)
    edit = edit_of("stribeck", compiled, {"rise": 0.4, "speed": 0.05}, 1)
    trace = sweep(robot, [edit], np.full(robot.n_joints, 0.1), np.full(robot.n_joints, 0.06))
    expected = -compiled.motor_coulomb[1] * (1 + 0.4 * np.exp(-((trace.q_velocity[TAIL, 1] / 0.05) ** 2)))
    np.testing.assert_allclose(trace.motor_friction[TAIL, 1], expected, rtol=1e-5)
    assert np.all(np.abs(trace.motor_friction[TAIL, 1]) > 1.05 * compiled.motor_coulomb[1])
    np.testing.assert_allclose(trace.motor_friction[-1, 0], -compiled.motor_coulomb[0], rtol=SLIDING)


def test_load(robot: Robot) -> None:
    compiled = compile_robot(robot)
    edit = edit_of("load_friction", compiled, {"coefficient": 0.05}, 1)
    trace = sweep(robot, [edit], np.full(robot.n_joints, 0.1), np.full(robot.n_joints, 0.1))
    load = compiled.stiffness[1] * (trace.q - trace.theta)[TAIL, 1]
    expected = -(compiled.motor_coulomb[1] + 0.05 * np.abs(load))
    np.testing.assert_allclose(trace.motor_friction[TAIL, 1], expected, rtol=1e-6)
    np.testing.assert_allclose(trace.motor_friction[-1, 0], -compiled.motor_coulomb[0], rtol=SLIDING)


def test_ripple(robot: Robot) -> None:
    compiled = compile_robot(robot)
    values = {"sin": 0.2, "cos": -0.1, "period": 0.3}
    trace = sweep(
        robot, [edit_of("friction_ripple", compiled, values, 1)], np.zeros(robot.n_joints), np.full(robot.n_joints, 0.1)
    )
    phase = 2 * np.pi * trace.q[TAIL, 1] / 0.3
    expected = -compiled.motor_coulomb[1] * (1 + 0.2 * np.sin(phase) - 0.1 * np.cos(phase))
    np.testing.assert_allclose(trace.motor_friction[TAIL, 1], expected, rtol=1e-6)


@pytest.mark.parametrize(("moved", "motor", "link"), [(0.25, 0.5, 1.5), (-0.5, 2.0, 0.0)])
def test_side(small: Robot, small_compiled: CompiledRobot, moved: float, motor: float, link: float) -> None:
    """Both sides of the small robot have the same level."""
    changed = compile_robot(small, [edit_of("friction_side", small_compiled, {"moved": moved}, 1)])
    np.testing.assert_allclose(changed.motor_coulomb, np.array(FRICTION) * [1, motor])
    np.testing.assert_allclose(changed.link_coulomb, np.array(FRICTION) * [1, link])


def test_as_much_moves_either_way_and_what_moves_twice_adds_up(hh150: Robot, hh150_compiled: CompiledRobot) -> None:
    """What moved back to the motor came out at less than half of itself: a signature is that of the other way."""

    def moved(*shares: float) -> float:
        edits = [edit_of("friction_side", hh150_compiled, {"moved": share}, 1) for share in shares]
        changed = compile_robot(hh150, edits)
        levels = changed.motor_coulomb + changed.link_coulomb
        np.testing.assert_allclose(levels, hh150_compiled.motor_coulomb + hh150_compiled.link_coulomb)
        return float(changed.link_coulomb[1] - hh150_compiled.link_coulomb[1])

    assert moved(-0.1) == pytest.approx(-moved(0.1))
    assert moved(-0.1, -0.1) == pytest.approx(moved(-0.2))


def test_no_more_moves_than_a_side_has(hh150: Robot, hh150_compiled: CompiledRobot) -> None:
    effect = CATALOGUE["friction_side"]
    for place in effect.places(hh150_compiled):
        (moved,) = effect.parameters_at(hh150_compiled, place)
        for share, side in ((moved.least, "link_coulomb"), (moved.most, "motor_coulomb")):
            changed = compile_robot(hh150, [edit_of("friction_side", hh150_compiled, {"moved": share}, place.index)])
            there = getattr(hh150_compiled, side)[place.index]
            assert getattr(changed, side)[place.index] == pytest.approx(0.0, abs=ROUNDED * there)
        assert moved.null < moved.typical < moved.most


@pytest.mark.parametrize("link", [0.0, 1.0])
def test_where_a_file_has_no_friction_at_the_motor_all_may_move(
    hh150: Robot, hh150_compiled: CompiledRobot, link: float
) -> None:
    """What a search found friction in has a place, and the file that says what is plausible has none: it was nan."""

    def without(spec: mujoco.MjSpec, robot: Robot) -> None:
        drive = drive_of(robot, CATALOGUE["friction_side"].places(hh150_compiled)[1])
        set_coulomb(spec, drive, "motor", 0.0)
        set_coulomb(spec, drive, "link", link * coulomb(spec, drive, "link"))

    effect, bare = CATALOGUE["friction_side"], compile_robot(hh150, [without])
    place = effect.places(hh150_compiled)[1]
    (moved,) = effect.parameters_at(bare, place)
    assert moved.null < moved.low < moved.typical < moved.high


def test_viscous(hh150: Robot, hh150_compiled: CompiledRobot) -> None:
    """The servo pays for it: at constant speed the torque grows by x f_v v."""
    edit = edit_of("viscous_level", hh150_compiled, {"change": 0.5}, 1)
    start, speed = np.full(6, 0.1), np.full(6, 0.05)
    extra = sweep(hh150, [edit], start, speed).motor_torque - sweep(hh150, [], start, speed).motor_torque
    damping = hh150_compiled.model.dof_damping[hh150_compiled.at.q_dof[1]]
    np.testing.assert_allclose(extra[-1, 1], 0.5 * damping * 0.05, rtol=1e-3)


def test_temperature(hh150: Robot, hh150_compiled: CompiledRobot) -> None:
    gear = np.array([293.15, 313.15, 293.15, 293.15, 293.15, 293.15])
    conditions = Conditions(gear, np.full(6, 350.0))
    edit = edit_of("friction_temperature", hh150_compiled, {"decrease": 0.03}, 1, conditions)
    changed = compile_robot(hh150, [edit])
    factor = np.array([1, np.exp(-0.6), 1, 1, 1, 1])
    np.testing.assert_allclose(changed.motor_coulomb, factor * hh150_compiled.motor_coulomb)
    np.testing.assert_allclose(changed.link_coulomb, factor * hh150_compiled.link_coulomb)
    at = hh150_compiled.at.q_dof
    np.testing.assert_allclose(changed.model.dof_damping[at], factor * hh150_compiled.model.dof_damping[at])
    rolls = edit_of("rolling_friction", hh150_compiled, {"rolling": 300.0}, 1)
    np.testing.assert_allclose(compile_robot(hh150, [rolls, edit]).motor_rolling, [0, 300.0 * factor[1], 0, 0, 0, 0])


def test_friction_falls_over_the_time_that_a_drive_moves(hh150: Robot, hh150_compiled: CompiledRobot) -> None:
    effect, n = CATALOGUE["friction_warming"], hh150_compiled.n_joints
    moving = recorded_on(hh150_compiled)  # from 70 to 3130 s
    place = effect.places_in(hh150_compiled, moving)[1]
    assert place.about_s == 1600.0

    def robot_at(time_s: float) -> CompiledRobot:
        conditions = replace(Conditions.reference(n), time_s=time_s)
        edit = effect.edit(place, {"rate": 0.3}, conditions)
        return compile_robot(hh150, [edit] if edit else [])

    for time_s, hours in ((1620.0, 20 / 3600), (3600.0, 2000 / 3600), (0.0, -1600 / 3600)):
        factor = np.ones(n)
        factor[1] = np.exp(-0.3 * hours)
        changed = robot_at(time_s)
        np.testing.assert_allclose(changed.motor_coulomb, factor * hh150_compiled.motor_coulomb)
        at = hh150_compiled.at.q_dof
        np.testing.assert_allclose(changed.model.dof_damping[at], factor * hh150_compiled.model.dof_damping[at])


def test_a_fall_is_looked_for_where_three_times_tell_it_and_no_thermometer(hh150_compiled: CompiledRobot) -> None:
    effect, every = CATALOGUE["friction_warming"], recorded_on(hh150_compiled)
    hung, up, _, late = every.runs
    assert len(effect.places_in(hh150_compiled, every)) == hh150_compiled.n_joints
    short = replace(late, end_s=late.start_s + 10)
    assert not effect.places_in(hh150_compiled, Recorded((hung, up, short)))
    warm = replace(up, columns=up.columns | {"gear_temperature_1_k"})
    assert not effect.places_in(hh150_compiled, Recorded((hung, warm, late)))


def test_friction_where_the_model_has_none(small: Robot) -> None:
    without = compile_robot(small, [friction_on("none")])
    assert not CATALOGUE["coulomb_level"].places(without)
    edits = [
        friction_on("none"),
        edit_of("coulomb_friction", without, {"level": 25.0}, 1),
        edit_of("viscous_friction", without, {"coefficient": 40.0}, 1),
    ]
    with_it = sweep(small, edits, START, SPEED)
    nominal = sweep(small, [friction_on("none")], START, SPEED)
    np.testing.assert_allclose(with_it.motor_friction[-1], [0, 25.0], rtol=SLIDING)
    np.testing.assert_allclose((with_it.motor_torque - nominal.motor_torque)[-1], [0, -25 - 4], atol=0.05)


def test_ranges_scale_with_the_drive(hh150_compiled: CompiledRobot) -> None:
    effect = CATALOGUE["coulomb_friction"]
    places = CATALOGUE["coulomb_level"].places(hh150_compiled)
    high = [effect.parameters_at(hh150_compiled, place)[0].high for place in places]
    limits = [11600, 16900, 9100, 2100, 2500, 900]
    np.testing.assert_allclose(high, 0.1 * np.array(limits))
