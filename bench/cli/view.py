"""`bench view`: open the recording of a session, of a diagnosis or of a prediction."""

from dataclasses import dataclass
from pathlib import Path

import tyro


@dataclass(frozen=True)
class View:
    """Open the recording of a results folder in the Rerun viewer."""

    folder: tyro.conf.Positional[Path]
    """Folder that `bench run`, `bench diagnose` or `bench predict` wrote, one inside of what `bench paper` wrote, or an
    .rrd file."""

    def run(self) -> int:
        """Open the viewer; return the exit code."""
        from bench.report.recording.view import view

        view(self.folder)
        return 0
