"""The command that a report gives repeats what was run."""

import shlex
from pathlib import Path

import pytest
import tyro

from bench.cli.compare import Compare
from bench.cli.diagnose import Diagnose
from bench.cli.predict import Predict

FILES = (Path("one effect.py"), Path("another.py"))


@pytest.mark.parametrize(
    "command",
    [
        Diagnose((Path("may"), Path("june")), Path("out"), file=FILES),
        Diagnose((Path("may"),), Path("out"), given=Path("earlier"), at_most="2m", despite_doubts=True, store=False),
        Compare(Path("may"), (Path("june"), Path("july")), Path("out"), robot="kr300", file=FILES, store=False),
        Compare(Path("may"), (Path("june"),)),
        Predict("found", (Path("june"), Path("july")), free=("payload", "encoder_zero"), nominal="hh150"),
    ],
)
def test_typed_again_it_is_the_same(command: Compare | Diagnose | Predict) -> None:
    bench, name, *words = shlex.split(command.command)
    assert (bench, name) == ("bench", type(command).__name__.lower())
    assert tyro.cli(type(command), args=words) == command
