"""What data do not tell is not told: value and interval are those of the prior, for the most part."""

import numpy as np
import pytest

from bench.diagnose.conclude import named_cause
from bench.diagnose.cross_validation.figures import fitted_figures
from bench.diagnose.extend.told import told_sizes
from bench.diagnose.linearise.candidates import Cause
from bench.effects.effect import WHOLE
from bench.effects.parameter import Parameter
from bench.identify.dynamics.quantities import Quantity
from bench.report.diagnosis.names import parameter_text
from tests.diagnose.made_runs import LENGTH, SIGMA, design_with, fit_of
from tests.diagnose.small_models import WAVE, Shift, X, Z, fit_alone
from tests.diagnose.sweeps import nominal

CAUSE = Cause(Shift(), WHOLE, (X, Z), (WAVE,))
PRIOR = X.high / np.sqrt(3)


def covariance(information: np.ndarray, wider: float = 1.0) -> np.ndarray:
    """Return the posterior covariance of x, z and the period for information in standard deviations of their priors."""
    sigma = np.array([PRIOR, PRIOR, (WAVE.high - WAVE.low) / np.sqrt(3)])
    posterior = np.linalg.inv(information + np.eye(3)) * np.outer(sigma, sigma)
    return wider**2 * posterior


@pytest.mark.parametrize(
    ("information", "told"),
    [
        (np.diag([1e6, 1e6, 0.0]), [True, True]),
        (np.diag([1e6, 0.0, 0.0]), [True, False]),
        (np.diag([1e6, 1e-3, 0.0]), [True, False]),
        # a mass of which data say a tenth of what was stated was told, with 0.95 of its prior's interval
        (np.diag([1e6, 0.1, 0.0]), [True, False]),
        (np.diag([1e6, 1.1, 0.0]), [True, True]),
        # their sum alone, as of the second moments of a payload that turns about one axis
        (1e7 * np.array([[1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 0.0]]), [False, False]),
        # the sum well and the difference badly
        (np.array([[1e7, 1e7 - 1.0, 0.0], [1e7 - 1.0, 1e7, 0.0], [0.0, 0.0, 0.0]]), [True, True]),
        # with a shape that trades against the size: its prior counts
        (1e4 * np.array([[1.0, 0.0, 0.5], [0.0, 1.0, 0.0], [0.5, 0.0, 0.25]]), [True, True]),
        (1e4 * np.array([[1.0, 0.0, 2.0], [0.0, 1.0, 0.0], [2.0, 0.0, 4.0]]), [False, True]),
    ],
)
def test_a_size_is_told_by_data_alone(information: np.ndarray, told: list[bool]) -> None:
    fit = fit_alone(CAUSE, (1e-3, 1e-3, 1.9), covariance(information))
    assert list(told_sizes(CAUSE, fit).values()) == told


@pytest.mark.parametrize(("information", "told"), [(0.9, False), (1.1, True)])
def test_first_pass_figures_and_findings_have_one_rule(information: float, told: bool) -> None:
    """A figure was told where 1 % of its prior's width was gone, a quantity of the first pass where 29 % were."""
    variance = 1 / (1 + information)
    assert (
        list(told_sizes(CAUSE, fit_alone(CAUSE, (0, 0, 1), covariance(information * np.eye(3)))).values()) == [told] * 2
    )
    assert Quantity("inertia", "m", "kg", 1.0, 1.0, np.sqrt(variance), 1.0, np.zeros(1)).told is told
    linear = design_with(np.zeros(LENGTH), SIGMA * np.sqrt(information / LENGTH) * np.ones((LENGTH, 1)), 1)
    linear.replay.compiled = nominal()
    (figure,) = fitted_figures(linear, fit_of(linear))
    assert figure.high == pytest.approx(1.959964 * np.sqrt(variance))
    assert figure.is_told is told


def test_what_runs_disagree_about_by_more_than_its_prior_is_not_told() -> None:
    fit = fit_alone(CAUSE, (1e-3, 1e-3, 1.9), covariance(np.diag([1e6, 0.1, 0.0]), wider=1.5))
    assert list(told_sizes(CAUSE, fit).values()) == [True, False]


def test_only_what_is_told_is_printed() -> None:
    """A SCARA's payload had second moments of 0.00 kg m^2 (-0.72 to 0.72): priors, cut by their sum."""
    sum_alone = 1e7 * np.array([[1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 0.0]])
    x, z, _ = named_cause(CAUSE, fit_alone(CAUSE, (1e-3, 1e-3, 1.9), covariance(sum_alone))).parameters
    assert (x.is_told, z.is_told) == (False, False)
    assert parameter_text(x) == "x: these data do not tell it"
    x, z, _ = named_cause(CAUSE, fit_alone(CAUSE, (1e-3, 1e-3, 1.9), covariance(np.diag([1e6, 1e6, 0.0])))).parameters
    assert (x.is_told, z.is_told) == (True, True)
    assert parameter_text(x).startswith("x 1.000 mm (")


def test_an_interval_ends_where_a_size_cannot_be() -> None:
    """A payload's second moment, "never below zero", was 0.0 kg m^2 (-4.2 to 4.2), and a period 49 deg (-44 to 141)."""
    grows = Parameter("y", "m", 0.0, 1e-3, 1e-2, "of one sign only")
    cause = Cause(Shift(), WHOLE, (X, grows), (WAVE,))
    x, y, period = named_cause(cause, fit_alone(cause, (1e-3, 1e-3, 0.9), np.diag([1e-6, 1e-6, 1.0]))).parameters
    assert (x.low, x.high) == pytest.approx((1e-3 - 1.959964e-3, 1e-3 + 1.959964e-3))
    assert (y.low, y.high) == pytest.approx((0.0, 1e-3 + 1.959964e-3))
    assert (period.low, period.high) == pytest.approx((WAVE.low / 2, 0.9 + 1.959964))
