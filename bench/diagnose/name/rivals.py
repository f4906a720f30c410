"""Rivals: what could take the place of a cause, weighed by what it fits and by what it predicts."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from bench.diagnose.extend.polish import polished
from bench.diagnose.measure.measure import held_out
from bench.diagnose.name.trials import Hypothesis, Stage, fitted, swaps
from bench.diagnose.picture.design import Design
from bench.executor.contract import Executor
from bench.executor.serial import SERIAL

MOST_POLISHED = 5  # of the rivals that come near; beyond, they are weighed as they were fitted first
IN_SET = 6.0  # log evidence behind the best, up to where a cause is not told apart from it (odds of 400)
NEARLY = 3.0  # beyond the set, up to where derivatives are taken anew before it is decided


def among_rivals(stage: Stage, progress: Callable[[str], None], executor: Executor = SERIAL) -> tuple[Hypothesis, ...]:
    """Return the best explanation and those in which one of its causes is another, by falling evidence.

    A rival that fits better but predicts what was held out worse does not come first, and is none if it is far worse.
    """
    progress("rivals")
    known = {h.keys for h in stage.tried}
    new = [trial for trial in swaps(stage) if trial.keys not in known]
    fits = [stage.best, *stage.tried, *fitted(stage, new, executor)]
    top = max(h.log_evidence for h in fits)
    settled = []
    near = sorted((h for h in fits if h.log_evidence > top - IN_SET - NEARLY), key=lambda h: -h.log_evidence)
    for hypothesis in fits:
        if hypothesis is not stage.best and hypothesis in near[:MOST_POLISHED]:
            _, fit = polished(stage.design, hypothesis.fit)
            value = hypothesis.log_evidence + fit.log_evidence - hypothesis.fit.log_evidence
            hypothesis = Hypothesis(fit, value)
        settled.append(hypothesis)
    best = stage.best
    settled = [h for h in (as_it_predicts(stage.design, best, h) for h in settled) if h is not None]
    return ranked(settled)


def ranked(fits: Sequence[Hypothesis]) -> tuple[Hypothesis, ...]:
    """Return explanations by falling evidence, each with its probability among them."""
    weights = np.exp(np.array([h.log_evidence for h in fits]) - max(h.log_evidence for h in fits))
    shares = weights / weights.sum()
    weighed = [replace(h, probability=float(p)) for h, p in zip(fits, shares, strict=True)]
    return tuple(sorted(weighed, key=lambda h: -h.log_evidence))


def as_it_predicts(design: Design, best: Hypothesis, rival: Hypothesis) -> Hypothesis | None:
    """Return a rival with no more evidence than the best where it predicts worse; None where odds of 400 say so."""
    if rival is best or rival.log_evidence <= best.log_evidence:
        return rival
    nats = held_out(design, best.fit, rival.fit).nats
    if nats > 0:
        return rival
    return replace(rival, log_evidence=best.log_evidence) if nats > -IN_SET else None
