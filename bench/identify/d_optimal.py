"""D-optimal choice among candidates whose information adds up: greedy start, then exchange.

The exchange is Fedorov's as modified by Cook and Nachtsheim (Technometrics 22, 1980): each chosen candidate in turn
gives way to the best of all others, until none does. It ends in a local optimum, so it also runs from random starts.
"""

import numpy as np
from numpy.typing import NDArray

from bench.errors import InputError
from bench.robot.bodies import Array

GAIN = 1e-9  # of log det; a smaller one is rounding


def log_determinant(information: Array, n_interest: int) -> Array:
    """Return log det of the information about the first parameters when the others are unknown too, shape (...,).

    Args:
        information: Shape (..., p, p).
        n_interest: How many parameters count; the rest are nuisances, and their Schur complement is taken.
    """
    total: Array = np.linalg.slogdet(information)[1]
    if n_interest == information.shape[-1]:
        return total
    nuisances: Array = np.linalg.slogdet(information[..., n_interest:, n_interest:])[1]
    return total - nuisances


def choose(
    candidates: Array,
    prior: Array,
    n_interest: int,
    count: int,
    limited: NDArray[np.bool_],
    limit: int,
    rng: np.random.Generator,
    starts: int,
) -> NDArray[np.int64]:
    """Return the indices of `count` different candidates with a large log det, in ascending order.

    Args:
        candidates: Shape (c, p, p), information of each.
        prior: Shape (p, p), positive definite: what is known beforehand.
        n_interest: How many parameters count; the rest are nuisances.
        count: How many to choose, 1 or more.
        limited: Shape (c,), candidates of which at most `limit` may be chosen.
        limit: See `limited`.
        rng: For the random starts.
        starts: Number of random starts besides the greedy one.

    Raises:
        InputError: There are not enough candidates.
    """
    available = int(np.sum(~limited)) + min(limit, int(np.sum(limited)))
    if available < count:
        raise InputError(f"{available} candidates can be chosen, which is not enough for {count}; relax the rules.")
    search = _Search(candidates, prior, n_interest, limited, limit)
    first: list[int] = []
    for _ in range(count):
        first.append(search.best_addition(first)[0])
    found = [search.exchange(first)]
    for _ in range(starts):
        found.append(search.exchange(search.random(count, rng)))
    best = max(found, key=search.value)
    return np.array(sorted(best), dtype=np.int64)


class _Search:
    """The candidates and the rule of choice."""

    def __init__(
        self, candidates: Array, prior: Array, n_interest: int, limited: NDArray[np.bool_], limit: int
    ) -> None:
        self.candidates, self.prior, self.n_interest = candidates, prior, n_interest
        self.limited, self.limit = limited, limit

    def value(self, chosen: list[int]) -> float:
        return float(log_determinant(self.prior + self.candidates[chosen].sum(axis=0), self.n_interest))

    def best_addition(self, chosen: list[int]) -> tuple[int, float]:
        """Return the candidate that adds most to those chosen, and the log det it leads to."""
        values = log_determinant(self.prior + self.candidates[chosen].sum(axis=0) + self.candidates, self.n_interest)
        values[chosen] = -np.inf
        if np.sum(self.limited[chosen]) >= self.limit:
            values[self.limited] = -np.inf
        best = int(np.argmax(values))
        return best, float(values[best])

    def exchange(self, chosen: list[int]) -> list[int]:
        chosen, value, improved = list(chosen), self.value(chosen), True
        while improved:
            improved = False
            for place in range(len(chosen)):
                others = chosen[:place] + chosen[place + 1 :]
                best, reached = self.best_addition(others)
                if reached > value + GAIN:
                    chosen, value, improved = [*others[:place], best, *others[place:]], reached, True
        return chosen

    def random(self, count: int, rng: np.random.Generator) -> list[int]:
        order = rng.permutation(len(self.candidates))
        past_limit = self.limited[order] & (np.cumsum(self.limited[order]) > self.limit)
        return [int(index) for index in order[~past_limit][:count]]
