"""The file of a study: interrupted, damaged, doubled, of other code."""

import json
import shutil
from dataclasses import asdict, replace
from pathlib import Path

import pytest

from bench.errors import InputError
from bench.study import code
from bench.study.code import code_of
from bench.study.plan import Counts
from bench.study.rows import ROWS
from bench.study.study import Settings, run_study
from tests.study.stub import Stub

NULLS = 99
COUNTS = Counts(seeds=0, nulls=NULLS, unlisted=0, pairs=0, twins=False)


@pytest.fixture(scope="module")
def settings() -> Settings:
    return Settings(seed=3, counts=COUNTS)


@pytest.fixture(scope="module")
def whole(settings: Settings, tmp_path_factory: pytest.TempPathFactory) -> list[bytes]:
    """Return the lines of a study that is done."""
    folder = tmp_path_factory.mktemp("study")
    again(settings, folder)
    return (folder / ROWS).read_bytes().splitlines()


def again(settings: Settings, folder: Path) -> tuple[list[str], list[str]]:
    """Run the study in a folder; return the campaigns that were done, and what was said."""
    begun = folder / "begun"
    begun.mkdir(exist_ok=True)
    said: list[str] = []
    outcomes = run_study(settings, folder, say=said.append, work=Stub(settings, begun))
    assert len({one.name for one in outcomes}) == len(outcomes) == NULLS
    assert [entry.name for entry in folder.iterdir() if entry.name.startswith(".")] == []
    return sorted(entry.name for entry in begun.iterdir()), said


def written(folder: Path, lines: list[bytes]) -> Path:
    (folder / ROWS).write_bytes(b"\n".join(lines) + b"\n")
    return folder


@pytest.mark.parametrize(
    "damage",
    [b"", b"{", b"null", b"\xff\xfe\x00", b"\x00" * 40, b'{"name": "null 2"}', b"[1, 2]"],
    ids=["empty", "cut", "another type", "not text", "zeros", "half of it", "a list"],
)
def test_a_damaged_line_costs_that_line(settings: Settings, whole: list[bytes], tmp_path: Path, damage: bytes) -> None:
    """The third of 100 lines once cost all that came after it."""
    lines = [*whole[:2], damage, *whole[3:]]
    done, said = again(settings, written(tmp_path, lines))
    assert done == ["null 2"]
    assert [("1 damaged line was dropped" in words) for words in said] == ([True] if damage else [])
    left = (tmp_path / ROWS).read_bytes().splitlines()
    assert sorted(left) == sorted(whole)
    assert again(settings, tmp_path)[1] == []


def test_damaged_lines_are_counted(settings: Settings, whole: list[bytes], tmp_path: Path) -> None:
    lines = [whole[0], *(line if i % 10 else line[:-9] for i, line in enumerate(whole[1:]))]
    done, (said,) = again(settings, written(tmp_path, lines))
    assert len(done) == 10
    assert "10 damaged lines were dropped" in said


def test_a_line_that_was_cut_off_is_done_again(settings: Settings, whole: list[bytes], tmp_path: Path) -> None:
    (tmp_path / ROWS).write_bytes(b"\n".join(whole)[:-30])
    done, _ = again(settings, tmp_path)
    assert done == [f"null {NULLS}"]
    assert sorted((tmp_path / ROWS).read_bytes().splitlines()) == sorted(whole)


def test_a_campaign_that_is_there_twice_counts_once(settings: Settings, whole: list[bytes], tmp_path: Path) -> None:
    done, said = again(settings, written(tmp_path, [*whole, whole[5], whole[5]]))
    assert (done, said) == ([], [])
    assert (tmp_path / ROWS).read_bytes().splitlines() == whole


def test_a_damaged_first_line_costs_nothing(settings: Settings, whole: list[bytes], tmp_path: Path) -> None:
    assert again(settings, written(tmp_path, [whole[0][:20], *whole[1:]])) == ([], [])
    assert (tmp_path / ROWS).read_bytes().splitlines() == whole


def test_a_file_that_names_no_study_is_refused(settings: Settings, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="first line is damaged"):
        again(settings, written(tmp_path, [b"{"]))


def test_a_line_of_another_study_does_not_count(settings: Settings, whole: list[bytes], tmp_path: Path) -> None:
    foreign = json.dumps(json.loads(whole[7]) | {"study": "00000000"}).encode()
    done, (said,) = again(settings, written(tmp_path, [*whole[:7], foreign, *whole[8:]]))
    assert done == ["null 7"]
    assert "1 damaged line" in said


def test_other_code_is_one_clear_error(settings: Settings, whole: list[bytes], tmp_path: Path) -> None:
    written(tmp_path, whole)
    with pytest.raises(InputError, match=r"begun by other code .*choose another folder") as caught:
        again(replace(settings, code="0123456789abcdef"), tmp_path)
    assert len(caught.value.problems) == 1
    assert (tmp_path / ROWS).read_bytes().splitlines() == whole


def test_a_study_of_an_earlier_version_is_of_other_code(settings: Settings, tmp_path: Path) -> None:
    head = {key: value for key, value in asdict(settings).items() if key != "code"} | {"version": "0.1.0"}
    with pytest.raises(InputError, match="begun by other code"):
        again(settings, written(tmp_path, [json.dumps(head).encode()]))


def test_the_fingerprint_is_of_every_source(tmp_path: Path) -> None:
    session = "session-study"
    package = Path(shutil.copytree(code.PACKAGE, tmp_path / "bench", ignore=shutil.ignore_patterns("__pycache__")))
    before = code_of(session)
    assert code_of(session, package) == before
    assert code_of("session-short") != before
    for name in ("diagnose/verdict.py", "actuators/plugin/friction.c"):
        file = package / name
        text = file.read_text()
        file.write_text(text + "\n")
        assert code_of(session, package) != before
        file.write_text(text)
    (package / "README.md").write_text("words")
    assert code_of(session, package) == before
    (package / "new.py").touch()
    assert code_of(session, package) != before
