"""`bench diagnose`: what the simulation gets wrong about a campaign."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

WAYS_OUT = (
    "Put this right first: a verdict would blame the robot for it. A column that cannot be mended is left out when its "
    "name begins with _; if all is as it should be, give --despite-doubts."
)


@dataclass(frozen=True)
class Diagnose:
    """Say what the nominal model gets wrong about measured data, name the cause, and write the extended model.

    Half a minute to two minutes on two cores. A cause is taken only where it pays on runs it was not fitted to; the
    threshold is such that chance alone passes it in 1 of 100 campaigns. How often it is right stands in the README.
    """

    campaign: tyro.conf.Positional[Path]
    """Campaign folder (format: bench/record/README.md)."""
    out: Annotated[Path, tyro.conf.arg(aliases=["-o"])]
    """Folder to write; must not exist yet."""
    file: tuple[Path, ...] = ()
    """Python files with effects of your own (bench/effects/README.md)."""
    despite_doubts: bool = False
    """Go on although channels are hardly what their names say; by default that ends in an error."""
    no_store: bool = False
    """Simulate all signatures anew and keep none on disk (bench/store/README.md)."""

    def run(self) -> int:
        """Diagnose, print and write; return the exit code."""
        import sys

        from bench.diagnose.diagnose import diagnose
        from bench.diagnose.doubt.channels import doubts_of
        from bench.effects.catalogue import catalogue
        from bench.effects.own import try_out
        from bench.errors import CampaignError
        from bench.record.folder import new_folder
        from bench.report.campaigns import open_campaign
        from bench.report.diagnosis.file_names import VERDICT
        from bench.report.diagnosis.words import places_of, words_of
        from bench.report.diagnosis.write import write_diagnosis
        from bench.store.place import open_store

        effects = catalogue(self.file)
        report, compiled = open_campaign(self.campaign)
        campaign = report.usable()
        assert compiled
        try_out([effect for name, effect in effects.items() if name not in catalogue()], compiled)
        doubts = (*report.doubts, *doubts_of(campaign, compiled, report.findings))
        if doubts and not self.despite_doubts:
            raise CampaignError([*(f"{self.campaign}: {doubt}" for doubt in doubts), WAYS_OUT])
        for finding in (*report.warnings, *doubts):
            print(f"{finding.level:8}{finding}", file=sys.stderr)
        with new_folder(self.out, VERDICT, replace=False) as folder:
            found = diagnose(
                campaign,
                compiled,
                effects,
                progress=lambda words: print(f"... {words}", file=sys.stderr),
                store=None if self.no_store else open_store(),
            )
            write_diagnosis(found, folder, campaign, self.command)
        for line in words_of(found.verdict):
            print(line)
        for line in places_of(self.out):
            print(line)
        return 0

    @property
    def command(self) -> str:
        """What to type to do it again."""
        import shlex

        files = [word for file in self.file for word in ("--file", str(file))]
        files += ["--despite-doubts"] * self.despite_doubts
        files += ["--no-store"] * self.no_store
        return shlex.join(["bench", "diagnose", str(self.campaign), "-o", str(self.out), *files])
