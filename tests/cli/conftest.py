"""What tests of commands share."""

from pathlib import Path

import pytest

from bench.record.write import write_campaign
from tests.diagnose.sweeps import SWEEPS, made


@pytest.fixture(scope="session")
def healthy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("campaigns") / "healthy"
    write_campaign(made(SWEEPS, seed=5), folder)
    return folder
