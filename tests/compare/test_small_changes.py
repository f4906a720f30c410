"""A change is as likely to be small as large: all scales are tried, and chance passes no more often for it."""

import numpy as np
import pytest

from bench.compare.search_changes import priors_of
from bench.diagnose.linearise.candidates import Candidate, Cause
from bench.diagnose.linearise.marginal import Nuisances
from bench.diagnose.linearise.screening import Entry, widths_of
from bench.diagnose.linearise.threshold import LEAST, family_threshold
from bench.effects.catalogue import catalogue
from bench.effects.effect import WHOLE
from bench.record.campaign import Array

PLAUSIBLE = 1000.0  # of each size, in standard errors: as a payload of 100 kg that is weighed to 0.1 kg
SMALL = 3.0  # of each size, in standard errors
SIZES, READINGS = 4, 40
RATE = 0.01
NULLS = 2000
MOST_ALARMS = 34  # of 2000 at 1 %: binomial, three standard deviations up


def entry_of(columns: Array, at: int = 0) -> Entry:
    """Return a cause whose sizes change readings as these columns say."""
    effect = catalogue()["tracker_frame"]
    cause = Cause(effect, WHOLE, effect.parameters[: columns.shape[1]], ())
    plausible = np.full(columns.shape[1], PLAUSIBLE)
    priors = tuple((width * plausible, -float(np.log(len(widths_of(cause))))) for width in widths_of(cause))
    candidate = Candidate(cause, {}, np.ones_like(plausible), plausible, columns)
    return Entry(candidate, at + np.arange(columns.shape[1]), priors)


def orthonormal(rng: np.random.Generator, count: int) -> Array:
    return np.asarray(np.linalg.qr(rng.standard_normal((READINGS, count)))[0], dtype=np.float64)


def test_a_small_change_of_several_sizes_passes(rng: np.random.Generator) -> None:
    columns = orthonormal(rng, SIZES)
    entry = entry_of(columns)
    none = Nuisances(np.zeros((READINGS, 1)))
    marginal = none.products(columns @ np.full(SIZES, SMALL), columns)
    as_large = max(marginal.log_evidence(entry.columns, prior) + share for prior, share in entry.priors)
    best = max(
        marginal.log_evidence(entry.columns, prior) + share for prior, share in priors_of(entry, marginal.diagonal)
    )
    assert as_large < LEAST, "else the test says nothing"
    assert best > LEAST
    assert best < 0.5 * SIZES * SMALL**2, "no more than knowing the sizes would give"


@pytest.mark.parametrize("sizes", [1, SIZES])
def test_scales_end_at_what_is_resolved_and_share_the_odds(sizes: int) -> None:
    entry = entry_of(np.eye(READINGS)[:, :sizes])
    information = np.ones(sizes)
    known = priors_of(entry, information)
    narrowest = known[-1][0][0]
    assert known[0][0][0] == PLAUSIBLE
    assert 1 <= narrowest < 10**0.5
    assert np.sum(np.exp([share for _, share in known])) == pytest.approx(1.0)
    (alone,) = priors_of(entry, information * 1e-8)  # not resolved: as plausible
    assert alone[0][0] == PLAUSIBLE
    assert alone[1] == pytest.approx(0.0)


def test_chance_passes_at_the_declared_rate(rng: np.random.Generator) -> None:
    columns = rng.standard_normal((READINGS, 30))
    entries = [entry_of(columns[:, 3 * i : 3 * i + 3], at=3 * i) for i in range(10)]
    none = Nuisances(np.zeros((READINGS, 1)))
    quiet = none.products(np.zeros(READINGS), columns)
    blocks = [(entry.columns, *prior) for entry in entries for prior in priors_of(entry, quiet.diagonal)]
    threshold = family_threshold(quiet, blocks, RATE, np.random.default_rng(0))
    alarms = 0
    for _ in range(NULLS):
        marginal = none.products(rng.standard_normal(READINGS), columns)
        best = max(marginal.log_evidence(which, prior) + share for which, prior, share in blocks)
        alarms += best > threshold
    assert alarms <= MOST_ALARMS
