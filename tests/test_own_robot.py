"""models/own-robot.md: its commands, in its order, lead from a stranger's MJCF and logs to a diagnosis."""

import json
import re
import shlex
import shutil
from pathlib import Path

import numpy as np
import pytest

from bench.cli import main
from bench.record.convert import convert
from bench.record.log_format import read_log_format
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from tests import stranger, stranger_rests

PAGE = (Path(__file__).parents[1] / "models" / "own-robot.md").read_text(encoding="utf-8")
MOVED, AT_REST = PAGE.split("## At rest, with weights and a laser tracker")


def blocks(text: str, kind: str) -> list[str]:
    """Return the blocks of a kind of code in a part of the page."""
    return re.findall(rf"```{kind}\n(.*?)```", text, re.DOTALL)


LINES = [line for block in blocks(MOVED, "sh") for line in block.splitlines()]
INSTRUMENTS, COUNTERBALANCE, REST_LOG = blocks(AT_REST, "yaml")
CYLINDER = blocks(AT_REST, "xml")[0].splitlines()
SECONDS, LOGS, PAYLOAD = 12.0, 3, 2.5
PLACEHOLDER = 5.0  # [kg m^2], one armature for drives of 200, 250 and 80 Nm; their rotors have less than a tenth
TIME_UP = 7  # exit code of a diagnosis that was ended by --at-most
CHANGED = 9  # exit code of a comparison that names a change
SOFTER = 0.85  # of the stiffness of joint 2, on the second day
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


def lab(folder: Path) -> None:
    """Write what a lab that weighs its arm has: the arm, and logs of two days, a gear softer on the second."""
    (folder / "arm.xml").write_text(stranger_rests.mjcf())
    for name, seed, softer in (("logs", 1, 1.0), ("later-logs", 2, SOFTER)):
        (folder / name).mkdir()
        one, two, three = stranger_rests.STIFFNESS
        stranger_rests.logs(folder / name, np.random.default_rng(seed), (one, softer * two, three))


def written(folder: Path) -> None:
    """Do to a started robot what the page says besides its commands."""
    figures, mjcf = folder / "figures.yaml", folder / "myarm.xml"
    text = re.sub(
        r"instruments:.*?(?=uncertainty:)", lambda _: f"{INSTRUMENTS}\n", figures.read_text(), flags=re.DOTALL
    )
    for constant in stranger_rests.CONSTANT:
        text = re.sub(r"# torque_constant_nm_per_a.*\n", f"torque_constant_nm_per_a: {constant}\n", text, count=1)
    figures.write_text(text)
    model = mjcf.read_text()
    for joint, level in enumerate(stranger_rests.FRICTION, start=1):
        zero = rf'(name="j{joint}_motor_friction".*?key="coulomb" value=)"0"'
        model = re.sub(zero, rf'\g<1>"{level}"', model, count=1, flags=re.DOTALL)
    mjcf.write_text(model)
    (folder / "log.yaml").write_text(REST_LOG)


def test_the_page_at_rest_from_its_first_command_to_its_last(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The page had nothing on rests, weights, reflectors; a lab that had them wrote its log.yaml by trial."""
    monkeypatch.chdir(tmp_path)
    lab(tmp_path)
    commands = [shlex.split(line)[1:] for block in blocks(AT_REST, "sh") for line in block.splitlines()]
    assert [words[0] for words in commands] == [
        *("new-robot", "convert", "check", "identify", "poses", "diagnose", "convert", "compare")
    ]
    for words in commands:
        code = main(words)
        said = capsys.readouterr()
        assert code == (CHANGED if words[0] == "compare" else 0), said.err
        if words[0] == "new-robot":
            written(tmp_path / "myarm")
        if words[0] == "check":
            assert "0 errors, 0 warnings" in said.out
        if words[0] == "identify":  # it was 0.007, 0.007 to 0.007 in 10^6 Nm/rad
            assert "[10^3 Nm/rad]" in said.out
            shown = [float(one) for one in re.findall(r"\d+\.\d{3}(?= to )", said.out)]
            assert shown == pytest.approx(np.array(stranger_rests.STIFFNESS) / 1e3, rel=0.1)
        if words[0] == "diagnose":
            assert "Nothing found" in said.out
    assert main(["identify", "campaign", "--method", "joint", "--json"]) == 0
    intervals = json.loads(capsys.readouterr().out)["estimates"]["joint"]["interval_nm_per_rad"]
    assert all(low < true < high for (low, high), true in zip(intervals, stranger_rests.STIFFNESS, strict=True))
    compared = json.loads((tmp_path / "changed" / "compare.json").read_text())
    (change,) = compared["explanations"][0]["changes"]
    assert (change["effect"], change["place"]) == ("joint_compliance", "joint 2")
    assert change["sizes"][0]["change"]["low"] < 1 / SOFTER - 1 < change["sizes"][0]["change"]["high"]


def test_the_counterbalance_of_the_page_goes_into_a_started_robot(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(stranger_rests.mjcf())
    assert main(["new-robot", "myarm", "--mjcf", str(tmp_path / "arm.xml"), "-o", str(tmp_path / "myarm")]) == 0
    mjcf, figures = tmp_path / "myarm" / "myarm.xml", tmp_path / "myarm" / "figures.yaml"
    before = ("</extension>", '<body name="l2"', '<joint name="j2"', "</tendon>", "</actuator>")
    text = mjcf.read_text()
    for line, mark in zip(CYLINDER, before, strict=True):
        assert text.count(mark) == 1
        text = text.replace(mark, f"{line}\n{mark}")
    mjcf.write_text(text)
    figures.write_text(f"{figures.read_text()}\n{COUNTERBALANCE}")
    gas = compile_robot(load_robot(tmp_path / "myarm")).counterbalance
    assert gas is not None
    assert (gas.joint, gas.gas_constant, gas.critical_length) == (1, 20, 0.4)


def test_the_example_of_rests_on_the_page_of_logs_converts(tmp_path: Path) -> None:
    """A file of the columns that it names, two loads in one pose."""
    page = (Path(__file__).parents[1] / "bench" / "record" / "logs" / "README.md").read_text(encoding="utf-8")
    (text,) = (block for block in blocks(page, "yaml") if block.startswith("kind: static"))
    (tmp_path / "log.yaml").write_text(text)
    names = re.findall(r"from: (\w+)", text)
    rows = [[1, side, step, 1, 10, 5 * step, 1.5, 800 - step] for side in (1, -1) for step in (0, 1)]
    np.savetxt(tmp_path / "x.csv", rows, delimiter=",", header=",".join(names), comments="", fmt="%g")
    (run,) = convert(tmp_path / "x.csv", read_log_format(tmp_path / "log.yaml"), "mine").campaign.runs
    assert run.kind == "static"
    np.testing.assert_allclose(run.columns["load_z_n"], [0, -49.03325, 0, -49.03325])
