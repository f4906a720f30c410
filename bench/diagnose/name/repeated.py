"""Selection repeated with a part of the runs left out: whether a finding hangs on one of them.

Choosing causes is part of a fit, so a gain on held-out runs that was chosen with those runs in sight is too good. Here
the search itself is made again without each part. All inner products without some rows are those of all rows less
those of the rows that are left out.
"""

from collections.abc import Hashable, Iterator, Mapping, Sequence

import numpy as np
from scipy.linalg import solve_triangular

from bench.diagnose.cross_validation.folds import Folds, folds_of
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.screening import Tried
from bench.diagnose.name.models import Model
from bench.diagnose.name.search import alternatives_of, search
from bench.diagnose.name.search_space import SearchSpace
from bench.diagnose.name.subset_posterior import SubsetPosterior

PARTS = 8  # effort: of the folds, each left out in turn; of 40 runs a part has five
EXPANDED = 8  # effort: subsets that are expanded in each search, which begins with what was found


def repeats(
    linear: LinearisedModel, tried: Tried, about: SearchSpace, models: Sequence[Model]
) -> Mapping[Hashable, float]:
    """Return the share of searches, each without one part of the runs, that find each cause of the best model again.

    What stands in the place of a cause in a model that cannot be told from the best counts for it. So does what the
    same search of all runs finds in its place, which simulation had ruled out: about a model with friction, the scale
    of a current is nearly all friction, and takes its place to first order; no part of the runs decides that.

    Args:
        linear: The campaign.
        tried: Everything that can be tried.
        about: The same linearised about the best model.
        models: That cannot be told apart, the best first.
    """
    same = {key: {key} for key in models[0].keys}
    for other in models[1:]:
        for key in models[0].keys - other.keys:
            same[key] |= other.keys - models[0].keys
    of_all, *found = (
        alternatives_of(model, search(model, [about.present], about.shape, EXPANDED))[0].keys
        for model in _without_parts(linear, tried, about)
    )
    for key in models[0].keys - of_all:
        same[key] |= of_all - models[0].keys
    parts = _parts_of(folds_of(linear))
    whose: Mapping[Hashable, int] = {
        cause.key: parts[cause.place.recording] for cause in models[0].causes if cause.place.recording in parts
    }
    return {
        key: float(np.mean([bool(keys & one) for part, one in enumerate(found) if part != whose.get(key)]))
        for key, keys in same.items()
    }


def _parts_of(folds: Folds) -> Mapping[str | None, int]:
    """Return with which part a recording is left out; what belongs to it alone cannot be found then."""
    return {name: fold % min(PARTS, len(folds)) for fold, name in enumerate(folds.recordings)}


def _without_parts(linear: LinearisedModel, tried: Tried, about: SearchSpace) -> Iterator[SubsetPosterior]:
    """Yield the linearised model of all runs, and without each part of them."""
    shape = [about.about.shape.columns] if about.about.shape else []
    matrix, jacobian, white = tried.columns.matrix, linear.jacobian, about.white
    present = np.concatenate([np.empty((len(white), 0)), *about.tangents, *shape], axis=1)
    beside = matrix.T @ present
    gram = np.block([[tried.columns.gram, beside], [beside.T, present.T @ present]])
    cross = np.concatenate([tried.columns.with_slopes(jacobian), jacobian.T @ present], axis=1)
    scores = np.concatenate([matrix.T @ white, present.T @ white])
    normal, pull = jacobian.T @ jacobian, jacobian.T @ white
    fold, gap = folds_of(linear).of_rows(linear)
    count = min(PARTS, gap.shape[1])
    for part in (None, *range(count)):
        if part is None:
            rows = np.zeros(len(white), dtype=np.bool_)
        else:
            rows = (fold % count == part) | np.any(gap[:, np.arange(gap.shape[1]) % count == part], axis=1)
        own, mine, left = np.concatenate([matrix[rows], present[rows]], axis=1), jacobian[rows], white[rows]
        factor = np.linalg.cholesky(np.eye(len(normal)) + normal - mine.T @ mine)
        reduced = solve_triangular(factor, cross - mine.T @ own, lower=True)
        drawn = solve_triangular(factor, pull - mine.T @ left, lower=True)
        information = gram - own.T @ own - reduced.T @ reduced
        yield SubsetPosterior(information, scores - own.T @ left - reduced.T @ drawn, about.model.terms)
