"""Effects that act as torques: what they change to first order against what a simulation says they change."""

from collections.abc import Iterator
from functools import cache

import numpy as np
import pytest

from bench.diagnose.diagnose import signatures_of
from bench.diagnose.linearise.first_order import FirstOrder
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.nominal_model import linearised_model_of
from bench.diagnose.linearise.signatures import Signatures
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.diagnose.replay.world import NOMINAL, World
from bench.effects.catalogue import catalogue
from bench.effects.effect import Acting, Effect
from bench.hide.campaign import hide_campaign
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.scenario.files import read_scenario

# Of the length of a signature in standard errors. Evidence goes with the square of the cosine between signatures: a
# twentieth of the length, at right angles, costs 1/400 of it.
USUAL, WORST = 0.05, 0.12
VISIBLE = 1.0  # standard errors; what is shorter cannot be seen in any case
EXACT = 1e-9  # of the largest change: rounding of torques whose difference it is
MOST = 8  # places and shapes of each effect
TORQUES = [name for name, effect in catalogue().items() if type(effect).torques is not Effect.torques]
BINS = 300
SMALL = 0.02  # of a level: hardly another instant slides, or holds


@cache
def campaign() -> tuple[Signatures, Replay, LinearisedModel]:
    """Return a lab's day with the HH-150, without anything hidden."""
    robot = load_robot("hh150")
    hidden = hide_campaign(robot, read_scenario("session-study"), (), np.random.default_rng(3))
    compiled = compile_robot(robot)
    signatures = signatures_of(hidden.campaign, compiled, catalogue())
    segments = segments_of(hidden.campaign, compiled, signatures.quantities, BINS)
    replay = Replay(compiled, segments, signatures.quantities)
    return signatures, replay, linearised_model_of(replay, signatures.nuisances)


def acting(name: str, signatures: Signatures) -> list[Acting]:
    every = [one for one in signatures.plan if one.effect.name == name]
    return [every[i] for i in np.unique(np.linspace(0, len(every) - 1, MOST).astype(int))] if every else []


@pytest.mark.parametrize("name", TORQUES)
def test_first_order_is_what_a_simulation_says(name: str) -> None:
    signatures, replay, linear = campaign()
    errors = list(_errors(signatures, FirstOrder(replay, NOMINAL), replay, linear, name, NOMINAL))
    if not errors:
        pytest.skip("a robot with friction has no place for friction that is left out")
    print(f"{name}: median {np.median(errors):.2%}, largest {max(errors):.2%} of {len(errors)}")
    assert np.median(errors) < USUAL
    assert max(errors) < WORST


def test_links_of_standing_joints_slide_where_others_push_them() -> None:
    """What reflectors show of a Coulomb level while another joint moves was left out, 60 to 80 % of what they do.

    Then friction of another law was named for a level that had changed: its signature, simulated, has that part.
    """
    _, replay, _ = campaign()
    effect = catalogue()["coulomb_level"]
    about, nominal = FirstOrder(replay, NOMINAL), replay.predict(NOMINAL)
    moves = np.concatenate([np.full(len(segment), not segment.is_static) for segment in replay.segments])
    shows = np.array([quantity.column.startswith("reflector") for quantity in replay.quantities])
    for place in effect.places(replay.compiled):
        one = Acting(effect, place, {"change": SMALL})
        change = about.change(one)
        assert change is not None
        simulated, found = (
            (values[moves][:, shows]) for values in (replay.predict(World(acting=(one,))) - nominal, change)
        )
        assert np.linalg.norm(found - simulated) < WORST * np.linalg.norm(simulated), place


def test_first_order_holds_about_an_extended_model() -> None:
    signatures, replay, linear = campaign()
    found = catalogue()["coulomb_level"]
    around = World(acting=(Acting(found, found.places(replay.compiled)[1], {"change": 0.3}),))
    errors = list(_errors(signatures, FirstOrder(replay, around), replay, linear, "friction_ripple", around))
    assert errors
    assert max(errors) < WORST


@pytest.mark.parametrize(("name", "values"), [("stribeck", {"rise": 0.4}), ("backlash", {"gap": 3e-4})])
def test_what_is_not_plain_is_simulated(name: str, values: dict[str, float]) -> None:
    """Friction that is shaped already, or a gear with play: neither level nor stiffness says what a torque does."""
    signatures, replay, _ = campaign()
    effect = catalogue()[name]
    place = effect.places(replay.compiled)[1]
    about = FirstOrder(replay, World(acting=(Acting(effect, place, effect.complete(values)),)))
    ripple = next(one for one in signatures.plan if one.effect.name == "friction_ripple" and one.place == place)
    assert about.change(ripple) is None


@pytest.mark.parametrize("name", ["rotor_inertia", "viscous_level"])
def test_what_the_motor_pays_alone_needs_no_plain_element(name: str) -> None:
    """With the motors' motion prescribed, the link behind a gear with play feels nothing of it."""
    signatures, replay, _ = campaign()
    play = catalogue()["backlash"]
    place = play.places(replay.compiled)[1]
    around = World(acting=(Acting(play, place, play.complete({"gap": 3e-4})),))
    one = next(one for one in signatures.plan if one.effect.name == name and one.place.index == place.index)
    simulated = replay.predict(World(acting=(*around.acting, one))) - replay.predict(around)
    found = FirstOrder(replay, around).change(one)
    assert found is not None
    assert np.max(np.abs(simulated)) > 0
    np.testing.assert_allclose(found, simulated, atol=EXACT * np.max(np.abs(simulated)))


def _errors(
    signatures: Signatures, about: FirstOrder, replay: Replay, linear: LinearisedModel, name: str, around: World
) -> Iterator[float]:
    nominal = replay.predict(around)
    for one in acting(name, signatures):
        change = about.change(one)
        assert change is not None
        simulated = replay.predict(World(acting=(*around.acting, one))) - nominal
        white = linear.whiten(np.stack([simulated, change], axis=2))
        size = float(np.linalg.norm(white[:, 0]))
        if size > VISIBLE:
            yield float(np.linalg.norm(white[:, 1] - white[:, 0])) / size
