"""What a world predicts depends on nothing that was simulated before it."""

import numpy as np

from bench.diagnose.diagnose import signatures_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.diagnose.replay.world import World
from bench.effects.catalogue import catalogue
from bench.effects.effect import Acting
from bench.errors import NOT_SIMULATED
from bench.record.campaign import Array
from tests.diagnose.sweeps import SWEEP, made, nominal

WORLDS = 40
MOST = 3  # effects in a world
BINS = 20


def test_any_order_of_worlds_predicts_the_same(rng: np.random.Generator) -> None:
    """Each world, after all kinds of others, against the first that a fresh replay simulates."""
    compiled, campaign = nominal(), made(SWEEP, seed=3)
    signatures = signatures_of(campaign, compiled, catalogue())
    segments = segments_of(campaign, compiled, signatures.quantities, BINS)

    def predicted(replay: Replay, world: World) -> Array | str:
        try:
            return replay.predict(world)
        except NOT_SIMULATED as error:
            return str(error)

    plan = signatures.plan
    deviations = [{n: n.sigma * rng.normal() for n in signatures.nuisances} for _ in range(2)]
    replay = Replay(compiled, segments, signatures.quantities)
    acting: list[Acting] = []
    for _ in range(WORLDS):  # one effect comes or goes at a time
        if acting and (len(acting) == MOST or rng.random() < 0.4):
            acting.pop(rng.integers(len(acting)))
        else:
            one = plan[rng.integers(len(plan))]
            acting = [other for other in acting if (other.effect, other.place) != (one.effect, one.place)] + [one]
        world = World(deviations[rng.integers(2)], tuple(acting))
        fresh = predicted(Replay(compiled, segments, signatures.quantities), world)
        np.testing.assert_array_equal(predicted(replay, world), fresh, err_msg=str([str(one) for one in acting]))
