"""What no play can stand in for: a finding that is needed where nothing rests."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.name.search import WINDOW
from bench.diagnose.name.search_space import SearchSpace


def is_needed_in_motion(linear: LinearisedModel, about: SearchSpace, terms: Sequence[int], i: int, play: int) -> bool:
    """Return whether a play instead of one finding of the model falls short, however it may scatter.

    By its signature a play is weighed as anything else is. Beside that it lets links rest anywhere, which explains no
    more than all that is left of readings at rest without the finding.

    Args:
        linear: The campaign.
        about: What may be wrong.
        terms: Of the leader.
        i: The finding that the play is to stand in for.
        play: The play.
    """
    what, fit = about.what[i], about.about.fit
    if not isinstance(what, Cause) or about.about.shape:
        return False
    _, sizes = fit.sizes_of(what)
    left = linear.whiten(fit.residual)
    without = left + about.tangents[about.about.causes.index(what)] @ sizes
    rests = _rests(linear, about.what[play].drive)
    regained = float(np.sum(np.maximum(without[rests] ** 2 - left[rests] ** 2, 0.0))) / 2
    instead = about.model.log_posterior((*(one for one in terms if one != i), play))
    return about.model.log_posterior(terms) - instead - regained > WINDOW


def _rests(linear: LinearisedModel, drive: int) -> NDArray[np.bool_]:
    """Return which whitened readings are of instants at which a drive stands, shape (m,)."""
    flags = []
    for segment, whitening in zip(linear.segments, linear.whitenings, strict=True):
        stands = segment.is_static or drive < 0 or bool(segment.standing[drive])
        flags.append(np.full(int(whitening.rows.sum()), stands))
    return np.concatenate(flags)
