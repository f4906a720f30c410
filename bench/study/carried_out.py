"""Do what is planned and not done yet, wherever an executor works, and write every row when it is there."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any, Protocol, TypeVar

from bench.errors import InputError
from bench.executor.contract import Executor, Progress
from bench.study.rows import Row, append, read_rows, study_of


class Planned(Protocol):
    """One row that is to be made."""

    @property
    def name(self) -> str:
        """Unique in its study."""


P = TypeVar("P", bound=Planned)
R = TypeVar("R", bound=Row)


P_contra = TypeVar("P_contra", bound=Planned, contravariant=True)
R_co = TypeVar("R_co", bound=Row, covariant=True)


class Work(Protocol[P_contra, R_co]):
    """Makes rows, as plain data: it may go to any process that has the same code."""

    def prepare(self, executor: Executor) -> None:
        """Make what all rows share."""

    def __call__(self, trial: P_contra, progress: Progress, /) -> R_co:
        """Make one row."""


def carried_out(
    trials: Sequence[P],
    work: Work[P, R],
    file: Path,
    settings: Mapping[str, Any],
    parse: Callable[[str], R],
    executor: Executor,
    progress: Progress,
    say: Callable[[str], None],
) -> tuple[R, ...]:
    """Return one row for each trial; those that stand in the file already are not made again.

    Args:
        trials: What is planned.
        work: Makes a row.
        file: Of the rows, in a folder that exists.
        settings: Of the study, as plain data; "code" is its fingerprint.
        parse: Reads a row from its line.
        executor: Where rows are made.
        progress: Called with the share that is done.
        say: Called with a warning.

    Raises:
        InputError: Nothing is planned; or the file is of another study, or of one that other code began.
    """
    if not trials:
        raise InputError("this study has no campaign to make; ask for one at least.")
    rows = read_rows(file, settings, parse)
    if rows.damaged:
        lines = "line was" if rows.damaged == 1 else "lines were"
        say(f"{file}: {rows.damaged} damaged {lines} dropped; what stood there is done again.")
    done = {outcome.name: outcome for outcome in rows.outcomes}
    missing = [trial for trial in trials if trial.name not in done]
    if missing and executor.shares_memory:
        work.prepare(executor)
    before = 1 - len(missing) / len(trials)

    def told(share: float) -> None:
        progress(before + share * (1 - before))

    with file.open("a", encoding="utf-8") as stream, closing(executor.map(work, missing, told)) as results:
        for result in results:
            append(stream, result.value, study_of(settings))
            done[result.value.name] = result.value
    return tuple(done[trial.name] for trial in trials)
