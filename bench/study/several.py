"""The study of several recordings of one machine: joint diagnoses, predictions of the last, and what changed."""

from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from time import process_time

import numpy as np
from scipy.linalg import LinAlgError
from threadpoolctl import threadpool_limits

from bench.diagnose.cross_validation.floor import floor_variance, measured
from bench.diagnose.cross_validation.next_recording import predicted_error
from bench.diagnose.diagnose import Diagnosis
from bench.diagnose.linearise.nominal_model import linearised_model_of
from bench.diagnose.replay.levels import handed_over
from bench.diagnose.replay.nuisances import nuisances_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.effects.catalogue import catalogue
from bench.effects.effect import IN_RECORDING
from bench.errors import BenchError, InputError, unknown_names
from bench.executor.contract import Executor, Progress, ignore
from bench.executor.serial import SERIAL
from bench.predict.errors import channel_errors
from bench.record.campaign import Campaign
from bench.record.carried import with_payloads
from bench.record.joined import joined
from bench.study import changes
from bench.study.blind import diagnose_with
from bench.study.carried_out import carried_out
from bench.study.labs import Lab, Setup
from bench.study.line import JsonLine
from bench.study.machines import Kind, Machine, MachineTrial, machine_of
from bench.study.outcome import Name
from bench.study.study import SetupSettings, setup_of
from bench.study.worlds import MachineWorld, catalogue_in

ROWS = "machines.jsonl"
KINDS: tuple[Kind, ...] = ("none", "machine", "one", "unchanged", "changed")


@dataclass(frozen=True)
class SeveralSettings(SetupSettings):
    """What such a study is; two with the same settings are the same study.

    Attributes:
        recordings: Of each machine, two at least.
        machines: Of each kind.
        effects: Names of what is hidden where anything is; empty: all that can act.
        kinds: What is made.
        world: Of all machines: messy, of the first plant or of the second.

    Raises:
        InputError: An effect that cannot be hidden in this world.
    """

    recordings: int = 3
    machines: int = 8
    effects: tuple[str, ...] = ()
    kinds: tuple[Kind, ...] = KINDS
    world: MachineWorld = "messy"

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.effects:
            return
        lab = Lab(self.session)
        compiled, there = lab.compiled(), catalogue_in(self.world, catalogue())
        known = tuple(name for name, effect in there.items() if lab.places(effect, compiled))
        if unknown := unknown_names("effect that can act there", self.effects, known):
            raise InputError(unknown)

    @property
    def trials(self) -> tuple[MachineTrial, ...]:
        """Machine by machine, so that a study that was stopped has some of every kind."""
        return tuple(
            MachineTrial(kind, i, self.recordings, self.effects, self.world)
            for i in range(self.machines)
            for kind in self.kinds
        )


@dataclass(frozen=True)
class JointFinding:
    """One finding of a joint diagnosis.

    Attributes:
        names: Effect and place, the likeliest first.
        is_machine: Whether it is said to be the machine's, not one recording's.
        confirmed_by: Recordings that become three times as probable with it, fitted to the others.
        acts: Whether any of its names acts as it says.
    """

    names: tuple[Name, ...]
    is_machine: bool
    confirmed_by: int
    acts: bool


@dataclass(frozen=True)
class JointAnswer:
    """What a joint diagnosis says of a machine, beside the truth.

    Attributes:
        hidden: In words; "" for nothing.
        cause: Effect and place of what is hidden, as of the machine; None: nothing.
        only: Recording in which alone it acts; "": in all.
        findings: The likeliest first.
        unlisted: Whether something unlisted is said to be there.
        promised: Intervals of errors of the last recording that the others promise; 0 where that was not tried.
        more, less: How many errors were larger, and smaller, than promised.
    """

    hidden: str
    cause: Name | None
    only: str
    findings: tuple[JointFinding, ...]
    unlisted: bool
    promised: int = 0
    more: int = 0
    less: int = 0

    @property
    def is_right(self) -> bool:
        """Whether what is hidden is among the names of a finding at its level."""
        assert self.cause
        effect, place = self.cause
        name = (effect, _in_recording(place, self.only)) if self.only else self.cause
        return any(name in finding.names and finding.is_machine == (not self.only) for finding in self.findings)

    @property
    def is_called_machines(self) -> bool:
        """Whether what is hidden in one recording is the likeliest name of a finding of the machine."""
        return bool(self.only) and any(f.is_machine and f.names[0] == self.cause for f in self.findings)


@dataclass(frozen=True)
class SeveralOutcome(JsonLine):
    """One machine of the study; exactly one of joint, change and failure says something.

    Attributes:
        name, kind: Of its trial.
        joint: Of a joint diagnosis.
        change: Of a comparison.
        failure: Why there is neither.
        make_s, answer_s: Processor time [s].
    """

    name: str
    kind: Kind
    joint: JointAnswer | None
    change: changes.Outcome | None
    failure: str
    make_s: float
    answer_s: float


@dataclass(frozen=True)
class Machines:
    """The work of such a study, as plain data."""

    settings: SeveralSettings

    def prepare(self, executor: Executor) -> None:
        """Make what all machines share."""
        setup_of(self.settings, executor)

    def __call__(self, trial: MachineTrial, _: Progress) -> SeveralOutcome:
        """Record one machine and ask of it."""
        with threadpool_limits(1, "blas"):
            return answered(trial, setup_of(self.settings), self.settings.seed)


def run_several(
    settings: SeveralSettings,
    folder: Path,
    executor: Executor = SERIAL,
    progress: Progress = ignore,
    say: Callable[[str], None] = lambda words: None,
    work: Machines | None = None,
) -> tuple[SeveralOutcome, ...]:
    """Make every machine of a study; those that stand in the folder already are not made again.

    Args:
        settings: Of the study.
        folder: Where to write; exists.
        executor: Where machines are made.
        progress: Called with the share that is done.
        say: Called with a warning.
        work: Makes a machine and asks of it; None: as the settings say.

    Raises:
        InputError: The folder holds another study, or one that other code began.
    """
    known = folder / ROWS, asdict(settings), SeveralOutcome.from_json
    return carried_out(settings.trials, work or Machines(settings), *known, executor, progress, say)


def answered(trial: MachineTrial, setup: Setup, seed: int) -> SeveralOutcome:
    """Record one machine, ask of it, and only then look at what was hidden."""
    start = process_time()
    if trial.kind in ("unchanged", "changed"):
        pair = changes.pair_of(setup, trial.number, seed, with_change=trial.kind == "changed", world=trial.world)
        ready = process_time()
        change = changes.outcome_of(pair, setup)
        return SeveralOutcome(trial.name, trial.kind, None, change, "", ready - start, process_time() - ready)
    machine = machine_of(trial, setup, seed)
    ready = process_time()
    joint, failure = None, ""
    try:
        joint = _joint(machine, setup, predicts=trial.kind != "one")
    except (BenchError, LinAlgError) as error:
        failure = f"{type(error).__name__}: {error}"
    return SeveralOutcome(trial.name, trial.kind, joint, None, failure, ready - start, process_time() - ready)


def _joint(machine: Machine, setup: Setup, *, predicts: bool) -> JointAnswer:
    diagnosis = _diagnosed(machine.campaign, setup)
    answers = Counter[str](_answers(machine, setup)) if predicts else Counter[str]()
    confirmed = {
        cause.name: len(step.confirmed_by) for step in diagnosis.verdict.steps if step.accepted for cause in step.added
    }
    findings = []
    for group in diagnosis.verdict.findings:
        names = tuple(one.cause.name for one in group.names)
        first = group.names[0].cause
        is_machine = first.level == "machine" and IN_RECORDING not in first.place
        by = max((confirmed.get(name, 0) for name in names), default=0)
        findings.append(JointFinding(names, is_machine, by, any(name in machine.truth for name in names)))
    hidden = machine.hidden.acting if machine.hidden else None
    return JointAnswer(
        str(hidden) if hidden else "",
        (hidden.effect.name, str(hidden.place)) if hidden else None,
        machine.only,
        tuple(findings),
        diagnosis.verdict.unlisted is not None,
        sum(n for answer, n in answers.items() if answer != "not promised"),
        answers["more"],
        answers["less"],
    )


def _diagnosed(campaign: Campaign, setup: Setup) -> Diagnosis:
    return diagnose_with(campaign, setup.compiled, setup.catalogue)


def _answers(machine: Machine, setup: Setup) -> Iterable[str]:
    """Return whether errors of the last recording keep what a diagnosis of all others promises, channel by channel."""
    *others, last = machine.recordings
    diagnosis = _diagnosed(joined({name: machine.recordings[name] for name in others}), setup)
    fit = diagnosis.extension or diagnosis.naming.null
    promises = predicted_error(diagnosis.linear, fit)
    world = handed_over(fit.world(diagnosis.linear), others if len(others) > 1 else [""])
    campaign, quantities = with_payloads(machine.recordings[last]), diagnosis.linear.quantities
    replay = Replay(setup.compiled, segments_of(campaign, setup.compiled, quantities), quantities)
    linear = linearised_model_of(replay, nuisances_of(setup.compiled, quantities))
    error = np.where(measured(linear), replay.observed - replay.predict(world), np.nan)
    found = channel_errors(linear, error, linear.residual, np.sqrt(floor_variance(linear)), promises)
    return [channel.answer for channel in found]


def _in_recording(place: str, recording: str) -> str:
    """Return the name of a place in one recording: there a drive is not called a joint."""
    return f"{place.replace('joint ', 'drive ')}{IN_RECORDING}{recording}"
