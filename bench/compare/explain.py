"""From the posterior over subsets to named changes, with sizes, intervals and what simulation says of them."""

from collections.abc import Mapping

import numpy as np

from bench.compare.background import Background
from bench.compare.comparison import (
    NORMAL_90,
    Change,
    ChangedFinding,
    ChangedSize,
    Explanation,
    Interval,
    PossibleName,
)
from bench.compare.fit_large import departure, large_change
from bench.compare.moved_along import Along
from bench.compare.search_changes import Found, Possible
from bench.diagnose.linearise.candidates import Candidate, Cause
from bench.diagnose.name.groups import groups_of
from bench.record.campaign import Array

WEEK = 7.0  # exact: [days]
NONE_TO_LOSE = "ask whether the robot had any of it before; the model has none that could become less"


def explanations_of(
    background: Background, found: Found, along: Mapping[tuple[int, ...], Along]
) -> tuple[Explanation, ...]:
    """Return the explanations that the data cannot tell apart, the likeliest first; empty where nothing changed.

    Args:
        background: All recordings.
        found: What changed.
        along: What may have moved along with the changes of each.
    """
    if not found.alternatives[0].keys or found.shape is not None:
        return ()
    explanations = []
    for i in found.near:
        alternative = found.alternatives[i]
        if not alternative.keys:
            continue
        terms = alternative.best.terms
        moved = along[terms]
        changes, start = [], 0
        for term, others in zip(terms, moved.causes, strict=True):
            possible = found.possible[term]
            stop = start + len(possible.prior)
            changes.append(_change(background, possible, moved.mean[start:stop], moved.sigma[start:stop], others))
            start = stop
        explanations.append(Explanation(tuple(changes), found.probability[i], alternative.log_posterior))
    return tuple(explanations)


def findings_of(found: Found) -> tuple[ChangedFinding, ...]:
    """Return the changes of the likeliest explanation, each with all that could stand in its place."""
    best = found.alternatives[0]
    if not best.keys or found.shape is not None:
        return ()
    model = found.model
    alone = {model.terms[i].key: model.log_posterior((i,)) for i in best.best.terms}
    posterior = {one.keys: one.log_posterior for one in found.alternatives}
    causes = {one.key: one.entry.cause for one in found.possible if one.entry.cause}
    groups = groups_of(sorted(best.keys, key=lambda key: -alone[key]), posterior, causes)
    return tuple(
        ChangedFinding(
            tuple(
                PossibleName(one.cause.effect.name, str(one.cause), str(one.cause.place), one.probability)
                for one in group.members
            ),
            group.probability,
        )
        for group in groups
    )


def interval_of(value: float, sigma: float, step: float) -> Interval:
    """Return a size with its 90 % interval, of a value and a standard deviation in steps."""
    value, half = value * step, NORMAL_90 * sigma * abs(step)
    return Interval(value, value - half, value + half)


def advice_of(possible: Possible) -> str:
    """Return what a person should look at where a change is named; "" where its title says that."""
    assert possible.entry.cause
    return possible.entry.cause.effect.advice or (NONE_TO_LOSE if np.any(possible.sign < 0) else "")


def _change(background: Background, possible: Possible, mean: Array, sigma: Array, along: tuple[Cause, ...]) -> Change:
    candidate = possible.entry.what
    assert isinstance(candidate, Candidate)
    cause, profile = candidate.cause, possible.profile
    sizes = []
    for size, x, s, step in zip(cause.sizes, mean.tolist(), sigma.tolist(), candidate.step.tolist(), strict=True):
        weekly = interval_of(x, s, step * WEEK / profile.days) if np.isfinite(profile.days) else None
        sizes.append(ChangedSize(size.name, size.unit, size.words, interval_of(x, s, step), weekly))
    return Change(
        effect=cause.effect.name,
        title=str(cause),
        place=str(cause.place),
        level=cause.effect.level,
        sizes=tuple(sizes),
        shape=dict(candidate.shape),
        course=profile.course,
        since=background.joint.recordings[profile.since].name,
        advice=advice_of(possible),
        nonlinearity=_nonlinearity(background, possible, mean),
        along=tuple(one.effect.title for one in along),
    )


def _nonlinearity(background: Background, possible: Possible, mean: Array) -> float:
    """Return the share of what a change does by simulation that its signature misses."""
    missed, length = departure(background, large_change(background, possible, mean), possible)
    return missed / length if length > 0 else float("nan")
