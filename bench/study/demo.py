"""One campaign with an effect at random, diagnosed blind, and whether the answer is right."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bench.diagnose.diagnose import Diagnosis
from bench.effects.catalogue import catalogue
from bench.executor.contract import Executor
from bench.executor.serial import SERIAL
from bench.hide.campaign import Hidden
from bench.study.blind import diagnose_with
from bench.study.labs import Lab, Setup, prepare
from bench.study.make import LIMITS, Made, make, sized
from bench.study.outcome import Outcome, answer_of, outcome_of
from bench.study.plan import Trial, singles_of
from bench.study.score import marks_of
from bench.study.study import NULL_STREAM


@dataclass(frozen=True, eq=False)
class Demo:
    """A hidden effect, what the diagnosis said, and both side by side."""

    made: Made
    hidden: Hidden
    diagnosis: Diagnosis
    outcome: Outcome


def hide_and_seek(seed: int, progress: Callable[[str], None] = lambda words: None, executor: Executor = SERIAL) -> Demo:
    """Hide an effect at random, clearly visible, and look for it.

    Args:
        seed: Of what is hidden, and of all noise.
        progress: Called with what is done next.
        executor: Where to simulate.
    """
    setup = prepare(Lab(), catalogue(), np.random.default_rng([seed, NULL_STREAM]), progress, executor)
    trial = visible_trial(seed, setup)
    progress("a campaign with a hidden effect")
    made = make(trial, setup, seed)
    campaign = made.campaign
    diagnosis = diagnose_with(campaign, setup.compiled, setup.catalogue, progress=progress, executor=executor)
    assert made.hidden  # it is of the first plant
    return Demo(made, made.hidden, diagnosis, outcome_of(trial, made, answer_of(diagnosis.verdict), 0.0, 0.0))


def visible_trial(seed: int, setup: Setup) -> Trial:
    """Return what to hide: the first effect that is drawn which this session shows at a plausible size.

    About torsion of the base, for one, a session says nothing at any plausible size: no verdict on it could be right.
    """
    rng = np.random.default_rng(seed)
    names = singles_of(setup.compiled, setup.lab)
    while True:  # of the catalogue's effects most are shown
        name = names[int(rng.integers(len(names)))]
        trial = Trial("demo", "single", (name,), number=int(rng.integers(100)), size="clear")
        drawn = sized(setup.catalogue[name], trial, setup, trial.rng(seed))
        if drawn.size >= LIMITS * drawn.limit:
            return trial


def judgement(outcome: Outcome) -> str:
    """Return in a sentence whether an answer to a single effect is right."""
    marks, answer = marks_of(outcome), outcome.answer
    n = len(answer.explanations)
    if marks.first and n == 1:
        return "Right: that is what was hidden."
    if marks.in_set:
        rest = "the likeliest of them" if marks.first else "not the likeliest of them"
        return f"Right, among {n} that these data cannot tell apart; the hidden one is {rest}."
    if not marks.found:
        return "Wrong: there was something, and it was not found."
    if marks.all_there:
        return "Half right: what was hidden is named, but so is something that is not there."
    return "Wrong: something else was hidden."
