"""Detection limits of effects, as a study hides them."""

import pytest

from bench.diagnose.linearise.nominal_model import linearised_model_of
from bench.diagnose.replay.nuisances import nuisances_of
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.effects.catalogue import catalogue
from bench.effects.effect import WHOLE
from bench.study.limits import Blur, Way, detection_limit
from tests.diagnose.sweeps import SWEEP, made, nominal


@pytest.mark.parametrize("name", ["drive_delay", "gas_loss"])
def test_what_acts_on_the_machine_has_a_limit(name: str) -> None:
    """Also what is read late, whose motion is that of samples and not of bins."""
    campaign, compiled = made(SWEEP, seed=3), nominal()
    quantities = quantities_of(campaign.runs, compiled)
    replay = Replay(compiled, segments_of(campaign, compiled, quantities), quantities)
    linear = linearised_model_of(replay, nuisances_of(compiled, quantities))
    effect = catalogue()[name]
    (parameter,) = effect.parameters_at(compiled, WHOLE)
    limit = detection_limit(Way(effect, WHOLE, {parameter.name: 1.0}, {}), linear, Blur(replay), threshold=5.0)
    assert 1e-3 < limit < 1.0
    stricter = detection_limit(Way(effect, WHOLE, {parameter.name: 1.0}, {}), linear, Blur(replay), threshold=20.0)
    assert stricter > limit
