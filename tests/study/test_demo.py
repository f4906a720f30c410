"""The demo hides something that its session can show."""

import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.study.demo import visible_trial
from bench.study.labs import Lab, Setup, prepare
from bench.study.make import LIMITS, sized
from bench.study.study import NULL_STREAM

HID_TORSION = 37484  # of the base, of which this session shows nothing at any plausible size; its verdict was "Wrong"


@pytest.fixture(scope="module")
def setup() -> Setup:
    return prepare(Lab(), catalogue(), np.random.default_rng([HID_TORSION, NULL_STREAM]))


@pytest.mark.parametrize("seed", [pytest.param(HID_TORSION, marks=pytest.mark.study), 1, 2, 3])
def test_what_the_demo_hides_is_clearly_visible(seed: int, setup: Setup) -> None:
    trial = visible_trial(seed, setup)
    drawn = sized(setup.catalogue[trial.effects[0]], trial, setup, trial.rng(seed))
    assert LIMITS * drawn.limit <= drawn.size <= 1
    assert trial == visible_trial(seed, setup)
