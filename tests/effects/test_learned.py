"""Learned shapes as effects: what the simulated robot does with them, against the shape itself."""

from collections.abc import Sequence

import numpy as np
import pytest

from bench.actuators.laws import Friction
from bench.diagnose.replay.nuisances import nuisances_of
from bench.effects.conditions import Conditions
from bench.effects.effect import Place
from bench.effects.friction_elements import Side
from bench.effects.learned import Learned, values_at, values_of
from bench.effects.learned_readings import LearnedDrift, LearnedLoss, LearnedMount, LearnedRoom, LearnedScale
from bench.effects.learned_torques import (
    LearnedCompliance,
    LearnedDrag,
    LearnedFriction,
    LearnedGearError,
    LearnedTorque,
    LearnedTorsion,
)
from bench.effects.nominal import nominal_parameters
from bench.robot.compiled import CompiledRobot, SpecEdit, compile_robot, read_spec
from bench.robot.folder import Robot
from bench.robot.plugins import attributes_of
from tests.effects.rest import perfect_reading, rest, some_trace, sweep

SECOND = Place("joint", 1, "joint_2")
NODES = np.array([-0.4, 0.0, 0.4])
LOAD = np.array([0.0, 0.0, -300.0, 0.0, 0.0, 0.0])  # [N], hangs at the load point
SAG = 0.3  # [Nm]; links sag a little more, and gravity with them
TAIL = slice(1500, None)  # steps after which all elements slide
SIDES: tuple[Side, Side] = ("link", "motor")


def edit_of(effect: Learned, sizes: Sequence[float]) -> SpecEdit:
    values = {parameter.name: size for parameter, size in zip(effect.parameters, sizes, strict=True)}
    edit = effect.edit(SECOND, values, Conditions.reference(2))
    assert edit
    return edit


def nodes(unit: str = "Nm", at: np.ndarray = NODES) -> tuple:
    return values_at(at, "rad", unit, 10.0), at


def paid(robot: Robot, edits: list, speed: float, start: float = -0.2, periods: int = 500) -> np.ndarray:
    """Return what the second motor pays in sliding, and where, shape (2, T)."""
    trace = sweep(robot, edits, np.array([0.1, start]), np.array([0.0, speed]), periods)
    return np.stack([trace.motor_torque[TAIL, 1], trace.theta[TAIL, 1]])


def test_null_changes_nothing() -> None:
    for kind in (LearnedTorque, LearnedFriction, LearnedDrag, LearnedGearError, LearnedTorsion, LearnedCompliance):
        effect = kind(*nodes())
        assert effect.edit(SECOND, effect.complete({}), Conditions.reference(2)) is None


@pytest.mark.parametrize("side", SIDES)
def test_torque_is_linear_between_nodes_and_constant_beyond(small: Robot, side: Side) -> None:
    edit = edit_of(LearnedTorque(*nodes(), side), (30.0, -10.0, 20.0))
    for angle, torque in ((-0.2, 10.0), (0.1, -2.5), (0.4, 20.0), (0.9, 20.0), (-0.9, 30.0)):
        q = np.array([0.1, angle])
        extra = rest(small, [edit], q).torque - rest(small, [], q).torque
        np.testing.assert_allclose(extra, [0.0, -torque], atol=SAG)


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("sign", [1, -1])
def test_friction_grows_here_and_falls_there(
    small: Robot, small_compiled: CompiledRobot, side: Side, sign: int
) -> None:
    level = getattr(small_compiled, f"{side}_coulomb")[1]
    sizes = np.array([0.5, -0.3, -0.3]) * level  # half the friction at -0.4 rad, more from 0 on
    edit = edit_of(LearnedFriction(*nodes(), side), sizes)
    (with_it, angle), (without, _) = (paid(small, e, 0.2 * sign, -0.2 * sign) for e in ([edit], []))
    np.testing.assert_allclose(with_it - without, -sign * np.interp(angle, NODES, sizes), atol=SAG)


def test_friction_never_drives(small: Robot, small_compiled: CompiledRobot) -> None:
    level = small_compiled.motor_coulomb[1]
    edit = edit_of(LearnedFriction(*nodes(), "motor"), (3 * level,) * 3)
    (with_it, _), (without, _) = (paid(small, e, 0.2) for e in ([edit], []))
    np.testing.assert_allclose(with_it - without, -level, atol=SAG)


@pytest.mark.parametrize("sign", [1, -1])
def test_drag_goes_through_its_nodes_and_in_between_as_the_shape_in_which_it_was_found(small: Robot, sign: int) -> None:
    speeds = np.array([0.05, 0.1, 0.2, 0.4])
    sizes = (4.0, 1.0, -3.0, -20.0)
    edit = edit_of(LearnedDrag(*nodes(at=speeds), "motor"), sizes)
    (between,) = LearnedDrag.through(speeds, np.array([0.3])) @ sizes
    for speed, size in zip([*speeds[1:], 0.3], [*sizes[1:], between], strict=True):
        (with_it, _), (without, _) = (paid(small, e, sign * float(speed)) for e in ([edit], []))
        np.testing.assert_allclose(with_it[-1] - without[-1], -sign * size, rtol=0.02)


def test_drag_adds_to_drag_and_does_not_fall_where_nobody_measured(small: Robot, small_compiled: CompiledRobot) -> None:
    drag = LearnedDrag(*nodes(at=np.array([0.1, 0.2, 0.3])), "motor")
    friction = small.figures.drives[1].motor_friction
    spec = read_spec(small)
    for sizes in ((-1.0, -2.0, -4.0), (0.0, -1.0, -1.0)):
        edit_of(drag, sizes)(spec, small)
    law = Friction(**{key: float(text) for key, text in attributes_of(spec, friction).items() if key != "element"})
    level = small_compiled.motor_coulomb[1]
    _, plus = law.levels(np.zeros(3), np.array([0.1, 0.2, 0.3]))
    np.testing.assert_allclose(plus, level + np.array([1.0, 3.0, 5.0]), rtol=1e-9)
    _, beyond = law.levels(np.zeros(3), np.array([0.3, 0.5, 2.0]))
    assert np.all(np.diff(beyond) >= 0)
    _, fallen = Friction(coulomb=level, presliding_stiffness=1e4, drag=-1.0, drag_speed=0.3).levels(
        np.zeros(2), [0.3, 9]
    )
    np.testing.assert_allclose(fallen, level - 0.3)


def test_learned_drag_is_a_figure_that_follows_its_oil(small: Robot) -> None:
    """Of a stranger's arm on a colder day it was called more viscous friction, and friction over the angle."""
    drag = edit_of(LearnedDrag(*nodes(at=np.array([0.1, 0.2, 0.3])), "motor"), (-1.0, -2.0, -4.0))
    joint = small.figures.drives[1].joint
    plain = {one.name for one in nominal_parameters(compile_robot(small))}
    figures = {one.name: one for one in nominal_parameters(compile_robot(small, [drag]))}
    (name,) = figures.keys() - plain
    assert name == f"learned friction over speed of {joint}"
    assert figures[name].is_viscous
    (own,) = {one.own for one in nuisances_of(compile_robot(small, [drag]), ()) if one.name == name}
    assert own == pytest.approx(0.15)  # 1.5 %/K over 10 K, as of viscous friction
    (warm, _), (cold, _), (without, _) = (
        paid(small, edits, 0.2) for edits in ([drag, figures[name].edit(-0.3)], [drag], [])
    )
    assert (cold - without)[-1] == pytest.approx(2.0, rel=0.01)
    assert (warm - without)[-1] == pytest.approx(1 + 0.7, rel=0.01), "1 Nm of it does not grow with speed: Coulomb"


def test_speeds_of_a_polynomial_lie_apart() -> None:
    np.testing.assert_array_equal(LearnedDrag.speeds(np.array([0.1, 0.101, 0.2, 0.399, 0.4])), [0.101, 0.2, 0.4])
    np.testing.assert_array_equal(LearnedDrag.speeds(np.array([0.3])), [0.3])
    assert len(LearnedDrag.speeds(np.linspace(0.1, 1.0, 7))) == 4


def test_gear_error_turns_the_link_alone(small: Robot, small_compiled: CompiledRobot) -> None:
    edit = edit_of(LearnedGearError(*nodes("rad")), (1e-4, -2e-4, 0.0))
    for angle in (-0.4, -0.2, 0.0, 0.2):
        q = np.array([0.1, angle])
        with_it, without = rest(small, [edit], q), rest(small, [], q)
        turned = np.interp(angle, NODES, (1e-4, -2e-4, 0.0))
        np.testing.assert_allclose(with_it.theta - without.theta, [0.0, turned], atol=2e-6)
        np.testing.assert_allclose(with_it.torque, without.torque, atol=SAG)


def test_torsion_turns_the_link_by_the_load(small: Robot, small_compiled: CompiledRobot) -> None:
    q = np.array([0.1, 0.3])
    load = float(rest(small, [], q).torque[1])
    at = load + np.array([-400.0, 0.0, 400.0])
    for sizes in ((1e-4, 1e-4, 1e-4), (0.0, -5e-5, 0.0), (-2e-4, 0.0, 3e-4)):
        edit = edit_of(LearnedTorsion(*nodes("rad", at)), sizes)
        turned = rest(small, [edit], q).theta - rest(small, [], q).theta
        np.testing.assert_allclose(turned, [0.0, sizes[1]], atol=2e-6)


def test_a_gear_gives_more_or_less_over_the_angle(small: Robot, small_compiled: CompiledRobot) -> None:
    sizes = (0.5, -0.3, -0.3)
    edit = edit_of(LearnedCompliance(*nodes("")), sizes)
    assert small_compiled.has_plain_elements
    assert not compile_robot(small, [edit]).has_plain_elements
    for angle in (-0.4, -0.2, 0.0, 0.3):
        q = np.array([0.1, angle])
        with_it, without = rest(small, [edit], q, LOAD), rest(small, [], q, LOAD)
        torsion = (without.theta - q)[1]
        more = float(np.interp(with_it.theta[1], NODES, sizes)) * torsion
        # where stiffness changes with the angle, a spring pulls towards where it is soft: k' u^2/2 beside k u
        np.testing.assert_allclose(with_it.theta - without.theta, [0.0, more], atol=0.004 * torsion)
        np.testing.assert_allclose(with_it.torque, without.torque, atol=1.0)


def test_readings(small: Robot, small_compiled: CompiledRobot, rng: np.random.Generator) -> None:
    plant, trace = some_trace(small, rng)
    reading = perfect_reading(plant.compiled, trace)
    conditions = Conditions.reference(2)

    def error(effect: Learned, sizes: Sequence[float], channel: str, place: Place = SECOND) -> np.ndarray:
        values = {parameter.name: size for parameter, size in zip(effect.parameters, sizes, strict=True)}
        seen = effect.distort(place, values, reading, trace, conditions)
        found: np.ndarray = getattr(seen, channel) - getattr(reading, channel)
        return found

    # what leaves no trace has no parameter, and the others keep their meaning
    scale = LearnedScale(values_of(("cube", "signed_square", "at_6"), ("", "", ""), "A", 1.0), "current", 2.0)
    share = reading.current[:, 1] / 2.0
    table = np.interp(share, [0.0, 0.02, 0.05], [0.0, 0.2, 0.0])
    expected = np.stack([0 * share, 0.3 * share**3 + 0.1 * share * np.abs(share) + table], axis=1)
    np.testing.assert_allclose(error(scale, (0.3, 0.1, 0.2), "current"), expected, atol=1e-12)

    stiffness, constant = float(small_compiled.stiffness[1]), float(small_compiled.torque_constant[1])
    load = stiffness * (trace.q[:, 1] - trace.theta[:, 1])
    loss = LearnedLoss(*nodes(at=np.array([-1e4, 1e4])), stiffness, constant)
    expected = -np.interp(load, [-1e4, 1e4], [5.0, -7.0]) * np.sign(trace.q_velocity[:, 1])
    assert np.any(expected)
    np.testing.assert_allclose(error(loss, (5.0, -7.0), "current")[:, 1], expected / constant, atol=1e-9)

    mount = LearnedMount(values_of(("y_share", "z_cube"), ("", ""), "m", 1e-4), 0, 100.0)
    force = np.linalg.norm(trace.wrench[:, :3], axis=1) / 100.0
    assert np.any(force)
    moved = error(mount, (1e-4, 2e-4), "reflectors")
    np.testing.assert_allclose(moved[:, 0], np.stack([0 * force, 1e-4 * force, 2e-4 * force**3], axis=1), atol=1e-12)
    np.testing.assert_array_equal(moved[:, 1:], 0.0)

    drift = LearnedDrift(values_of(("y_rate", "z_bend"), ("", ""), "m", 1e-4), 1800.0)
    hours = (trace.time - 1800.0) / 3600.0
    moved = error(drift, (1e-4, 2e-4), "reflectors")
    np.testing.assert_allclose(moved[:, 0], np.stack([0 * hours, 1e-4 * hours, 2e-4 * hours**2], axis=1), atol=1e-12)

    room = LearnedRoom(values_of(("x_from_z_squared", "y_from_y"), ("", ""), "m", 1e-4), np.array([0.1, 0.2, 0.3]), 2.0)
    place = (trace.reflectors.mean(axis=1) - [0.1, 0.2, 0.3]) / 2.0
    moved = error(room, (1e-4, -2e-4), "reflectors")
    np.testing.assert_allclose(
        moved[:, -1], np.stack([1e-4 * place[:, 2] ** 2, -2e-4 * place[:, 1], 0 * hours], 1), atol=1e-12
    )
