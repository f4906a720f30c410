"""Which directions of angles are tried, where nobody knows which of them are turned."""

from itertools import combinations, product

import numpy as np

Flags = np.ndarray[tuple[int], np.dtype[np.bool_]]

MOST_FLIPPED = 6  # drives up to which all directions are tried
MOST_TRIALS = 64  # effort: as many as six drives have; more drives are turned two at a time up to so many, else one


def most_at_once(n: int) -> int:
    """Return how many of n drives are turned at once, at most, in what is tried."""
    if n <= MOST_FLIPPED:
        return n
    return 2 if 1 + n + n * (n - 1) // 2 <= MOST_TRIALS else 1


def directions(n: int) -> list[Flags]:
    """Return what is tried for n drives, whether each is turned, shape (n,) each; fewer turns first, none at first."""
    if n <= MOST_FLIPPED:
        return [np.array(turned) for turned in sorted(product((False, True), repeat=n), key=sum)]
    every = range(n)
    chosen = [axes for count in range(most_at_once(n) + 1) for axes in combinations(every, count)]
    return [np.isin(every, axes) for axes in chosen]
