"""Which directions of angles are tried, where nobody knows which of them are turned."""

from itertools import combinations, product

import numpy as np

from bench.record.campaign import Array

Flags = np.ndarray[tuple[int], np.dtype[np.bool_]]

MOST_FLIPPED = 6  # drives up to which all directions are tried
MOST_OF = 0.5  # exact: of all instants; what holds in more of them is how a joint moved, not readings that were lost
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


def kept_by_range(limits: Array, position: Array) -> Flags:
    """Return which joints stay within their range as they are, and turned would be beyond it most of the time.

    Args:
        limits: Shape (n, 2) [rad] or [m], lower and upper ends; nothing is told of a joint without a range.
        position: Shape (T, n) [rad] or [m].
    """
    low, high = limits.T
    given, turned = (np.mean((q < low) | (q > high), axis=0) for q in (position, -position))
    return np.asarray((high > low) & (given == 0) & (turned > MOST_OF), dtype=np.bool_)
