"""Posterior of one subset of what may be wrong, linearised, and by how much each further term would raise it.

With whitened residuals r of the model without any finding and columns X, background and nuisances integrated out
(`linearise/marginal.py`), the evidence of a subset S with normal priors P^2 is closed:

    log E(S) = 1/2 s' H^-1 s - 1/2 log det(P H P),    H = G + P^-2,    G = X' M^-1 X,  s = X' M^-1 r

A size that has one sign only has a half-normal prior, which multiplies the evidence by 2 Phi(mean / deviation).
"""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg.lapack import dtrtrs

from bench.diagnose.linearise.marginal import JITTER, log_evidences_of, log_half_normal
from bench.record.campaign import Array


@dataclass(frozen=True, eq=False)
class Term:
    """Something that may be in the model; k columns.

    Attributes:
        key: What it is. Terms with the same key are different shapes of it, and exclude each other.
        columns: Shape (k,), indices into all columns.
        prior: Shape (k,), standard deviations of the columns' sizes.
        log_odds: Logarithm of its prior odds.
        sign: Shape (k,), of the columns whose size can only be positive (1) or negative (-1); 0: either.
        is_listed: Whether a search may add it; other terms are in its subsets only where it is told so.
        needs: Keys of the terms without which it has no place: more friction needs friction that was found.
        most: Shape (k,), sizes of the columns beyond which it is something else, either way; None: any will do.
    """

    key: Hashable
    columns: Array
    prior: Array
    log_odds: float
    sign: Array
    is_listed: bool = True
    needs: frozenset[Hashable] = frozenset()
    most: Array | None = None


class SubsetPosterior:
    """A linearised model with everything that may be added to it.

    Args:
        information: Shape (q, q), X' M^-1 X.
        scores: Shape (q,), X' M^-1 r.
        terms: What may be added.
    """

    def __init__(self, information: Array, scores: Array, terms: Sequence[Term]) -> None:
        self.information, self.scores, self.terms = information, scores, tuple(terms)

    def log_posterior(self, which: Sequence[int]) -> float:
        """Return the log posterior odds of some terms against none; -inf where one has no place, or is too large."""
        if not which:
            return 0.0
        terms = [self.terms[i] for i in which]
        if not frozenset().union(*(term.needs for term in terms)) <= {term.key for term in terms}:
            return -np.inf
        prior, sign = np.concatenate([t.prior for t in terms]), np.concatenate([t.sign for t in terms])
        root, pull = self._root(which)
        if any(term.most is not None for term in terms):
            most = np.concatenate([np.full(len(t.prior), np.inf) if t.most is None else t.most for t in terms])
            if np.any(np.abs(self._sizes(root, pull)) > most):
                return -np.inf
        total = 0.5 * float(pull @ pull) - float(np.sum(np.log(np.diag(root)))) - float(np.sum(np.log(prior)))
        if np.any(sign):
            inverse = _solved(root, np.eye(len(root)))
            mean, deviation = pull @ inverse, np.sqrt(np.sum(inverse**2, axis=0))
            total += float(np.sum(log_half_normal(mean * sign, deviation, sign)))
        return total + sum(term.log_odds for term in terms)

    @staticmethod
    def _sizes(root: Array, pull: Array) -> Array:
        return _solved(root, pull, transposed=True)

    def additions(self, which: Sequence[int]) -> Array:
        """Return by how much the log posterior odds rise with each term added to some, shape (number of terms,).

        What a size with one sign says of the terms that are there already is left out. -inf where a term excludes
        one that is there, or has no place.
        """
        score, reduced = self.scores, np.zeros((0, len(self.scores)))
        if which:
            root, pull = self._root(which)
            columns = np.concatenate([self.terms[i].columns for i in which])
            reduced = _solved(root, self.information[columns])
            score = score - pull @ reduced
        across = np.ascontiguousarray(reduced.T)
        rise = np.full(len(self.terms), -np.inf)
        for members, columns, prior, sign, odds, own in self._groups:
            there = across[columns]
            h = own - there @ there.transpose(0, 2, 1)
            rise[members] = log_evidences_of(h, score[columns], prior, sign) + odds
        for i in which:
            rise[self._same[self.terms[i].key]] = -np.inf
        taken = {self.terms[i].key for i in which}
        rise[[i for i, needs in self._needing if not needs <= taken]] = -np.inf
        return rise

    def equations(self, which: Sequence[int]) -> tuple[Array, Array]:
        """Return H and s of the columns of some terms, one term after the other; their sizes x solve H x = s."""
        columns = np.concatenate([self.terms[i].columns for i in which])
        prior = np.concatenate([self.terms[i].prior for i in which])
        h: Array = self.information[np.ix_(columns, columns)].copy()
        h[np.diag_indices_from(h)] += 1 / prior**2 + JITTER * np.maximum(np.diag(h), 1.0)
        return h, self.scores[columns]

    def _root(self, which: Sequence[int]) -> tuple[Array, Array]:
        """Return the Cholesky factor L of H and L^-1 s of the columns of some terms."""
        h, scores = self.equations(which)
        root = np.asarray(np.linalg.cholesky(h), dtype=np.float64)
        return root, _solved(root, scores)

    @cached_property
    def _same(self) -> dict[Hashable, list[int]]:
        """Indices of the terms of each key."""
        found: dict[Hashable, list[int]] = {}
        for i, term in enumerate(self.terms):
            found.setdefault(term.key, []).append(i)
        return found

    @cached_property
    def _needing(self) -> list[tuple[int, frozenset[Hashable]]]:
        """Terms that have a place beside others alone, and what these are."""
        return [(i, term.needs) for i, term in enumerate(self.terms) if term.needs]

    @cached_property
    def _groups(self) -> list[tuple[Array, Array, Array, Array, Array, Array]]:
        """Terms with as many columns: their indices, columns, priors, signs, prior odds, and own H."""
        by_size: dict[int, list[int]] = {}
        for i, term in enumerate(self.terms):
            by_size.setdefault(len(term.columns), []).append(i)
        groups = []
        for k, members in by_size.items():
            columns, prior, sign = (
                np.stack([getattr(self.terms[i], name) for i in members]) for name in ("columns", "prior", "sign")
            )
            own = self.information[columns[:, :, None], columns[:, None, :]]
            own = own + _diagonal(1 / prior**2 + JITTER * np.maximum(np.diagonal(own, axis1=1, axis2=2), 1.0))
            odds = np.array([self.terms[i].log_odds for i in members])
            groups.append((np.array(members), columns.reshape(-1, k), prior, sign, odds, own))
        return groups


def _solved(root: Array, right: Array, *, transposed: bool = False) -> Array:
    """Return L^-1 b, or L^-T b, of a lower triangular L, without checks that take as long as a small system itself."""
    return np.asarray(dtrtrs(root, right, lower=1, trans=int(transposed))[0], dtype=np.float64)


def _diagonal(values: Array) -> Array:
    """Return diagonal matrices, shape (E, k, k), of their diagonals, shape (E, k)."""
    full = np.zeros((*values.shape, values.shape[1]))
    every = np.arange(values.shape[1])
    full[:, every, every] = values
    return full
