"""Noise and changes together: what the named changes leave is noise, and what is named has to stand out of that."""

from collections.abc import Sequence

import numpy as np

from bench.compare.background import Background, raised_background
from bench.compare.noise import scatter_of
from bench.compare.profiles import Profile
from bench.compare.search_changes import Found, find_changes
from bench.record.campaign import Array

ENOUGH = 1.2**2  # of a variance; one that has to be changed by less is settled (as in `diagnose.name.neighbourhood`)
ROUNDS = 4


def settled_changes(background: Background, profiles: Sequence[Profile], rate: float) -> tuple[Background, Found]:
    """Return what changed, with noise that counts all that the named changes leave.

    At first nothing is named, so all that is otherwise than before counts as noise; a change that is large shows all the
    same, and noise falls to what it leaves.

    Args:
        background: All recordings, with the noise of instruments at least.
        profiles: Courses.
        rate: Declared false-alarm rate.
    """
    found: Found | None = None
    for _ in range(ROUNDS):
        factors = _factors(background, found)
        if found is not None and np.all((factors < ENOUGH) & (factors > 1 / ENOUGH)):
            break
        background = raised_background(background, factors)
        found = find_changes(background, profiles, rate)
    assert found
    return background, found


def _factors(background: Background, found: Found | None) -> Array:
    """Return by what the variances have to be changed, shape (2, c); none falls below what instruments have."""
    known = background.nuisances
    assert known.tangent is not None
    parts = [known.jacobian, known.tangent]
    named = found.best if found else ()
    parts += [background.acting(one.entry.columns, one.profile.weights) * one.prior for one in named]
    scatter = scatter_of(background.joint.linear, np.concatenate(parts, axis=1), background.white)
    own = background.repeatability.own
    return np.asarray(np.maximum(scatter * own, 1.0) / own, dtype=np.float64)
