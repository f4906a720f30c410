"""A linear model with priors, fitted to a whole campaign, and what one more column would explain of it."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve, solve_triangular

from bench.record.campaign import Array

FREE = 1e-9  # rounding: precision of a column that has no prior, in units of its own information
TWICE = 2  # effort: times that the errors of readings are taken from what the fit before left
OWN = 1e-9  # rounding: of the information of a column, that it has beside all others


@dataclass(frozen=True, eq=False)
class LinearFit:
    """A fit; T instants, c quantities, k columns.

    Attributes:
        residual: Shape (T, c); nan where nothing was measured.
        columns: Shape (T, c, k), with a prior of one.
        errors: Shape (T, c), standard deviations of the readings.
        more: Shape (T, c, q), without a prior.
    """

    residual: Array
    columns: Array
    errors: Array
    more: Array

    @property
    def weights(self) -> Array:
        """Shape (T, c), 0 where nothing was measured."""
        return np.where(np.isfinite(self.residual), 1 / self.errors, 0.0)

    @cached_property
    def _matrix(self) -> Array:
        """Whitened columns, shape (T, c, k + q); those without a prior as long as one."""
        free = self.more * self.weights[:, :, None]
        free = free / np.maximum(np.linalg.norm(free, axis=(0, 1)), OWN)
        return np.concatenate([self.columns * self.weights[:, :, None], free], axis=2)

    @cached_property
    def _factor(self) -> tuple[Array, bool]:
        """Cholesky factor of the information of all columns."""
        flat = self._flat(self._matrix)
        precision = np.where(np.arange(flat.shape[1]) < self.columns.shape[2], 1.0, FREE)
        factor, lower = cho_factor(flat.T @ flat + np.diag(precision), lower=True)
        return np.tril(factor), lower

    @cached_property
    def left(self) -> Array:
        """Whitened residual of the fit, shape (T, c), 0 where nothing was measured."""
        white = np.nan_to_num(self.residual) * self.weights
        flat = self._flat(self._matrix)
        found: Array = white - self._matrix @ cho_solve(self._factor, flat.T @ white.ravel())
        return found

    @cached_property
    def explained(self) -> Array:
        """What columns with a prior explain of the residual, shape (T, c)."""
        flat, white = self._flat(self._matrix), np.nan_to_num(self.residual) * self.weights
        sizes = cho_solve(self._factor, flat.T @ white.ravel())
        found: Array = self.columns @ sizes[: self.columns.shape[2]]
        return found

    def products(self, rows: NDArray[np.bool_], columns: Array) -> tuple[Array, Array]:
        """Return scores, shape (p,), and information, shape (p, p), of columns that act in some rows alone.

        All that the model has is integrated out: the score is that of what others predict for these rows.

        Args:
            rows: Shape (T,), of which there are t.
            columns: Shape (t, c, p).
        """
        white = self._flat(columns * self.weights[rows][:, :, None])
        cross = self._flat(self._matrix[rows]).T @ white
        reduced = solve_triangular(self._factor[0], cross, lower=True)
        return white.T @ self.left[rows].ravel(), white.T @ white - reduced.T @ reduced

    def with_more(self, column: Array) -> "LinearFit":
        """Return the fit with one more column without a prior, shape (T, c)."""
        more = np.concatenate([self.more, column[:, :, None]], axis=2)
        return LinearFit(self.residual, self.columns, self.errors, more)

    @staticmethod
    def _flat(values: Array) -> Array:
        return values.reshape(-1, values.shape[2])


def fitted(residual: Array, columns: Array, errors: Array, kinds: Sequence[NDArray[np.str_]]) -> LinearFit:
    """Return a fit, with errors of readings as large as what it leaves of the run in the middle, where that is more.

    Args:
        residual: Shape (T, c); nan where nothing was measured.
        columns: Shape (T, c, k), with a prior of one.
        errors: Shape (T, c), by the instruments.
        kinds: For each kind of run, at rest and in motion, the run of every instant, shape (T,); "" where of another.
    """
    free = np.zeros((*residual.shape, 0))
    fit = LinearFit(residual, columns, errors, free)
    for _ in range(TWICE):
        left = np.where(np.isfinite(residual), fit.left * fit.errors, np.nan)
        raised = errors.copy()
        for run_of in kinds:
            rows = run_of != ""
            for c in range(residual.shape[1]):
                squares = [_mean_square(left[run_of == run, c]) for run in np.unique(run_of[rows])]
                if known := [one for one in squares if np.isfinite(one)]:
                    raised[rows, c] = np.maximum(errors[rows, c], np.sqrt(np.median(known)))
        fit = LinearFit(residual, columns, raised, free)
    return fit


def _mean_square(values: Array) -> float:
    """Return the mean square of what was measured, nan of nothing."""
    known = values[np.isfinite(values)]
    return float(np.mean(known**2)) if len(known) else np.nan
