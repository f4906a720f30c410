"""Nothing that is spoilt is believed, ends in a traceback, or hangs."""

import re
from pathlib import Path

import pytest

from tests.poison.run import run, variants, write_base
from tests.poison.variant import Variant

FEW = 1  # of each family is tried in the fast set; `python -m tests.poison` and `-m study` try all
README = Path(__file__).parents[2] / "README.md"
EVERY = variants()


def _some() -> list[object]:
    seen: dict[str, int] = {}
    params = []
    for variant in EVERY:
        seen[variant.family] = seen.get(variant.family, 0) + 1
        marks = () if seen[variant.family] <= FEW else (pytest.mark.study,)
        params.append(pytest.param(variant, id=f"{variant.family}-{variant.name}"[:80], marks=marks))
    return params


@pytest.fixture(scope="module")
def base(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_base(tmp_path_factory.mktemp("poison"))


@pytest.mark.parametrize("variant", _some())
def test_a_poisoned_file_gets_the_answer_that_is_right(variant: Variant, base: Path) -> None:
    outcome = run(variant, base)
    assert outcome.kind == "right", f"{outcome.kind} after {outcome.seconds:.1f} s\n{outcome.said[-3000:]}"


def test_there_are_as_many_as_the_readme_says() -> None:
    text = " ".join(README.read_text().split())
    stated = re.search(r"(\d+) variants in (\d+) families", text)
    assert stated
    assert [int(number) for number in stated.groups()] == [len(EVERY), len({variant.family for variant in EVERY})]
    assert len(EVERY) >= 250
    assert len({variant.family for variant in EVERY}) >= 30
    assert len({(variant.family, variant.name) for variant in EVERY}) == len(EVERY)
