"""`bench compare`: what changed on a machine between recordings of it."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import tyro

from bench.cli.command_line import command_line

CHANGED = 9  # exit code


@dataclass(frozen=True)
class Compare:
    """Say what changed on a machine between two or more campaigns of it, and by how much.

    Whatever stayed as it was is not blamed, however wrong the model is: it is learned from BEFORE, to which the
    robot's figures are fitted first, and what its drawing leaves out. Where that leaves more than twice the noise,
    BEFORE is diagnosed, which takes minutes; --robot with the folder of a diagnosis saves them. Best with the same
    motion before and after, a routine check; then everything that stayed cancels. With three or more campaigns after,
    courses over time are told apart: a step, something that was there once, a trend.
    """

    before: tyro.conf.Positional[Path]
    """Campaign folder of the machine as it was; several recordings in it count as repeats."""
    after: tyro.conf.Positional[tuple[Path, ...]]
    """Campaign folders made later, one or more."""
    out: Annotated[Path | None, tyro.conf.arg(aliases=["-o"])] = None
    """Folder to write compare.json and report.html into; must not exist yet. By default nothing is written."""
    robot: str = ""
    """Robot to take, name or folder; the folder of a diagnosis, such as one of BEFORE, stands for the robot that it
    handed over. By default the campaigns name it."""
    file: tuple[Path, ...] = ()
    """Python files with effects of your own (bench/effects/README.md)."""
    despite_doubts: bool = False
    """Go on although channels failed plausibility checks; by default that ends in an error."""
    cores: int = 0
    """Processes; 0: one for each core. The result does not depend on it."""
    at_most: str | None = None
    """Time after which to end with what was found so far, such as 90, 60s or 2m; so does Ctrl-C."""
    store: bool = True
    """Keep simulated signatures on disk for later, and use those that are kept (bench/store/README.md)."""

    def run(self) -> int:
        """Compare, print and write; return the exit code: 0: nothing changed; 9: something did; 7: ended early."""
        import sys
        from contextlib import nullcontext
        from math import inf
        from tempfile import TemporaryDirectory

        from bench.cli.doubts import heed
        from bench.cli.joints import by_number
        from bench.cli.progress import phases
        from bench.cli.stopping import UNFINISHED, ending_on_interrupt, seconds_of
        from bench.compare.as_it_was import as_it_was
        from bench.compare.compare import compare
        from bench.compare.recordings import recordings_of
        from bench.effects.catalogue import catalogue
        from bench.effects.own import try_out
        from bench.errors import InputError
        from bench.executor.local import on_cores
        from bench.executor.watched import Stop, Stopped, Watched
        from bench.record.folder import new_folder
        from bench.report.comparison.recordings import open_compared
        from bench.report.comparison.words import words_of
        from bench.report.comparison.write import COMPARISON, REPORT, write_comparison
        from bench.report.prediction.model import known_of, load_model
        from bench.store.place import open_store

        if not self.after:
            raise InputError("give the campaign of the machine as it was, and at least one made later.")
        stop = Stop(inf if self.at_most is None else seconds_of(self.at_most))
        robot = load_model(self.robot) if self.robot else None
        known = catalogue()
        effects = catalogue(self.file)
        opened = open_compared((self.before, *self.after), robot)
        heed(opened.warnings, opened.doubts, despite_doubts=self.despite_doubts)
        compiled = opened.robots[0]
        try_out([effect for name, effect in effects.items() if name not in known], compiled)
        (name, before), *later = opened.campaigns.items()
        recordings = recordings_of({name: before}, dict(later))
        out = new_folder(self.out, COMPARISON, replace=False) if self.out else nullcontext()
        try:
            with ending_on_interrupt(stop), out as folder, phases() as shown, TemporaryDirectory() as files:
                executor = Watched(on_cores(self.cores), check=stop.check, shows=shown.share)
                is_handed_over = robot is not None and known_of(robot.folder) is not None
                store = open_store() if self.store else None
                begun = as_it_was(
                    before,
                    compiled,
                    Path(files),
                    effects,
                    is_handed_over=is_handed_over,
                    progress=shown.phase,
                    executor=executor,
                    store=store,
                    check=stop.check,
                )
                found = compare(
                    recordings,
                    begun.robot,
                    effects,
                    progress=shown.phase,
                    executor=executor,
                    store=store,
                    check=stop.check,
                )
                found = replace(found, robot=begun.origin)
                if folder:
                    write_comparison(found, folder, compiled.robot.figures.titled, self.command)
        except Stopped as stopped:
            print(f"bench: {stopped}: nothing was weighed yet, so nothing is known of any change.", file=sys.stderr)
            return UNFINISHED
        for line in (*by_number(compiled), *words_of(found)):
            print(line)
        if self.out:
            print(f"report     {self.out / REPORT}")
            print(f"numbers    {self.out / COMPARISON}")
        if found.unfinished:
            return UNFINISHED
        return CHANGED if found.has_changed else 0

    @property
    def command(self) -> str:
        """What to type to do it again."""
        return command_line("compare", self)
