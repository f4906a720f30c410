"""What is fitted and figures that do the same to friction: the data do not tell which of them it is."""

import numpy as np
import pytest

from bench.diagnose.cross_validation.leave_out import tangent_of
from bench.diagnose.extend.relinearise import relinearised_fit
from bench.effects.catalogue import catalogue
from bench.effects.effect import Acting
from tests.diagnose.noise_free import fitted_alone, linearised, noise_free
from tests.diagnose.sweeps import nominal

JOINT = 1
ROUGHLY = 0.05  # of a standard deviation: links stick and slide within half a standard error, too


@pytest.mark.parametrize("moved", [-0.25, -0.2])
def test_nobody_learns_where_friction_was_before_it_moved(moved: float) -> None:
    """Levels before and what moved are three numbers, and friction shows two: the third has its prior alone.

    Of figures of equal standard deviation s for the levels M and L, of which the sum is known, L has s / sqrt(1 +
    (L / M)^2) left. With derivatives over steps of different lengths, between which links stick and slide, or with
    those of a nominal figure, it had 0.47 and 0.72 where 0.92 is right, and intervals of what moved were too narrow.
    """
    effect = catalogue()["friction_side"]
    place = effect.places(nominal())[JOINT]
    campaign = noise_free("session-short", 4, (Acting(effect, place, {"moved": moved}),))
    linear = linearised(campaign)
    first = fitted_alone(linear, campaign, effect.name, str(place), moved=moved)
    about, fit = relinearised_fit(linear, first)
    covariance = np.linalg.inv(tangent_of(about, fit).precision)
    (i,) = (i for i, one in enumerate(about.nuisances) if one.name == "link-side Coulomb friction of joint2")
    left = 1 / np.hypot(1.0, nominal().link_coulomb[JOINT] / nominal().motor_coulomb[JOINT])
    print(f"moved {moved:g}: {np.sqrt(covariance[i, i]):.3f} of a standard deviation is left, expected {left:.3f}")
    assert np.sqrt(covariance[i, i]) == pytest.approx(left, rel=ROUGHLY)
