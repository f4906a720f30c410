"""Extensions fitted by simulation."""

import numpy as np
import pytest

from bench.diagnose.diagnose import diagnose
from bench.diagnose.extend.refit import Unknown
from bench.diagnose.picture.candidates import Cause
from bench.effects.catalogue import catalogue
from bench.effects.effect import WHOLE, Acting, Effect
from bench.hide.campaign import hide_campaign
from bench.robot.folder import load_robot
from tests.diagnose.sweeps import SWEEPS, nominal

PERIOD = 0.173  # [rad]; nine of them in a sweep, and in the middle between two that are tried at first
BLURRED = 0.15  # a bin is up to a third of a period long and averages a part of the amplitude away


def test_a_short_period_is_found_between_those_that_are_tried() -> None:
    """A step of a twentieth of the range, 0.3 rad, once stood for the derivative of a period of 0.15 rad."""
    effect = catalogue()["friction_ripple"]
    acting = Acting(effect, effect.places(nominal())[1], {"sin": 0.2, "cos": -0.1, "period": PERIOD})
    campaign = hide_campaign(load_robot("hh150"), SWEEPS, [acting], np.random.default_rng(8)).campaign
    best = diagnose(campaign, nominal(), {effect.name: effect}, asks=False).naming.hypotheses[0].fit
    assert [cause.key for cause in best.causes] == [("friction_ripple", "joint 2")]
    np.testing.assert_allclose(best.values[:2], [0.2, -0.1], rtol=BLURRED)
    assert best.values[2] == pytest.approx(PERIOD, rel=0.01)


@pytest.mark.parametrize("effect", catalogue().values(), ids=lambda effect: effect.name)
def test_fits_stay_where_a_parameter_means_something(effect: Effect) -> None:
    for parameter in effect.parameters:
        unknown = Unknown(Cause(effect, WHOLE, (), ()), parameter)
        low, high = unknown.bounds
        assert parameter.least <= low < high <= parameter.most
        for value in (low, parameter.null, high):
            assert low <= value + unknown.step_from(value) <= high
