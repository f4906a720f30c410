"""Writing commands that are ended at random moments leave nothing half-written, or the next run removes it."""

import shutil
import signal
import subprocess
import sys
from pathlib import Path
from time import sleep

import numpy as np
import pytest
import yaml

from bench.cli import TERMINATED
from bench.cli.stopping import UNFINISHED
from tests.poison.in_scenarios import LOG, ROWS
from tests.poison.run import write_base
from tests.simulate.session_small import PARTS

# It says that Python is up: whoever is not cannot say 143 when it is told to end, however slow the machine
BENCH = "import sys; from bench.cli import main; print('up', flush=True); sys.exit(main())"
COMMANDS: dict[str, tuple[tuple[str, ...], str, float]] = {
    # what to run, what is there when it is done, and how long it takes, about [s]
    "convert": (("convert", "base/robot", "log.csv", "-o", "out"), "campaign.yaml", 1.5),
    "new-robot": (("new-robot", "mine", "--mjcf", "arm.xml", "-o", "out"), "figures.yaml", 2.0),
    "run": (("run", "scenario.yaml", "-o", "out"), "session.rrd", 4.0),
    "hide": (("hide", "--none", "--scenario", "scenario.yaml", "-o", "out"), "truth", 4.0),
    "diagnose": (("diagnose", "base", "-o", "out", "--cores", "2", "--no-store"), "verdict.json", 20.0),
    "paper": (("paper", "-o", "out"), "", 20.0),
    "demo": (("demo", "-o", "out"), "", 20.0),
    "poses": (("poses", "--robot", "hh150", "-n", "3", "-o", "out.yaml"), "", 10.0),
    "study": (("study", "--small", "-o", "out"), "", 20.0),
}
FAST = ("convert", "new-robot", "run")  # one moment each; the others and more moments with -m study
MOMENTS = 4


def _cases() -> list[object]:
    cases = []
    for name in COMMANDS:
        for number in (signal.SIGTERM, signal.SIGKILL):
            for moment in range(MOMENTS):
                is_fast = name in FAST and moment == 0
                marks = () if is_fast else (pytest.mark.study,)
                cases.append(pytest.param(name, number, moment, id=f"{name}-{number.name}-{moment}", marks=marks))
    return cases


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with what the commands read."""
    folder = tmp_path_factory.mktemp("killed")
    base = write_base(folder)
    (base / "robot" / "log.yaml").write_text(LOG)
    (folder / "log.csv").write_text(ROWS)
    (folder / "arm.xml").write_text(
        "<mujoco><worldbody><body><joint name='a' axis='0 1 0'/><geom size='0.1 0.2' type='capsule' mass='3'/>"
        "<body pos='0 0 1'><joint name='b' axis='0 1 0'/><geom size='0.1 0.2' type='capsule' mass='2'/></body>"
        "</body></worldbody></mujoco>"
    )
    scenario = {"experiment": "session", "robot": str(base / "robot"), "seed": 5, **PARTS}
    (folder / "scenario.yaml").write_text(yaml.safe_dump(scenario))
    return folder


@pytest.mark.parametrize(("name", "number", "moment"), _cases())
def test_nothing_half_written_stays(
    name: str, number: signal.Signals, moment: int, place: Path, tmp_path: Path
) -> None:
    command, mark, seconds = COMMANDS[name]
    after = float(np.random.default_rng([moment, int(number), *name.encode()]).uniform(0.3, seconds))
    folder = tmp_path / "work"
    shutil.copytree(place, folder)
    process = subprocess.Popen(
        [sys.executable, "-c", BENCH, *command], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout
    assert process.stdout.readline() == "up\n"
    sleep(after)
    process.send_signal(number)
    _, errors = process.communicate(timeout=60)
    assert "Traceback" not in errors, errors
    out = folder / "out"
    is_done = name != "study" and (out / mark).exists()  # and Python, on its way out, is ended by the signal itself
    assert process.returncode in (0, -signal.SIGKILL, TERMINATED, UNFINISHED, *((-number,) if is_done else ())), errors
    if number == signal.SIGKILL:  # the next run cleans up
        subprocess.run([sys.executable, "-c", BENCH, *COMMANDS["convert"][0][:-1], "next"], cwd=folder, check=True)
    hidden = [entry.name for entry in folder.iterdir() if entry.name.startswith(".") and "poses" not in name]
    assert hidden == []
    if name != "study":  # it keeps what is done
        assert not out.exists() or is_done
