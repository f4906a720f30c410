"""Whitening in padded blocks against dense generalised least squares that is written out."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bench.identify.gls import SeriesModel, equal_weights, solve, whiten

SAME = 1e-8  # relative; dense algebra of some ten rows, condition below 1e4


def random_model(lengths, seed, *, has_offset=True, p=2, shared=1):
    rng = np.random.default_rng(seed)
    series = rng.permutation(np.repeat(np.arange(len(lengths)), lengths))
    m = len(series)
    root = rng.normal(size=(m, 3, 3)) + 3 * np.eye(3)
    return SeriesModel(
        series=series,
        response=rng.normal(size=(m, 3)),
        regressor=rng.normal(size=(m, 3, p)),
        covariance=root @ root.transpose(0, 2, 1),
        shared=rng.normal(size=(m, 3, shared)),
        has_offset=has_offset,
    )


def dense(model):
    """Return regressor, offsets, response and covariance as plain matrices."""
    m = len(model.series)
    covariance = np.zeros((3 * m, 3 * m))
    offsets = np.zeros((3 * m, 3 * (model.series.max() + 1)))
    for i in range(m):
        covariance[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] += model.covariance[i]
        offsets[3 * i : 3 * i + 3, 3 * model.series[i] : 3 * model.series[i] + 3] = np.eye(3)
        for j in range(m):
            if model.series[i] == model.series[j]:
                covariance[3 * i : 3 * i + 3, 3 * j : 3 * j + 3] += model.shared[i] @ model.shared[j].T
    return model.regressor.reshape(3 * m, -1), offsets, model.response.ravel(), covariance


@settings(max_examples=25)
@given(lengths=st.lists(st.integers(2, 5), min_size=1, max_size=4), seed=st.integers(0, 2**32 - 1))
def test_free_offsets_are_dummy_variables(lengths, seed):
    model = random_model(lengths, seed)
    A, B, y, V = dense(model)
    full = np.hstack([A, B])
    information = full.T @ np.linalg.solve(V, full)
    expected = np.linalg.solve(information, full.T @ np.linalg.solve(V, y))
    found = solve(whiten(model), np.zeros(2), np.full(2, np.inf))
    np.testing.assert_allclose(found.parameters, expected[:2], rtol=SAME, atol=SAME)
    np.testing.assert_allclose(found.covariance, np.linalg.inv(information)[:2, :2], rtol=SAME, atol=SAME)
    residual = y - full @ expected
    assert found.chi_square == pytest.approx(residual @ np.linalg.solve(V, residual), rel=SAME, abs=SAME)
    assert found.degrees_of_freedom == len(y) - full.shape[1]


def test_without_offset_nothing_is_projected_out():
    model = random_model([3, 4], 1, has_offset=False)
    A, _, y, V = dense(model)
    expected = np.linalg.solve(A.T @ np.linalg.solve(V, A), A.T @ np.linalg.solve(V, y))
    found = solve(whiten(model), np.zeros(2), np.full(2, np.inf))
    np.testing.assert_allclose(found.parameters, expected, rtol=SAME)


def test_restricted_likelihood_is_the_density_of_error_contrasts():
    """Differences of log likelihood between two models of the noise agree with the dense density of contrasts."""
    results = []
    for seed_of_noise in (2, 3):
        model = random_model([3, 4, 2], 1)
        noise = random_model([3, 4, 2], seed_of_noise)
        model = SeriesModel(model.series, model.response, model.regressor, noise.covariance, noise.shared, True)
        A, B, y, V = dense(model)
        full = np.hstack([A, B])
        contrasts = np.linalg.svd(full)[0][:, np.linalg.matrix_rank(full) :]
        spread = contrasts.T @ V @ contrasts
        value = contrasts.T @ y
        expected = -0.5 * (np.linalg.slogdet(spread)[1] + value @ np.linalg.solve(spread, value))
        results.append((solve(whiten(model), np.zeros(2), np.full(2, np.inf)).log_likelihood, expected))
    (found_1, expected_1), (found_2, expected_2) = results
    assert found_1 - found_2 == pytest.approx(expected_1 - expected_2, rel=SAME)


def test_a_prior_is_one_more_reading():
    model = random_model([4, 4], 5)
    white = whiten(model)
    found = solve(white, np.array([0.3, 0.0]), np.array([0.2, np.inf]))
    A = np.vstack([white.regressor, [1 / 0.2, 0]])
    y = np.append(white.response, 0.3 / 0.2)
    np.testing.assert_allclose(found.parameters, np.linalg.lstsq(A, y, rcond=None)[0], rtol=SAME)
    np.testing.assert_allclose(found.covariance, np.linalg.inv(A.T @ A), rtol=SAME)


def test_a_prior_without_spread_fixes_the_parameter():
    found = solve(whiten(random_model([4, 4], 5)), np.array([0.3, 0.0]), np.array([0.0, np.inf]))
    assert found.parameters[0] == pytest.approx(0.3)


def test_what_the_rows_do_not_tell_gets_a_variance_that_says_so():
    model = random_model([5, 5], 7)
    twins = np.concatenate([model.regressor[..., :1], model.regressor[..., :1]], axis=2)
    model = SeriesModel(model.series, model.response, twins, model.covariance, model.shared, True)
    found = solve(whiten(model), np.zeros(2), np.full(2, np.inf))
    alone = 1 / np.sum(whiten(model).regressor[:, 0] ** 2)
    assert np.all(np.diag(found.covariance) > 1e9 * alone)
    assert found.covariance.sum() == pytest.approx(alone, rel=1e-3), "their sum is known as well as ever"


def test_equal_weights_are_least_squares_of_differences():
    model = random_model([3, 4], 9)
    later, first = [], []
    for s in (0, 1):
        rows = np.flatnonzero(model.series == s)
        later += list(rows[1:])
        first += [rows[0]] * (len(rows) - 1)
    A = (model.regressor[later] - model.regressor[first]).reshape(-1, 2)
    y = (model.response[later] - model.response[first]).ravel()
    found = solve(equal_weights(model), np.zeros(2), np.full(2, np.inf))
    np.testing.assert_allclose(found.parameters, np.linalg.lstsq(A, y, rcond=None)[0], rtol=SAME)
