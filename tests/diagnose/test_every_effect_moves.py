"""Every effect of the catalogue can be replayed along a motion."""

import numpy as np
import pytest

from bench.diagnose.replay.nuisances import nuisances_of
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.diagnose.replay.world import NOMINAL, World
from bench.effects.catalogue import catalogue
from bench.effects.effect import Acting
from tests.diagnose.sweeps import SWEEP, made, nominal

SIZE = 0.3  # of the largest plausible size


@pytest.fixture(scope="module")
def replay() -> Replay:
    campaign, compiled = made(SWEEP, seed=2), nominal()
    quantities = quantities_of(campaign.runs, compiled)
    return Replay(compiled, segments_of(campaign, compiled, quantities), quantities)


@pytest.mark.parametrize("name", catalogue())
def test_an_effect_is_replayed_in_motion(replay: Replay, name: str) -> None:
    """A base that rocks has a hinge that nothing drives; with other masses than stated it could not be simulated."""
    effect, seen = catalogue()[name], replay.predict(NOMINAL)
    heavier = next(one for one in nuisances_of(replay.compiled, replay.quantities) if one.name.startswith("mass of"))
    share = 0.1 * (1 + list(catalogue()).index(name))  # links that no other world had
    for place in effect.places(replay.compiled)[:2]:
        sizes = effect.parameters_at(replay.compiled, place)
        values = {one.name: one.null + SIZE * one.high for one in sizes if not one.is_shape}
        world = World({heavier: share}, (Acting(effect, place, effect.complete(values)),))
        assert np.array_equal(np.isfinite(replay.predict(world)), np.isfinite(seen))
