"""Ask: the next experiment, the one that would best split what today's data cannot tell apart."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from bench.diagnose.experiment_design.direct import direct_measurements
from bench.diagnose.experiment_design.experiments import experiments_for
from bench.diagnose.experiment_design.preposterior import (
    Expectation,
    Preposterior,
    expected_log_bayes_factor,
    narrowing,
)
from bench.diagnose.experiment_design.workspace import quantities_with_more
from bench.diagnose.extend.fit import Fit
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.executor.contract import Executor
from bench.executor.serial import SERIAL
from bench.record.campaign import Array

MOST_PROPOSALS = 5  # declared: in the verdict, the best first
MOST_FITS = 4  # effort: explanations that are told apart, the best first
SIMULATED = 8  # effort: experiments that are simulated with every deviation of the model
TOLD_APART = 6.0  # declared: log Bayes factor; more than that, odds of 400, is as good
# declared: expected log Bayes factor below which an experiment is not worth a lab's time: odds of ten
LEAST = float(np.log(10))
LEAST_NARROWING = 0.8  # declared: of the standard deviation, above which the same holds
NONE = "none of it"  # of an explanation that has nothing which another one has not


@dataclass(frozen=True)
class Proposal:
    """An experiment that would tell explanations apart, or show what these data cannot.

    Attributes:
        experiment: In words: pose, speed, load, dwell, or an instrument.
        splits: What either of the two explanations that it tells apart best has and the other has not; of one that
            stands alone, its name and "".
        separation: Log Bayes factor between the two that it is expected to add, if the one that it favours less is
            true. Of one alone, the logarithm of the factor by which the standard deviation of its least known parameter
            shrinks.
        today: What the data at hand say of the two; 0 for one alone.
        narrows: Of one alone, what it does to that parameter, in words; else "".
    """

    experiment: str
    splits: tuple[str, str]
    separation: float
    today: float
    narrows: str = ""


@dataclass(frozen=True, eq=False)
class Rated:
    """An experiment with its worth.

    Attributes:
        proposal: For people.
        family: What it is like.
        gain: By which it is ranked: log Bayes factors of all pairs, each counted up to where it is told apart, then
            that of the best pair.
    """

    proposal: Proposal
    family: str
    gain: tuple[float, float]


def propose(linear: LinearisedModel, fits: Sequence[Fit], executor: Executor = SERIAL) -> tuple[Proposal, ...]:
    """Return at most five experiments, the best first, each of another kind; none where nothing tried would help.

    With several explanations, an experiment is worth what it tells apart; with one, by how much it narrows the size of
    which these data have told least of what was plausible.

    Args:
        linear: Today's campaign.
        fits: The explanations that today's data cannot tell apart, the best first.
        executor: Where to simulate.

    Raises:
        ConvergenceError, RobotError: An explanation cannot be simulated in one of the experiments.
    """
    fits = [fit for fit in fits if fit.unknowns][:MOST_FITS]
    if not fits:
        return ()
    quantities = quantities_with_more(linear)
    is_thermal = any(cause.effect.needs for fit in fits for cause in fit.causes)
    experiments = experiments_for(linear, is_thermal)
    quick = Preposterior(linear, fits, experiments, quantities, is_quick=True, executor=executor)
    first = [_rate(e.words, e.family, fits, quick.expect(e)) for e in experiments]
    best = sorted(range(len(experiments)), key=lambda i: first[i].gain, reverse=True)[:SIMULATED]
    chosen = [experiments[i] for i in best]
    full = Preposterior(linear, fits, chosen, quantities, is_quick=False, executor=executor)
    rated = [_rate(e.words, e.family, fits, full.expect(e)) for e in chosen]
    direct = direct_measurements(linear, fits, quick.trace)
    rated += [_rate(d.words, d.family, fits, d.expectations) for d in direct]
    return _best_of_each(rated, LEAST if len(fits) > 1 else -np.log(LEAST_NARROWING))


def _best_of_each(rated: Sequence[Rated], least: float) -> tuple[Proposal, ...]:
    found: dict[str, Proposal] = {}
    for one in sorted(rated, key=lambda r: r.gain, reverse=True):
        if one.proposal.separation >= least:
            found.setdefault(one.family, one.proposal)
    return tuple(found.values())[:MOST_PROPOSALS]


def _rate(words: str, family: str, fits: Sequence[Fit], expectations: Sequence[Expectation]) -> Rated:
    """Return the worth of an experiment."""
    if len(fits) == 1:
        return _rate_narrowing(words, family, fits[0], expectations[0])
    pairs = list(combinations(range(len(fits)), 2))
    apart = [told_apart(fits[i], fits[j], expectations[i], expectations[j]) for i, j in pairs]
    best = int(np.argmax(apart[: len(fits) - 1]))  # the first pairs are those with the likeliest explanation
    one, two = (fits[i] for i in pairs[best])
    proposal = Proposal(
        experiment=words,
        splits=(name_of(one, two), name_of(two, one)),
        separation=apart[best],
        today=abs(one.log_evidence - two.log_evidence),
    )
    return Rated(proposal, family, (sum(min(value, TOLD_APART) for value in apart), apart[best]))


def told_apart(one: Fit, two: Fit, first: Expectation, second: Expectation) -> float:
    """Return the expected log Bayes factor between two explanations, as far as their own causes bring it about.

    Two fits differ in figures as well that today's data hardly tell, such as the stiffness of a joint without a link
    encoder. An experiment that shows these, and nothing of the causes that are in question, would seem to decide. What
    the causes change by d, in standard errors, tells them apart by d^2 / 2 at most.

    Args:
        one: An explanation.
        two: The other.
        first: What the one expects.
        second: What the other expects.
    """
    own = _own_change(one, two, first) - _own_change(two, one, second)
    return min(expected_log_bayes_factor(first, second), float(own @ own) / 2)


def _own_change(fit: Fit, other: Fit, expectation: Expectation) -> Array:
    """Return what the causes that another explanation has not change in an experiment, shape (m,), to first order."""
    shared = {cause.key for cause in other.causes}
    sizes = [
        0.0 if unknown.cause.key in shared or unknown.parameter.is_shape else value - unknown.parameter.null
        for unknown, value in zip(fit.unknowns, fit.values, strict=True)
    ]
    own: Array = expectation.jacobian[:, expectation.jacobian.shape[1] - len(sizes) :] @ np.array(sizes)
    return own


def _rate_narrowing(words: str, family: str, fit: Fit, expectation: Expectation) -> Rated:
    told = [0.0 if u.parameter.is_shape else s / u.sigma for u, s in zip(fit.unknowns, fit.sigma, strict=True)]
    least = int(np.argmax(told))
    share = narrowing(expectation, len(expectation.covariance) - len(fit.unknowns) + least)
    unknown, sigma = fit.unknowns[least], float(fit.sigma[least])
    unit = f" {unknown.parameter.unit}" if unknown.parameter.unit else ""
    name = f"{unknown.parameter.name.replace('_', ' ')} of {unknown.cause}"
    narrows = f"{name}: {fit.values[least]:.3g} +- {sigma:.2g}{unit} today, +- {share * sigma:.2g}{unit} then"
    gain = float(-np.log(max(share, np.finfo(float).tiny)))
    return Rated(Proposal(words, (name_of(fit), ""), gain, 0.0, narrows), family, (gain, gain))


def name_of(fit: Fit, other: Fit | None = None) -> str:
    """Return an explanation in words; against another one, what that has not."""
    shared = {cause.key for cause in other.causes} if other else set()
    return " and ".join(str(cause) for cause in fit.causes if cause.key not in shared) or NONE
