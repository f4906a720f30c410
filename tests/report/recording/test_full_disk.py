"""A recording that does not fit on its disk is an error; its writer waited for ever, or left half of it."""

import subprocess
import sys
from pathlib import Path
from uuid import UUID

import pytest

WRITE = """
import resource, sys
import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from pathlib import Path
from bench.errors import InputError
from bench.report.recording.writer import recording_to

limit = int(sys.argv[2])
resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
layout = rrb.Blueprint(rrb.Vertical(*[rrb.TimeSeriesView(name=str(i)) for i in range(30)]))
try:
    with recording_to(Path(sys.argv[1]), np.arange(10.0), sys.argv[3], "n", layout) as writer:
        for i in range(20):
            writer.moving(str(i), rr.Scalars.columns(scalars=np.arange(10.0)))
except InputError as error:
    print(error)
"""


@pytest.mark.parametrize("limit", [0, 1_000, 20_000, 60_000])
def test_a_recording_that_does_not_fit_is_an_error(tmp_path: Path, limit: int) -> None:
    command = [sys.executable, "-c", WRITE, str(tmp_path / "film.rrd"), str(limit), str(UUID(int=7, version=4))]
    found = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert found.returncode == 0, found.stderr
    assert "film.rrd: cannot be written (File too large)" in found.stdout
    assert list(tmp_path.iterdir()) == []
