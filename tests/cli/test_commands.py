"""The command line: what it writes, what it returns, and what it says when it cannot."""

import json
import os
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
import yaml

from bench.cli import main
from bench.record.read import read_campaign
from bench.record.write import write_campaign
from bench.report.diagnosis.facts import versions
from tests.simulate.loading_small import small_loading


@pytest.fixture(scope="module")
def scenario(small_robot: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("scenarios") / "mine.yaml"
    content = small_loading(small_robot, orientation=True).model_dump(mode="json")
    file.write_text(yaml.safe_dump(content))
    return file


@pytest.fixture(scope="module")
def results(scenario: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("out") / "results"
    assert main(["run", str(scenario), "-o", str(folder)]) == 0
    return folder


def test_robot_that_knows_no_logs_hears_how_to_begin(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["convert", "hh150", str(tmp_path), "-o", str(tmp_path / "out")]) == 2
    assert "`bench convert --look LOG --robot ROBOT -o log.yaml` proposes one" in capsys.readouterr().err


def test_study_goes_into_no_folder_of_something_else(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """It began for hours in the folder of another command."""
    (tmp_path / "session.rrd").write_bytes(b"")
    assert main(["study", "--small", "-o", str(tmp_path)]) == 2
    assert "is not empty, and holds no study to go on with" in capsys.readouterr().err
    assert [file.name for file in tmp_path.iterdir()] == ["session.rrd"]


def test_run_writes_campaign_truth_and_recording_apart(results: Path) -> None:
    assert {entry.name for entry in results.iterdir()} == {"campaign", "truth", "session.rrd"}
    assert (results / "campaign" / "campaign.yaml").is_file()
    assert (results / "truth" / "truth.yaml").is_file()


def test_the_version_is_the_one_that_verdicts_state(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"bench {versions()['bench']}\n"


def test_check_accepts_it(results: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(results / "campaign")]) == 0
    assert "0 errors, 0 warnings; 4 runs" in capsys.readouterr().out


def test_check_names_the_place_of_a_fault(results: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "campaign"
    (folder / "runs").mkdir(parents=True)
    (folder / "campaign.yaml").write_text((results / "campaign" / "campaign.yaml").read_text())
    for table in (results / "campaign" / "runs").iterdir():
        (folder / "runs" / table.name).write_text(table.read_text())
    table = folder / "runs" / "pose1-from-below.csv"
    lines = table.read_text().splitlines()
    lines[3] = lines[3].replace(",", ",oops", 1)
    table.write_text("\n".join(lines))
    assert main(["check", str(folder)]) == 3
    assert "runs/pose1-from-below.csv: row 3 (line 4): pose" in capsys.readouterr().out


@pytest.mark.parametrize("method", ["current", "force", "joint", "all"])
def test_identify_prints_json(results: Path, capsys: pytest.CaptureFixture[str], method: str) -> None:
    assert main(["identify", str(results / "campaign"), "--method", method, "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    estimates = printed["estimates"]
    assert set(estimates) >= ({"current", "force", "joint"} if method == "all" else {method})
    for estimate in estimates.values():
        assert estimate["joints"] == ["hinge_a", "hinge_b"]
        for value, (low, high) in zip(estimate["stiffness_nm_per_rad"], estimate["interval_nm_per_rad"], strict=True):
            assert low < value
            assert high is None or value < high


def test_identify_by_plain_least_squares_and_from_the_first_load(
    results: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def found(*options: str) -> list[float]:
        assert main(["identify", str(results / "campaign"), "--method", "force", "--json", *options]) == 0
        return list(json.loads(capsys.readouterr().out)["estimates"]["force"]["stiffness_nm_per_rad"])

    usual = found()
    assert found("--weights", "equal") != usual
    assert found("--reference", "first-load") != usual
    assert main(["identify", str(results / "campaign"), "--weights", "equal"]) == 2
    assert "--weights equal needs --method current or --method force" in capsys.readouterr().err


def test_stiffness_is_not_identified_from_what_check_fails(
    results: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Reflectors 1.4 m from where the model has them gave a table of stiffnesses without a word."""
    shutil.copytree(results / "campaign", folder := tmp_path / "mirrored")
    for table in (folder / "runs").iterdir():
        header, *rows = (line.split(",") for line in table.read_text().splitlines())
        seen = {i for i, name in enumerate(header) if name.startswith("reflector_")}
        for row in rows:
            row[:] = [repr(-float(cell)) if i in seen and cell else cell for i, cell in enumerate(row)]
        table.write_text("\n".join(map(",".join, [header, *rows])) + "\n")
    command = ["identify", str(folder), "--method", "force", "--json"]
    assert main(command) == 3
    assert "reflector_1_x_m" in (said := capsys.readouterr().err)
    assert "--despite-doubts" in said
    assert main([*command, "--despite-doubts"]) == 0
    assert capsys.readouterr().err.startswith("failed check")


def test_identify_prints_a_table(results: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["identify", str(results / "campaign")]) == 0
    printed = capsys.readouterr().out
    assert "hinge_b" in printed
    assert "joint" in printed


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (["run", "lodaing", "-o", "OUT"], 2, "no scenario file 'lodaing'"),
        (["check", "NOWHERE"], 3, ""),
        (["identify", "NOWHERE"], 3, "NOWHERE"),
        (["view", "NOWHERE"], 2, "does not exist"),
    ],
)
def test_bad_input_ends_in_its_exit_code(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], code: int, said: str
) -> None:
    out = tmp_path / "out"
    arguments = [str(out) if word == "OUT" else word for word in arguments]
    assert main(arguments) == code
    assert said in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.parametrize("arguments", [["predict", "FOLDER", "x"], ["apply", "FOLDER", "-o", "OUT"]])
def test_who_names_no_robot_hears_of_diagnoses_too(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str]
) -> None:
    words = {"FOLDER": str(tmp_path), "OUT": str(tmp_path / "out")}
    assert main([words.get(word, word) for word in arguments]) == 4
    assert "`bench diagnose -o DIR` writes one as DIR/robot" in capsys.readouterr().err


@pytest.mark.parametrize("arguments", [["--nulls", "0"], ["--recordings", "2"]])
def test_a_study_of_nothing_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str]
) -> None:
    none = ["--seeds", "0", "--unlisted", "0", "--pairs", "0", "--no-twins"]
    assert main(["study", *none, *arguments, "-o", str(tmp_path / "out")]) == 2
    assert "no campaign to make" in capsys.readouterr().err


def test_known_effects_are_listed_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["study", "--effects", "gas_los", "nonsense", "-o", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert "unknown effect that can act 'gas_los'. Did you mean 'gas_loss'?" in said
    assert "'nonsense'" in said
    assert said.count("Known: ") == 1


@pytest.mark.parametrize("place", ["x.csv/inner/log.yaml", "x.csv/log.yaml", "n" * 300])
def test_a_proposal_that_cannot_be_written_is_one_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], place: str
) -> None:
    file = tmp_path / "x.csv"
    file.write_text("t,q\n" + "".join(f"{k / 100},{(k / 50) ** 2}\n" for k in range(100)))
    assert main(["convert", "--look", str(file), "-o", str(tmp_path / place)]) == 2
    assert "cannot be written" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["x.csv"]


@pytest.mark.parametrize("folder", ["", "inner"])
def test_names_that_are_no_utf_8_are_refused_before_any_work(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], folder: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A run of minutes ended in a UnicodeEncodeError, a new robot in a TypeError of MuJoCo."""
    odd = tmp_path / os.fsdecode(b"\x80bad")
    odd.mkdir()
    monkeypatch.chdir(odd)
    for command in (["run", "line"], ["new-robot", "rob", "--mjcf", "arm.urdf"], ["hide", "gas_loss"], ["demo"]):
        assert main([*command, "-o", folder or str(odd / "out")]) == 2
        said = capsys.readouterr().err
        assert r"\x80bad" in said
        assert "is no UTF-8" in said
        assert said.count("\n") == 1
    assert main(["new-robot", "rob", "--mjcf", "arm.urdf"]) == 2  # into a folder with the robot's name, here
    assert [path.name for path in tmp_path.rglob("*")] == [odd.name]


def test_results_of_the_paper_may_be_replaced(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "results.json").touch()
    assert main(["paper", "-o", str(tmp_path)]) == 2
    assert "or give --replace" in capsys.readouterr().err


def test_a_full_folder_is_not_touched(scenario: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "mine.txt").write_text("precious")
    assert main(["run", str(scenario), "-o", str(tmp_path)]) == 2
    assert capsys.readouterr().err.endswith("is not empty; choose another name\n")
    assert [entry.name for entry in tmp_path.iterdir()] == ["mine.txt"]


def test_unfit_scenario_leaves_nothing_behind(
    scenario: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    content = yaml.safe_load(scenario.read_text())
    content["poses"][0]["force_n"] = [100, 5000]
    bad = tmp_path / "bad.yaml"
    bad.write_text(yaml.safe_dump(content))
    assert main(["run", str(bad), "-o", str(tmp_path / "out")]) == 2
    assert "poses[0].force_n[1]: 5000 N is above the rating of small, 300 N" in capsys.readouterr().err
    assert [entry.name for entry in tmp_path.iterdir()] == ["bad.yaml"]


def test_help_is_light() -> None:
    """`bench --help` imports neither an engine nor a plotting library."""
    heavy = ["mujoco", "pinocchio", "matplotlib", "rerun", "scipy", "pyarrow"]
    probe = (
        "import sys; from bench.cli import main\n"
        "try: main(['--help'])\n"
        f"except SystemExit: pass\nprint([name for name in {heavy} if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", probe], check=True, capture_output=True, text=True)
    assert done.stdout.splitlines()[-1] == "[]"


@pytest.mark.parametrize("buffering", ["buffered", "unbuffered"])
@pytest.mark.parametrize(
    "arguments",
    [
        ["--help"],
        ["view", "--help"],
        ["effects"],
        ["robots"],
        ["store"],
        ["poses", "--robot", "hh150", "-n", "1"],
        ["identify", "CAMPAIGN"],
    ],
    ids=" ".join,
)
def test_whoever_stops_reading_sees_no_traceback(results: Path, arguments: list[str], buffering: str) -> None:
    """As with `bench effects | head -1`."""
    arguments = [str(results / "campaign") if word == "CAMPAIGN" else word for word in arguments]
    words = [sys.executable, "-c", "import sys; from bench.cli import main; sys.exit(main())", *arguments]
    environment = os.environ | {"PYTHONUNBUFFERED": "1" if buffering == "unbuffered" else ""}
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment)
    assert process.stdout
    assert process.stderr
    process.stdout.close()  # before anything was written
    assert process.wait(timeout=60) == 141
    assert process.stderr.read() == ""
    process.stderr.close()


def test_a_failed_plausibility_check_is_called_that(
    healthy: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    spoilt = read_campaign(healthy)
    first, *others = spoilt.runs
    dead = replace(first, columns=dict(first.columns) | {"current_2_a": 0 * first.columns["current_2_a"]})
    write_campaign(replace(spoilt, runs=(dead, *others)), tmp_path / "spoilt")
    assert main(["check", str(tmp_path / "spoilt")]) == 3
    said = capsys.readouterr().out
    assert "failed check  runs/" in said
    assert "0 errors, 1 failed plausibility check, " in said
    assert "doubt" not in said


@pytest.mark.parametrize("command", ["diagnose", "compare"])
def test_help_names_no_option_twice_denied(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main([command, "--help"])
    said = capsys.readouterr().out
    assert "--no-store" in said
    assert "--no-no" not in said


@pytest.mark.parametrize(
    "options", [("--effects", "no_such_effect"), ("--recordings", "2", "--world", "plain")], ids=["effect", "world"]
)
def test_a_study_that_cannot_be_leaves_no_folder(options: tuple[str, ...], tmp_path: Path) -> None:
    """The folder of a study was made before it was known whether there is one, and stayed there empty."""
    assert main(["study", "-o", str(tmp_path / "study"), *options]) == 2
    assert not (tmp_path / "study").exists()
