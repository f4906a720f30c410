"""What shows on standard error: a bar with the time left on a terminal, plain lines elsewhere."""

import io
import re
import sys

import pytest

from bench.cli import progress
from bench.cli.progress import phases, progress_bar


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def terminal(monkeypatch: pytest.MonkeyPatch) -> Terminal:
    """Return what takes the place of standard error; of a test, since pytest puts its own there before each."""
    shown = Terminal()
    monkeypatch.setattr(sys, "stderr", shown)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.setattr(progress, "LEAST_S", 0.0)
    return shown


def test_elsewhere_phases_are_plain_lines(capsys: pytest.CaptureFixture[str]) -> None:
    with phases() as shown:
        shown.phase("naming")
        shown.share(0.5)
        shown.phase("rivals")
    assert capsys.readouterr() == ("", "... naming\n... rivals\n")


def test_elsewhere_a_bar_is_silent(capsys: pytest.CaptureFixture[str]) -> None:
    with progress_bar("campaigns") as told:
        told(0.5)
    assert capsys.readouterr() == ("", "")


def test_a_terminal_shows_phase_share_and_time_left(monkeypatch: pytest.MonkeyPatch) -> None:
    standard_error = terminal(monkeypatch)
    with phases() as shown:
        shown.phase("signatures of 39 causes")
        for i in range(5):
            shown.share(i / 10)
        shown.phase("naming")
        shown.share(0.25)
    text = standard_error.getvalue()
    assert re.search(r"signatures of 39 causes.* 40%.*\d:\d\d:\d\d", text)
    assert re.search(r"naming.* 25%", text)


def test_a_bar_on_a_terminal_has_the_time_left(monkeypatch: pytest.MonkeyPatch) -> None:
    standard_error = terminal(monkeypatch)
    with progress_bar("campaigns") as told:
        for i in range(1, 4):
            told(i / 10)
    assert re.search(r"campaigns.* 30%.*\d:\d\d:\d\d", standard_error.getvalue())
