"""From what was found to the verdict, as plain data."""

from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from bench.diagnose.cross_validation.held_out import HeldOut
from bench.diagnose.extend.fit import BEYOND, Fit, Unknown
from bench.diagnose.extend.size import size_of
from bench.diagnose.extend.told import told_sizes
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.limits import detection_limits
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.name.discrepancy import Discrepancy
from bench.diagnose.name.learned_shape import learned_of
from bench.diagnose.name.models import Model
from bench.diagnose.name.naming import Finding, Naming, fitted_probabilities
from bench.diagnose.replay.instants import recordings_of
from bench.diagnose.verdict import (
    CONFIRMED,
    NORMAL_95,
    AmbiguityGroup,
    Explanation,
    NamedCause,
    NoisyChannel,
    ParameterValue,
    PossibleCause,
    Proposal,
    Step,
    Unfinished,
    Unlisted,
    Verdict,
)

PROMISING = 3  # effort: causes that an unfinished diagnosis names
NOISY = 3.0  # declared: times its instrument's standard error


def verdict_of(
    naming: Naming,
    rate: float,
    missing: Mapping[str, tuple[str, ...]],
    not_simulated: tuple[str, ...],
    gain: HeldOut | None = None,
    proposals: tuple[Proposal, ...] = (),
    discrepancy: Discrepancy | None = None,
) -> Verdict:
    """Return the verdict.

    Args:
        naming: What the data say.
        rate: Declared false-alarm rate.
        missing: Effect -> channels that were not there.
        not_simulated: Causes whose model found no balance.
        gain: What the best explanation is worth on what was held out.
        proposals: Next experiments.
        discrepancy: What became of the free shape that is called unlisted.
    """
    near = tuple(m for m in naming.alternatives if m.causes and bool(m.shape) == bool(naming.unlisted))
    fits = [model.listed_fit(naming.linear) for model in near]
    linear = naming.linear
    shares = dict(zip([m.keys for m in naming.models], fitted_probabilities(naming.models), strict=True))
    if discrepancy and discrepancy.fit and discrepancy.is_gain:
        fits[:1], linear = [discrepancy.fit] if near else [], discrepancy.linear
    findings = _findings(naming, near, fits)
    explanations = tuple(_explanation(m, fit, shares, findings) for m, fit in zip(near, fits, strict=True))
    unlisted = _unlisted(naming, discrepancy)
    return Verdict(
        kind=kind_beside(naming.kind, explanations, unlisted),
        false_alarm_rate=rate,
        threshold=naming.screening.threshold,
        noise_scale=float(np.mean(linear.inflation**2)),
        explanations=explanations,
        rivals=tuple(
            _explanation(m, m.listed_fit(naming.linear), shares, findings)
            for m in naming.models
            if m.causes and m not in near
        ),
        findings=findings,
        unlisted=unlisted,
        missing=missing,
        not_simulated=not_simulated,
        gain=gain.channels if gain else (),
        held_out_by=gain.by if gain else "",
        held_out_of=gain.of if gain else "",
        steps=tuple(_step(finding) for finding in naming.findings),
        next=proposals,
        detectable=tuple(d for d in detection_limits(naming.screening) if (d.effect, d.place) not in naming.found),
        noisy=_noisy(linear),
    )


def kind_beside(kind: str, explanations: Sequence[Explanation], unlisted: Unlisted | None) -> str:
    """Return what was found in a word: the causes, where what is left beside them is too small to have a shape.

    Args:
        kind: In a word, if it has one.
        explanations: The likeliest first.
        unlisted: What no listed effect explains.
    """
    if not explanations or unlisted is None or unlisted.stands_out:
        return kind
    return "cause" if len(explanations[0].causes) == 1 else "several causes"


def _findings(naming: Naming, near: Sequence[Model], fits: Sequence[Fit]) -> tuple[AmbiguityGroup, ...]:
    """Return the findings, each cause as the likeliest fitted model with it has it.

    Args:
        naming: What the data say.
        near: Models that cannot be told from the best.
        fits: Theirs.
    """
    fitted = [*zip(near, fits, strict=True)]
    fitted += [
        (model, model.listed_fit(naming.linear)) for model in naming.models if model.causes and model not in near
    ]

    def named(cause: Cause) -> NamedCause:
        for model, fit in fitted:
            for own in model.causes:
                if own.key == cause.key:
                    return named_cause(own, fit)
        return _titled(cause, ())

    is_one = len(recordings_of(naming.linear.segments)) < 2  # several confirm by themselves
    held = {one.cause.key for one in naming.findings if one.is_taken and (not is_one or one.repeats >= CONFIRMED)}
    found = [
        AmbiguityGroup(
            tuple(PossibleCause(named(member.cause), member.probability) for member in group.members),
            group.probability,
            group.may_be_unlisted,
            bool(group.keys & held),
        )
        for group in naming.groups
    ]
    return tuple(sorted(found, key=lambda group: group.rank, reverse=True))


def unfinished_of(naming: Naming, why: str, during: str) -> Unfinished:
    """Return why a diagnosis ended, and what would have been fitted next."""
    taken = {cause.key for model in naming.models for cause in model.causes}
    causes = [cause for cause in naming.promising if cause.key not in taken][:PROMISING]
    return Unfinished(why, during, tuple(_titled(cause, ()) for cause in causes))


def _noisy(linear: LinearisedModel) -> tuple[NoisyChannel, ...]:
    found = [
        NoisyChannel(quantity.column, bool(kind), float(linear.inflation[kind, c]))
        for c, quantity in enumerate(linear.quantities)
        for kind in (0, 1)
        if linear.inflation[kind, c] > NOISY
    ]
    return tuple(sorted(found, key=lambda one: -one.times))


def _step(finding: Finding) -> Step:
    gain = finding.held_out
    reason = f"held-out {gain.decided_by}s {'become' if gain.is_gain else 'do not become'} more probable"
    if gain.is_gain and not finding.is_taken:
        reason = (
            "beside the others its evidence is no more than what chance, errors of what these are simulated to, or the "
            "scatter between runs brings about"
        )
    named = (named_cause(finding.cause, finding.fit),)
    known = (finding.log_evidence, gain.nats, gain.low, gain.high, finding.is_taken, reason, gain.channels)
    is_of_machine = finding.cause.place.recording is None
    return Step(named, *known, finding.repeats, gain.recordings if is_of_machine else (), gain.of)


def _unlisted(naming: Naming, discrepancy: Discrepancy | None) -> Unlisted | None:
    shape = learned_of(naming, discrepancy)
    if shape is None:
        return None
    block = shape.block
    parameters = tuple(
        ParameterValue(name, float(value), float(value - half), float(value + half), shape.unit, words)
        for (name, words), value, half in zip(shape.names, shape.value, shape.half, strict=True)
    )
    runs, words = (discrepancy.is_gain, discrepancy.words) if discrepancy else (False, "")
    return Unlisted(block.place, block.kind, block.depends_on, parameters, runs, words, shape.stands_out)


def _explanation(
    model: Model, fit: Fit, shares: Mapping[frozenset[Hashable], float], findings: Sequence[AmbiguityGroup]
) -> Explanation:
    causes = in_order((named_cause(cause, fit) for cause in model.causes), findings)
    return Explanation(causes, model.probability, model.log_evidence, shares[model.keys], model.log_posterior)


def in_order(causes: Iterable[NamedCause], findings: Sequence[AmbiguityGroup]) -> tuple[NamedCause, ...]:
    """Return causes in the order of findings, each where it is the likeliest name of one; the others by their size."""

    def rank(cause: NamedCause) -> tuple[float, float]:
        named = ((one.probability, group) for group in findings for one in group.names if one.cause.name == cause.name)
        _, group = max(named, key=lambda one: one[0], default=(0.0, None))
        return group.rank if group else (cause.sure_share, 0.0)

    return tuple(sorted(causes, key=rank, reverse=True))


def named_cause(cause: Cause, fit: Fit) -> NamedCause:
    """Return a cause with the sizes that a fit gives it."""
    told = told_sizes(cause, fit)
    parameters = tuple(
        _parameter(u, float(value), float(sigma), is_told=told.get(u.parameter.name, True))
        for u, value, sigma in zip(fit.unknowns, fit.values, fit.sigma, strict=True)
        if u.cause is cause
    )
    size = size_of(cause, fit)
    named = replace(_titled(cause, (*parameters, *quotients_of(cause, fit))), share=size.share, sigmas=size.sigmas)
    if not size.share > BEYOND:
        return named
    doubt = f"{size.share:.2g} times the largest plausible size: is it this, or is a figure or a channel wrong?"
    return replace(named, advice=f"{doubt} {named.advice}".strip())


def _parameter(unknown: Unknown, value: float, sigma: float, *, is_told: bool) -> ParameterValue:
    p, (least, most) = unknown.parameter, unknown.possible
    low, high = (min(max(end, least), most) for end in (value - NORMAL_95 * sigma, value + NORMAL_95 * sigma))
    return ParameterValue(p.name, value, low, high, p.unit, p.words, is_told)


def quotients_of(cause: Cause, fit: Fit) -> Iterator[ParameterValue]:
    """Yield what people know in the place of sizes that need another one, such as a centre of mass.

    Of q = s/m the variance is (var s - 2 q cov(s, m) + q^2 var m) / m^2, to first order.
    """
    mine = {u.parameter.name: i for i, u in enumerate(fit.unknowns) if u.cause is cause}
    for i in mine.values():
        quotient = fit.unknowns[i].parameter.quotient
        if quotient is None or quotient.by not in mine:
            continue
        by = mine[quotient.by]
        if not fit.values[by] > NORMAL_95 * fit.sigma[by]:  # it could be anything
            continue
        value = fit.values[i] / fit.values[by]
        slope = np.array([1.0, -value]) / fit.values[by]
        half = NORMAL_95 * float(np.sqrt(max(slope @ fit.covariance[np.ix_([i, by], [i, by])] @ slope, 0.0)))
        yield ParameterValue(
            quotient.name, float(value), float(value - half), float(value + half), quotient.unit, quotient.words
        )


def _titled(cause: Cause, parameters: tuple[ParameterValue, ...]) -> NamedCause:
    effect = cause.effect
    return NamedCause(
        effect=effect.name,
        title=effect.title,
        place=str(cause.place),
        parameters=parameters,
        physics=effect.physics,
        source=effect.source,
        level="recording" if cause.place.recording is not None and effect.level == "machine" else effect.level,
        advice=effect.advice,
    )
