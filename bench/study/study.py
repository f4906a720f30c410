"""Run a study: campaigns are made, diagnosed blind and written down one by one, on all cores."""

import json
import multiprocessing
import os
import signal
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from time import process_time

import numpy as np
from scipy.linalg import LinAlgError

from bench import __version__
from bench.effects.catalogue import catalogue
from bench.errors import BenchError, InputError
from bench.store.store import Store
from bench.study.blind import diagnose_with, signatures_of
from bench.study.labs import Ground, Lab, prepare
from bench.study.make import make
from bench.study.outcome import Answer, Outcome, answer_of, outcome_of
from bench.study.plan import Counts, Trial, plan

ROWS = "campaigns.jsonl"
NULL_STREAM = 1  # of the campaign that signatures come from; no trial has it

_shared: tuple[Ground, int] | None = None  # of a worker, from the moment it is forked


@dataclass(frozen=True)
class Settings:
    """What a study is; two with the same settings are the same study.

    Attributes:
        counts: How much is hidden.
        seed: Of all random numbers.
        session: Name or file of the session.
        version: Of the bench.
    """

    counts: Counts = field(default_factory=Counts)
    seed: int = 1
    session: str = "session-study"
    version: str = __version__


Progress = Callable[[float], None]


def run_study(
    settings: Settings,
    folder: Path,
    cores: int,
    progress: Progress = lambda share: None,
    store: Store | None = None,
) -> tuple[Outcome, ...]:
    """Make and diagnose every campaign of a study; those that stand in the folder already are not done again.

    Every campaign becomes one line of `campaigns.jsonl` when it is done, so that a study that was interrupted goes on
    where it stood.

    Args:
        settings: Of the study.
        folder: Where to write; exists.
        cores: Processes.
        progress: Called with the share that is done.
        store: Where the signatures of the session are kept between processes; None: nowhere.

    Raises:
        InputError: The folder holds another study.
    """
    rows = folder / ROWS
    done = {outcome.name: outcome for outcome in read_rows(rows, settings)}
    lab = Lab(settings.session)
    trials = _plan(settings, lab)
    missing = [trial for trial in trials if trial.name not in done]
    if missing:
        before = os.environ.get("BENCH_CORES")
        os.environ["BENCH_CORES"] = str(cores)
        try:
            ground = prepare(lab, catalogue(), np.random.default_rng([settings.seed, NULL_STREAM]), store=store)
            os.environ["BENCH_CORES"] = "1"  # of each worker: there is one for each core already
            with rows.open("a", encoding="utf-8") as file:
                for outcome in _all(missing, ground, settings.seed, cores):
                    file.write(outcome.as_json() + "\n")
                    file.flush()
                    done[outcome.name] = outcome
                    progress(len(done) / len(trials))
        finally:
            _restore("BENCH_CORES", before)
    return tuple(done[trial.name] for trial in trials)


def read_rows(rows: Path, settings: Settings) -> list[Outcome]:
    """Return the campaigns that are done; writes the head of a new file. A line that was cut off is taken away.

    Raises:
        InputError: The file is of another study.
    """
    head = json.dumps(asdict(settings))
    if not rows.exists():
        rows.write_text(head + "\n", encoding="utf-8")
        return []
    first, *lines = rows.read_text(encoding="utf-8").splitlines() or [""]
    if first != head:
        raise InputError(f"{rows}: is of a study with other settings; choose another folder.")
    found = []
    for line in lines:
        try:
            found.append(Outcome.from_json(line))
        except ValueError:
            break
    whole = "".join(f"{line}\n" for line in [head, *lines[: len(found)]])
    rows.write_text(whole, encoding="utf-8")
    return found


def run_trial(trial: Trial, ground: Ground, seed: int) -> Outcome:
    """Make one campaign, diagnose it, and only then look at what was hidden.

    A diagnosis that comes to no end is an outcome too.

    Args:
        trial: What to hide.
        ground: Of the ordinary lab.
        seed: Of the study.
    """
    start = process_time()
    made = make(trial, ground, seed)
    ready = process_time()
    campaign, signatures = made.hidden.campaign, ground.signatures
    if trial.twin is not None:  # its lab has other instruments, or another robot
        lab = trial.twin.extra if trial.is_split else trial.twin.ordinary
        signatures = signatures_of(campaign, lab.compiled(), ground.catalogue)
    try:
        answer = answer_of(diagnose_with(campaign, signatures, ground.catalogue).verdict)
    except (BenchError, LinAlgError) as error:
        answer = Answer("failed", failure=f"{type(error).__name__}: {error}")
    return outcome_of(trial, made, answer, ready - start, process_time() - ready)


def _plan(settings: Settings, lab: Lab) -> tuple[Trial, ...]:
    return plan(settings.counts, lab.compiled(), settings.seed)


def _all(trials: Sequence[Trial], ground: Ground, seed: int, cores: int) -> Iterator[Outcome]:
    """Yield outcomes as they come; workers are forked and have the ground already."""
    global _shared
    _shared = (ground, seed)
    try:
        if cores == 1 or "fork" not in multiprocessing.get_all_start_methods():
            yield from map(_run, trials)
            return
        with multiprocessing.get_context("fork").Pool(cores, _start_worker) as pool:
            yield from pool.imap_unordered(_run, trials)
    finally:
        _shared = None


def _start_worker() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent decides


def _run(trial: Trial) -> Outcome:
    assert _shared
    ground, seed = _shared
    return run_trial(trial, ground, seed)


def _restore(name: str, value: str | None) -> None:
    if value is None:
        os.environ.pop(name, None)
    else:
        os.environ[name] = value
