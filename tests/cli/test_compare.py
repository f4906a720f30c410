"""`bench compare`: exit codes, files, and what cannot be compared."""

import json
import os
import shutil
import signal
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench import paths
from bench.cli import main
from bench.cli.compare import CHANGED
from bench.cli.stopping import UNFINISHED
from bench.compare.as_it_was import AsItWas
from bench.diagnose.replay.posterior import Posterior
from bench.errors import InputError
from bench.record.known import Known
from bench.record.write import write_campaign
from bench.report.comparison.recordings import open_compared
from bench.report.handover.posterior_file import write_posterior
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from tests.diagnose.sweeps import SWEEP, made


@pytest.fixture(scope="module")
def campaigns(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("machine")
    write_campaign(made(SWEEP, 1, machine=5), folder / "may")
    write_campaign(made(SWEEP, 2, machine=5), folder / "june")
    write_campaign(made(SWEEP, 3, {"coulomb_level": 0.6}, machine=5), folder / "july")
    return folder


def test_nothing_changed_ends_with_0_and_writes_nothing_unasked(
    campaigns: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["compare", str(campaigns / "may"), str(campaigns / "june"), "--no-store", "--cores", "1"]) == 0
    assert capsys.readouterr().out.startswith("Nothing changed")
    assert sorted(path.name for path in campaigns.iterdir()) == ["july", "june", "may"]


def test_a_change_ends_with_its_code_and_writes_page_and_numbers(
    campaigns: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    arguments = [str(campaigns / "may"), str(campaigns / "july"), "-o", str(out), "--no-store", "--cores", "1"]
    assert main(["compare", *arguments]) == CHANGED
    assert capsys.readouterr().out.startswith("Changed: ")
    assert json.loads((out / "compare.json").read_text())["has_changed"] is True
    assert "bench compare" in (out / "report.html").read_text()


def test_what_ends_before_anything_was_weighed_leaves_nothing(
    campaigns: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = [str(campaigns / "may"), str(campaigns / "july"), "-o", str(tmp_path / "out"), "--at-most", "0.001"]
    assert main(["compare", *arguments, "--no-store", "--cores", "1"]) == UNFINISHED
    assert "ended after 0.001 s: nothing was weighed yet" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_what_ends_early_hands_over_what_was_found(
    campaigns: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*given: object) -> None:
        os.kill(os.getpid(), signal.SIGINT)  # as somebody who waits for it

    monkeypatch.setattr("bench.compare.settle.settled_background", interrupted)
    arguments = [str(campaigns / "may"), str(campaigns / "july"), "-o", str(tmp_path / "out"), "--no-store"]
    assert main(["compare", *arguments, "--cores", "1"]) == UNFINISHED
    said = capsys.readouterr().out
    assert said.startswith("Unfinished (interrupted, during: what changed, beside the noise that it leaves). So far: ")
    assert "Coulomb" in said.splitlines()[0]
    assert "ended before it was done" in said.splitlines()[1]
    written = json.loads((tmp_path / "out" / "compare.json").read_text())
    assert written["has_changed"] is True
    assert written["unfinished"]["why"] == "interrupted"
    assert "ended before it was done" in (tmp_path / "out" / "report.html").read_text()


def test_what_is_used_is_not_said(tmp_path: Path) -> None:
    known = (Known("gas_temperature_k", 293.0, 0.5),)
    write_campaign(replace(made(SWEEP, 1, machine=5), known=known), tmp_path / "noted")
    assert not [one for one in open_compared([tmp_path / "noted"], None).warnings if "known" in str(one)]


def test_what_is_not_used_is_said(campaigns: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    known = (Known("gas_temperature_k", 293.0, 4.0),)
    write_campaign(replace(made(SWEEP, 1, machine=5), known=known), tmp_path / "noted")
    write_campaign(made(SWEEP, 2, machine=5, without=("pressure",)), tmp_path / "unread")
    folders = [str(tmp_path / name) for name in ("noted", "unread")]
    assert main(["compare", *folders, "--no-store", "--cores", "1"]) == 0
    said = capsys.readouterr()
    assert "noted: campaign.yaml: known: gas_temperature_k: is not used in a comparison" in said.err
    assert "Left out: gas_pressure_pa, read before or after alone." in said.out


@pytest.mark.parametrize(
    ("names", "code", "words"),
    [
        (["may"], 2, "at least one made later"),
        (["may", "june", "june"], 2, "given twice"),
        (["may", "may"], 2, "given twice"),
        (["may", "august"], 3, "august"),
        (["august", "june", "--robot", "nobody"], 4, "unknown robot 'nobody'"),  # before a campaign is read
        (["august", "june", "--robot", "n" * 300], 4, "unknown robot 'nnn"),
    ],
)
def test_what_cannot_be_compared_is_said(
    names: list[str], code: int, words: str, campaigns: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    months = ("may", "june", "august")
    assert main(["compare", *(str(campaigns / name) if name in months else name for name in names)]) == code
    assert words in capsys.readouterr().err


def test_the_folder_of_a_diagnosis_stands_for_the_robot_that_it_handed_over(
    campaigns: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = copied(tmp_path)
    folders = [str(campaigns / name) for name in ("may", "june")]
    arguments = [*folders, "--robot", str(found), "--no-store", "--cores", "1"]
    assert main(["compare", *arguments]) == 0
    assert capsys.readouterr().out.startswith("Nothing changed")


def test_where_the_robot_as_it_was_comes_from_is_handed_on(
    campaigns: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def begun(*given: object, **how: object) -> AsItWas:
        return AsItWas(compile_robot(load_robot("hh150")), "diagnosed")

    monkeypatch.setattr("bench.compare.as_it_was.as_it_was", begun)
    folders = [str(campaigns / name) for name in ("may", "june")]
    assert main(["compare", *folders, "-o", str(tmp_path / "out"), "--no-store", "--cores", "1"]) in (0, CHANGED)
    assert json.loads((tmp_path / "out/compare.json").read_text())["robot"] == "diagnosed"


@pytest.mark.parametrize("is_handed_over", [True, False])
def test_a_robot_is_known_to_be_handed_over(
    campaigns: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, is_handed_over: bool
) -> None:
    found = copied(tmp_path)
    if is_handed_over:
        write_posterior(found / "robot", Posterior((), np.empty((0, 0))))
    given: list[bool] = []

    def asked(*_given: object, is_handed_over: bool, **_how: object) -> CompiledRobot:
        given.append(is_handed_over)
        raise InputError("that is all that was asked")

    monkeypatch.setattr("bench.compare.as_it_was.as_it_was", asked)
    folders = [str(campaigns / name) for name in ("may", "june")]
    assert main(["compare", *folders, "--robot", str(found), "--no-store", "--cores", "1"]) == 2
    assert given == [is_handed_over]


def copied(folder: Path) -> Path:
    """Return the folder of a diagnosis that handed over the nominal robot."""
    shutil.copytree(paths.models_dir() / "hh150", folder / "found" / "robot")
    return folder / "found"
