"""`bench identify --method dynamics`: what it prints, writes and refuses."""

import json
from pathlib import Path

import numpy as np
import pytest

from bench.cli import main
from tests.recordings import write_emps, write_kr300


@pytest.fixture(scope="module")
def campaigns(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Return two stand-ins for recordings of one robot."""
    folder, rng = tmp_path_factory.mktemp("dynamics"), np.random.default_rng(3)
    for name, seconds in (("one", 6.0), ("two", 5.0)):
        write_kr300(folder / f"{name}.csv", rng, seconds)
        assert main(["convert", "kr300", str(folder / f"{name}.csv"), "-o", str(folder / name)]) == 0
    return folder / "one", folder / "two"


def test_json_holds_errors_and_parameters(
    campaigns: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    one, two = map(str, campaigns)
    out = tmp_path / "out"
    command = ["identify", one, "--method", "dynamics", "--held-out", two, "--json", "-o", str(out)]
    capsys.readouterr()
    assert main(command) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed == json.loads((out / "dynamics.json").read_text())
    assert len(printed["joints"]) == 6
    for errors in (printed["held_out_rms_nm"], printed["predicted_rms_nm"][two]):
        assert all(ours < nominal for ours, nominal in zip(errors["first_pass"], errors["nominal"], strict=True))
    payload = next(one for one in printed["quantities"] if one["kind"] == "payload")
    assert payload["interval"][0] < payload["value"] < payload["interval"][1]
    lumped = [one["together_with"] for one in printed["quantities"]]
    assert max(len(words.split(" + ")) + words.count(" - ") for words in lumped) > 4
    assert not any(words.endswith(" more") for words in lumped)  # whoever computes with them needs every term
    assert len(printed["links"]) == 6
    assert printed["links"][5]["found"]["m"] > 0


@pytest.mark.parametrize("command", [["identify", "--method", "dynamics"], ["predict", "kr300"]])
def test_a_folder_that_is_not_empty_is_refused_before_the_work(
    command: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """No campaign is there to be read: the folder is told first, not after minutes (an examiner found it)."""
    (tmp_path / "mine.txt").write_text("mine")
    assert main([*command, str(tmp_path / "no-campaign"), "-o", str(tmp_path)]) == 2
    assert "is not empty" in capsys.readouterr().err
    assert [file.name for file in tmp_path.iterdir()] == ["mine.txt"]


def test_text_has_errors_first(campaigns: tuple[Path, Path], capsys: pytest.CaptureFixture[str]) -> None:
    capsys.readouterr()
    assert main(["identify", *map(str, campaigns), "--method", "dynamics", "--cutoff-hz", "8"]) == 0
    printed = capsys.readouterr().out
    assert printed.index("plain least squares") < printed.index("Coulomb friction")
    assert "as stated" in printed
    assert "whole runs" in printed
    assert "friction by the torque passed on" not in printed.split("Not needed: ")[0], (
        "rows of zeros told nobody anything"
    )
    said = " ".join(printed.split())
    assert "spring balancer (all joints)" in said.split("Not needed: ")[1]
    assert "friction that falls" not in said, "runs of one minute were not asked for it"


@pytest.mark.parametrize(
    ("extra", "said"),
    [
        ((), "--method dynamics"),
        (("--held-out", "x"), "--method dynamics"),
        (("--method", "dynamics", "--cutoff-hz", "-1"), "must be positive"),
        (("--method", "dynamics", "--cutoff-hz", "1e9"), "lies above half of the sampling rate, 125 Hz; give less"),
        (("--method", "dynamics", "--level", "90"), "between 0 and 1"),
    ],
)
def test_refusals_say_what_to_do(
    campaigns: tuple[Path, Path], extra: tuple[str, ...], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["identify", *map(str, campaigns), *extra]) == 2
    assert said in capsys.readouterr().err


def test_the_same_campaign_twice_is_refused(campaigns: tuple[Path, Path], capsys: pytest.CaptureFixture[str]) -> None:
    one, two = map(str, campaigns)
    assert main(["identify", one, one, "--method", "dynamics"]) == 2
    assert "is given twice" in capsys.readouterr().err
    again = f"{two}/../{campaigns[0].name}"
    for held_out in ([one], [again], [two, two]):
        assert main(["identify", one, "--method", "dynamics", "--held-out", *held_out]) == 2
        assert "is given twice" in capsys.readouterr().err


def test_a_recording_of_another_robot_is_not_predicted(
    campaigns: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """An arm of three joints predicted one of six by 358 Nm, without a word, and the other way round ended in SciPy."""
    write_emps(tmp_path / "emps.csv", np.random.default_rng(3), seconds=3.0)
    assert main(["convert", "emps", str(tmp_path / "emps.csv"), "-o", str(tmp_path / "emps")]) == 0
    one, other = str(campaigns[0]), str(tmp_path / "emps")
    for fitted, held_out in ((one, other), (other, one)):
        capsys.readouterr()
        assert main(["identify", fitted, "--method", "dynamics", "--held-out", held_out]) == 3
        assert "give campaigns of one machine" in capsys.readouterr().err


def test_failed_checks_come_first(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A campaign that `bench check` fails was fitted without a word: 2144 Nm of friction for an arm of 3 kg."""
    write_emps(tmp_path / "emps.csv", np.random.default_rng(3), seconds=3.0)
    folder = tmp_path / "turned"
    assert main(["convert", "emps", str(tmp_path / "emps.csv"), "-o", str(folder)]) == 0
    (table,) = folder.rglob("*.csv")
    header, *rows = table.read_text().splitlines()
    place = header.split(",").index("tau_motor_1_n")
    cells = [row.split(",") for row in rows]
    for row in cells:
        row[place] = repr(-float(row[place]))
    table.write_text("\n".join([header, *map(",".join, cells)]) + "\n")
    command = ["identify", str(folder), "--method", "dynamics", "--json"]
    capsys.readouterr()
    assert main(command) == 3
    assert "tau_motor_1_n" in (said := capsys.readouterr().err)
    assert "--despite-doubts" in said
    assert main([*command, "--despite-doubts"]) == 0
    assert capsys.readouterr().err.startswith("failed check")
    assert main(["identify", str(folder), "--despite-doubts"]) == 2
