"""Numbers of a study in words."""

from math import inf, isnan

from bench.study.calibration import Margin
from bench.study.goals import Goal
from bench.study.shares import Mean, Share


def measured_words(measured: Share | Mean) -> str:
    """Return a measured number with its 95 % interval."""
    if measured.of == 0:
        return "nothing to measure"
    low, high = measured.interval
    if isinstance(measured, Share):
        share = f"{100 * measured.value:.1f} % ({measured.hits} of {measured.of})"
        return f"{share}, 95 % interval {100 * low:.1f} to {100 * high:.1f} %"
    between = "" if isnan(low) else f", 95 % interval {low:.2f} to {high:.2f}"
    return f"mean {measured.value:.2f} over {measured.of}{between}, largest {measured.largest:.2f}"


def met_words(goal: Goal) -> str:
    """Return whether a goal is met, and whether chance may have decided it."""
    if goal.met is None:
        return "not measured"
    return "met" if goal.met else "missed"


def share_words(share: Share) -> str:
    """Return a share in few characters."""
    return f"{share.hits} of {share.of}" if share.of else "-"


def margin_words(margin: Margin) -> str:
    """Return in words what margin of evidence a set that holds asks for."""
    given = f"The sets as given hold it in {share_words(margin.given)}."
    if margin.nats == inf:
        return f"Of {margin.learned_from} campaigns more than 1 % did not weigh it: no margin holds. {given}"
    return (
        f"Naming all that has at most {margin.nats:.1f} nats less evidence than the best, as one half of the campaigns "
        f"({margin.learned_from}) asks for, holds the truth in {share_words(margin.held)} of the other, with "
        f"{margin.size:.1f} explanations on average. {given}"
    )
