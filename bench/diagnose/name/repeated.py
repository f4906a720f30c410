"""Selection repeated with a part of the runs left out: whether a finding hangs on one of them.

Choosing causes is part of a fit, so a gain on held-out runs that was chosen with those runs in sight is too good. Here
the search itself is made again without each part. All inner products without some rows are those of all rows less
those of the rows that are left out.
"""

from collections.abc import Hashable, Iterator, Mapping, Sequence

import numpy as np
from scipy.linalg import solve_triangular

from bench.diagnose.measure.folds import folds_of
from bench.diagnose.name.linearised import Linearised
from bench.diagnose.name.models import Model
from bench.diagnose.name.search import LinearModel, alternatives_of, search
from bench.diagnose.picture.design import Design
from bench.diagnose.picture.screening import Tried

PARTS = 8  # of the folds, each left out in turn; of 40 runs a part has five
EXPANDED = 8  # subsets that are expanded in each search, which begins with what was found


def repeats(design: Design, tried: Tried, about: Linearised, models: Sequence[Model]) -> Mapping[Hashable, float]:
    """Return the share of searches, each without one part of the runs, that find each cause of the best model again.

    What stands in the place of a cause in a model that cannot be told from the best counts for it.

    Args:
        design: The campaign.
        tried: Everything that can be tried.
        about: The same linearised about the best model.
        models: That cannot be told apart, the best first.
    """
    same = {key: {key} for key in models[0].keys}
    for other in models[1:]:
        for key in models[0].keys - other.keys:
            same[key] |= other.keys - models[0].keys
    shape = about.present[-1:] if models[0].shape else ()
    found = []
    for model in _without_parts(design, tried, about):
        found.append(alternatives_of(model, search(model, [about.present], shape, EXPANDED))[0].keys)
    return {key: float(np.mean([bool(keys & one) for one in found])) for key, keys in same.items()}


def _without_parts(design: Design, tried: Tried, about: Linearised) -> Iterator[LinearModel]:
    """Yield the linearised model without each part of the runs."""
    shape = [about.about.shape.columns] if about.about.shape else []
    columns = np.concatenate([tried.columns.matrix, *about.tangents, *shape], axis=1)
    slopes, white = design.slopes, about.white
    gram, cross, normal = columns.T @ columns, slopes.T @ columns, slopes.T @ slopes
    scores, pull = columns.T @ white, slopes.T @ white
    fold, gap = folds_of(design).of_rows(design)
    count = min(PARTS, gap.shape[1])
    for part in range(count):
        rows = (fold % count == part) | np.any(gap[:, np.arange(gap.shape[1]) % count == part], axis=1)
        own, mine, left = columns[rows], slopes[rows], white[rows]
        factor = np.linalg.cholesky(np.eye(len(normal)) + normal - mine.T @ mine)
        reduced = solve_triangular(factor, cross - mine.T @ own, lower=True)
        drawn = solve_triangular(factor, pull - mine.T @ left, lower=True)
        information = gram - own.T @ own - reduced.T @ reduced
        yield LinearModel(information, scores - own.T @ left - reduced.T @ drawn, about.model.terms)
