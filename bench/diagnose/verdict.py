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
from typing import Any

from bench.diagnose.baseline.comparison import Baseline as Baseline  # part of the verdict
from bench.diagnose.baseline.comparison import DriveErrors as DriveErrors  # part of the verdict
from bench.diagnose.cross_validation.figures import FittedFigure as FittedFigure  # part of the verdict
from bench.diagnose.cross_validation.held_out import ChannelGain as ChannelGain  # part of the verdict
from bench.diagnose.cross_validation.held_out import RecordingGain as RecordingGain  # part of the verdict
from bench.diagnose.cross_validation.predicted_error import PredictedError as PredictedError  # part of the verdict
from bench.diagnose.experiment_design.propose import Proposal as Proposal  # part of the verdict
from bench.diagnose.experiment_design.undetectable import (
    UndetectableEffect as UndetectableEffect,
)  # part of the verdict
from bench.diagnose.extend.size import NORMAL_95 as NORMAL_95  # of the intervals of a verdict
from bench.diagnose.linearise.contradicted import (
    ContradictedReading as ContradictedReading,
)  # part of the verdict
from bench.diagnose.linearise.limits import DetectionLimit as DetectionLimit  # part of the verdict
from bench.diagnose.named_causes import AmbiguityGroup as AmbiguityGroup  # part of the verdict
from bench.diagnose.named_causes import Explanation as Explanation  # part of the verdict
from bench.diagnose.named_causes import NamedCause as NamedCause  # part of the verdict
from bench.diagnose.named_causes import ParameterValue as ParameterValue  # part of the verdict
from bench.diagnose.named_causes import PossibleCause as PossibleCause  # part of the verdict
from bench.diagnose.replay.slow_motion import SlowMotion as SlowMotion  # part of the verdict

CONFIRMED = 0.5  # declared: of searches without a part of the runs, that find a cause again: the majority
UNLIKELY = 0.01  # declared: what is left out of the names of a finding and beside them: names hold 99 % (DESIGN 6.2)


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
        stand_ins: Listed causes that the robot that is handed over has in its place, with their sizes there: they are
            not all that it is, but predict better than nothing in its place.
    """

    place: str
    kind: str
    depends_on: str
    parameters: tuple[ParameterValue, ...] = ()
    runs: bool = False
    words: str = ""
    stands_out: bool = True
    stand_ins: tuple[NamedCause, ...] = ()


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
        channels: By how much each channel is missed where it was held out, without the finding (`before`) and with it
            (`after`), everything else fitted both times.
        repeats: Share of searches, each without a part of the runs, that find it again; nan where none was made.
            What less than half of them find hangs on a few runs, and is not confirmed.
        recordings: Of a finding of the machine in several recordings: what each of them gains by it, fitted to the
            others; empty elsewhere.
        of_recording: Name of the recording whose readings `channels` are, where it alone shows the finding; "": all
            readings.
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
    of_recording: str = ""

    @property
    def confirmed_by(self) -> tuple[str, ...]:
        """Names of the recordings that become three times as probable with it or more, fitted to the others."""
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
        findings: The same finding by finding: of each, the causes that may be behind it; by how large they
            surely are (`AmbiguityGroup.rank`).
        unlisted: Where nothing listed explains the data.
        missing: Effect -> channels without which it was not looked for.
        not_simulated: Causes whose model found no balance along the measured motion.
        gain: Of every channel on data that were not fitted; empty where there is no extension to try.
        held_out_by: "recording", "run" or "block": what was left out as a whole to measure the gain.
        held_out_of: Name of the recording of whose readings the gain is, where it alone shows what was found; "": all.
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
        changed: Figures that are other ones than the diagnosis found from which this one started, however far they were
            expected to drift: those of the robot first, then those of readings, the least expected first.
        slow: How much of the motion of each drive was compared.
        contradicted: What the lab knows besides and all other readings contradict.
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
    held_out_of: str = ""
    steps: tuple[Step, ...] = ()
    next: tuple[Proposal, ...] = ()
    detectable: tuple[DetectionLimit, ...] = ()
    predicted: tuple[PredictedError, ...] = ()
    blind: tuple[UndetectableEffect, ...] = ()
    noisy: tuple[NoisyChannel, ...] = ()
    unfinished: Unfinished | None = None
    baseline: Baseline | None = None
    links: float = 1.0
    changed: tuple[FittedFigure, ...] = ()
    slow: tuple[SlowMotion, ...] = ()
    contradicted: tuple[ContradictedReading, ...] = ()

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
