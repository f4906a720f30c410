"""Worlds of a study: what acts beside what is hidden."""

import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.effects.conditions import Conditions
from bench.effects.effect import WHOLE, Acting
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from bench.study.labs import Lab, machine_components
from bench.study.worlds import (
    FEWEST,
    LARGEST,
    LONGEST,
    MOST,
    SHORTEST,
    SMALLEST,
    WORLDS,
    PreslidingTravel,
    surroundings_of,
    travel_of,
    unlisted_in,
)


@pytest.fixture(scope="module")
def hh150() -> CompiledRobot:
    return compile_robot(load_robot("hh150"))


def test_a_messy_arm_has_many_small_things_beside_what_is_hidden(hh150: CompiledRobot) -> None:
    effects = catalogue()
    known = tuple(machine_components(effects, Lab(), hh150))
    hidden = Acting(effects["gas_loss"], WHOLE, {"lost": 0.2})
    counts = []
    for seed in range(30):
        others = surroundings_of("messy", (hidden,), known, hh150, np.random.default_rng(seed))
        counts.append(len(others))
        names = [(one.effect.name, str(one.place)) for one, _ in others]
        assert len(set(names)) == len(names)
        assert ("gas_loss", "robot") not in names
        for one, size in others:
            assert SMALLEST <= size <= LARGEST
            sizes = [p for p in one.effect.parameters_at(hh150, one.place) if not p.is_shape]
            shares = [abs(one.values[p.name] - p.null) / p.high for p in sizes]
            assert max(shares) == pytest.approx(size)
    assert min(counts) >= FEWEST
    assert max(counts) <= MOST
    assert np.ptp(counts) > (MOST - FEWEST) / 2


def test_a_messy_arm_may_have_any_component(hh150: CompiledRobot) -> None:
    known = tuple(machine_components(catalogue(), Lab(), hh150))
    everything = {(effect.name, str(place)) for effect, place in known}
    drawn = {
        (one.effect.name, str(one.place))
        for seed in range(60)
        for one, _ in surroundings_of("messy", (), known, hh150, np.random.default_rng(seed))
    }
    assert drawn == everything


def test_other_worlds_have_nothing_beside(hh150: CompiledRobot) -> None:
    known = tuple(machine_components(catalogue(), Lab(), hh150))
    for world in WORLDS:
        others = surroundings_of(world, (), known, hh150, np.random.default_rng(1))
        assert bool(others) == (world == "messy")
        assert bool(travel_of(world, np.random.default_rng(1))) == (world == "presliding")


def test_presliding_travel_of_every_element_is_another_one(hh150: CompiledRobot) -> None:
    edit = PreslidingTravel().edit(WHOLE, {"seed": 7.0}, Conditions.reference(hh150.n_joints))
    assert edit
    first, again = (compile_robot(hh150.robot, (edit,)) for _ in range(2))
    factors = np.concatenate(
        [hh150.motor_presliding / first.motor_presliding, hh150.link_presliding / first.link_presliding]
    )
    assert np.all((factors >= SHORTEST) & (factors <= LONGEST))
    assert len(set(np.round(factors, 6))) == 2 * hh150.n_joints
    assert np.array_equal(first.motor_presliding, again.motor_presliding)
    assert np.array_equal(first.motor_coulomb, hh150.motor_coulomb)


def test_what_is_unlisted_is_in_no_catalogue() -> None:
    for world in WORLDS:
        assert unlisted_in(world)
        assert not set(unlisted_in(world)) & set(catalogue())


def test_friction_of_load_and_angle_is_hidden_where_gravity_loads_a_gear(hh150: CompiledRobot) -> None:
    """At joint 1, whose axis is upright, it is 6 % of what rubs there anyway, and friction is known to 10 %."""
    places = unlisted_in("second")["angle_load_friction"].places(hh150)
    assert [str(place) for place in places] == [f"joint {i}" for i in range(2, 7)]
