"""Noise and changes together: what the named changes leave is noise, and what is named has to stand out of that."""

from collections.abc import Sequence

import numpy as np

from bench.compare.background import Background, settled_background
from bench.compare.profiles import Profile
from bench.compare.search_changes import Found, find_changes

ROUNDS = 3


def settled_changes(background: Background, profiles: Sequence[Profile], rate: float) -> tuple[Background, Found]:
    """Return what changed, with noise that counts all that the named changes leave.

    At first nothing is named, so all that is otherwise than before counts as noise; a change that is large shows all
    the same, and noise falls to what it leaves.

    Args:
        background: All recordings, settled with nothing named.
        profiles: Courses.
        rate: Declared false-alarm rate.
    """
    found = find_changes(background, profiles, rate)
    for _ in range(ROUNDS):
        named = found.best
        if not named:
            break
        weights = [one.profile.weights[background.joint.of_row][:, None] for one in named]
        changes = [
            background.columns[:, one.entry.columns] * share * one.prior
            for one, share in zip(named, weights, strict=True)
        ]
        settled = settled_background(background, np.concatenate(changes, axis=1))
        if settled is background:
            break
        background, found = settled, find_changes(settled, profiles, rate)
    return background, found
