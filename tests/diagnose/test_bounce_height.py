"""How high links bounce in their gears is read from what a model leaves."""

import numpy as np
import pytest

from bench.diagnose.linearise.bounce_height import FEW, bounce_in
from bench.diagnose.linearise.linearised_model import LinearisedModel, with_play
from bench.diagnose.linearise.noise_covariance import gap_response
from bench.diagnose.linearise.rattling import ANYWHERE, Play, rattles
from bench.record.campaign import Array
from tests.diagnose.small_models import linear_of
from tests.diagnose.sweeps import SWEEPS, made

GAPS = 4e-4 * (np.arange(6) == 1)  # [rad], of the joint that sweeps


@pytest.fixture(scope="module")
def linear() -> LinearisedModel:
    return linear_of(made(SWEEPS, seed=5))


def left_by(linear: LinearisedModel, play: Play, rng: np.random.Generator) -> tuple[Array, int]:
    """Return residuals of instruments and of links that bounce, shape (T, c), and in how many instants these do."""
    compiled, found, count = linear.replay.compiled, [], 0
    for segment, response in zip(linear.weighed, linear.responses, strict=True):
        sigma = np.where(np.isfinite(segment.observed) & np.isfinite(segment.sigma), segment.sigma, np.nan)
        left = sigma * rng.standard_normal(sigma.shape)
        if not segment.is_static:
            off = rattles(compiled, segment, response, play)
            moved = gap_response(compiled, segment, response, linear.quantities, play)
            left += np.einsum("tcj,tj->tc", moved, off * rng.standard_normal(off.shape))
            count += int(np.count_nonzero(np.any(off > 0, axis=1)))
        found.append(left)
    return np.concatenate(found), count


@pytest.mark.parametrize("bounce", [0.15, 0.4])
def test_links_bounce_as_high_as_it_shows(linear: LinearisedModel, bounce: float) -> None:
    rng = np.random.default_rng(2)
    found = []
    for _ in range(8):
        residual, count = left_by(linear, Play(GAPS, bounce), rng)
        found.append(bounce_in(with_play(linear, Play(GAPS)), residual))
    print(count, np.round(found, 3))
    assert count > 2 * FEW
    assert np.mean(found) == pytest.approx(bounce, rel=0.15)


def test_where_hardly_any_link_bounces_it_may_be_anywhere(linear: LinearisedModel) -> None:
    residual, _ = left_by(linear, Play(GAPS, 0.1), np.random.default_rng(3))
    assert bounce_in(with_play(linear, Play(np.roll(GAPS, 4))), residual) == ANYWHERE  # of the wrist, which stands


def test_how_high_nobody_asks_where_nothing_has_play() -> None:
    tight, loose = np.zeros(6), GAPS
    assert Play(tight, 0.1).scatters_as(Play(tight, 0.5))
    assert not Play(loose, 0.1).scatters_as(Play(loose, 0.5))
    assert Play(loose, 0.5).scatters_as(Play(1.05 * loose, 0.5))
    assert not Play(loose, 0.5).scatters_as(Play(1.5 * loose, 0.5))
