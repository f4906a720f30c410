"""How well the first pass, its rival and the nominal model predict what was held out of the fit."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.identify.dynamics.consistency import Bodies, nearest
from bench.identify.dynamics.folds import Folds
from bench.identify.dynamics.normal import Normal, Weighed, likeliest_widths, normal_of, posterior
from bench.identify.dynamics.prior import Prior
from bench.identify.dynamics.rival import Rival
from bench.identify.dynamics.solve import Solution
from bench.record.campaign import Array


@dataclass(frozen=True)
class HeldOut:
    """Squared errors on what was held out; K folds, n drives.

    Attributes:
        count: Shape (K, n), readings in each.
        squares: "measured", "nominal", "rival" or "first_pass" -> shape (K, n) [Nm^2], sums; "measured" of the torque.
    """

    count: Array
    squares: dict[str, Array]

    def rms(self, model: str, fold: int | None = None) -> Array:
        """Return the root mean square error of a model, shape (n,) [Nm]; nan where nothing was held out."""
        rows = slice(None) if fold is None else slice(fold, fold + 1)
        count = self.count[rows].sum(axis=0)
        total = self.squares[model][rows].sum(axis=0)
        return np.asarray(np.where(count > 0, np.sqrt(total / np.maximum(count, 1)), np.nan))


def excess(solution: Solution, prior: Prior, folds: Folds) -> Array:
    """Return how many times what was held out is missed by more than the posterior expects, in squares, at least 1.

    Shape (n,). A model that is wrong somewhere fits its own data better than those beside them; that is part of what
    its readings err by. What a fold alone shows is expected to be missed, and does not count.
    """
    size, late = len(prior.mean), solution.delay
    missed, expected = np.zeros((2, len(solution.drives)))
    responses = [one.rows.response(late) for one in solution.drives]
    for fold in range(len(folds)):
        out = [_rows_of(one, folds, fold, near=True) for one in solution.drives]
        parameters, covariance = posterior(
            solution.normal - _normal_of_rows(solution.drives, responses, out, size), prior, solution.widths
        )
        for j, (one, noise) in enumerate(zip(solution.drives, solution.noise, strict=True)):
            mine = _rows_of(one, folds, fold, near=False)
            if noise is None or not mine.any():
                continue
            factors, own = one.factors[mine], covariance[np.ix_(one.rows.index, one.rows.index)]
            missed[j] += np.sum((responses[j][mine] - one.rows.model(parameters)[mine]) ** 2)
            expected[j] += mine.sum() * noise.variance + np.sum((factors @ own) * factors)
    return np.asarray(np.where(expected > 0, np.maximum(missed / np.where(expected > 0, expected, 1.0), 1.0), 1.0))


def hold_out(
    solution: Solution, plain: Sequence[Weighed], prior: Prior, bodies: Bodies, rival: Rival, folds: Folds
) -> HeldOut:
    """Return the errors on each fold of models that were fitted to all others.

    Delay, noise and linearisation are those of the whole campaign; the widths of the prior are found anew.
    """
    n, size, late = len(plain), len(prior.mean), solution.delay
    count = np.zeros((len(folds), n))
    squares = {name: np.zeros((len(folds), n)) for name in ("measured", "nominal", "rival", "first_pass")}
    plain_normal = normal_of(plain, late, size)
    responses = [one.rows.response(late) for one in plain]
    for fold in range(len(folds)):
        held = [_rows_of(one, folds, fold, near=False) for one in plain]
        out = [_rows_of(one, folds, fold, near=True) for one in plain]
        without = solution.normal - _normal_of_rows(solution.drives, responses, out, size)
        widths = likeliest_widths(without, prior, solution.widths)
        free, factor = posterior(without, prior, widths)[0], prior.factor(widths)
        models = {
            "nominal": prior.mean,
            "rival": rival.fit(plain_normal - _normal_of_rows(plain, responses, out, size)),
            "first_pass": nearest(bodies, free, prior.mean, factor, without.gram),
        }
        for j, (one, mine) in enumerate(zip(plain, held, strict=True)):
            count[fold, j] = mine.sum()
            squares["measured"][fold, j] = np.sum((responses[j] + one.rows.known)[mine] ** 2)
            for name, parameters in models.items():
                squares[name][fold, j] = np.sum((responses[j] - one.rows.model(parameters))[mine] ** 2)
    return HeldOut(count, squares)


def _rows_of(drive: Weighed, folds: Folds, fold: int, near: bool) -> NDArray[np.bool_]:
    """Return which rows of a drive a fold holds out, and with `near` those beside it too, shape (R,) bool."""
    rows, found = drive.rows, np.zeros(len(drive.rows), dtype=np.bool_)
    for stretch, (of, beside) in enumerate(zip(folds.of, folds.near, strict=True)):
        mine = rows.stretch == stretch
        instant = rows.instant[mine]
        found[mine] = (of[instant] == fold) | (beside[instant, fold] if near else False)
    return found


def _normal_of_rows(
    drives: Sequence[Weighed], responses: Sequence[Array], rows: Sequence[NDArray[np.bool_]], size: int
) -> Normal:
    gram, right = np.zeros((size, size)), np.zeros(size)
    for one, response, mine in zip(drives, responses, rows, strict=True):
        factors = one.factors[mine]
        gram[np.ix_(one.rows.index, one.rows.index)] += one.weight * factors.T @ factors
        right[one.rows.index] += one.weight * factors.T @ response[mine]
    return Normal(gram, right)
