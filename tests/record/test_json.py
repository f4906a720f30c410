"""JSON of strangers: refused in words, whatever stands there."""

import os
from pathlib import Path

import pytest

from bench.record.json_text import load_json


@pytest.mark.parametrize(
    "text", ["[" * 100_000, "", "{", "\udcff", '{"a": 1, "a": 2}'], ids=["deep", "empty", "cut", "not UTF-8", "twice"]
)
def test_what_is_no_json_is_a_value_error(text: str, tmp_path: Path) -> None:
    file = tmp_path / "a.json"
    file.write_bytes(text.encode("utf-8", "surrogateescape"))
    with pytest.raises(ValueError, match=r"."):
        load_json(file)


def test_a_pipe_and_what_is_too_large_are_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    os.mkfifo(tmp_path / "pipe.json")
    with pytest.raises(ValueError, match="is a named pipe"):
        load_json(tmp_path / "pipe.json")
    (tmp_path / "a.json").write_text("[1, 2, 3]")
    assert load_json(tmp_path / "a.json") == [1, 2, 3]
    monkeypatch.setenv("BENCH_MOST_JSON_BYTES", "5")
    with pytest.raises(ValueError, match="BENCH_MOST_JSON_BYTES"):
        load_json(tmp_path / "a.json")
