"""`bench study`: the diagnosis held to its goals, over hundreds of campaigns with hidden effects."""

import sys
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import tyro

if TYPE_CHECKING:
    from contextlib import AbstractContextManager

    from bench.executor.contract import Executor
    from bench.study.study import Settings


VARIED = "vary.json"


@dataclass(frozen=True)
class Study:
    """Hide effects in hundreds of campaigns, diagnose them blind, and hold the answers against the truth.

    Hours on two cores: 15 s to some minutes of processor time a campaign. Every campaign that is done stands in the
    folder; after an interruption the same command goes on from there, as long as the code is the same.
    """

    out: Annotated[Path, tyro.conf.arg(aliases=["-o"])]
    """Folder to write; may hold the same study, to go on with it."""
    small: bool = False
    """A few campaigns of each kind, in some minutes. Of what is below, `world` and `seed` alone count then."""
    seeds: int = 6
    """Campaigns for each single effect."""
    effects: tuple[str, ...] = ()
    """Names of the single effects and of those in pairs; none: all of the catalogue that can act on the robot."""
    nulls: int = 200
    """Campaigns without any effect."""
    unlisted: int = 40
    """Campaigns with an effect that is not in the catalogue."""
    pairs: int = 40
    """Campaigns with two effects."""
    twins: bool = True
    """The four pairs of twins, each in an ordinary session and in one that splits them."""
    world: tuple[Literal["plain", "messy", "presliding", "servo", "second", "resting"], ...] = ()
    """In which all of this is hidden: plain (if none is given), messy (10 to 60 other small effects), presliding,
    servo (that gives), second (another plant), resting (there, links rest anywhere that friction holds them); several:
    a study of each."""
    recordings: int = 0
    """Instead of this: so many recordings of each of `seeds` messy machines of each of `kinds`. They are diagnosed
    together, the last is predicted by the others, and two of them are compared, with and without a change. Of what is
    above, `effects`, `seeds`, `small` and `world` count; of worlds, messy (as without any), second and resting, one of
    them."""
    kinds: tuple[Literal["none", "machine", "one", "unchanged", "changed"], ...] = (
        "none",
        "machine",
        "one",
        "unchanged",
        "changed",
    )
    """With `recordings`: what is hidden, and whether machines are diagnosed or compared (bench/study/README.md)."""
    brief: bool = False
    """With `recordings`: sweeps of 15 degrees with the heaviest payload, no line, no dwell and no pressure, so that a
    diagnosis takes a fifth of the time."""
    vary: str | None = None
    """Instead of a study: halve and double each named number of the diagnosis that matches, such as "name.*" or
    "*.PROMISING", and print what that moves in a handful of campaigns. Of what is above, nothing counts but `out`."""
    seed: int = 1
    """Of all random numbers."""
    cores: int = 0
    """Processes; 0: one for each core."""
    scheduler: str | None = None
    """Address of a Dask scheduler, such as tcp://10.0.0.1:8786, whose workers do the work (bench/study/README.md)."""

    def run(self) -> int:
        """Run, print the table and name the folder; return the exit code."""
        from bench.cli.seeds import checked_seed
        from bench.errors import InputError
        from bench.study.plan import SMALL, Counts
        from bench.study.study import Settings

        if self.recordings and self.recordings < 2:
            raise InputError(
                f"--recordings {self.recordings}: a machine has to be recorded twice at least; give 2 or more."
            )
        if self.vary is not None:
            from bench.study.constants import constants_of

            if not constants_of(self.vary):
                raise InputError(f"--vary {self.vary}: no number is named so; give a pattern such as 'name.*'.")
        worlds = self.world or ("plain",)
        counts = Counts(self.seeds, self.nulls, self.unlisted, self.pairs, self.twins, self.effects, worlds)
        if self.small:
            counts = replace(SMALL, worlds=worlds)
        settings = Settings(checked_seed(self.seed), counts=counts)
        workers = self._workers()
        is_new = not self.out.exists()
        try:
            return self._in_folder(workers, settings)
        finally:
            if is_new and self.out.is_dir() and not any(self.out.iterdir()):
                self.out.rmdir()  # it ended in an error before anything was made

    def _in_folder(self, workers: "AbstractContextManager[Executor]", settings: "Settings") -> int:
        """Run the study in its folder; return the exit code."""
        from bench.cli.progress import progress_bar
        from bench.errors import InputError
        from bench.report.study.words import measured_words, met_words
        from bench.report.study.write import PAGE, write_study
        from bench.study.labs import Lab
        from bench.study.rows import ROWS
        from bench.study.scores import scores_of
        from bench.study.study import run_study

        try:
            self.out.mkdir(parents=True, exist_ok=True)
            if any(self.out.iterdir()) and not any((self.out / name).exists() for name in (ROWS, VARIED)):
                raise InputError(f"{self.out}: is not empty, and holds no study to go on with; choose another name")
        except OSError as error:
            raise InputError(f"{self.out}: cannot be made ({error.strerror}); choose another folder") from error
        if self.vary is not None:
            return self._vary(self.vary)
        if self.recordings:
            return self._several()
        with workers as executor, progress_bar("campaigns") as progress:
            outcomes = run_study(settings, self.out, executor, progress, _warn)
        scores = scores_of(outcomes)
        write_study(outcomes, scores, settings, Lab(settings.session).words(), self.out)
        for goal in scores.goals:
            print(f"{met_words(goal):13}{goal.name}: {measured_words(goal.measured)} (goal {goal.goal})")
        print(f"\nStudy: {self.out.resolve() / PAGE}")
        return 0

    def _workers(self) -> "AbstractContextManager[Executor]":
        """Return what does the work: a cluster, or this machine."""
        from contextlib import nullcontext

        from bench.executor.cluster import Cluster
        from bench.executor.local import on_cores

        return Cluster(self.scheduler) if self.scheduler else nullcontext(on_cores(self.cores))

    def _several(self) -> int:
        """Run the study of several recordings, print its numbers and write them down."""
        from bench.cli.progress import progress_bar
        from bench.report.study.several import lines_of, write_several
        from bench.study.several import SeveralSettings, run_several
        from bench.study.several_scores import several_goals
        from bench.study.worlds import world_of_machines

        machines = 1 if self.small else self.seeds
        settings = SeveralSettings(
            self.seed,
            brief=self.brief,
            recordings=self.recordings,
            machines=machines,
            effects=self.effects,
            kinds=self.kinds,
            world=world_of_machines(self.world),
        )
        with self._workers() as executor, progress_bar("machines") as progress:
            outcomes = run_several(settings, self.out, executor, progress, _warn)
        goals = several_goals(outcomes)
        for line in lines_of(goals):
            print(line)
        print(f"\nStudy: {write_several(goals, outcomes, settings, self.out).resolve()}")
        return 0

    def _vary(self, pattern: str) -> int:
        """Print what constants move, and write it down."""
        import json
        from dataclasses import asdict

        from bench.cli.progress import progress_bar
        from bench.executor.local import on_cores
        from bench.study.study import Settings
        from bench.study.vary import FEW, lines_of, vary

        with progress_bar("constants") as progress:
            found = vary(pattern, Settings(self.seed, counts=FEW), on_cores(self.cores, "spawn"), progress)
        for variation, moved in found:
            print("\n".join(lines_of(variation, moved)))
        rows = [asdict(variation) | {"moved": [asdict(one) for one in moved]} for variation, moved in found]
        (self.out / VARIED).write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
        return 0


def _warn(words: str) -> None:
    print(f"bench: {words}", file=sys.stderr)
