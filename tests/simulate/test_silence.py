"""What MuJoCo warns of while models are tried is no news for the user, and no file in the user's folder."""

from pathlib import Path

import mujoco
import pytest

import bench.cli
from bench.actuators.laws import GasSpring
from bench.executor.contract import Progress, in_order
from bench.executor.processes import CAN_FORK, Processes
from bench.simulate.silence import engine_silent
from tests.actuators.slider import follow, slider

GAS = GasSpring(constant=4771.4, critical_length=0.9112)
LOG = "MUJOCO_LOG.TXT"


def past_the_end(self: object) -> int:
    """Do as a search that steps to where the gas has no room left."""
    follow(slider(GAS), [1.0])
    return 0


def tried(item: int, progress: Progress) -> int:
    return past_the_end(item)


@pytest.mark.parametrize("command", bench.cli.TRYING_MODELS, ids=lambda command: command.__name__)
def test_commands_that_try_models_leave_no_warnings(
    command: type, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """36 lines of bench.gas_spring stood on a stranger's terminal during a diagnosis, and as many in a file."""
    arguments = {"Diagnose": ["a", "-o", "b"], "Compare": ["a", "b"], "Predict": ["a", "b"], "Study": ["-o", "a"]}
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(command, "run", past_the_end)
    assert bench.cli.main([command.__name__.lower(), *arguments.get(command.__name__, [])]) == 0
    assert capfd.readouterr() == ("", "")
    assert not (tmp_path / LOG).exists()
    assert mujoco.get_mju_user_warning() is None


@pytest.mark.skipif(not CAN_FORK, reason="workers are threads there")
def test_workers_are_silent_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    with engine_silent():
        assert in_order(Processes(2), tried, [0, 1]) == [0, 0]
    assert capfd.readouterr() == ("", "")
    assert not (tmp_path / LOG).exists()


def test_what_somebody_listens_to_is_still_heard() -> None:
    heard: list[str] = []
    mujoco.set_mju_user_warning(heard.append)
    try:
        with engine_silent():
            past_the_end(None)
        assert len(heard) == 1
    finally:
        mujoco.set_mju_user_warning(None)


def test_one_model_that_is_simulated_still_warns(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with engine_silent():
        past_the_end(None)
    past_the_end(None)
    assert (tmp_path / LOG).read_text().count("reaches critical_length") == 1
