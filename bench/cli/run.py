"""`bench run`: a scenario on the virtual robot."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro


@dataclass(frozen=True)
class Run:
    """Run a scenario on the virtual robot; write the campaign, apart from it the truth, and a Rerun recording.

    The K_C analysis (`complementary`) has no campaign; it writes numbers and figures.
    """

    scenario: tyro.conf.Positional[str]
    """Name of a scenario that comes along, or path to a scenario file."""
    out: Annotated[Path, tyro.conf.arg(aliases=["-o"])]
    """Folder to write; must not exist yet."""
    seed: int | None = None
    """Overrides the scenario's seed."""
    parquet: bool = False
    """Write tables as Parquet instead of CSV."""

    def run(self) -> int:
        """Run the scenario; return the exit code."""
        from bench.cli.progress import progress_bar
        from bench.cli.seeds import checked_seed
        from bench.record.folder import new_folder
        from bench.record.truth import expect_apart
        from bench.report.paper.complementary.run import NUMBERS, run_complementary
        from bench.report.results import RECORDING, write_session
        from bench.scenario.complementary import Complementary
        from bench.scenario.files import read_scenario, said_of
        from bench.simulate.session import run_session

        scenario = read_scenario(self.scenario)
        if isinstance(scenario, Complementary):
            with new_folder(self.out, NUMBERS, replace=False) as folder, said_of(self.scenario):
                run_complementary(scenario, folder)
            print(f"numbers and figures  {self.out}")
            return 0
        if self.seed is not None:
            scenario = type(scenario).model_validate(scenario.model_dump() | {"seed": checked_seed(self.seed)})
        expect_apart(self.out)
        with new_folder(self.out, RECORDING, replace=False) as folder:
            with progress_bar(f"{scenario.experiment} on {scenario.robot}") as progress, said_of(self.scenario):
                session = run_session(scenario, progress)
            write_session(session, folder, "parquet" if self.parquet else "csv")
        print(f"campaign   {self.out / 'campaign'}")
        print(f"truth      {self.out / 'truth'}")
        print(f"recording  {self.out / 'session.rrd'}   (bench view {self.out})")
        return 0
