"""`bench demo`: hide an effect at random, look for it, say whether that was right."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro


@dataclass(frozen=True)
class Demo:
    """Hide an effect at random, diagnose the campaign blind, and hold the verdict against the truth.

    Half a minute to two minutes of processor time. It may be wrong; `bench study` says how often.
    """

    out: Annotated[Path | None, tyro.conf.arg(aliases=["-o"])] = None
    """Folder to write; must not exist yet. Without it: demo-SEED."""
    seed: int | None = None
    """Of what is hidden; without it another one every time."""

    def run(self) -> int:
        """Hide, diagnose, print both and write; return the exit code."""
        import sys
        import time

        from bench.cli.seeds import checked_seed
        from bench.executor.local import on_cores
        from bench.hide.write import CAMPAIGN, write_hidden
        from bench.record.folder import new_folder
        from bench.report.diagnosis.write import write_diagnosis
        from bench.study.demo import hide_and_seek, judgement

        seed = int(time.time()) % 100_000 if self.seed is None else checked_seed(self.seed)
        out = self.out or Path(f"demo-{seed}")
        with new_folder(out, CAMPAIGN, replace=False) as folder:
            demo = hide_and_seek(seed, lambda words: print(f"... {words}", file=sys.stderr), on_cores())
            write_hidden(demo.hidden, folder)
            (folder / "diagnosis").mkdir()
            sentences = write_diagnosis(demo.diagnosis, folder / "diagnosis")
        for line in sentences:
            print(line)
        for one in demo.made.effects:
            print(f"\nHidden: {one.acting} ({one.size / one.limit:.0f} times what this session can just see)")
        print(judgement(demo.outcome))
        print(f"\nDiagnosis  {out / 'diagnosis'}\nCampaign   {out / 'campaign'}\nTruth      {out / 'truth'}")
        print(f"Again with `bench demo --seed {seed} -o FOLDER`, or another one with `bench demo`.")
        return 0
