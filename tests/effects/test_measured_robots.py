"""Entries for robots whose recordings do not say what they carry, and whose joints have encoders behind the gear."""

import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.effects.conditions import Conditions
from bench.effects.effect import WHOLE, Place
from bench.effects.payloads import FARTHEST_M
from bench.errors import RobotError
from bench.robot.compiled import CompiledRobot, SpecEdit, compile_robot
from bench.robot.folder import load_robot
from bench.robot.links import rigid_bodies
from bench.simulate.instruments import Instruments
from bench.simulate.plant import Plant

EFFECTS = catalogue()


@pytest.fixture(scope="module")
def kr300() -> CompiledRobot:
    return compile_robot(load_robot("kr300"))


SPREAD = {"second_moment_x": 4.0, "second_moment_y": 1.0, "second_moment_z": 2.5}  # [kg m^2]


def with_payload(**values: float) -> SpecEdit:
    effect = EFFECTS["unstated_payload"]
    edit = effect.edit(WHOLE, effect.complete(values), Conditions.reference(6))
    assert edit
    return edit


def steiner(mass: float, offset: np.ndarray) -> np.ndarray:
    return mass * (offset @ offset * np.eye(3) - np.outer(offset, offset))


def test_unstated_payload_adds_its_mass_and_inertia(kr300: CompiledRobot) -> None:
    effect = EFFECTS["unstated_payload"]
    assert effect.places(kr300) == (WHOLE,)
    mass, *seconds = effect.parameters_at(kr300, WHOLE)[:4]
    moments = effect.parameters_at(kr300, WHOLE)[4:]
    assert mass.high == 300
    assert all(second.high > 5 for second in seconds)
    assert all(moment.high == pytest.approx(600 / 2943 * 300) for moment in moments)  # rated moment and force
    edit = with_payload(**SPREAD, mass=150.0, moment_x=3.0, moment_z=-15.0)
    links, loaded = rigid_bodies(kr300), rigid_bodies(compile_robot(load_robot("kr300"), [edit]))
    point = links.points[kr300.robot.figures.load_point]
    place = point.position + point.rotation @ np.array([0.02, 0.0, -0.1])
    together = links.mass[-1] + 150
    com = (links.mass[-1] * links.com[-1] + 150 * place) / together
    inertia = point.rotation @ np.diag([1.0 + 2.5, 4.0 + 2.5, 4.0 + 1.0]) @ point.rotation.T
    inertia_of_both = links.inertia[-1] + inertia + steiner(links.mass[-1], links.com[-1] - com)
    np.testing.assert_allclose(loaded.mass[-1], together)
    np.testing.assert_allclose(loaded.com[-1], com)
    np.testing.assert_allclose(loaded.inertia[-1], inertia_of_both + steiner(150, place - com), atol=1e-9)


@pytest.mark.parametrize("seed", range(5))
def test_a_payload_as_thin_as_a_plate_compiles(seed: int) -> None:
    """Its largest moment of inertia is the sum of the others, to the last bit or beyond it."""
    drawn = np.random.default_rng(seed).uniform(0.1, 9.0, (20, 3))
    for x, z, mass in drawn.tolist():
        compile_robot(load_robot("kr300"), [with_payload(mass=10 * mass, second_moment_x=x, second_moment_z=z)])


def test_a_first_moment_without_a_mass_is_of_no_body(kr300: CompiledRobot) -> None:
    light = compile_robot(load_robot("kr300"), [with_payload(mass=1.0, moment_x=30.0)])
    payload = light.model.body("effect/unstated payload")
    assert np.linalg.norm(payload.pos - kr300.model.body_ipos[kr300.at.load_body]) == pytest.approx(FARTHEST_M)
    assert (
        EFFECTS["unstated_payload"].edit(
            WHOLE, EFFECTS["unstated_payload"].complete({"moment_x": 30.0}), Conditions.reference(6)
        )
        is None
    )


def test_robots_that_state_their_payload_have_no_unstated_one() -> None:
    effect, emps, hh150 = EFFECTS["unstated_payload"], *(compile_robot(load_robot(n)) for n in ("emps", "hh150"))
    assert effect.places(emps) == ()  # its figures say so
    assert effect.parameters_at(hh150, WHOLE)[0].high == pytest.approx(hh150.robot.figures.rating.force_n / 9.80665)


def test_late_link_encoders_follow_speed(kr300: CompiledRobot) -> None:
    effect, plant = EFFECTS["link_encoder_delay"], Plant(load_robot("kr300"))
    time = 4e-3 * np.arange(50)
    trace = plant.advance(np.outer(0.1 * time**2, np.ones(6)), np.zeros((50, 6)), 4e-3)
    reading = Instruments(kr300, None).read(trace)
    late = effect.distort(WHOLE, {"delay": 2e-3}, reading, trace, Conditions.reference(6))
    joints = slice(0, 3)  # axes with an encoder behind the gear
    gap = (reading.q_link - late.q_link)[:, joints]
    np.testing.assert_allclose(gap, 2e-3 * trace.theta_velocity[:, joints], atol=1e-15)
    assert effect.places(compile_robot(load_robot("emps"))) == ()


def test_a_payload_is_added_to_what_the_model_carries_already(kr300: CompiledRobot) -> None:
    """Two bodies would have another moment of inertia than one with both masses and first moments."""
    light = with_payload(mass=20.0, moment_x=4.0, second_moment_y=0.5)
    heavier = compile_robot(load_robot("kr300"), [light, with_payload(mass=30.0, moment_x=-6.0, second_moment_y=0.2)])
    once = compile_robot(load_robot("kr300"), [with_payload(mass=50.0, moment_x=-2.0, second_moment_y=0.7)])
    np.testing.assert_allclose(rigid_bodies(heavier).inertia, rigid_bodies(once).inertia)
    np.testing.assert_allclose(rigid_bodies(heavier).com, rigid_bodies(once).com)
    back = compile_robot(load_robot("kr300"), [light, with_payload(mass=-20.0, moment_x=-4.0, second_moment_y=-0.5)])
    np.testing.assert_allclose(rigid_bodies(back).mass, rigid_bodies(kr300).mass)
    np.testing.assert_allclose(rigid_bodies(back).inertia, rigid_bodies(kr300).inertia)


def test_nothing_is_taken_away_of_a_payload_that_is_not_there() -> None:
    with pytest.raises(RobotError, match="carries nothing that nobody stated"):
        compile_robot(load_robot("kr300"), [with_payload(mass=-1.0)])


def test_words_of_a_slide_are_those_of_a_slide() -> None:
    """Rolling friction of a quill was "26.9 N, at 1 rad/s"."""
    compiled = compile_robot(load_robot("emps"))
    (rolling,) = EFFECTS["rolling_friction"].parameters_at(compiled, Place("joint", 0, "joint1"))
    assert (rolling.unit, rolling.words.split(";")[0]) == ("N", "r, at 1 m/s")
