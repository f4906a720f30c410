"""How large a cause is against what is plausible, and how small one may be to be found: closed forms."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from bench.diagnose.extend.fit import Fit
from bench.diagnose.extend.size import NORMAL_95, Size, evidence_of, is_clear_of_none, size_of
from bench.diagnose.linearise.candidates import Candidate, Cause, shape_grid
from bench.diagnose.linearise.limits import DetectionLimit, detection_limits, smallest_found
from bench.diagnose.linearise.screening import Entry, Screening
from bench.diagnose.named_causes import SMALL, NamedCause
from bench.effects.effect import WHOLE
from tests.diagnose.small_models import WAVE, Shift, X, Z, fit_alone

CAUSE = Cause(Shift(), WHOLE, (X, Z), (WAVE,))
PLAIN = Cause(Shift(), WHOLE, (X,), ())


def fitted(x: float, z: float, sigma: float) -> Fit:
    return fit_alone(CAUSE, (x, z, 1.9), np.diag([sigma**2, sigma**2, 1.0]))


def test_a_cause_is_as_large_as_its_clear_components() -> None:
    assert size_of(CAUSE, fitted(1e-4, -6e-3, 5e-4)) == Size(pytest.approx(0.6), pytest.approx(12.0))


def test_without_a_clear_component_the_first_counts() -> None:
    assert size_of(CAUSE, fitted(1e-4, -6e-3, 5e-3)) == Size(pytest.approx(0.01), pytest.approx(0.02))


def test_a_shape_is_no_size() -> None:
    assert size_of(CAUSE, fitted(0.0, 1e-3, 1e-4)).share == pytest.approx(0.1)


def test_a_cause_that_was_not_fitted_has_no_size() -> None:
    assert np.isnan(size_of(PLAIN, fitted(0.0, 1e-3, 1e-4)).share)


@pytest.mark.parametrize(
    ("sigmas", "correlation", "is_clear"), [(1.5, 0.0, False), (2.0, 0.0, True), (1.8, 0.9, False)]
)
def test_sizes_that_trade_against_each_other_are_clear_together(
    sigmas: float, correlation: float, is_clear: bool
) -> None:
    """Two sizes of n standard errors: a Wald statistic of 2 n^2 / (1 + r); with a shape its 95 % quantile is 7.81."""
    fit = fitted(sigmas * 5e-4, sigmas * 5e-4, 5e-4)
    covariance = fit.covariance.copy()
    covariance[0, 1] = covariance[1, 0] = correlation * 5e-4**2
    assert is_clear_of_none(CAUSE, replace(fit, covariance=covariance)) is is_clear


def test_shifts_against_each_other_are_clear_where_neither_is() -> None:
    """A jump of the tracker was refused, for none of its six sizes was clear of none, and came out as a slip."""
    fit = fitted(1e-3, -1e-3, 1e-3)
    covariance = fit.covariance.copy()
    covariance[0, 1] = covariance[1, 0] = 0.9 * 1e-6
    assert is_clear_of_none(CAUSE, replace(fit, covariance=covariance))
    assert size_of(CAUSE, fit).sigmas < NORMAL_95


def test_a_size_that_trades_against_its_own_shape_acts() -> None:
    """Links that grow by alpha w (T - T_0) were dropped from every model, for alpha alone and w alone are unknown."""
    for correlation, acts in ((0.0, False), (0.9, True)):
        sigma, other = 1.2e-3, 0.4
        covariance = np.diag([sigma**2, 1e-6, other**2])
        covariance[0, 2] = covariance[2, 0] = correlation * sigma * other
        fit = fit_alone(CAUSE, (1e-3, 0.0, 1.9), covariance)
        off, given = fit.sizes_against_none(CAUSE)
        np.testing.assert_allclose(off, [1e-3, 0.0])
        np.testing.assert_allclose(np.diag(given), [sigma**2 * (1 - correlation**2), 1e-6])
        assert fit.acts(CAUSE) is acts
        assert fit.sigma[0] == pytest.approx(sigma)  # its interval counts what is not known of its shape


def test_one_size_is_clear_where_its_interval_leaves_out_none() -> None:
    for share in (0.99, 1.01):
        fit = fit_alone(PLAIN, [share * NORMAL_95 * 1e-3], np.array([[1e-6]]))
        assert is_clear_of_none(PLAIN, fit) is (share > 1)
    assert not is_clear_of_none(CAUSE, fit)


def test_small_is_less_than_a_fifth_of_what_is_plausible() -> None:
    assert NamedCause("shift", "shift", "robot", (), share=SMALL - 1e-6).is_small
    assert not NamedCause("shift", "shift", "robot", (), share=SMALL).is_small
    assert not NamedCause("shift", "shift", "robot", ()).is_small  # nobody fitted it


def screening(cause: Cause, information: list[float], steps: float = 2e-3) -> Screening:
    """Return what the limits need of a screening: one entry for each shape, one column for each of its sizes."""
    count = len(cause.sizes)
    prior = np.full(count, X.high / np.sqrt(3) / steps)
    entries = [
        Entry(
            Candidate(cause, {}, np.full(count, steps), prior, np.empty((0, count))),
            np.arange(i * count, (i + 1) * count),
            ((prior, 0.0),),
        )
        for i in range(len(information) // count)
    ]
    marginal = SimpleNamespace(diagonal=np.array(information))
    return SimpleNamespace(entries=tuple(entries), marginal=marginal, threshold=6.0)  # type: ignore[return-value]


def limit_at(information: float, steps: float = 2e-3) -> float:
    return steps * smallest_found(information, X.high / np.sqrt(3) / steps, 6.0)


def test_the_limit_of_several_shapes_spans_the_best_and_the_worst() -> None:
    shapes = len(shape_grid(CAUSE))
    assert shapes > 2
    information = [x for i in range(shapes) for x in (100.0 / (i + 1), 50.0)]
    x, z = detection_limits(screening(CAUSE, information))
    assert (x.limit, x.worst) == (pytest.approx(limit_at(100.0)), pytest.approx(limit_at(100.0 / shapes)))
    assert (x.plausible, x.shapes) == (X.high, shapes)
    assert z.limit == z.worst == pytest.approx(limit_at(50.0))


def test_a_shape_that_leaves_no_trace_has_no_limit() -> None:
    shapes = len(shape_grid(CAUSE))
    (x, _) = detection_limits(screening(CAUSE, [100.0] * 2 * (shapes - 1)))
    assert x.limit == pytest.approx(limit_at(100.0))
    assert x.worst == np.inf
    assert not x.is_plausible


@pytest.mark.parametrize(("information", "is_plausible"), [(100.0, True), (1e-3, False)])
def test_a_limit_beyond_what_is_plausible_is_none(information: float, is_plausible: bool) -> None:
    (found,) = detection_limits(screening(PLAIN, [information]))
    assert found.limit == found.worst
    assert found.is_plausible is is_plausible
    assert isinstance(found, DetectionLimit)


def test_the_evidence_for_sizes_is_the_ratio_of_normal_densities(rng: np.random.Generator) -> None:
    cause = Cause(Shift(), WHOLE, (X, Z), ())
    slopes, deviations = 1e3 * rng.standard_normal((5, 2)), fit_alone(cause, (0.0, 0.0), np.eye(2)).unknowns
    prior = np.diag([unknown.sigma**2 for unknown in deviations])
    white = slopes @ [2e-3, -1e-3] + rng.standard_normal(5)
    covariance = np.linalg.inv(np.linalg.inv(prior) + slopes.T @ slopes)
    fit = fit_alone(cause, covariance @ slopes.T @ white, covariance)
    with_sizes, without = np.eye(5) + slopes @ prior @ slopes.T, np.eye(5)
    expected = multivariate_normal(cov=with_sizes).logpdf(white) - multivariate_normal(cov=without).logpdf(white)
    assert evidence_of(cause, fit) == pytest.approx(expected)
    unknown = replace(fit, covariance=np.diag([covariance[0, 0], 0.0]))
    assert evidence_of(cause, unknown) == np.inf, "a size without an error is not told by derivatives"
