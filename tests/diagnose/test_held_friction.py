"""How much friction joints hold, and how that scatters: as the model has it that was found, not the nominal robot."""

import numpy as np
import pytest

from bench.diagnose.linearise.held_friction import levels_of
from bench.diagnose.linearise.linearised_model import LinearisedModel, with_friction_of
from bench.diagnose.replay.world import NOMINAL, World
from bench.effects.catalogue import catalogue
from bench.effects.effect import Acting
from tests.diagnose.small_models import linear_of
from tests.diagnose.sweeps import LOADS, made, nominal

JOINT = 1


@pytest.fixture(scope="module")
def linear() -> LinearisedModel:
    return linear_of(made(LOADS, seed=5))


def world(name: str, **values: float) -> World:
    effect = catalogue()[name]
    place = next(place for place in effect.places(nominal()) if place.index == JOINT)
    return World(acting=(Acting(effect, place, effect.complete(values)),))


def held(linear: LinearisedModel, side: str) -> np.ndarray:
    """Return how much the readings change with the friction that the joint holds at rest on a side, shape (T, c)."""
    joint = linear.replay.compiled.robot.figures.drives[JOINT].joint
    (i,) = (i for i, one in enumerate(linear.nuisances) if one.name == f"{side}-side friction held at rest by {joint}")
    return linear.sensitivities[:, :, i]


def test_friction_that_moved_to_the_link_is_held_there(linear: LinearisedModel) -> None:
    compiled = linear.replay.compiled
    about = with_friction_of(linear, world("friction_side", moved=0.5), compiled.play)
    np.testing.assert_allclose(linear.scatter.levels, levels_of(compiled))
    moved = 0.5 * compiled.motor_coulomb[JOINT]
    others = np.arange(compiled.n_joints) != JOINT
    np.testing.assert_allclose(about.scatter.levels[:, others], linear.scatter.levels[:, others])
    np.testing.assert_allclose(about.scatter.levels[0, JOINT], compiled.link_coulomb[JOINT] + moved, rtol=1e-6)
    assert np.linalg.norm(held(about, "link")) > 1.2 * np.linalg.norm(held(linear, "link"))


def test_more_friction_scatters_more(linear: LinearisedModel) -> None:
    play = linear.replay.compiled.play
    determinants = [
        with_friction_of(linear, world("coulomb_level", change=change), play).log_determinants.sum()
        for change in (-0.5, 0.0, 0.5)
    ]
    assert determinants == sorted(determinants, reverse=True)  # what scatters more counts less
    assert determinants[0] > determinants[1] + 1


def test_friction_that_rises_at_low_speed_holds_more_than_its_level(linear: LinearisedModel) -> None:
    about = with_friction_of(linear, world("stribeck", rise=0.4, speed=0.05), linear.replay.compiled.play)
    rose = about.scatter.levels[:, JOINT] / linear.scatter.levels[:, JOINT]
    assert np.all(rose > 1.3)
    assert np.all(rose < 1.4 + 1e-6)


def test_about_the_nominal_model_nothing_changes(linear: LinearisedModel) -> None:
    about = with_friction_of(linear, NOMINAL, linear.replay.compiled.play)
    assert about.whitenings is linear.whitenings
    np.testing.assert_allclose(about.sensitivities, linear.sensitivities, atol=1e-9)
