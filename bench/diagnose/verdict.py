"""The verdict: what a campaign says of the nominal model, as plain data. `verdict.json` is this, field by field.

Schema of `verdict.json` (format 1): `kind` is "nothing found", "cause", "several causes" or "unlisted cause";
`explanations` holds the explanations that the data cannot tell apart, the likeliest first, each with its causes,
parameters, units and 95 % intervals; `findings` says the same finding by finding, each with all causes that may be
behind it and their probabilities; `rivals` the ones that were fitted and fell behind; `unlisted` the place and the
dependence of what no listed effect explains; `missing` the channels that were not there; `blind` what the campaign
could not have shown, and what would. `unfinished` is null, or says why the diagnosis ended before it was done, and
during what; then what stands there is what had been found so far, and `kind` may also be "nothing found so far" or
"nothing weighed" (the session's signatures were not finished). `baseline` holds the errors of each drive's torque
beside those of least squares, or null where there is no moving data to make a first pass of.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from math import isfinite
from typing import Any

from bench.diagnose.baseline.comparison import Baseline as Baseline  # part of the verdict
from bench.diagnose.baseline.comparison import DriveErrors as DriveErrors  # part of the verdict
from bench.diagnose.cross_validation.held_out import ChannelGain as ChannelGain  # part of the verdict
from bench.diagnose.cross_validation.held_out import PredictedError as PredictedError  # part of the verdict
from bench.diagnose.cross_validation.held_out import RecordingGain as RecordingGain  # part of the verdict
from bench.diagnose.experiment_design.propose import Proposal as Proposal  # part of the verdict
from bench.diagnose.experiment_design.undetectable import (
    UndetectableEffect as UndetectableEffect,
)  # part of the verdict
from bench.diagnose.extend.size import NORMAL_95 as NORMAL_95  # of the intervals of a verdict
from bench.diagnose.linearise.limits import DetectionLimit as DetectionLimit  # part of the verdict

CONFIRMED = 0.5  # declared: of searches without a part of the runs, that find a cause again: the majority
UNLIKELY = 0.01  # declared: what is left out of the names of a finding and beside them: names hold 99 % (DESIGN 6.2)
# declared: of the plausible range, as the report says (of 16 large effects hidden in messes the smallest came out at
# 0.196: DESIGN 6.1)
SMALL = 0.2


@dataclass(frozen=True)
class ParameterValue:
    """One parameter of a cause with its 95 % interval, in `unit`; `words` say what it is."""

    name: str
    value: float
    low: float
    high: float
    unit: str
    words: str = ""


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
        """Whether it is reported after the large ones: every cause of it that was fitted is small."""
        fitted = [one.cause for one in self.names if isfinite(one.cause.share)]
        return bool(fitted) and all(cause.is_small for cause in fitted)


@dataclass(frozen=True)
class Explanation:
    """One or several causes together.

    Attributes:
        causes: That act together, the largest of its plausible range first.
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


@dataclass(frozen=True)
class Unlisted:
    """What no listed effect explains: where it acts, on what it depends, and its shape.

    Attributes:
        place, kind, depends_on: As in `generic.Block`.
        parameters: Of the learned shape (`learned_shape.learned_of`).
        runs: Whether the model with it runs and is kept.
        words: The same for people.
        stands_out: Whether the 95 % band of the shape leaves out zero anywhere; if not, something is left that is too
            small to give a shape.
    """

    place: str
    kind: str
    depends_on: str
    parameters: tuple[ParameterValue, ...] = ()
    runs: bool = False
    words: str = ""
    stands_out: bool = True


@dataclass(frozen=True)
class NoisyChannel:
    """A column that scatters `times` the standard error of its instrument, in motion or at rest, unexplained."""

    column: str
    in_motion: bool
    times: float


@dataclass(frozen=True)
class Step:
    """What one finding is worth beside all others, or one that was refused.

    Attributes:
        added: The cause.
        log_evidence: By how much the logarithm of the evidence falls without it.
        held_out: By how much the log probability of held-out runs falls without it, in all [nats].
        low, high: 90 % interval of it, over the runs.
        accepted: Whether the model keeps it.
        reason: Why, in words.
        channels: What each channel gains by it on what was held out.
        repeats: Share of searches, each without a part of the runs, that find it again; nan where none was made.
            What less than half of them find hangs on a few runs, and is not confirmed.
        recordings: Of a finding of the machine in several recordings: what each of them gains by it, fitted to the
            others; empty elsewhere.
    """

    added: tuple[NamedCause, ...]
    log_evidence: float
    held_out: float
    low: float
    high: float
    accepted: bool
    reason: str
    channels: tuple[ChannelGain, ...] = ()
    repeats: float = float("nan")
    recordings: tuple[RecordingGain, ...] = ()

    @property
    def confirmed_by(self) -> tuple[str, ...]:
        """Names of the recordings that become more probable with it, fitted to the others."""
        return tuple(one.recording for one in self.recordings if one.confirms)

    @property
    def is_confirmed(self) -> bool:
        """Whether it does not hang on a few runs."""
        return not self.repeats < CONFIRMED


@dataclass(frozen=True)
class Unfinished:
    """A diagnosis that ended before it was done.

    Attributes:
        why: In words, such as "interrupted".
        during: What was under way.
        promising: Causes with more evidence than chance brings about that were not fitted yet, the best first.
    """

    why: str
    during: str
    promising: tuple[NamedCause, ...] = ()


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
        findings: The same finding by finding: of each, the causes that may be behind it. Large findings first, and the
            surest of these.
        unlisted: Where nothing listed explains the data.
        missing: Effect -> channels without which it was not looked for.
        not_simulated: Causes whose model found no balance along the measured motion.
        gain: Of every channel on data that were not fitted; empty where there is no extension to try.
        held_out_by: "recording", "run" or "block": what was left out as a whole to measure the gain.
        steps: The findings, the one with the most evidence first, then the refused ones.
        next: Experiments that would tell more, the best first.
        predicted: What the model will leave of a recording that nobody has made yet, by channel.
        detectable: What would have been found, had it been there; without what was found.
        blind: What would not have been found at any plausible size, and what would show it.
        noisy: Channels that scatter far more than their instruments, the worst first; causes hide in them.
        unfinished: Why it ended before it was done; None: it is done.
        baseline: Held-out errors of each drive's torque beside those of least squares; None: there is no first pass.
        links: Times that masses and centres of mass were taken to be less certain than stated, moments of inertia
            likewise; 1: as stated.
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
    findings: tuple[AmbiguityGroup, ...] = ()
    gain: tuple[ChannelGain, ...] = ()
    held_out_by: str = ""
    steps: tuple[Step, ...] = ()
    next: tuple[Proposal, ...] = ()
    detectable: tuple[DetectionLimit, ...] = ()
    predicted: tuple[PredictedError, ...] = ()
    blind: tuple[UndetectableEffect, ...] = ()
    noisy: tuple[NoisyChannel, ...] = ()
    unfinished: Unfinished | None = None
    baseline: Baseline | None = None
    links: float = 1.0

    @property
    def other_explanations(self) -> tuple[Explanation, ...]:
        """Explanations that are more than another name for single findings, such as two causes in the place of one.

        One with less than a hundredth of the probability is left out.
        """
        names = {one.cause.name for group in self.findings for one in group.names}
        others = [e for e in self.explanations[1:] if not {cause.name for cause in e.causes} <= names]
        return tuple(e for e in others if e.fitted_probability >= UNLIKELY)

    def counts_for(self, explanation: Explanation) -> Explanation | None:
        """Return the likelier explanation for which another one counts, as it has all of its causes; None: itself."""
        fitted = (*self.explanations, *self.rivals)
        likelier = (e for e in fitted if e.log_posterior > explanation.log_posterior)
        return next((e for e in likelier if e.names < explanation.names), None)

    def as_json(self) -> dict[str, Any]:
        """Return the content of `verdict.json`."""
        return {"format": 1, **asdict(self)}


def unweighed(rate: float, why: str, during: str) -> Verdict:
    """Return the verdict of a diagnosis that ended before anything could be weighed.

    Args:
        rate: Declared false-alarm rate.
        why: It ended.
        during: What was under way.
    """
    unknown = float("nan")
    return Verdict("nothing weighed", rate, unknown, unknown, (), (), None, {}, (), unfinished=Unfinished(why, during))
