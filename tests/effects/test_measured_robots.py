"""Entries for robots whose recordings do not say what they carry, and whose joints have encoders behind the gear."""

import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.effects.effect import WHOLE, Conditions
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from bench.robot.links import rigid_bodies
from bench.simulate.instruments import Instruments
from bench.simulate.plant import Plant

EFFECTS = catalogue()


@pytest.fixture(scope="module")
def kr300() -> CompiledRobot:
    return compile_robot(load_robot("kr300"))


def test_unstated_payload_adds_its_mass_and_inertia(kr300: CompiledRobot) -> None:
    effect = EFFECTS["unstated_payload"]
    assert effect.places(kr300) == (WHOLE,)
    mass, inertia = effect.parameters_at(kr300, WHOLE)
    assert mass.high == 300
    edit = effect.edit(WHOLE, {"mass": 150.0, "inertia": 5.0}, Conditions.reference(6))
    assert edit
    loaded = compile_robot(load_robot("kr300"), [edit])
    np.testing.assert_allclose(rigid_bodies(loaded).mass.sum() - rigid_bodies(kr300).mass.sum(), 150)
    np.testing.assert_allclose(loaded.model.body_inertia[kr300.at.load_body], 5.0)
    assert inertia.high > 5


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
