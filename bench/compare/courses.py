"""Inner products of changes on any course: what is in proportion to its weights is multiplied once.

A change x with weights w_k reads X_w = sum_k w_k X_k, with the part X_k of the columns in recording k, and is whitened
by a W that ties recordings together. A' W' W X_w and its scores are sums over k, and

    X_v' W' W X_w = sum_k v_k w_k X_k' X_k - (sum_k v_k C X_k)' (sum_k w_k C X_k)

where C has a row for each state of the machine, not for each reading (`shared.py: taken`). So a course costs what its
states do, and all of them together one pass over the readings, however many there are.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.compare.background import Background
from bench.diagnose.linearise.marginal import Gram, Marginal
from bench.record.campaign import Array


@dataclass(frozen=True, eq=False)
class _Part:
    """What the columns have in one recording; q columns.

    Attributes:
        recording: Its index.
        gram: Shape (q, q), X_k' X_k.
        scores: Shape (q,), X_k' W' M^-1 r.
        rows: Shape (l,), of what is taken out, those that this recording has a part in.
        reduced: Shape (l, q), these: of nuisances, and of what repeats.
    """

    recording: int
    gram: Array
    scores: Array
    rows: NDArray[np.intp]
    reduced: Array


@dataclass(frozen=True, eq=False)
class Courses:
    """Columns of a background that may act with other weights in each recording after.

    Attributes:
        misfit: Of a machine that stayed as it was.
        parts: Of each recording after.
    """

    misfit: float
    parts: tuple[_Part, ...]

    def marginal(self, which: Sequence[tuple[NDArray[np.intp], Array]]) -> Marginal:
        """Return the inner products of some columns, each group with a share, shape (K,), of its size in recordings."""
        columns = np.concatenate([np.empty(0, dtype=np.intp), *(own for own, _ in which)])
        acting = [one for one in self.parts if any(weights[one.recording] for _, weights in which)]
        gram, scores = np.zeros((len(columns), len(columns))), np.zeros(len(columns))
        rows = np.unique(np.concatenate([np.empty(0, dtype=np.intp), *(part.rows for part in acting)]))
        reduced = np.zeros((len(rows), len(columns)))
        for part in acting:
            share = np.concatenate([np.full(len(own), weights[part.recording]) for own, weights in which])
            here = np.flatnonzero(share)
            mine, share = columns[here], share[here]
            gram[np.ix_(here, here)] += part.gram[np.ix_(mine, mine)] * np.outer(share, share)
            scores[here] += part.scores[mine] * share
            reduced[np.ix_(np.searchsorted(rows, part.rows), here)] += part.reduced[:, mine] * share
        return Marginal(self.misfit, scores, Gram(gram), reduced)


def courses_of(background: Background) -> Courses:
    """Return the products of all columns of a background in each recording after."""
    known, whitening = background.nuisances, background.whitening
    slopes = whitening.transposed(known.jacobian)
    white = whitening.transposed(background.white[:, None])[:, 0]
    pull = known.reduced(known.jacobian.T @ background.white)
    parts = []
    for k, one in enumerate(background.joint.recordings):
        if not one.is_after:
            continue
        here = np.flatnonzero(background.joint.of_row == k)
        columns = background.columns[here]
        reduced = known.reduced(slopes[here].T @ columns)
        rows, taken = whitening.taken(columns, here)
        parts.append(
            _Part(
                recording=k,
                gram=columns.T @ columns,
                scores=columns.T @ white[here] - pull @ reduced,
                rows=np.concatenate([np.arange(len(pull)), len(pull) + rows]),
                reduced=np.concatenate([reduced, taken]),
            )
        )
    misfit = float(background.white @ background.white - pull @ pull)
    return Courses(misfit, tuple(parts))
