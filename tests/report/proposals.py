"""What `bench convert --look` proposes, read as `bench convert` reads it."""

from pathlib import Path

from bench.record.log_format import LogFormat, read_log_format


def proposed(folder: Path, text: str) -> LogFormat:
    """Write a proposal into a folder, and read it."""
    (folder / "log.yaml").write_text(text)
    return read_log_format(folder / "log.yaml")
