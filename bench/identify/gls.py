"""Generalised least squares for readings in series: correlated within a series, independent between them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.robot.bodies import Array

SURE = 1e-9  # a prior sharper than this, zero included, is taken to be this sharp
EIGENVALUE_FLOOR = 1e-13  # of the largest; directions below it are unknown, and get a variance that says so


@dataclass(frozen=True)
class SeriesModel:
    """response = regressor @ parameters + offset of the series + disturbances, for m states with d rows each.

    Attributes:
        series: Shape (m,) int.
        response: Shape (m, d).
        regressor: Shape (m, d, p).
        covariance: Shape (m, d, d), of what is independent from state to state.
        shared: Shape (m, d, k); column k is how one unit normal disturbance of the series moves its states.
        has_offset: Each series has a free d-vector added to all its states (the unloaded reading is then one state of
            many, and its noise is shared correctly).
    """

    series: NDArray[np.int64]
    response: Array
    regressor: Array
    covariance: Array
    shared: Array
    has_offset: bool


@dataclass(frozen=True)
class Whitened:
    """The same problem with independent unit noise, the free offsets projected out.

    Attributes:
        regressor: Shape (rows, p).
        response: Shape (rows,).
        n_free: Independent rows; `rows` less the offsets.
        log_determinant: Of the covariance and of the offsets' information, for the restricted likelihood.
    """

    regressor: Array
    response: Array
    n_free: int
    log_determinant: float


@dataclass(frozen=True)
class Solution:
    """Least-squares parameters of a whitened problem with normal priors.

    Attributes:
        parameters: Shape (p,).
        covariance: Shape (p, p).
        information: Shape (p, p), of the readings alone, without priors.
        residual: Shape (rows,), unit variance where the model is right.
        chi_square: Sum of squared residuals, priors included.
        degrees_of_freedom: Of `chi_square`.
        log_likelihood: Restricted, up to a constant that depends on nothing but the readings.
    """

    parameters: Array
    covariance: Array
    information: Array
    residual: Array
    chi_square: float
    degrees_of_freedom: int
    log_likelihood: float


def whiten(model: SeriesModel) -> Whitened:
    """Return the problem with unit, independent noise.

    All series are padded to the length of the longest with rows that say nothing, so that one batched call serves
    them all.
    """
    _, d, p = model.regressor.shape
    rows, is_real = _padded(model.series)
    count, length = rows.shape
    covariance = np.where(is_real[..., None, None], model.covariance[rows], np.eye(d))
    columns = np.concatenate([model.regressor, model.response[:, :, None], model.shared], axis=2)[rows]
    columns = np.where(is_real[..., None, None], columns, 0.0).reshape(count, length * d, -1)
    shared = columns[..., p + 1 :]
    block = shared @ shared.transpose(0, 2, 1)
    diagonal = np.arange(length)
    block.reshape(count, length, d, length, d)[:, diagonal, :, diagonal, :] += covariance.swapaxes(0, 1)
    root = np.linalg.cholesky(block)
    log_determinant = 2 * float(np.log(np.diagonal(root, axis1=1, axis2=2)).sum())
    offset = np.where(is_real[..., None, None], np.eye(d), 0.0).reshape(count, length * d, d)
    white = np.linalg.solve(root, np.concatenate([columns[..., : p + 1], offset], axis=2))
    n_free = int(is_real.sum()) * d
    known = white[..., : p + 1]
    if model.has_offset:
        basis, triangle = np.linalg.qr(white[..., p + 1 :])
        known = known - basis @ (basis.transpose(0, 2, 1) @ known)
        log_determinant += 2 * float(np.log(np.abs(np.diagonal(triangle, axis1=1, axis2=2))).sum())
        n_free -= count * d
    real = known.reshape(count, length, d, p + 1)[is_real].reshape(-1, p + 1)
    return Whitened(real[:, :p], real[:, p], n_free, log_determinant)


def equal_weights(model: SeriesModel) -> Whitened:
    """Return every state less the first of its series, all rows alike, in units of the mean noise of a difference."""
    rows, is_real = _padded(model.series)
    first = np.broadcast_to(rows[:, :1], rows.shape)
    later, first = rows[:, 1:][is_real[:, 1:]], first[:, 1:][is_real[:, 1:]]
    variance = np.trace(model.covariance, axis1=1, axis2=2) / model.covariance.shape[1]
    sigma = np.sqrt(np.mean(variance[later] + variance[first]))
    regressor = (model.regressor[later] - model.regressor[first]) / sigma
    response = (model.response[later] - model.response[first]) / sigma
    return Whitened(regressor.reshape(-1, regressor.shape[2]), response.ravel(), response.size, 0.0)


def solve(problem: Whitened, prior_mean: Array, prior_sigma: Array) -> Solution:
    """Return the parameters that fit best, under independent normal priors.

    Args:
        problem: Whitened rows.
        prior_mean: Shape (p,).
        prior_sigma: Shape (p,); inf where nothing is known beforehand.
    """
    prior_sigma = np.maximum(prior_sigma, SURE)
    precision = prior_sigma**-2.0
    information = problem.regressor.T @ problem.regressor
    normal = information + np.diag(precision)
    scale = 1 / np.sqrt(np.maximum(np.diag(normal), np.finfo(float).tiny))
    eigenvalues, vectors = np.linalg.eigh(normal * np.outer(scale, scale))
    eigenvalues = np.maximum(eigenvalues, EIGENVALUE_FLOOR * eigenvalues[-1])
    covariance = scale[:, None] * (vectors / eigenvalues) @ vectors.T * scale
    parameters = covariance @ (problem.regressor.T @ problem.response + precision * prior_mean)
    residual = problem.response - problem.regressor @ parameters
    is_prior = np.isfinite(prior_sigma)
    surprise = (parameters - prior_mean)[is_prior] / prior_sigma[is_prior]
    chi_square = float(residual @ residual + surprise @ surprise)
    log_normal = float(np.log(eigenvalues).sum() - 2 * np.log(scale).sum())
    log_prior = float(-2 * np.log(prior_sigma[is_prior]).sum())
    return Solution(
        parameters=parameters,
        covariance=covariance,
        information=information,
        residual=residual,
        chi_square=chi_square,
        degrees_of_freedom=problem.n_free - len(parameters) + int(is_prior.sum()),
        log_likelihood=-0.5 * (problem.log_determinant + log_normal - log_prior + chi_square),
    )


def _padded(series: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Return the rows of each series, shape (s, longest), and which of them are real; their order is kept."""
    _, label = np.unique(series, return_inverse=True)
    order = np.argsort(label, kind="stable")
    count = np.bincount(label)
    is_real = np.arange(count.max()) < count[:, None]
    rows = np.zeros(is_real.shape, dtype=np.int64)
    rows[is_real] = order
    return rows, is_real
