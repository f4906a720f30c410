"""How well the first pass, its rival and the nominal model predict what was held out of the fit."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

from bench.identify.dynamics.consistency import Bodies, nearest
from bench.identify.dynamics.folds import Folds
from bench.identify.dynamics.normal import Normal, Weighed, likeliest_widths, normal_of, posterior
from bench.identify.dynamics.prior import Prior
from bench.identify.dynamics.rival import Rival
from bench.identify.dynamics.solve import Solution
from bench.record.campaign import Array

SAME = 1.02  # declared: errors that differ by less are the same
MUCH = 1.1  # declared: a drive that is predicted worse by more is predicted worse, however few folds say so
ROUNDING = 1e-9  # rounding: of what was subtracted
SURE = 0.95  # declared: one-sided, by Student's t, for folds are few


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


@dataclass(frozen=True)
class Missed:
    """How far a posterior misses what it was not given; P parts of what is held out at a time, n drives.

    Attributes:
        squares: Shape (P, n) [Nm^2], sums over what was held out.
        expected: Shape (P, n) [Nm^2], what the posterior without the fold expects of them: noise and its own errors.
        readings: Shape (P, n), how many were held out.
    """

    squares: Array
    expected: Array
    readings: Array

    @property
    def excess(self) -> Array:
        """Shape (n,), how many times more is missed than expected, in squares, at least 1.

        A model that is wrong somewhere fits its own data better than those beside them; that is part of what its
        readings err by. What a fold alone shows is expected to be missed, and does not count.
        """
        squares, expected = self.squares.sum(axis=0), self.expected.sum(axis=0)
        return np.asarray(np.where(expected > 0, np.maximum(squares / np.where(expected > 0, expected, 1.0), 1.0), 1.0))

    @property
    def misfit(self) -> float:
        """Sum over the drives of the logarithm of what is missed, in squares."""
        squares = self.squares.sum(axis=0)
        return float(np.sum(np.log(squares[squares > 0])))

    def surely_less_than(self, other: "Missed", worse: float = MUCH) -> bool:
        """Return whether less is missed than by another model, by more than parts differ, and no drive surely by more.

        Each drive counts by the logarithm of its error, which is its likelihood with unknown noise.

        Args:
            other: What the other model misses of the same.
            worse: Times the error of a drive, from where it is worse however few folds say so.
        """
        ours, others = self.squares.sum(axis=0), other.squares.sum(axis=0)
        shown = (self.squares > 0) & (other.squares > 0)
        ratio = np.where(shown, other.squares, 1.0) / np.where(shown, self.squares, 1.0)
        gain = self.readings / 2 * np.log(ratio)
        if len(gain) < 2:
            return False
        suffers = (ours > SAME**2 * others) & (surely_positive(-gain) | (ours > worse**2 * others))
        return bool(not np.any(suffers) and surely_positive(gain.sum(axis=1, keepdims=True))[0])


def surely_positive(gain: Array) -> NDArray[np.bool_]:
    """Return which log likelihood ratios are above zero by more than folds differ, shape (n,).

    Their signed roots are compared, which are nearly normal, as the signed root of a deviance is (P. McCullagh,
    J. A. Nelder, "Generalized Linear Models", 1989, 2.4.2). The ratios themselves are skewed, for a fold in which all
    drives move tells a hundred times what another one does: of gains of 16, 26, 40, 94 and 505 the last made the others
    unsure.

    Args:
        gain: Shape (P, n) [nats], of each part of what is held out; P of 2 or more.
    """
    root = np.sign(gain) * np.sqrt(np.abs(gain))
    least = stdtrit(len(root) - 1, SURE) * root.std(axis=0, ddof=1) / np.sqrt(len(root))
    return np.asarray(root.mean(axis=0) > least)


def missed(solution: Solution, prior: Prior, folds: Folds) -> Missed:
    """Return how far the posterior without each fold misses it, at the noise that the solution has."""
    parts, count = folds.parts()
    size, late, shape = len(prior.mean), solution.delay, (count, len(solution.drives))
    squares, expected, readings = np.zeros(shape), np.zeros(shape), np.zeros(shape)
    responses = [one.rows.response(late) for one in solution.drives]
    for fold in range(len(folds)):
        out = [_rows_of(one, folds, fold, near=True) for one in solution.drives]
        without = solution.normal - _normal_of_rows(solution.drives, responses, out, size)
        parameters, covariance = posterior(without, prior, solution.widths)
        for j, (one, noise) in enumerate(zip(solution.drives, solution.noise, strict=True)):
            mine = _rows_of(one, folds, fold, near=False)
            if noise is None or not mine.any():
                continue
            factors, own = one.factors[mine], covariance[np.ix_(one.rows.index, one.rows.index)]
            error = (responses[j][mine] - one.rows.model(parameters)[mine]) ** 2
            unsure = noise.variance + np.sum((factors @ own) * factors, axis=1)
            part = _parts_of(one, parts)[mine]
            squares[:, j] += np.bincount(part, error, minlength=count)
            expected[:, j] += np.bincount(part, unsure, minlength=count)
            readings[:, j] += np.bincount(part, minlength=count)
    return Missed(squares, expected, readings)


@dataclass(frozen=True)
class Problems:
    """What first pass and plain least squares solve, with all readings in.

    Attributes:
        solution: Posterior of the first pass.
        plain: Rows as plain least squares takes them.
        prior: Of the parameters.
        bodies: Constraints of the first pass.
        rival: Plain least squares.
        payloads: Where the parameters of the payload of each recording stand.
    """

    solution: Solution
    plain: tuple[Weighed, ...]
    prior: Prior
    bodies: Bodies
    rival: Rival
    payloads: tuple[slice, ...] = ()

    def without(self, folds: Folds) -> Iterator[dict[str, Array]]:
        """Yield the parameters of each model, shape (p,), fitted without one fold after the other.

        Delay, noise and linearisation are those of the whole campaign; the widths of the prior are found anew. A
        payload that the fold alone carries is fitted to it, for nothing else could tell it.
        """
        size, late, solution, prior = len(self.prior.mean), self.solution.delay, self.solution, self.prior
        plain_normal = normal_of(self.plain, late, size)
        responses = [one.rows.response(late) for one in self.plain]
        for fold in range(len(folds)):
            out = [_rows_of(one, folds, fold, near=True) for one in self.plain]
            held = _normal_of_rows(solution.drives, responses, out, size)
            plain_held = _normal_of_rows(self.plain, responses, out, size)
            without = solution.normal - held
            widths = likeliest_widths(without, prior, solution.widths)
            free, factor = posterior(without, prior, widths)[0], prior.factor(widths)
            found = nearest(self.bodies, free, prior.mean, factor, without.gram)
            yield {
                "nominal": prior.mean,
                "rival": self._with_own_payload(self.rival.fit(plain_normal - plain_held), without, plain_held),
                "first_pass": self._with_own_payload(found, without, held),
            }

    def _with_own_payload(self, parameters: Array, without: Normal, held: Normal) -> Array:
        """Return parameters with the payload that nothing but what is held out carries, all else as given."""
        found = parameters.copy()
        for one in self.payloads:
            own = held.gram[one, one]
            if np.any(own) and np.all(np.diag(without.gram)[one] <= ROUNDING * np.diag(own)):
                found[one] = 0.0
                known = np.diag(1 / self.solution.prior_sigma[one] ** 2)
                found[one] = np.linalg.solve(own + known, (held.right - held.gram @ found)[one])
        return found


def hold_out(problems: Problems, folds: Folds) -> HeldOut:
    """Return the errors on each fold of models that were fitted to all others."""
    plain, n = problems.plain, len(problems.plain)
    count = np.zeros((len(folds), n))
    squares = {name: np.zeros((len(folds), n)) for name in ("measured", "nominal", "rival", "first_pass")}
    responses = [one.rows.response(problems.solution.delay) for one in plain]
    for fold, models in enumerate(problems.without(folds)):
        for j, one in enumerate(plain):
            mine = _rows_of(one, folds, fold, near=False)
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


def _parts_of(drive: Weighed, parts: Sequence[NDArray[np.int64]]) -> NDArray[np.int64]:
    """Return in which part of what is held out each row of a drive is, shape (R,)."""
    rows, found = drive.rows, np.full(len(drive.rows), -1)
    for stretch, part in enumerate(parts):
        mine = rows.stretch == stretch
        found[mine] = part[rows.instant[mine]]
    return found


def _normal_of_rows(
    drives: Sequence[Weighed], responses: Sequence[Array], rows: Sequence[NDArray[np.bool_]], size: int
) -> Normal:
    gram, right = np.zeros((size, size)), np.zeros(size)
    for one, response, mine in zip(drives, responses, rows, strict=True):
        factors = one.factors[mine]
        gram[np.ix_(one.rows.index, one.rows.index)] += one.weight * factors.T @ factors
        right[one.rows.index] += one.weight * factors.T @ (response + one.beyond)[mine]
    return Normal(gram, right)
