"""A linear model with priors, fitted to a whole campaign, and what one more column would explain of it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_solve, solve_triangular

from bench.diagnose.plausibility.drive_looks import TOLD
from bench.record.campaign import Array

FREE = 1e-9  # rounding: precision of a column without a prior, whitened and as long as one
JITTER = 1e-10  # rounding: of a diagonal, added to it; columns far larger than any noise are alike within that
OWN = 1e-9  # rounding: of the information of a column, that it has beside all others
TWICE = 2  # effort: times that the errors of readings are taken from what the fit before left


@dataclass(frozen=True, eq=False)
class LinearFit:
    """A fit; T instants, c quantities, m readings, k columns with a prior of one, q without a prior.

    Attributes:
        residual: Shape (T, c); nan where nothing was measured.
        columns: Shape (T, c, k), those with a prior.
        errors: Shape (T, c), standard deviations of the readings.
        matrix: Shape (m, k + q), all columns, whitened; those without a prior as long as one.
        factor: Shape (k + q, k + q), lower Cholesky factor of their information.
    """

    residual: Array
    columns: Array
    errors: Array
    matrix: Array
    factor: Array

    @classmethod
    def of(cls, residual: Array, columns: Array, errors: Array) -> "LinearFit":
        """Return a fit of columns with a prior of one, shape (T, c, k)."""
        seen = np.isfinite(residual)
        matrix = columns[seen] / errors[seen][:, None]
        information = matrix.T @ matrix
        information[np.diag_indices_from(information)] *= 1 + JITTER
        information[np.diag_indices_from(information)] += 1.0
        return cls(residual, columns, errors, matrix, np.asarray(np.linalg.cholesky(information), dtype=np.float64))

    def with_more(self, column: Array) -> "LinearFit":
        """Return the fit with one more column without a prior, shape (T, c)."""
        white = column[self.seen] / self.errors[self.seen]
        length = float(np.linalg.norm(white))
        if length == 0:
            return self
        white /= length
        reduced = solve_triangular(self.factor, self.matrix.T @ white, lower=True)
        own = float(np.sqrt(max(1 + FREE - reduced @ reduced, FREE)))
        k = len(self.factor)
        factor = np.zeros((k + 1, k + 1))
        factor[:k, :k], factor[k, :k], factor[k, k] = self.factor, reduced, own
        return replace(self, matrix=np.column_stack([self.matrix, white]), factor=factor)

    @cached_property
    def seen(self) -> NDArray[np.bool_]:
        """Shape (T, c), m of them."""
        return np.isfinite(self.residual)

    @cached_property
    def _white(self) -> Array:
        return np.asarray(self.residual[self.seen] / self.errors[self.seen])

    @cached_property
    def _sizes(self) -> Array:
        """Shape (k + q,)."""
        return np.asarray(cho_solve((self.factor, True), self.matrix.T @ self._white))

    @cached_property
    def _left(self) -> Array:
        """Whitened residual of the fit, shape (m,)."""
        return self._white - self.matrix @ self._sizes

    @cached_property
    def left(self) -> Array:
        """Residual of the fit, shape (T, c); nan where nothing was measured."""
        found = np.full(self.residual.shape, np.nan)
        found[self.seen] = self._left * self.errors[self.seen]
        return found

    @cached_property
    def explained(self) -> Array:
        """What columns with a prior explain of the residual, shape (T, c)."""
        found: Array = self.columns @ self._sizes[: self.columns.shape[2]]
        return found

    def products(self, rows: NDArray[np.bool_], columns: Array) -> tuple[Array, Array]:
        """Return scores, shape (p,), and information, shape (p, p), of columns that act in some rows alone.

        All that the model has is integrated out: the score is that of what others predict for these rows. Both are 0 of
        columns that have next to nothing of their own beside the model.

        Args:
            rows: Shape (T,), of which there are t.
            columns: Shape (t, c, p).
        """
        mine = np.nonzero(self.seen)[0]
        own, seen = rows[mine], self.seen[rows]
        white = columns[seen] / self.errors[rows][seen][:, None]
        reduced = solve_triangular(self.factor, self.matrix[own].T @ white, lower=True)
        before, information = white.T @ white, white.T @ white - reduced.T @ reduced
        told = np.diag(information) > TOLD**2 * np.diag(before)
        return told * (white.T @ self._left[own]), information * np.outer(told, told)


def fitted(residual: Array, columns: Array, errors: Array, kinds: Sequence[NDArray[np.str_]]) -> LinearFit:
    """Return a fit, with errors of readings as large as what it leaves of the run in the middle, where that is more.

    Args:
        residual: Shape (T, c); nan where nothing was measured.
        columns: Shape (T, c, k), with a prior of one.
        errors: Shape (T, c), by the instruments.
        kinds: For each kind of run, at rest and in motion, the run of every instant, shape (T,); "" where of another.
    """
    fit = LinearFit.of(residual, columns, errors)
    for _ in range(TWICE):
        raised = errors.copy()
        for run_of in kinds:
            rows = run_of != ""
            for c in range(residual.shape[1]):
                squares = [_mean_square(fit.left[run_of == run, c]) for run in np.unique(run_of[rows])]
                if known := [one for one in squares if np.isfinite(one)]:
                    raised[rows, c] = np.maximum(errors[rows, c], np.sqrt(np.median(known)))
        fit = LinearFit.of(residual, columns, raised)
    return fit


def _mean_square(values: Array) -> float:
    """Return the mean square of what was measured, nan of nothing."""
    known = values[np.isfinite(values)]
    return float(np.mean(known**2)) if len(known) else np.nan


def gain_of(
    scores: Array, information: Array, mine: NDArray[np.int64], beside: NDArray[np.int64]
) -> tuple[Array, float]:
    """Return the numbers of some columns, and twice the logarithm of what they gain, beside others that act as well."""
    both = np.concatenate([mine, beside])
    values, gain = _solved(scores[both], information[np.ix_(both, both)])
    return values[: len(mine)], gain - _solved(scores[beside], information[np.ix_(beside, beside)])[1]


def _solved(scores: Array, information: Array) -> tuple[Array, float]:
    if not len(scores):
        return scores, 0.0
    size = np.sqrt(np.maximum(np.diag(information), 0.0))
    there = size > OWN * np.max(size, initial=0.0)
    values = np.zeros(len(scores))
    if np.any(there):
        scale = size[there]
        values[there] = np.linalg.pinv(information[np.ix_(there, there)] / np.outer(scale, scale), rcond=OWN**0.5) @ (
            scores[there] / scale
        )
        values[there] /= scale
    return values, float(values @ scores)
