"""A vertical slide that was converted with the wrong sign, angle and torque alike, is told by its weight.

A hose pulls the first axis round, so the nominal model leaves too much of it to be believed about the others.
"""

import numpy as np
import pytest

from bench.diagnose.plausibility.channels import doubts_of
from bench.record.campaign import Campaign, Run
from bench.robot.compiled import CompiledRobot
from bench.robot.starter.folder import start_robot
from bench.robot.starter.source import read_source
from tests import scara

HOSE = 25.0  # [Nm/rad]
STICKING = (7.0, 3.0, 60.0, 0.35)  # [Nm], [N]: friction that holds the quill and its load up
WEIGHT = 9.81 * (scara.MASS[2] + scara.MASS[3])  # [N], of the quill


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> CompiledRobot:
    """Return the robot as `bench new-robot` starts it."""
    folder = tmp_path_factory.mktemp("scara")
    (folder / "scara.xml").write_text(scara.mjcf())
    return start_robot("scara", read_source(folder / "scara.xml"), folder / "scara").compiled


def doubts(
    robot: CompiledRobot,
    signs: tuple[float, ...],
    load: scara.Load | None = None,
    coulomb: tuple[float, ...] = scara.COULOMB,
    spring: float = 0.0,
) -> list[str]:
    """Return what is doubted of two runs.

    Args:
        robot: Nominal.
        signs: Of each axis, of angle and torque alike.
        load: That hangs at the tool.
        coulomb: Friction of the drives.
        spring: What holds the quill up, and no file has [N].
    """
    runs = []
    for k in range(2):
        log = scara.moved(np.random.default_rng(4 + k), load, coulomb)
        torque = log.current * scara.CONSTANT
        torque[:, 0] += HOSE * (log.position[:, 0] - 0.3)
        torque[:, 2] += spring  # the axis points down
        columns = {"time_s": log.time}
        for j in range(scara.N):
            unit, of_torque = ("m", "n") if j == 2 else ("rad", "nm")
            columns[f"q_motor_{j + 1}_{unit}"] = signs[j] * log.position[:, j]
            columns[f"tau_motor_{j + 1}_{of_torque}"] = signs[j] * torque[:, j]
        runs.append(Run(f"run{k}", "motion", 100.0 * k, columns))
    return [str(doubt) for doubt in doubts_of(Campaign("scara", tuple(runs)), robot)]


@pytest.mark.parametrize("load", [None, scara.BESIDE])
def test_a_slide_whose_weight_nothing_can_hold_is_doubted(robot: CompiledRobot, load: scara.Load | None) -> None:
    """An offset of 16 N held the quill up, and of 26 N beside its load."""
    (doubt,) = doubts(robot, scara.UP, load)
    assert "q_motor_3: J3 moves against the model's sense of turning, torque and angle alike" in doubt
    assert "its weight, friction and the stated offset leave" in doubt


@pytest.mark.parametrize("load", [None, scara.BESIDE])
@pytest.mark.parametrize("coulomb", [scara.COULOMB, STICKING])
def test_of_a_slide_that_counts_as_it_should_nothing_is_said(
    robot: CompiledRobot, load: scara.Load | None, coulomb: tuple[float, ...]
) -> None:
    assert doubts(robot, (1.0,) * scara.N, load, coulomb) == []


@pytest.mark.parametrize("share", [0.5, 0.9, 1.2])
def test_a_spring_that_no_file_has_is_not_taken_for_a_slide_that_is_turned(robot: CompiledRobot, share: float) -> None:
    said = doubts(robot, (1.0,) * scara.N, spring=share * WEIGHT)
    assert not any("sense of turning" in doubt for doubt in said)


def test_a_slide_that_friction_could_hold_is_not_doubted(robot: CompiledRobot) -> None:
    assert doubts(robot, scara.UP, None, STICKING) == []
