"""With other noise, what was whitened instant by instant is what it would be if it were all made again."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from bench.compare.background import background_of
from bench.compare.by_instant import ByInstant
from bench.compare.joint import Joint, joint_of
from bench.compare.recordings import recordings_of
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.other_noise import raised, with_scatter
from bench.effects.catalogue import catalogue
from tests.diagnose.sweeps import LOADS, SWEEP, made, nominal

FEW = {name: catalogue()[name] for name in ("gas_loss", "coulomb_level", "joint_compliance")}


@cache
def joint(kind: str) -> Joint:
    session = LOADS if kind == "loads" else SWEEP
    before, after = (made(session, seed, machine=3) for seed in (1, 2))
    return joint_of(recordings_of({"before": before}, {"after": after}), nominal(), FEW, most_bins=40)


def noisier(linear: LinearisedModel) -> LinearisedModel:
    return raised(linear, 1 + np.random.default_rng(0).uniform(0, 3, linear.inflation.shape))


def held(linear: LinearisedModel) -> LinearisedModel:
    return with_scatter(linear, replace(linear.scatter, new=0.04))


@pytest.mark.parametrize("kind", ["sweep", "loads"])
@pytest.mark.parametrize("other", [noisier, held])
def test_it_is_as_if_it_were_made_again(kind: str, other: Callable[[LinearisedModel], LinearisedModel]) -> None:
    linear = other(joint(kind).linear)
    found = ByInstant.of(joint(kind)).again(linear)
    expected = ByInstant.of(replace(joint(kind), linear=linear))
    np.testing.assert_array_equal(found.residual, expected.residual)
    np.testing.assert_array_equal(found.slopes.matrix, expected.slopes.matrix)
    size = np.abs(expected.columns).max(axis=0)
    np.testing.assert_allclose(found.columns / size, expected.columns / size, atol=1e-10)
    for one, other_one in zip(found.entries, expected.entries, strict=True):
        assert str(one.what) == str(other_one.what) or one.cause == other_one.cause


def test_it_may_be_stopped_between_steps() -> None:
    """A comparison that was to end after five minutes ended after seven, for one step took a minute."""
    looked = []
    background_of(joint("sweep"), lambda: looked.append(None))
    assert len(looked) >= 4  # twice with each scatter of friction at rest
