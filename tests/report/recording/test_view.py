"""Opening a recording: what is opened, and what is said when that cannot be."""

import subprocess
from pathlib import Path

import pytest

from bench.errors import BenchError, InputError
from bench.report.recording.view import has_display, recordings_in, view


@pytest.fixture
def results(tmp_path: Path) -> Path:
    for name in ("b.rrd", "a.rrd", "campaign.yaml"):
        (tmp_path / name).touch()
    return tmp_path


def test_a_folder_stands_for_its_recordings(results: Path) -> None:
    assert [path.name for path in recordings_in(results)] == ["a.rrd", "b.rrd"]
    assert recordings_in(results / "b.rrd") == (results / "b.rrd",)


@pytest.mark.parametrize(
    ("name", "words"),
    [("nothing", "does not exist"), ("empty", "holds no recording"), ("empty/x.csv", "not a recording")],
)
def test_no_recording(tmp_path: Path, name: str, words: str) -> None:
    (tmp_path / "empty").mkdir()
    if name.endswith("csv"):
        (tmp_path / name).touch()
    with pytest.raises(InputError, match=words):
        view(tmp_path / name)


def test_folders_inside_that_hold_recordings_are_named(tmp_path: Path) -> None:
    """As in a folder of `bench paper`."""
    for place in ("loading/link-side", "rotation"):
        (tmp_path / place).mkdir(parents=True)
        (tmp_path / place / "session.rrd").touch()
    inside = ", ".join(str(tmp_path / place) for place in ("loading/link-side", "rotation"))
    with pytest.raises(InputError, match=f"holds no recording .*; give one of {inside}"):
        recordings_in(tmp_path)


def test_without_display_it_says_how_else(results: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("bench.report.recording.view.has_display", lambda: False)
    with pytest.raises(BenchError, match=r"rerun --web-viewer .*a\.rrd"):
        view(results)


@pytest.mark.parametrize(
    ("variable", "shown"), [("DISPLAY", True), ("WAYLAND_DISPLAY", True), ("NO_SUCH_THING", False)]
)
def test_display_is_looked_up_on_linux(monkeypatch: pytest.MonkeyPatch, variable: str, shown: bool) -> None:
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.setenv(variable, ":0")
    assert has_display() is shown


@pytest.mark.parametrize("code", [0, 3])
def test_opens_the_viewer_for_this_machine_only(results: Path, monkeypatch: pytest.MonkeyPatch, code: int) -> None:
    commands = []

    def run(command: list[str], check: bool) -> subprocess.CompletedProcess[str]:
        commands.append(command)
        return subprocess.CompletedProcess(command, code)

    monkeypatch.setattr("bench.report.recording.view.has_display", lambda: True)
    monkeypatch.setattr("subprocess.run", run)
    if code:
        with pytest.raises(BenchError, match="code 3"):
            view(results)
    else:
        view(results)
    (command,) = commands
    assert command[1:3] == ["-m", "rerun"]
    assert command[command.index("--bind") + 1] == "127.0.0.1"
    assert command[-2:] == [str(results / "a.rrd"), str(results / "b.rrd")]
