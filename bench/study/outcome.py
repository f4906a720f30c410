"""What came of one campaign: truth beside verdict, as plain data. A study is a list of these."""

from dataclasses import dataclass

from bench.diagnose.verdict import NORMAL_95, ChannelGain, Explanation, Verdict
from bench.study.line import JsonLine
from bench.study.make import Made, Sized
from bench.study.plan import Kind, SizeRule, Trial
from bench.study.worlds import World

Name = tuple[str, str]  # effect and place, in words


@dataclass(frozen=True)
class TrueCause:
    """What acted.

    Attributes:
        effect, place: In words.
        values: Parameter -> value.
        size: As a share of the largest plausible.
        limit: Detection limit as the same share, None if it was not computed.
    """

    effect: str
    place: str
    values: dict[str, float]
    size: float
    limit: float | None

    @property
    def name(self) -> Name:
        """Effect and place."""
        return self.effect, self.place


@dataclass(frozen=True)
class Found:
    """A parameter as found, with its standard deviation."""

    value: float
    sigma: float


@dataclass(frozen=True)
class FoundCause:
    """A cause that was named."""

    effect: str
    place: str
    values: dict[str, Found]

    @property
    def name(self) -> Name:
        """Effect and place."""
        return self.effect, self.place


@dataclass(frozen=True)
class Named:
    """One explanation; its log evidence against the nominal model, None in studies from before it was kept."""

    causes: tuple[FoundCause, ...]
    probability: float
    log_evidence: float | None = None

    @property
    def names(self) -> frozenset[Name]:
        """Of its causes."""
        return frozenset(cause.name for cause in self.causes)


@dataclass(frozen=True)
class FoundGroup:
    """One finding: the names that it may have, each with its probability, the likeliest first."""

    names: tuple[tuple[Name, float], ...]
    probability: float


@dataclass(frozen=True)
class Answer:
    """What a diagnosis said.

    Attributes:
        kind: "nothing found", "cause", "several causes", "unlisted cause", or "failed".
        explanations: That cannot be told apart, the likeliest first.
        unlisted: Where nothing listed explains the data, None otherwise.
        held_out: Root mean square over the channels of held-out error over noise floor, None where nothing was named.
        failure: Why there is no verdict.
        rivals: Explanations that were fitted and fell behind.
        findings: The explanations finding by finding; empty in studies from before it was kept.
    """

    kind: str
    explanations: tuple[Named, ...] = ()
    unlisted: str | None = None
    held_out: float | None = None
    failure: str = ""
    rivals: tuple[Named, ...] = ()
    findings: tuple[FoundGroup, ...] = ()


@dataclass(frozen=True)
class Outcome(JsonLine):
    """One campaign of a study.

    Attributes:
        name, kind, size: Of its trial.
        truth: What acted.
        twin: The cause that looks alike, of a twin.
        is_split: Whether a twin was hidden where it can be told apart.
        answer: What the diagnosis said.
        make_s, diagnose_s: Processor time [s]; the wall clock says the same on a core that has nothing else to do.
        world: How the campaign was beside what was hidden.
        others: What else of the catalogue acted.
    """

    name: str
    kind: Kind
    size: SizeRule
    truth: tuple[TrueCause, ...]
    twin: Name | None
    is_split: bool
    answer: Answer
    make_s: float
    diagnose_s: float
    world: World = "plain"
    others: tuple[TrueCause, ...] = ()


def answer_of(verdict: Verdict) -> Answer:
    """Return what a verdict says, as plain data."""
    return Answer(
        verdict.kind,
        tuple(_named(explanation) for explanation in verdict.explanations),
        verdict.unlisted.place if verdict.unlisted else None,
        _held_out(verdict.gain),
        rivals=tuple(_named(explanation) for explanation in verdict.rivals),
        findings=tuple(
            FoundGroup(tuple((one.cause.name, one.probability) for one in group.names), group.probability)
            for group in verdict.findings
        ),
    )


def outcome_of(trial: Trial, made: Made, answer: Answer, make_s: float, diagnose_s: float) -> Outcome:
    """Put truth beside an answer; the diagnosis is over."""
    twin = trial.twin.other if trial.twin else None
    return Outcome(
        trial.name,
        trial.kind,
        trial.size,
        tuple(_true(one) for one in made.effects),
        twin,
        trial.is_split,
        answer,
        make_s,
        diagnose_s,
        trial.world,
        tuple(_true(one) for one in made.others),
    )


def _true(one: Sized) -> TrueCause:
    effect = one.acting.effect
    values = {name: float(value) for name, value in effect.complete(one.acting.values).items()}
    return TrueCause(
        effect.name, str(one.acting.place), values, one.size, one.limit if one.limit < float("inf") else None
    )


def _named(explanation: Explanation) -> Named:
    causes = tuple(
        FoundCause(
            cause.effect,
            cause.place,
            {p.name: Found(p.value, (p.high - p.low) / (2 * NORMAL_95)) for p in cause.parameters},
        )
        for cause in explanation.causes
    )
    return Named(causes, explanation.probability, explanation.log_evidence)


def _held_out(channels: tuple[ChannelGain, ...]) -> float | None:
    ratios = [channel.after / channel.floor for channel in channels if channel.floor > 0]
    return float((sum(ratio**2 for ratio in ratios) / len(ratios)) ** 0.5) if ratios else None
