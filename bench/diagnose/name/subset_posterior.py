"""Posterior of one subset of what may be wrong, linearised, and by how much each further term would raise it.

With whitened residuals r of the model without any finding and columns X, background and nuisances integrated out
(`linearise/marginal.py`), the evidence of a subset S with normal priors P^2 is closed:

    log E(S) = 1/2 s' H^-1 s - 1/2 log det(P H P),    H = G + P^-2,    G = X' M^-1 X,  s = X' M^-1 r

A size that has one sign only has a half-normal prior, which multiplies the evidence by 2 Phi(mean / deviation).
"""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dpotrf, dtrtrs

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
        self._added: dict[bool | None, _Added] = {}

    def log_posterior(self, which: Sequence[int]) -> float:
        """Return the log posterior odds of some terms against none; -inf where one has no place, or is too large."""
        if not which:
            return 0.0
        terms = [self.terms[i] for i in which]
        if any(term.needs for term in terms):
            taken = {term.key for term in terms}
            if not all(term.needs <= taken for term in terms):
                return -np.inf
        rows = self._all.rows_of(which)
        root, pull = self._root(rows)
        most, sign = self._all.most[rows], self._all.sign[rows]
        if np.any(np.isfinite(most)) and np.any(np.abs(_solved(root, pull, transposed=True)) > most):
            return -np.inf
        total = 0.5 * float(pull @ pull) - float(np.log(root.diagonal() * self._all.prior[rows]).sum())
        if np.any(sign):
            inverse = _solved(root, np.eye(len(root)))
            mean, deviation = pull @ inverse, np.sqrt(np.sum(inverse**2, axis=0))
            total += float(np.sum(log_half_normal(mean * sign, deviation, sign)))
        return total + sum(term.log_odds for term in terms)

    def additions(self, which: Sequence[int], *, listed: bool | None = None) -> Array:
        """Return by how much the log posterior odds rise with each term added to some, shape (number of terms,).

        What a size with one sign says of the terms that are there already is left out. -inf where a term excludes
        one that is there, or has no place.

        Args:
            which: Indices of the terms that are there.
            listed: True: of the terms that are listed alone; False: of those that are not; the others have -inf.
        """
        added = self._added_of(listed)
        score, reduced = self.scores[added.columns], np.zeros((0, len(added.columns)))
        if which:
            rows = self._all.rows_of(which)
            root, pull = self._root(rows)
            reduced = _solved(root, added.information[self._all.columns[rows]])
            score = score - pull @ reduced
        across = np.ascontiguousarray(reduced.T)
        rise = np.full(len(self.terms), -np.inf)
        for group in added.groups:
            there = across[group.columns]
            h = group.own - there @ there.transpose(0, 2, 1)
            rise[group.members] = log_evidences_of(h, score[group.columns], group.prior, group.sign) + group.log_odds
        for i in which:
            rise[self._same[self.terms[i].key]] = -np.inf
        taken = {self.terms[i].key for i in which}
        rise[[i for i, needs in self._needing if not needs <= taken]] = -np.inf
        return rise

    def equations(self, which: Sequence[int]) -> tuple[Array, Array]:
        """Return H and s of the columns of some terms, one term after the other; their sizes x solve H x = s."""
        return self._equations(self._all.rows_of(which))

    def _equations(self, rows: NDArray[np.intp]) -> tuple[Array, Array]:
        columns = self._all.columns[rows]
        h: Array = self.information[columns[:, None], columns]
        h.reshape(-1)[:: len(h) + 1] += self._all.own[rows]
        return h, self.scores[columns]

    def _root(self, rows: NDArray[np.intp]) -> tuple[Array, Array]:
        """Return the Cholesky factor L of H and L^-1 s of some columns of all terms."""
        h, scores = self._equations(rows)
        root, fault = dpotrf(h, lower=1, overwrite_a=0)
        if fault:
            raise np.linalg.LinAlgError("Matrix is not positive definite")
        return root, _solved(root, scores)

    @cached_property
    def _all(self) -> "_Flat":
        """The columns of all terms."""
        columns, prior, sign = (
            np.concatenate([np.empty(0), *(getattr(term, name) for term in self.terms)])
            for name in ("columns", "prior", "sign")
        )
        most = [np.full(len(t.prior), np.inf) if t.most is None else t.most for t in self.terms]
        indices = columns.astype(np.intp)
        own = 1 / prior**2 + JITTER * np.maximum(self.information.diagonal()[indices], 1.0)
        ends = np.cumsum([0, *(len(term.columns) for term in self.terms)])
        rows = tuple(np.arange(first, end) for first, end in pairwise(ends.tolist()))
        return _Flat(rows, indices, prior, sign, np.concatenate([np.empty(0), *most]), own)

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

    def _added_of(self, listed: bool | None) -> "_Added":
        """Return what may be added, as of `additions`."""
        if listed not in self._added:
            by_size: dict[int, list[int]] = {}
            for i, term in enumerate(self.terms):
                if listed is None or term.is_listed == listed:
                    by_size.setdefault(len(term.columns), []).append(i)
            every = [self._all.rows[i] for members in by_size.values() for i in members]
            columns = np.unique(self._all.columns[np.concatenate([np.empty(0, dtype=np.intp), *every])])
            information = np.asfortranarray(self.information[:, columns])
            groups = tuple(self._group(members, columns) for members in by_size.values())
            self._added[listed] = _Added(columns, information, groups)
        return self._added[listed]

    def _group(self, members: Sequence[int], among: NDArray[np.intp]) -> "_Group":
        rows = np.stack([self._all.rows[i] for i in members])
        columns = self._all.columns[rows]
        own = self.information[columns[:, :, None], columns[:, None, :]] + _diagonal(self._all.own[rows])
        prior, sign, odds = self._all.prior[rows], self._all.sign[rows], [self.terms[i].log_odds for i in members]
        return _Group(np.array(members), np.searchsorted(among, columns), prior, sign, np.array(odds), own)


@dataclass(frozen=True, eq=False)
class _Flat:
    """The columns of all terms, one term after the other; n in all.

    Attributes:
        rows: Where those of each term stand.
        columns: Shape (n,), indices into all columns; prior, sign and most as those of a `Term`.
        own: Shape (n,), what the priors, and rounding, add to the diagonal of the information.
    """

    rows: tuple[NDArray[np.intp], ...]
    columns: NDArray[np.intp]
    prior: Array
    sign: Array
    most: Array
    own: Array

    def rows_of(self, which: Sequence[int]) -> NDArray[np.intp]:
        """Return where the columns of some terms stand, one term after the other."""
        return np.concatenate([self.rows[i] for i in which])


@dataclass(frozen=True, eq=False)
class _Group:
    """E terms of k columns each.

    Attributes:
        members: Shape (E,), their indices.
        columns: Shape (E, k), where theirs stand among those that may be added; prior and sign as those of a `Term`.
        log_odds: Shape (E,).
        own: Shape (E, k, k), H of each alone.
    """

    members: NDArray[np.intp]
    columns: NDArray[np.intp]
    prior: Array
    sign: Array
    log_odds: Array
    own: Array


@dataclass(frozen=True, eq=False)
class _Added:
    """What may be added, with n columns between them.

    Attributes:
        columns: Shape (n,), indices into all q columns, in rising order.
        information: Shape (q, n), of all columns with these.
        groups: Those with as many columns, group by group.
    """

    columns: NDArray[np.intp]
    information: Array
    groups: "tuple[_Group, ...]"


def _solved(root: Array, right: Array, *, transposed: bool = False) -> Array:
    """Return L^-1 b, or L^-T b, of a lower triangular L, without checks that take as long as a small system itself."""
    return np.asarray(dtrtrs(root, right, lower=1, trans=int(transposed))[0], dtype=np.float64)


def _diagonal(values: Array) -> Array:
    """Return diagonal matrices, shape (E, k, k), of their diagonals, shape (E, k)."""
    full = np.zeros((*values.shape, values.shape[1]))
    every = np.arange(values.shape[1])
    full[:, every, every] = values
    return full
