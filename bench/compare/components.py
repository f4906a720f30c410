"""Every parameter of every cause of the machine over the recordings, with what would have been found of it."""

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.compare.background import Background
from bench.compare.comparison import Component, Interval
from bench.compare.explain import interval_of
from bench.compare.moved_along import Along, averaged
from bench.compare.search_changes import Found, priors_of
from bench.diagnose.linearise.candidates import Candidate, Cause, shape_grid
from bench.diagnose.linearise.limits import smallest_found
from bench.diagnose.linearise.marginal import Columns, Marginal
from bench.diagnose.linearise.screening import Entry
from bench.record.campaign import Array


@dataclass(frozen=True, eq=False)
class _Beside:
    """What a component is fitted beside: other changes, and with some probability what may have moved along."""

    alone: Marginal
    along: Marginal | None = None
    probability: float = 0.0

    def sizes(self, columns: Array, prior: Array) -> tuple[Array, Array]:
        """Return the sizes of some columns and their standard deviations, shape (k,) each."""
        known = [one.sizes(columns, prior) for one in (self.alone, self.along or self.alone)]
        (mean, covariance), (other, beside) = known
        return averaged((mean, other), (_sigma(covariance), _sigma(beside)), self.probability)


def _sigma(covariance: Array) -> Array:
    return np.asarray(np.sqrt(np.diag(covariance)), dtype=np.float64)


def components_of(
    background: Background, found: Found, along: Mapping[tuple[int, ...], Along]
) -> tuple[Component, ...]:
    """Return every component, those that are named first, then by how small a part of its range would have been found.

    The value of a component in a recording is fitted beside all other changes of the likeliest explanation that it is
    part of, and what may have moved along; one that is part of none, beside the changes of the likeliest.

    Args:
        background: All recordings.
        found: What changed.
        along: What may have moved along with the changes of each explanation.
    """
    near = list(along)
    explanation: dict[object, tuple[int, ...]] = {}
    for terms in near:
        for term in terms:
            explanation.setdefault(found.possible[term].key, terms)
    acting = sorted({term for terms in near for term in terms})
    one_each = {found.possible[term].key: found.possible[term].entry for term in reversed(acting)}
    taken = {entry.cause.key: entry for entry in one_each.values() if entry.cause}
    entries = _one_shape_each(background, found, taken)
    columns = np.concatenate([np.empty(0), *(entry.columns for entry in entries)]).astype(np.intp)
    count = len(background.joint.recordings)
    n_before = sum(not one.is_after for one in background.joint.recordings)
    own = [background.acting(found.possible[i].entry.columns, found.possible[i].profile.weights) for i in acting]
    own += [one.columns for one in along.values()]
    each = [background.acting(columns, np.eye(count)[k]) for k in range(n_before, count)]
    every = background.nuisances.products(background.white, Columns(np.concatenate([*own, *each], axis=1)))
    edges = np.cumsum([0, *(len(found.possible[i].prior) for i in acting)])
    places = {i: np.arange(a, b) for i, (a, b) in zip(acting, itertools.pairwise(edges), strict=True)}
    edges = int(edges[-1]) + np.cumsum([0, *(len(one.prior) for one in along.values())])
    moving = {terms: np.arange(a, b) for terms, (a, b) in zip(along, itertools.pairwise(edges), strict=True)}
    beside: dict[object, _Beside] = {}
    components: list[Component] = []
    start = int(edges[-1])
    for entry in entries:
        cause = entry.cause
        assert cause
        key = cause.key if cause.key in taken else None
        if key not in beside:
            whole = explanation.get(key, near[0] if near else ())
            others = [i for i in whole if found.possible[i].key != key]
            indices = np.concatenate([np.empty(0, dtype=np.intp), *(places[i] for i in others)])
            prior = np.concatenate([np.empty(0), *(found.possible[i].prior for i in others)])
            beside[key] = _Beside(every.given(indices, prior))
            if key is not None:
                indices, prior = np.append(indices, moving[whole]), np.append(prior, along[whole].prior)
                beside[key] = replace(
                    beside[key], along=every.given(indices, prior), probability=along[whole].probability
                )
        which = start + np.arange(len(entry.columns))
        start += len(entry.columns)
        steps = [which + k * len(columns) for k in range(count - n_before)]
        values = _values(beside[key], entry, steps)
        components += _rows(background, found, entry, values, is_named=cause.key in taken)
    return tuple(sorted(components, key=lambda one: (not one.is_named, one.limit / one.plausible)))


def _one_shape_each(background: Background, found: Found, taken: dict[tuple[str, str], Entry]) -> list[Entry]:
    """Return for each cause of the machine, and for each that is named, the shape that is found or seen best."""
    information = found.screened[0].information
    best: dict[tuple[str, str], Entry] = {}
    for entry in background.entries:
        cause = entry.cause
        if cause is None or (cause.effect.level != "machine" and cause.key not in taken):
            continue
        if not np.all(information[entry.columns] > 0):
            continue
        known = best.get(cause.key)
        if known is None or _known(information, entry) > _known(information, known):
            best[cause.key] = entry
    best |= taken
    return list(best.values())


def _known(information: Array, entry: Entry) -> float:
    return float(information[entry.columns[0]] * entry.priors[0][0][0] ** 2)


def _values(beside: _Beside, entry: Entry, steps: list[NDArray[np.intp]]) -> list[list[Interval]]:
    """Return for each size its change in every recording after."""
    prior, k = entry.priors[0][0], len(entry.columns)
    mean, sigma = beside.sizes(np.concatenate(steps), np.tile(prior, len(steps)))
    what = entry.what
    assert isinstance(what, Candidate)
    return [
        [interval_of(float(mean[i * k + j]), float(sigma[i * k + j]), float(what.step[j])) for i in range(len(steps))]
        for j in range(k)
    ]


def _rows(
    background: Background, found: Found, entry: Entry, values: list[list[Interval]], *, is_named: bool
) -> list[Component]:
    cause = entry.cause
    assert cause
    rows = []
    for j, size in enumerate(cause.sizes):
        low, worst = _limits(background, found, cause, j)
        mine = tuple(values[j])
        key = cause.effect.name, str(cause), str(cause.place)
        rows.append(Component(*key, size.name, size.unit, mine, low, worst, size.high, is_named))
    return rows


def _limits(background: Background, found: Found, cause: Cause, j: int) -> tuple[float, float]:
    """Return the smallest change that would have been found, of the shapes that are seen best and worst."""
    first = found.screened[0]
    limits = []
    for entry in background.entries:
        if entry.cause is None or entry.cause.key != cause.key or len(entry.columns) != len(cause.sizes):
            continue
        assert isinstance(entry.what, Candidate)
        known = float(first.information[entry.columns[j]])
        limit = min(
            smallest_found(known, float(prior[j]), first.threshold - share)
            for prior, share in priors_of(entry, first.information)
        )
        limits.append(limit * abs(float(entry.what.step[j])))
    worst = max(limits) if len(limits) == len(shape_grid(cause)) else float("inf")
    return min(limits), worst
