"""The verdict: what a campaign says of the nominal model, as plain data. `verdict.json` is this, field by field.

Schema of `verdict.json` (format 1): `kind` is "nothing found", "cause", "several causes" or "unlisted cause";
`explanations` holds the explanations that the data cannot tell apart, the likeliest first, each with its causes,
parameters, units and 95 % intervals; `rivals` the ones that were fitted and fell behind; `unlisted` the place and the
dependence of what no listed effect explains; `missing` the channels that were not there.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from bench.diagnose.naming import Hypothesis, Naming

NORMAL_95 = 1.959964


@dataclass(frozen=True)
class ParameterValue:
    """One parameter of a cause with its 95 % interval, in `unit`."""

    name: str
    value: float
    low: float
    high: float
    unit: str


@dataclass(frozen=True)
class NamedCause:
    """One cause: the effect of the catalogue, where it acts, and how large it is."""

    effect: str
    title: str
    place: str
    parameters: tuple[ParameterValue, ...]


@dataclass(frozen=True)
class Explanation:
    """One or several causes together.

    Attributes:
        causes: That act together.
        probability: Among the explanations that were fitted, and nothing else.
        log_evidence: Logarithm of the Bayes factor against the nominal model.
    """

    causes: tuple[NamedCause, ...]
    probability: float
    log_evidence: float


@dataclass(frozen=True)
class Unlisted:
    """What no listed effect explains: where it acts and on what it depends."""

    place: str
    kind: str
    depends_on: str


@dataclass(frozen=True)
class Verdict:
    """What a campaign says.

    Attributes:
        kind: In a word.
        false_alarm_rate: Declared for the whole catalogue at once.
        threshold: Log evidence that chance exceeds at that rate.
        noise_scale: Variance that is left against what the instruments explain, at least 1.
        explanations: That cannot be told apart, the likeliest first.
        rivals: Fitted, and behind.
        unlisted: Where nothing listed explains the data.
        missing: Effect -> channels without which it was not looked for.
        not_simulated: Effects whose model found no balance.
    """

    kind: str
    false_alarm_rate: float
    threshold: float
    noise_scale: float
    explanations: tuple[Explanation, ...]
    rivals: tuple[Explanation, ...]
    unlisted: Unlisted | None
    missing: Mapping[str, tuple[str, ...]]
    not_simulated: tuple[str, ...]

    def as_json(self) -> dict[str, Any]:
        """Return the content of `verdict.json`."""
        return {"format": 1, **asdict(self)}


def verdict_of(naming: Naming, rate: float, missing: Mapping[str, tuple[str, ...]]) -> Verdict:
    """Return the verdict.

    Args:
        naming: What the data say.
        rate: Declared false-alarm rate.
        missing: Effect -> channels that were not there.
    """
    near = naming.alternatives
    block = naming.unlisted
    return Verdict(
        kind=naming.kind,
        false_alarm_rate=rate,
        threshold=naming.screening.threshold,
        noise_scale=naming.screening.marginal.scale,
        explanations=tuple(_explanation(h) for h in near),
        rivals=tuple(_explanation(h) for h in naming.hypotheses if h not in near),
        unlisted=Unlisted(block.place, block.kind, block.depends_on) if block else None,
        missing=missing,
        not_simulated=naming.not_simulated,
    )


def _explanation(hypothesis: Hypothesis) -> Explanation:
    fit = hypothesis.fit
    causes = []
    for cause in fit.causes:
        parameters = tuple(
            ParameterValue(
                u.parameter.name,
                float(value),
                float(value - NORMAL_95 * sigma),
                float(value + NORMAL_95 * sigma),
                u.parameter.unit,
            )
            for u, value, sigma in zip(fit.unknowns, fit.values, fit.sigma, strict=True)
            if u.cause is cause
        )
        causes.append(NamedCause(cause.effect.name, cause.effect.title, str(cause.place), parameters))
    return Explanation(tuple(causes), hypothesis.probability, hypothesis.log_evidence)
