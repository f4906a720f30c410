"""models/own-robot.md: its commands, in its order, lead from a stranger's MJCF and logs to a diagnosis."""

import json
import re
import shlex
import shutil
from pathlib import Path

import numpy as np
import pytest

from bench.cli import main
from tests import stranger

PAGE = (Path(__file__).parents[1] / "models" / "own-robot.md").read_text(encoding="utf-8")
LINES = [line for block in re.findall(r"```sh\n(.*?)```", PAGE, re.DOTALL) for line in block.splitlines()]
SECONDS, LOGS, PAYLOAD = 12.0, 3, 2.5
PLACEHOLDER = 5.0  # [kg m^2], one armature for drives of 200, 250 and 80 Nm; their rotors have less than a tenth
TIME_UP = 7  # exit code of a diagnosis that was ended by --at-most
SHORT = "3s"  # in place of what the page gives a diagnosis; the test is whether the command works on such a folder


def quantity(found: dict[str, list[dict[str, object]]], name: str) -> tuple[float, float]:
    (interval,) = [q["interval"] for q in found["quantities"] if q["name"] == name]
    low, high = interval  # type: ignore[misc]
    return float(low), float(high)


def test_the_page_from_its_first_command_to_its_last(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "arm.xml").write_text(stranger.mjcf())
    (tmp_path / "logs").mkdir()
    rng = np.random.default_rng(11)
    for k in range(LOGS):
        motion = stranger.moved(rng, SECONDS, stranger.as_filed(PAYLOAD))
        stranger.ur_log(tmp_path / "logs" / f"run{k}.csv", motion, separator=";", decimal=",")
    commands = [shlex.split(line) for line in LINES]
    assert [words[1] for words in commands if words[0] == "bench"] == [
        *("new-robot", "convert", "convert", "check", "identify", "diagnose")
    ]
    for words in commands:
        if words[0] == "cp":
            shutil.copyfile(*words[1:])
            continue
        words = [SHORT if before == "--at-most" else word for before, word in zip(["", *words], words, strict=False)]
        code = main(words[1:])
        said = capsys.readouterr()
        assert code == 0 or (words[1] == "diagnose" and code == TIME_UP), said.err
        if words[1] == "check":
            assert said.out.startswith("assumed ")
            assert "0 errors, 0 warnings" in said.out
    found = json.loads((tmp_path / "first-pass" / "dynamics.json").read_text())
    low, high = quantity(found, "unstated payload")
    assert low < PAYLOAD < high
    assert high - low < 1.5
    for joint, coulomb in enumerate(stranger.COULOMB):
        low, high = quantity(found, f"Coulomb friction (j{joint + 1})")
        assert 0.9 * coulomb < low < high < 1.1 * coulomb
    assert all(rms < 0.5 for rms in found["held_out_rms_nm"]["first_pass"])
    assert (tmp_path / "found" / "report.html").is_file()
    assert (tmp_path / "found" / "verdict.json").is_file()


def test_a_file_without_actuators_leads_to_friction_as_it_is(tmp_path: Path) -> None:
    """Friction of 9 Nm was too large to be plausible in a drive of which nobody had said more than a guessed 30 Nm."""
    (tmp_path / "arm.xml").write_text(stranger.mjcf("0", actuators=False))
    motion = stranger.moved(np.random.default_rng(1), SECONDS)
    columns = [motion.time, motion.position, motion.torque]
    names = ["time_s", *(f"q_motor_{j}_rad" for j in (1, 2, 3)), *(f"tau_motor_{j}_nm" for j in (1, 2, 3))]
    np.savetxt(tmp_path / "run.csv", np.column_stack(columns), delimiter=",", header=",".join(names), comments="")
    assert main(["new-robot", "arm", "--mjcf", str(tmp_path / "arm.xml"), "-o", str(tmp_path / "arm")]) == 0
    assert main(["convert", str(tmp_path / "arm"), str(tmp_path / "run.csv"), "-o", str(tmp_path / "campaign")]) == 0
    assert main(["diagnose", str(tmp_path / "campaign"), "-o", str(tmp_path / "found")]) == 0
    verdict = json.loads((tmp_path / "found" / "verdict.json").read_text())
    found = {(one["effect"], one["place"]): one for one in verdict["explanations"][0]["causes"]}
    for effect, true in (("coulomb_friction", stranger.COULOMB), ("viscous_friction", stranger.VISCOUS)):
        for joint, size in enumerate(true, start=1):
            (value,) = found[effect, f"joint {joint}"]["parameters"]
            assert value["low"] < size < value["high"]


def test_drives_that_report_current(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Torque constants that nobody knows are estimated from a log, written down, and then used."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "arm.xml").write_text(stranger.mjcf())
    assert main(["new-robot", "myarm", "--mjcf", "arm.xml"]) == 0
    motion = stranger.moved(np.random.default_rng(3), 20.0)
    names = ["time", *(f"actual_q_{j}" for j in range(3)), *(f"actual_current_{j}" for j in range(3))]
    rows = np.column_stack([motion.time, motion.position, motion.torque / np.array(stranger.CONSTANT)])
    np.savetxt("log.csv", rows, delimiter=",", header=",".join(names), comments="", fmt="%.8g")
    capsys.readouterr()
    assert main(["convert", "--look", "log.csv", "--robot", "myarm", "-o", "log.yaml"]) == 0
    convert = ["convert", "myarm", "log.csv", "--log", "log.yaml", "-o", "campaign"]
    assert main(convert) == 0
    assert main(["check", "campaign"]) == 3  # the constants are not written down yet
    told = (tmp_path / "log.yaml").read_text().split("as estimated: ")[1].split(" (torque")[0]
    constants = [part.split()[1] for part in told.split(", ")]
    figures = tmp_path / "myarm" / "figures.yaml"
    text = figures.read_text().replace("current: null", "current: {}")
    text = re.sub(r"  torque:\n(    .*\n)+", "  torque: null\n", text)
    for constant in constants:
        line = f"torque_constant_nm_per_a: {constant}\n    torque_constant_error: 0.1\n"
        text = re.sub(r"# torque_constant_nm_per_a.*\n", line, text, count=1)
    figures.write_text(text)
    capsys.readouterr()
    assert main(["check", "campaign"]) == 0
    assert main(["identify", "campaign", "--method", "dynamics", "-o", "first-pass"]) == 0
    found = json.loads((tmp_path / "first-pass" / "dynamics.json").read_text())
    for joint, coulomb in enumerate(stranger.COULOMB):
        low, high = quantity(found, f"Coulomb friction (j{joint + 1})")
        assert low < coulomb < high


def test_an_arm_unlike_its_file_is_not_doubted_and_a_first_pass_serves(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Drives were doubted where one armature stands for all, as in public models, or where rotors were a guess."""
    rng = np.random.default_rng(7)
    arm = stranger.unlike_its_file(rng)
    robot, logs, campaign = tmp_path / "robot", tmp_path / "logs", tmp_path / "campaign"
    (tmp_path / "arm.xml").write_text(stranger.mjcf(armature=PLACEHOLDER))
    logs.mkdir()
    for k in range(LOGS):
        motion = stranger.moved(rng, SECONDS, arm)
        table = np.column_stack([motion.time, motion.position, motion.torque])
        names = ["time_s", *(f"q_motor_{j}_rad" for j in (1, 2, 3)), *(f"tau_motor_{j}_nm" for j in (1, 2, 3))]
        np.savetxt(logs / f"run{k}.csv", table, delimiter=",", header=",".join(names), comments="", fmt="%.8g")
    assert main(["new-robot", "unlike", "--mjcf", str(tmp_path / "arm.xml"), "-o", str(robot)]) == 0
    assert main(["convert", str(robot), str(logs), "-o", str(campaign)]) == 0
    assert main(["check", str(campaign)]) == 0
    assert "0 errors, 0 warnings" in capsys.readouterr().out
    assert main(["identify", str(campaign), "--method", "dynamics", "-o", str(tmp_path / "first")]) == 0
    found = json.loads((tmp_path / "first" / "dynamics.json").read_text())
    assert all(
        ours < 0.2 * nominal
        for ours, nominal in zip(*(found["held_out_rms_nm"][key] for key in ("first_pass", "nominal")), strict=True)
    )
