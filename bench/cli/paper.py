"""`bench paper`: the main job."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro


@dataclass(frozen=True)
class Paper:
    """The paper's measurements and the virtual robot, identified by every method, side by side."""

    out: Annotated[Path, tyro.conf.arg(aliases=["-o"])] = Path("results-paper")
    """Folder to write."""
    replace: bool = False
    """Replace a results folder that stands there already."""
    in_time: bool = False
    """Also run some protocols of the loading experiment in time, in each friction world: a minute more."""
    cores: int = 0
    """Processes; 0: one for each core."""

    def run(self) -> int:
        """Run everything, print the table, name the folder; return the exit code."""
        from bench.cli.progress import progress_bar
        from bench.errors import InputError
        from bench.executor.local import on_cores
        from bench.record.folder import new_folder
        from bench.report.paper.run import RESULTS, print_paper, run_paper

        if (self.out / RESULTS).is_file() and not self.replace:
            raise InputError(f"{self.out}: holds results already; choose another folder, or give --replace.")
        with new_folder(self.out, RESULTS, self.replace) as folder, progress_bar("the paper's experiments") as progress:
            executor = on_cores(self.cores, "spawn")  # recordings are written by threads, which are not forked
            result = run_paper(folder, progress, executor, self.in_time)
        print_paper(result)
        print(f"\nResults: {self.out.resolve()}")
        print(f"Look at an experiment with, for example: bench view {self.out / 'loading' / 'link-side'}")
        return 0
