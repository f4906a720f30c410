"""Noise and changes together: what the named changes leave is noise, and what is named has to stand out of that."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial

import numpy as np

from bench.compare.background import Background, settled_background
from bench.compare.profiles import Profile
from bench.compare.search_changes import Found, Possible, find_changes
from bench.executor.watched import Check, never
from bench.record.campaign import Array

ROUNDS = 3  # effort: of noise and names, in turn
# effort: log odds; noise that moves what is named by less is settled, a twelfth of what tells explanations apart
SETTLED = 0.5


def settled_changes(
    background: Background,
    profiles: Sequence[Profile],
    rate: float,
    progress: Callable[[str], None] = lambda words: None,
    check: Check = never,
) -> Iterator[tuple[Background, Found]]:
    """Yield what changed, at last with noise that counts all that the named changes leave.

    At first noise is what not even everything together explains, which is too little where everything explains noise
    too. So what is named has to be found again with the noise that it leaves.

    Args:
        background: All recordings, with noise that not even everything together explains.
        profiles: Courses.
        rate: Declared false-alarm rate.
        progress: Called with what is done next; what it raises ends it.
        check: Called within that; what it raises ends it.
    """
    progress("what changed")
    found = find_changes(background, profiles, rate)
    yield background, found
    for _ in range(ROUNDS):
        named = found.best
        if not named:
            break
        settled = settled_background(background, partial(_changes, named), check)
        if settled is background:
            break
        progress("what changed, beside the noise that it leaves")
        before, background, found = found, settled, find_changes(settled, profiles, rate)
        yield background, found
        moved = abs(found.alternatives[0].log_posterior - before.alternatives[0].log_posterior)
        if found.alternatives[0].keys == before.alternatives[0].keys and moved < SETTLED:
            break


def _changes(named: Sequence[Possible], background: Background) -> Array:
    """Return what some changes do, shape (m, k), whitened instant by instant, each with a prior of one."""
    weights = [one.profile.weights[background.joint.of_row][:, None] for one in named]
    changes = [
        background.columns[:, one.entry.columns] * share * one.prior for one, share in zip(named, weights, strict=True)
    ]
    return np.concatenate(changes, axis=1)
