"""Run a study: campaigns are made, diagnosed blind and written down one by one, wherever an executor works."""

from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from pathlib import Path
from time import process_time

import numpy as np
from scipy.linalg import LinAlgError
from threadpoolctl import threadpool_limits

from bench.effects.catalogue import catalogue
from bench.errors import BenchError, InputError
from bench.executor.contract import Executor, Progress, ignore
from bench.executor.serial import SERIAL
from bench.study.blind import diagnose_with
from bench.study.carried_out import carried_out
from bench.study.code import code_of
from bench.study.labs import Lab, Setup, prepare
from bench.study.make import lab_of, make
from bench.study.outcome import Answer, Outcome, answer_of, outcome_of
from bench.study.plan import Counts, Trial, plan
from bench.study.rows import ROWS

BRIEF = ("line", "repeat_at_end", "dwell", "pressure")  # effort: left out of a brief session
NULL_STREAM = 1  # of the campaign that detection limits come from; no trial has it


@dataclass(frozen=True)
class SetupSettings:
    """What decides the setup that all campaigns of a study share.

    Attributes:
        seed: Of all random numbers.
        session: Name or file of the session.
        code: Fingerprint of what makes and diagnoses the campaigns; by default that of this installation.
        brief: Whether only a part of the session is run (`BRIEF`): a diagnosis takes a fifth of the time.

    Raises:
        InputError: There is no such session.
    """

    seed: int = 1
    session: str = "session-study"
    code: str = ""
    brief: bool = False

    def __post_init__(self) -> None:
        if not self.code:
            object.__setattr__(self, "code", code_of(self.session))


@dataclass(frozen=True)
class Settings(SetupSettings):
    """What a study is; two with the same settings are the same study.

    Attributes:
        counts: How much is hidden.
    """

    counts: Counts = field(default_factory=Counts)


@dataclass(frozen=True)
class Campaigns:
    """The work of a study, as plain data: it may go to any process that has the same code.

    Attributes:
        settings: Of the study.
    """

    settings: Settings

    def prepare(self, executor: Executor) -> None:
        """Make what all campaigns share, so that workers need not that have what this process has in memory."""
        setup_of(self.settings, executor)

    def __call__(self, trial: Trial, _: Progress) -> Outcome:
        """Make and diagnose one campaign."""
        with threadpool_limits(1, "blas"):
            return run_trial(trial, setup_of(self.settings), self.settings.seed)


def run_study(
    settings: Settings,
    folder: Path,
    executor: Executor = SERIAL,
    progress: Progress = ignore,
    say: Callable[[str], None] = lambda words: None,
    work: Campaigns | None = None,
) -> tuple[Outcome, ...]:
    """Make and diagnose every campaign of a study; those that stand in the folder already are not done again.

    Every campaign becomes one line of `campaigns.jsonl` when it is done, so that a study that was interrupted goes on
    where it stood.

    Args:
        settings: Of the study.
        folder: Where to write; exists.
        executor: Where campaigns are made and diagnosed.
        progress: Called with the share that is done.
        say: Called with a warning.
        work: Makes and diagnoses a campaign; None: as the settings say.

    Raises:
        InputError: The folder holds another study, or one that other code began.
    """
    lab = Lab(settings.session)
    trials = plan(settings.counts, lab.compiled(), settings.seed, lab)
    work = work or Campaigns(settings)
    known = folder / ROWS, asdict(settings), Outcome.from_json
    return carried_out(trials, work, *known, executor, progress, say)


def run_trial(trial: Trial, setup: Setup, seed: int) -> Outcome:
    """Make one campaign, diagnose it, and only then look at what was hidden.

    A diagnosis that comes to no end is an outcome too.

    Args:
        trial: What to hide.
        setup: Of the ordinary lab.
        seed: Of the study.
    """
    start = process_time()
    made = make(trial, setup, seed)
    ready = process_time()
    campaign, compiled = made.campaign, setup.compiled
    if trial.twin is not None:  # its lab may have another robot
        compiled = lab_of(trial, setup).compiled()
    try:
        answer = answer_of(diagnose_with(campaign, compiled, setup.catalogue).verdict)
    except (BenchError, LinAlgError) as error:
        answer = Answer("failed", failure=f"{type(error).__name__}: {error}")
    return outcome_of(trial, made, answer, ready - start, process_time() - ready)


_setups: dict[SetupSettings, Setup] = {}  # made once in a process, and the same in every one


def setup_of(settings: SetupSettings, executor: Executor = SERIAL) -> Setup:
    """Return what the campaigns of a study share.

    Raises:
        InputError: This process has other code than the one that began the study.
    """
    key = SetupSettings(settings.seed, settings.session, settings.code, settings.brief)
    if key not in _setups:
        code = code_of(settings.session)
        if code != settings.code:
            raise InputError(
                f"this worker has other code ({code}) than the study ({settings.code}); install the same version on it."
            )
        rng = np.random.default_rng([settings.seed, NULL_STREAM])
        lab = Lab(settings.session, BRIEF, is_brief=True) if settings.brief else Lab(settings.session)
        setup = prepare(lab, catalogue(), rng, executor=executor)
        _setups.clear()
        _setups[key] = setup
    return _setups[key]
