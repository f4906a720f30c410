"""What a comparison says, as plain data. `compare.json` is this, field by field (format 1)."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, Literal

from bench.compare.profiles import Course
from bench.diagnose.verdict import Unfinished
from bench.effects.effect import Level

# of the robot that changes are linear about: fitted to the recordings before, found by a diagnosis of them, or earlier
Origin = Literal["fitted", "diagnosed", "handed over"]
NORMAL_90 = 1.645  # exact: standard deviations, of the intervals of a comparison


@dataclass(frozen=True)
class Interval:
    """A number with its 90 % interval."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class ChangedSize:
    """By how much one parameter of a cause changed, in `unit`; `words` say what it is.

    Attributes:
        name, unit, words: Of the parameter; a unit of "" is a relative size.
        change: After less before; of a trend up to the last recording, of what was there once in that recording.
        per_week: Of a trend over known times; None of any other.
    """

    name: str
    unit: str
    words: str
    change: Interval
    per_week: Interval | None = None


@dataclass(frozen=True)
class Change:
    """One cause that changed.

    Attributes:
        effect: Of the catalogue.
        title: What a person calls it, with its place.
        place: Where it acts.
        level: Of the "machine", or an error of the "recording" or of a "run" of it.
        sizes: By how much.
        shape: Its other parameters, as they were tried.
        course: How it runs over the recordings.
        since: Name of the recording with which it sets in.
        advice: What to look at; "" where the title says that.
        nonlinearity: Share of what it changes by simulation that the linearised model misses; nan where not simulated.
        along: What else of its place may have changed by as large a share, which its intervals count.
    """

    effect: str
    title: str
    place: str
    level: Level
    sizes: tuple[ChangedSize, ...]
    shape: Mapping[str, float]
    course: Course
    since: str
    advice: str = ""
    nonlinearity: float = float("nan")
    along: tuple[str, ...] = ()


@dataclass(frozen=True)
class Explanation:
    """Changes that together explain the recordings.

    Attributes:
        changes: All of them.
        probability: That all of them happened, among everything that was weighed.
        log_odds: Logarithm of its posterior odds against a machine that stayed as it was.
    """

    changes: tuple[Change, ...]
    probability: float
    log_odds: float


@dataclass(frozen=True)
class PossibleName:
    """One of the causes that may be behind a finding.

    Attributes:
        effect, title, place: Of the cause, as of a `Change`.
        probability: That it changed, everything else that changed being what it is.
    """

    effect: str
    title: str
    place: str
    probability: float


@dataclass(frozen=True)
class ChangedFinding:
    """One change of the likeliest explanation, with what could stand in its place, everything else as it is.

    Attributes:
        names: The likeliest first; together they hold 99 %.
        probability: That any of them changed.
    """

    names: tuple[PossibleName, ...]
    probability: float


@dataclass(frozen=True)
class UnlistedChange:
    """A change that no effect of the catalogue explains: where it acts, and on what it depends.

    Attributes:
        title: In words.
        place, kind, depends_on: As in `diagnose.linearise.generic.Block`.
        course, since: As of a listed one.
        log_odds: Logarithm of its posterior odds against a machine that stayed as it was.
    """

    title: str
    place: str
    kind: str
    depends_on: str
    course: Course
    since: str
    log_odds: float


@dataclass(frozen=True)
class Component:
    """One parameter of one cause over the recordings, whether it changed or not.

    Attributes:
        effect, title, place: Of the cause.
        parameter, unit: Of its size.
        values: One for each recording after: its change against before.
        limit: Smallest lasting change that would have been found, of the shape that is seen best.
        worst: The same for the shape that is seen worst; inf where a shape is not seen.
        plausible: Largest plausible size.
        is_named: Whether it is part of an explanation.
    """

    effect: str
    title: str
    place: str
    parameter: str
    unit: str
    values: tuple[Interval, ...]
    limit: float
    worst: float
    plausible: float
    is_named: bool


@dataclass(frozen=True)
class Drift:
    """By how much a figure of the machine differs from before that drifts from day to day, which is no change.

    Attributes:
        name: Of the figure, with its place.
        unit: "" for a share of what the robot has.
        values: One for each recording after, against the mean of those before.
        expected: Standard deviation with which it was expected to differ.
    """

    name: str
    unit: str
    values: tuple[Interval, ...]
    expected: float


@dataclass(frozen=True)
class Compared:
    """One recording that was compared.

    Attributes:
        name: For people.
        is_after: Whether it was asked what changed in it.
        started: ISO 8601, None where nobody wrote it down.
        days: Since the first recording; nan where that is not known of all.
        instants: Rests and bins of motion.
        coinciding: Share of them in a state of the machine that another recording has too.
    """

    name: str
    is_after: bool
    started: str | None
    days: float
    instants: int
    coinciding: float


@dataclass(frozen=True)
class ChannelNoise:
    """How well a channel repeats, at rest or in motion.

    Attributes:
        column: Name.
        in_motion: Which.
        own: Standard deviation of what is new in each recording, in standard errors of the instrument; 1 at least.
        shared: The same of what the model misses every time.
        pairs: Readings in a state that another recording has too.
    """

    column: str
    in_motion: bool
    own: float
    shared: float
    pairs: int


@dataclass(frozen=True)
class LeftBefore:
    """A channel that the robot as it was misses in what was recorded before, by far more than a right model would.

    Attributes:
        column: Name.
        times: Root mean square of what it leaves, figures fitted, in what is expected of a right model
            (`diagnose/cross_validation/floor.py`).
    """

    column: str
    times: float


@dataclass(frozen=True)
class Comparison:
    """What changed.

    Attributes:
        recordings: Those before first.
        false_alarm_rate: Declared for everything that was tried at once.
        threshold: Log evidence that chance exceeds at that rate, of a change that comes with the first one after.
        probability_unchanged: That nothing changed, among everything that was weighed.
        explanations: That the data cannot tell apart, the likeliest first; empty where nothing listed changed.
        findings: The likeliest explanation finding by finding, each with all names that it may have.
        unlisted: What changed and is not listed.
        components: Every parameter of every cause of the machine.
        noise: How well channels repeat.
        drifts: What drifted from day to day, where the recordings tell it, beside the likeliest explanation.
        left_out: Columns that were read before or after alone, and say nothing of a change.
        left_before: Channels that the robot as it was misses before, the worst first: the names of what changed are no
            better than that robot.
        unfinished: Why it ended before it was done; None: it was.
        robot: Where the robot as it was comes from.
    """

    recordings: tuple[Compared, ...]
    false_alarm_rate: float
    threshold: float
    probability_unchanged: float
    explanations: tuple[Explanation, ...]
    findings: tuple[ChangedFinding, ...]
    unlisted: UnlistedChange | None
    components: tuple[Component, ...]
    noise: tuple[ChannelNoise, ...]
    drifts: tuple[Drift, ...] = ()
    left_out: tuple[str, ...] = ()
    left_before: tuple[LeftBefore, ...] = ()
    unfinished: Unfinished | None = None
    robot: Origin = "fitted"

    @property
    def has_changed(self) -> bool:
        """Whether anything is said to have changed."""
        return bool(self.explanations) or self.unlisted is not None

    @property
    def has_other_explanations(self) -> bool:
        """Whether an explanation is more than the likeliest one with other names for its findings."""
        names = [{(one.effect, one.place) for one in finding.names} for finding in self.findings]
        for explanation in self.explanations:
            keys = {(change.effect, change.place) for change in explanation.changes}
            if len(keys) != len(names) or not all(keys & own for own in names) or not keys <= set().union(*names):
                return True
        return False

    def as_json(self) -> dict[str, Any]:
        """Return the content of `compare.json`."""
        return {"format": 1, "has_changed": self.has_changed, **asdict(self)}
