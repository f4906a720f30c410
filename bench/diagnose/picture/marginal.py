"""Inner products after nuisances were integrated out: all that comparing linear models needs.

With whitened residuals r, nuisance slopes A (prior one) and columns X of candidates, the covariance of r under the null
model is M = I + A A^T, and [r X]^T M^-1 [r X] holds every score, every loss of fit and every evidence.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import cho_factor, cho_solve, solve_triangular

from bench.diagnose.picture.design import Design
from bench.record.campaign import Array

JITTER = 1e-9


@dataclass(frozen=True, eq=False)
class Marginal:
    """Inner products under the null model.

    Attributes:
        misfit: Chi-square of the null model.
        scores: Shape (q,), X^T M^-1 r.
        information: Shape (q, q), X^T M^-1 X.
        n: Number of readings.
    """

    misfit: float
    scores: Array
    information: Array
    n: int

    def gain(self, columns: Array, prior: Array | None = None) -> float:
        """Return by how much chi-square falls with some columns; with a prior, by how much the penalised one falls."""
        b, h = self.scores[columns], self._penalised(columns, prior)
        return float(b @ np.linalg.solve(h, b))

    def sizes(self, columns: Array, prior: Array | None = None) -> tuple[Array, Array]:
        """Return the best sizes of some columns and their covariance."""
        covariance = np.asarray(np.linalg.inv(self._penalised(columns, prior)), dtype=np.float64)
        return covariance @ self.scores[columns], covariance

    def log_evidence(self, columns: Array, prior: Array) -> float:
        """Return the logarithm of the Bayes factor of some columns with normal priors against the null model."""
        h = self.information[np.ix_(columns, columns)]
        _, determinant = np.linalg.slogdet(np.eye(len(columns)) + prior[:, None] * h * prior)
        return 0.5 * self.gain(columns, prior) - 0.5 * float(determinant)

    def given(self, columns: Array, prior: Array | None = None) -> "Marginal":
        """Return the products with some columns in the model already."""
        if len(columns) == 0:
            return self
        factor = cho_factor(self._penalised(columns, prior))
        cross = self.information[:, columns]
        scores = self.scores - cross @ cho_solve(factor, self.scores[columns])
        information = self.information - cross @ cho_solve(factor, cross.T)
        misfit = self.misfit - float(self.scores[columns] @ cho_solve(factor, self.scores[columns]))
        return Marginal(misfit, scores, information, self.n)

    def _penalised(self, columns: Array, prior: Array | None) -> Array:
        h: Array = self.information[np.ix_(columns, columns)].copy()
        diagonal = np.diag(h)
        h[np.diag_indices_from(h)] += JITTER * np.maximum(diagonal, 1.0)
        if prior is not None:
            h[np.diag_indices_from(h)] += 1 / prior**2
        return h


class Nuisances:
    """Integrates nuisances out of whitened vectors.

    Args:
        slopes: Shape (m, p).
    """

    def __init__(self, slopes: Array) -> None:
        self.slopes = slopes
        self._factor = np.linalg.cholesky(np.eye(slopes.shape[1]) + slopes.T @ slopes)

    def products(self, white: Array, columns: Array) -> Marginal:
        """Return the inner products of a whitened residual, shape (m,), and columns, shape (m, q)."""
        both = np.concatenate([white[:, None], columns], axis=1)
        reduced = solve_triangular(self._factor, self.slopes.T @ both, lower=True)
        gram = both.T @ both - reduced.T @ reduced
        return Marginal(float(gram[0, 0]), gram[1:, 0], gram[1:, 1:], len(white))

    @cached_property
    def log_determinant(self) -> float:
        """Logarithm of det(I + A^T A)."""
        return 2 * float(np.sum(np.log(np.diag(self._factor))))


def marginal_of(design: Design, columns: Array) -> Marginal:
    """Return the products of a campaign's residual with some columns, shape (m, q)."""
    return Nuisances(design.slopes).products(design.white, columns)
