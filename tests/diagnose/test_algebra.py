"""The linearised model against dense algebra, and the declared false-alarm rate."""

from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.linearise import threshold as threshold_module
from bench.diagnose.linearise.marginal import Columns, Marginal, Nuisances
from bench.diagnose.linearise.threshold import family_threshold
from bench.diagnose.replay.segment_input import centre_weights

M, P, K = 60, 5, 4


@pytest.fixture
def data() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(1)
    return rng.standard_normal((M, P)), rng.standard_normal(M), rng.standard_normal((M, K))


def test_products_are_those_of_the_marginal_covariance(data: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
    jacobian, white, columns = data
    inverse = np.linalg.inv(np.eye(M) + jacobian @ jacobian.T)
    found = Nuisances(jacobian).products(white, columns)
    assert found.misfit == pytest.approx(white @ inverse @ white)
    np.testing.assert_allclose(found.scores, columns.T @ inverse @ white, rtol=1e-9)
    np.testing.assert_allclose(found.information, columns.T @ inverse @ columns, rtol=1e-9)


@pytest.mark.parametrize("count", [1, 2])
def test_evidence_is_the_ratio_of_two_normal_densities(
    data: tuple[np.ndarray, np.ndarray, np.ndarray], count: int
) -> None:
    jacobian, white, columns = data
    prior = np.array([0.5, 2.0])[:count]
    null = np.eye(M) + jacobian @ jacobian.T
    more = null + (columns[:, :count] * prior**2) @ columns[:, :count].T

    def log_density(covariance: np.ndarray) -> float:
        return float(-0.5 * white @ np.linalg.solve(covariance, white) - 0.5 * np.linalg.slogdet(covariance)[1])

    found = Nuisances(jacobian).products(white, columns).log_evidence(np.arange(count), prior)
    assert found == pytest.approx(log_density(more) - log_density(null), abs=1e-6)


def test_evidence_of_many_groups_is_that_of_each_alone(data: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
    jacobian, white, columns = data
    groups = np.array([[0, 1], [1, 3], [2, 3]])
    prior = np.array([[0.5, 2.0], [1.0, 0.1], [3.0, 3.0]])
    alone = [
        Nuisances(jacobian).products(white, columns[:, group]).log_evidence(np.arange(2), sigma)
        for group, sigma in zip(groups, prior, strict=True)
    ]
    marginal = Nuisances(jacobian).products(white, columns)
    np.testing.assert_allclose(marginal.log_evidences(groups, prior), alone, rtol=1e-9)
    assert marginal.columns.gram.shape == (K, K)  # formed now, and used from now on
    np.testing.assert_allclose(marginal.log_evidences(groups, prior), alone, rtol=1e-9)


def test_columns_serve_another_model_with_a_few_other_slopes(data: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
    jacobian, white, columns = data
    known = Columns(columns)
    Nuisances(jacobian).products(white, known)
    other = jacobian.copy()
    other[:, 2] *= -0.3
    found = Nuisances(other).products(white, known)
    fresh = Nuisances(other).products(white, columns)
    np.testing.assert_allclose(found.information, fresh.information, rtol=1e-9)
    np.testing.assert_allclose(found.diagonal, np.diag(fresh.information), rtol=1e-9)
    np.testing.assert_allclose(found.scores, fresh.scores, rtol=1e-9)


def test_columns_in_the_model_are_further_slopes(data: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
    jacobian, white, columns = data
    tangent = 2.0 * np.sin(np.outer(np.arange(M), [1.0, 2.0]))
    fresh = Nuisances(np.concatenate([jacobian, tangent], axis=1)).products(white, columns)
    given = Nuisances(jacobian).products(white, np.concatenate([columns, tangent], axis=1))
    given = given.given(np.arange(K, K + 2), np.ones(2))
    np.testing.assert_allclose(given.scores[:K], fresh.scores, rtol=1e-6)
    np.testing.assert_allclose(given.information[:K, :K], fresh.information, rtol=1e-6)
    assert given.misfit == pytest.approx(fresh.misfit)


def test_threshold_keeps_the_declared_rate(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(threshold_module, "LEAST", -np.inf)  # chance alone
    rng = np.random.default_rng(2)
    root = 5 * rng.standard_normal((60, 60))
    marginal = Marginal(0.0, np.zeros(60), Columns(root.T), np.empty((0, 60)))
    blocks = [(np.arange(i, i + 2), np.full(2, 0.1), -0.1 * (i % 4)) for i in range(0, 60, 2)]
    rate = 0.05
    threshold = family_threshold(marginal, blocks, rate, rng)
    alarms = 0
    for _ in range(600):
        null = replace(marginal, scores=root @ rng.standard_normal(60))
        alarms += max(null.log_evidence(columns, prior) + share for columns, prior, share in blocks) > threshold
    assert 0.025 < alarms / 600 < 0.085  # three standard deviations of 600 draws and of the threshold's own


def test_columns_of_which_hardly_anything_is_left_have_a_threshold() -> None:
    """What is known already takes all but rounding of them; correlations of that are those of no numbers."""
    rng = np.random.default_rng(3)
    jacobian = 1e6 * rng.standard_normal((M, P))
    gone = jacobian @ (1e-6 * rng.standard_normal((P, 20)))
    seen = 5 * rng.standard_normal((M, K))
    found, blocks = [], [([i], np.ones(1), 0.0) for i in range(K)]
    for columns in (seen, np.concatenate([seen, gone], axis=1)):
        marginal = Nuisances(jacobian).products(np.zeros(M), columns)
        alone = [(np.array(block), prior, cost) for block, prior, cost in blocks]
        found.append(family_threshold(marginal, alone, 0.01, np.random.default_rng(0)))
    assert found[1] == pytest.approx(found[0], abs=0.3)  # other draws, of the same columns


def test_a_bin_gives_the_middle_of_a_parabola() -> None:
    t = np.linspace(-1, 1, 9)
    assert centre_weights(9) @ (2.0 - t + 5 * t**2) == pytest.approx(2.0)
    np.testing.assert_allclose(centre_weights(3), 1 / 3)
