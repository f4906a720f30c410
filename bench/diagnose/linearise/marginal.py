"""Inner products after nuisances were integrated out: all that comparing linear models needs.

With whitened residuals r, nuisance slopes A (prior one) and columns X of candidates, the covariance of r under the null
model is M = I + A A^T, and [r X]^T M^-1 [r X] holds every score, every loss of fit and every evidence. With the
Cholesky factor L of I + A^T A, X^T M^-1 X = X^T X - R^T R, R = L^-1 A^T X. Only R depends on the model, so X^T X is
formed once for all models of a campaign.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_solve, solve_triangular
from scipy.special import log_ndtr

from bench.record.campaign import Array

Indices = NDArray[Any]
JITTER = 1e-9  # rounding: of a diagonal, added to it
AT_A_TIME = 1024  # effort: sums whose variances are found together: memory stays small


class Columns:
    """Whitened columns with their inner products, each formed when it is first needed.

    Args:
        matrix: Shape (m, q).
    """

    def __init__(self, matrix: Array) -> None:
        self._matrix: Array | None = matrix
        self._gram: Array | None = None
        self._slopes: Array | None = None
        self._cross: Array = np.empty((0, 0))

    @property
    def matrix(self) -> Array:
        """Shape (m, q).

        Raises:
            RuntimeError: It was let go.
        """
        if self._matrix is None:
            raise RuntimeError("these columns were let go: a later model has others")
        return self._matrix

    def let_go(self) -> None:
        """Let go of the matrix, the largest of a diagnosis; of the products the squares stay."""
        _ = self.squares
        self._matrix = self._gram = self._slopes = None

    @property
    def gram(self) -> Array:
        """Shape (q, q), X^T X."""
        if self._gram is None:
            self._gram = self.matrix.T @ self.matrix
        gram: Array = self._gram
        return gram

    @cached_property
    def squares(self) -> Array:
        """Shape (q,), diagonal of X^T X."""
        return np.asarray(np.einsum("ij,ij->j", self.matrix, self.matrix), dtype=np.float64)

    def products_of(self, columns: Indices) -> Array:
        """Return the inner products of E groups of k columns, shape (E, k, k), for indices of shape (E, k)."""
        if columns.shape[1] == 1:
            single: Array = self.squares[columns][:, :, None]
            return single
        if self._gram is not None:
            return np.asarray(self._gram[columns[:, :, None], columns[:, None, :]], dtype=np.float64)
        groups = (self.matrix[:, own] for own in columns)
        return np.stack([group.T @ group for group in groups])

    def with_slopes(self, jacobian: Array) -> Array:
        """Return A^T X, shape (p, q), for slopes of shape (m, p); only slopes that are new are multiplied."""
        if self._slopes is None or self._slopes.shape != jacobian.shape:
            self._cross = jacobian.T @ self.matrix
        elif jacobian is not self._slopes:
            new = np.flatnonzero(np.any(jacobian != self._slopes, axis=0))
            self._cross = self._cross.copy()
            self._cross[new] = jacobian[:, new].T @ self.matrix
        self._slopes = jacobian
        cross: Array = self._cross
        return cross

    def with_all(self, columns: Indices) -> Array:
        """Return the inner products of some columns with all, shape (k, q)."""
        products: Array = self.matrix[:, columns].T @ self.matrix
        return products


class Gram(Columns):
    """Columns that are known by their inner products alone.

    Args:
        gram: Shape (q, q), X^T X.
    """

    def __init__(self, gram: Array) -> None:
        super().__init__(np.empty((0, len(gram))))
        self._gram = gram

    @cached_property
    def squares(self) -> Array:
        """Shape (q,), diagonal of X^T X."""
        return np.diagonal(self.gram)

    def with_all(self, columns: Indices) -> Array:
        """Return the inner products of some columns with all, shape (k, q)."""
        products: Array = self.gram[columns]
        return products


@dataclass(frozen=True, eq=False)
class Marginal:
    """Inner products under the null model.

    Attributes:
        misfit: Chi-square of the null model.
        scores: Shape (q,), X^T M^-1 r.
        columns: X.
        reduced: Shape (p, q), R.
    """

    misfit: float
    scores: Array
    columns: Columns
    reduced: Array

    @cached_property
    def information(self) -> Array:
        """Shape (q, q), X^T M^-1 X."""
        information: Array = self.columns.gram - self.reduced.T @ self.reduced
        return information

    @property
    def multiplied(self) -> "Marginal":
        """The same with information in the place of X^T X and R, for many small blocks of it."""
        return Marginal(self.misfit, self.scores, Gram(self.information), np.empty((0, len(self.scores))))

    @property
    def diagonal(self) -> Array:
        """Shape (q,), of the information."""
        diagonal: Array = self.columns.squares - np.einsum("ij,ij->j", self.reduced, self.reduced)
        return diagonal

    def sizes(self, columns: Indices, prior: Array | None = None) -> tuple[Array, Array]:
        """Return the best sizes of some columns and their covariance."""
        covariance = np.asarray(np.linalg.inv(self._penalised(columns, prior)), dtype=np.float64)
        return covariance @ self.scores[columns], covariance

    def log_evidence(self, columns: Indices, prior: Array, sign: Array | None = None) -> float:
        """Return the logarithm of the Bayes factor of some columns against the null model, as of `log_evidences`."""
        signs = None if sign is None else sign[None]
        return float(self.log_evidences(columns[None], prior[None], signs)[0])

    def log_evidences(self, columns: Indices, prior: Array, sign: Array | None = None) -> Array:
        """Return the log evidence of E groups of k columns, shape (E,), for indices and priors of shape (E, k).

        Args:
            columns: Indices.
            prior: Standard deviations of normal priors.
            sign: Shape (E, k), of sizes that can have one sign only, with half-normal priors; None: either.
        """
        h, b = self._blocks(columns), self.scores[columns]
        every = np.arange(columns.shape[1])
        h[:, every, every] += JITTER * np.maximum(h[:, every, every], 1.0) + 1 / prior**2
        return log_evidences_of(h, b, prior, sign)

    def given(self, columns: Indices, prior: Array | None = None) -> "Marginal":
        """Return the products with some columns in the model already."""
        if len(columns) == 0:
            return self
        root = np.linalg.cholesky(self._penalised(columns, prior))
        cross = self.columns.with_all(columns) - self.reduced[:, columns].T @ self.reduced
        more = solve_triangular(root, np.column_stack([cross, self.scores[columns]]), lower=True)
        reduced, pull = more[:, :-1], more[:, -1]
        both = np.concatenate([self.reduced, reduced])
        return Marginal(self.misfit - float(pull @ pull), self.scores - pull @ reduced, self.columns, both)

    def _blocks(self, columns: Indices) -> Array:
        own = np.moveaxis(self.reduced[:, columns], 0, 1)
        blocks: Array = self.columns.products_of(columns) - own.transpose(0, 2, 1) @ own
        return blocks

    def _penalised(self, columns: Indices, prior: Array | None) -> Array:
        h: Array = self._blocks(columns[None])[0]
        diagonal = np.diag(h)
        h[np.diag_indices_from(h)] += JITTER * np.maximum(diagonal, 1.0)
        if prior is not None:
            h[np.diag_indices_from(h)] += 1 / prior**2
        return h


def log_evidences_of(h: Array, b: Array, prior: Array, sign: Array | None = None) -> Array:
    """Return the log evidence of E groups of k sizes, shape (E,), by their products.

    Args:
        h: Shape (E, k, k), information with that of the priors.
        b: Shape (E, k), scores.
        prior: Shape (E, k), standard deviations of normal priors.
        sign: Shape (E, k), of sizes that can have one sign only, with half-normal priors; 0 or None: either.
    """
    # closed for one or two: hundreds of calls of LAPACK for blocks that small take as long as the rest of a search
    determinant, inverse = _inverted(h) if h.shape[1] <= 2 else (None, None)
    mean = np.linalg.solve(h, b[:, :, None])[:, :, 0] if inverse is None else (inverse @ b[:, :, None])[:, :, 0]
    log_determinant = np.linalg.slogdet(h)[1] if determinant is None else np.log(determinant)
    found: Array = 0.5 * np.sum(mean * b, axis=1) - 0.5 * log_determinant - np.sum(np.log(prior), axis=1)
    if sign is not None and np.any(sign):
        variance = np.diagonal(np.linalg.inv(h) if inverse is None else inverse, axis1=1, axis2=2)
        found = found + log_half_normal(mean * sign, np.sqrt(variance), sign).sum(axis=1)
    return found


def _inverted(h: Array) -> tuple[Array, Array]:
    """Return the determinants and the inverses of E matrices of one or two rows, shape (E, 1, 1) or (E, 2, 2)."""
    if h.shape[1] == 1:
        return h[:, 0, 0], 1 / h
    (a, b), (c, d) = h.transpose(1, 2, 0)
    determinant = a * d - b * c
    adjugate = np.array([[d, -b], [-c, a]]).transpose(2, 0, 1)
    return determinant, adjugate / determinant[:, None, None]


def log_half_normal(mean: Array, deviation: Array, sign: Array) -> Array:
    """Return the logarithm of what a half-normal prior makes of the evidence of a normal one, same shape.

    Args:
        mean: Posterior mean of each size under the normal prior, positive where it has its sign.
        deviation: Its standard deviation.
        sign: 0 where both signs are possible: 0 then.
    """
    return np.asarray(np.where(sign == 0, 0.0, np.log(2) + log_ndtr(mean / deviation)), dtype=np.float64)


class Nuisances:
    """Integrates nuisances out of whitened vectors.

    Args:
        jacobian: Shape (m, p).
    """

    def __init__(self, jacobian: Array) -> None:
        self.jacobian = jacobian
        self._factor = np.linalg.cholesky(np.eye(jacobian.shape[1]) + jacobian.T @ jacobian)

    @property
    def log_determinant(self) -> float:
        """Half of the logarithm of the determinant of M, the covariance of whitened readings."""
        return float(np.sum(np.log(np.diag(self._factor))))

    def reduced(self, cross: Array) -> Array:
        """Return R, shape (p, k), for A^T X, shape (p, k)."""
        return np.asarray(solve_triangular(self._factor, cross, lower=True), dtype=np.float64)

    def most_probable(self, white: Array) -> Array:
        """Return the most probable sizes of all nuisances, shape (p,), for whitened residuals of shape (m,)."""
        return np.asarray(cho_solve((self._factor, True), self.jacobian.T @ white), dtype=np.float64)

    def covariance_with(self, weights: Array) -> Array:
        """Return the covariance of the sizes of all nuisances with weighted sums of them, shape (p, n) as weights."""
        return np.asarray(cho_solve((self._factor, True), weights), dtype=np.float64)

    def variances(self, weights: Array) -> Array:
        """Return the variances of weighted sums of the sizes of nuisances, shape (n,), for weights of shape (n, p)."""
        found = np.empty(len(weights))
        for start in range(0, len(weights), AT_A_TIME):
            reduced = self.reduced(weights[start : start + AT_A_TIME].T)
            found[start : start + AT_A_TIME] = np.einsum("ij,ij->j", reduced, reduced)
        return found

    def regression(self, known: Array, columns: Array) -> Array:
        """Return the coefficients of columns, shape (m, k), on known ones, shape (m, n): shape (n, k)."""
        reduced = [self.reduced(self.jacobian.T @ some) for some in (known, columns)]
        information = known.T @ known - reduced[0].T @ reduced[0]
        information[np.diag_indices_from(information)] += JITTER * np.maximum(np.diag(information), 1.0)
        cross = known.T @ columns - reduced[0].T @ reduced[1]
        return np.asarray(np.linalg.solve(information, cross), dtype=np.float64)

    def products(self, white: Array, columns: Array | Columns) -> Marginal:
        """Return the inner products of a whitened residual, shape (m,), and columns, shape (m, q)."""
        if not isinstance(columns, Columns):
            columns = Columns(columns)
        reduced = self.reduced(columns.with_slopes(self.jacobian))
        pull = self.reduced(self.jacobian.T @ white)
        scores = columns.matrix.T @ white - pull @ reduced
        return Marginal(float(white @ white - pull @ pull), scores, columns, reduced)
