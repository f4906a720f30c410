"""What a drift of the day took of the difference between recordings is said, though it is no change."""

from functools import cache, partial
from pathlib import Path

import numpy as np
import pytest

from bench.compare.as_it_was import as_it_was
from bench.compare.background import Background
from bench.compare.compare import comparison_of, weighed
from bench.compare.drift import drifts_of
from bench.compare.joint import joint_of
from bench.compare.recordings import recordings_of
from bench.compare.search_changes import Found
from bench.diagnose.diagnose import FALSE_ALARM_RATE
from bench.effects.catalogue import catalogue
from bench.report.comparison.words import words_of
from tests.diagnose.sweeps import SWEEP, made, nominal

LESS = 0.2  # of the viscous friction of joint 2, as on a day that is 13 K warmer
MORE = 0.3  # of the Coulomb friction
FEW = {name: catalogue()[name] for name in ("gas_loss", "coulomb_level")}
MOVES = "viscous friction of joint2"  # of the sweep, nothing else moves


@cache
def on_a_warm_day(more: float, folder: Path) -> tuple[Background, Found]:
    """Return one machine twice; its figures and its noise are the same, for all of it comes from one seed."""
    rubs = {"coulomb_level": more} if more else {}
    cold, warm = (made(SWEEP, 7, hidden) for hidden in ({}, {"viscous_level": -LESS, **rubs}))
    recordings, robot = (
        recordings_of({"cold": cold}, {"warm": warm}),
        as_it_was(cold, nominal(), folder / str(more)).robot,
    )
    joined = partial(joint_of, recordings, robot, FEW, 60)
    return weighed(lambda large, before: joined(large=large, before=before))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("as it was")


def test_friction_that_fell_with_the_day_is_said(folder: Path) -> None:
    """It was let drift and not said: Coulomb friction alone was named where viscous friction changed far more."""
    found = comparison_of(*on_a_warm_day(0.0, folder), FALSE_ALARM_RATE)
    assert not found.has_changed
    drifts = {drift.name: drift for drift in found.drifts}
    print({name: drift.values for name, drift in drifts.items()})
    (size,) = drifts[MOVES].values
    assert size.low < -LESS < size.high < 0
    assert {name for name in drifts if name.startswith("viscous")} == {MOVES}, "what stands still is not told"
    assert all(one.values[0].low < 0 < one.values[0].high for name, one in drifts.items() if name != MOVES)
    assert any("viscous friction: joint2 -" in line for line in words_of(found))


def test_a_drift_knows_what_is_named_beside_it(folder: Path) -> None:
    """Against the posterior of drifts and changes together, by inverting all of it."""
    background, found = on_a_warm_day(MORE, folder)
    assert found.best
    own = [background.acting(one.entry.columns, one.profile.weights) * one.prior for one in found.best]
    every = np.concatenate([background.nuisances.jacobian, *own], axis=1)
    covariance = np.linalg.inv(np.eye(every.shape[1]) + every.T @ every)
    mean = covariance @ (every.T @ background.white)
    names = [one.name for one in background.joint.linear.nuisances]
    before, after = (
        int(np.flatnonzero((background.slopes.nuisance == names.index(MOVES)) & (background.slopes.recording == k))[0])
        for k in (0, 1)
    )
    weights = np.zeros(every.shape[1])
    weights[[before, after]] = -1.0, 1.0
    drift = next(one for one in drifts_of(background, found) if one.name == MOVES)
    own_part = drift.expected / np.sqrt(2)
    np.testing.assert_allclose(drift.values[0].value, own_part * weights @ mean, rtol=1e-6)
    half = (drift.values[0].high - drift.values[0].low) / 2
    np.testing.assert_allclose(half, 1.645 * own_part * np.sqrt(weights @ covariance @ weights), rtol=1e-6)
