"""A change is as likely to be small as large: all scales are tried, and chance passes no more often for it."""

import numpy as np
import pytest

from bench.compare.search_changes import most_probable_first, priors_of
from bench.diagnose.linearise.candidates import Candidate, Cause
from bench.diagnose.linearise.marginal import Nuisances
from bench.diagnose.linearise.screening import Entry, widths_of
from bench.diagnose.linearise.threshold import LEAST, family_threshold
from bench.diagnose.name.search import Alternative, Subset
from bench.effects.catalogue import catalogue
from bench.effects.effect import WHOLE
from bench.record.campaign import Array
from tests.diagnose.sweeps import nominal

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


def test_a_mass_may_sit_at_any_lever() -> None:
    """With one scale for mass and moments a tool of 0.35 kg was 0.21 kg, or the last link 43 % heavier."""
    effect = catalogue()["unstated_payload"]
    cause = Cause(effect, WHOLE, effect.parameters_at(nominal(), WHOLE), ())
    count = len(cause.sizes)
    plausible = np.full(count, PLAUSIBLE)
    entry = Entry(Candidate(cause, {}, np.ones(count), plausible, np.eye(count)), np.arange(count), ((plausible, 0.0),))
    known = priors_of(entry, np.ones(count))
    assert np.sum(np.exp([share for _, share in known])) == pytest.approx(1.0)
    power = np.array([{"kg": 0, "kg m": 1, "kg m^2": 2}[size.unit] for size in cause.sizes])
    levers = {round(float(np.log10(prior[power == 1][0] / prior[power == 0][0])), 3) for prior, _ in known}
    assert levers == {0.0, -0.5, -1.0}
    for prior, _ in known:
        lever = prior[power == 1][0] / prior[power == 0][0]
        np.testing.assert_allclose(prior, prior[power == 0][0] * lever**power)


def test_the_most_probable_explanation_comes_first_with_all_that_counts_for_it() -> None:
    """A headline had a dress pack at 39 %: with a payload it was likelier by itself than the payload alone, at 61 %."""

    def saying(log_posterior: float, *keys: str) -> Alternative:
        return Alternative(frozenset(keys), Subset((), log_posterior), log_posterior)

    both, alone, more, nothing = saying(1.0, "a", "b"), saying(0.8, "a"), saying(0.5, "a", "c"), saying(0.0)
    order, probability = most_probable_first([both, alone, more, nothing])
    assert order == (alone, both, more, nothing)
    assert probability[0] > probability[1] > probability[2] == 0.0
    assert sum(probability) == pytest.approx(1.0)
    unchanged, unlikely = saying(0.0), saying(-0.1, "a")
    assert most_probable_first([unchanged, unlikely, saying(-0.2, "a", "b")])[0][0] is unchanged
