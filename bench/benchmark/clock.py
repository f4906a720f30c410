"""Processor time, which other work on the machine does not lengthen by waiting."""

import os
import time
from collections.abc import Callable, Sequence

import numpy as np

from bench.record.campaign import Array


def processor_time() -> float:
    """Return the time that processors spent on this process, its threads and its ended children [s]."""
    ended = os.times()
    return time.process_time() + ended.children_user + ended.children_system


def seconds(work: Callable[[], object]) -> float:
    """Return the processor time of one call [s]."""
    start = processor_time()
    work()
    return processor_time() - start


def interleaved(works: Sequence[Callable[[], object]], rounds: int) -> Array:
    """Return the processor time of each work in each round, shape (rounds, number of works) [s].

    All works take their turn in each round, forwards and backwards by turns. A slow spell of the machine hits all of
    them, and a ratio of two columns, taken round by round, hardly feels it.
    """
    found = np.empty((rounds, len(works)))
    for turn in range(rounds):
        order = range(len(works)) if turn % 2 == 0 else range(len(works) - 1, -1, -1)
        for i in order:
            found[turn, i] = seconds(works[i])
    return found


def exponent(sizes: Sequence[float], spent: Array) -> float:
    """Return b of seconds = a size^b by least squares of the logarithms: 1 for linear growth, below it a fixed cost."""
    return float(np.polyfit(np.log(sizes), np.log(spent), 1)[0])
