"""Causes as a verdict tells them: with their values, beside what could stand in their place, and several together."""

from dataclasses import dataclass
from math import isfinite

from bench.diagnose.extend.size import NORMAL_95

# declared: of the plausible range, as the report says (of 16 large effects hidden in messes the smallest came out at
# 0.196: DESIGN 6.1)
SMALL = 0.2
LIKELY = 0.9  # declared: of the probability of a finding, that the names hold by which it is as large as it surely is


@dataclass(frozen=True)
class ParameterValue:
    """One parameter of a cause with its 95 % interval, in `unit`.

    Attributes:
        name: Of the catalogue.
        value, low, high: As fitted, and the ends of its interval, as far as it can have such values.
        unit: SI.
        words: What it is.
        is_told: Whether the data say more of it than was assumed; if not, value and interval are what was assumed, for
            the most part.
    """

    name: str
    value: float
    low: float
    high: float
    unit: str
    words: str = ""
    is_told: bool = True


@dataclass(frozen=True)
class NamedCause:
    """One cause.

    Attributes:
        effect: Of the catalogue.
        title: What a person calls it.
        place: Where it acts.
        parameters: How large it is.
        physics: Why it happens.
        source: Who says so.
        share, sigmas: How large and how sure it is (`extend.size.Size`); nan where it was not fitted.
        level: Whether it is of the "machine", of one "recording", or of single runs of it ("run").
        advice: What to look at on the robot or in the log; "" where the title says that.
    """

    effect: str
    title: str
    place: str
    parameters: tuple[ParameterValue, ...]
    physics: str = ""
    source: str = ""
    share: float = float("nan")
    sigmas: float = float("nan")
    level: str = "machine"
    advice: str = ""

    @property
    def name(self) -> tuple[str, str]:
        """What tells it from others: its effect and its place."""
        return self.effect, self.place

    @property
    def sure_share(self) -> float:
        """How large it surely is, as a share of the plausible range: the nearer end of its 95 % interval, or 0."""
        return self.share * max(0.0, 1 - NORMAL_95 / self.sigmas) if self.sigmas > 0 else 0.0

    @property
    def is_small(self) -> bool:
        """Whether it is a small finding, which is reported after the large ones; one that was not fitted is not."""
        return self.share < SMALL


@dataclass(frozen=True)
class PossibleCause:
    """One of the names that a finding may have, with the probability that it acts, all other findings as they are.

    Parameters are those of the likeliest model that was fitted with it; a cause that no fitted model has is without.
    """

    cause: NamedCause
    probability: float


@dataclass(frozen=True)
class AmbiguityGroup:
    """One finding, with all causes that these data cannot tell apart in its place.

    Attributes:
        names: The likeliest first; the fewest that together hold 99 %.
        probability: That any of them acts.
        may_be_unlisted: Whether what is unlisted may hold it too: the set at 99 % has that as well.
        is_confirmed: Whether it does not hang on a few runs, as of its step.
    """

    names: tuple[PossibleCause, ...]
    probability: float
    may_be_unlisted: bool = False
    is_confirmed: bool = True

    @property
    def is_small(self) -> bool:
        """Whether it is told as small: every cause of it that was fitted is."""
        fitted = [one.cause for one in self.names if isfinite(one.cause.share)]
        return bool(fitted) and all(cause.is_small for cause in fitted)

    @property
    def rank(self) -> tuple[float, float]:
        """How large it surely is, and how sure it is: findings are told in this order, the greatest first.

        What may be a large offset of a current or a small torque on a joint is surely no larger than the latter: the
        smallest counts of the fewest names that together hold `LIKELY` of it. A finding that was not fitted stands
        between the large ones and the small ones.
        """
        held, shares, all_names = 0.0, list[float](), sum(one.probability for one in self.names)
        for one in sorted(self.names, key=lambda one: -one.probability):
            if isfinite(one.cause.share):
                shares.append(one.cause.sure_share)
            held += one.probability
            if shares and held >= LIKELY * all_names:
                break
        sigmas = self.names[0].cause.sigmas
        return min(shares, default=SMALL), sigmas if isfinite(sigmas) else 0.0


@dataclass(frozen=True)
class Explanation:
    """One or several causes together.

    Attributes:
        causes: That act together, in the order of the findings.
        probability: Among everything that was weighed, fitted or not.
        log_evidence: Logarithm of the Bayes factor against the nominal model.
        fitted_probability: Among the explanations that were fitted, which share what all of them have; as with the
            names of a finding, simulation decides. What has all causes of a likelier one and more counts for that one.
        log_posterior: Logarithm of the evidence and of the prior odds of the causes, which each of them lowers.
    """

    causes: tuple[NamedCause, ...]
    probability: float
    log_evidence: float
    fitted_probability: float
    log_posterior: float

    @property
    def names(self) -> frozenset[tuple[str, str]]:
        """Of its causes."""
        return frozenset(cause.name for cause in self.causes)
