"""Friction over speed that was learned as a polynomial: MuJoCo's own, and told where it cannot be meant."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

from bench.cli import main
from bench.report.handover.applied import applied_robot
from bench.report.handover.drag import beyond_learned, drag_torque, falls_beyond, learned_words
from bench.report.handover.urdf_gaps import gaps_of
from bench.robot.compiled import CompiledRobot, compile_robot, read_spec
from bench.robot.folder import load_robot
from bench.robot.write import write_robot

FALLING = (7.6, 11.0, -4.3)  # of v, v|v| and v^3: as a stranger's arm got it, measured up to 1.5 rad/s
TURNS = 2.0  # [rad/s], 7.6 + 22 v - 12.9 v^2 = 0


@pytest.fixture(scope="module")
def folder(small_robot: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the two-joint robot with a learned drag on its second drive, part of it on either side."""
    robot = load_robot(small_robot)
    spec = read_spec(robot)
    drive = robot.figures.drives[1]
    spec.joint(drive.rotor).damping = [FALLING[0], 0.0, FALLING[2]]
    spec.joint(drive.joint).damping = [0.0, FALLING[1], 0.0]
    spec.compile()
    path = tmp_path_factory.mktemp("drag") / "learned"
    path.mkdir()
    write_robot(robot, spec, robot.figures, path, "")
    return path


@pytest.fixture(scope="module")
def learned(folder: Path) -> CompiledRobot:
    return compile_robot(load_robot(folder))


@pytest.mark.parametrize(
    ("coefficients", "speed"),
    [
        ((5.0, 0.0, 0.0), np.inf),
        ((5.0, 2.0, 1.0), np.inf),
        ((-3.0, 0.0, 4.0), np.inf),  # falls at first, as Stribeck friction does, and grows later
        ((6.0, -1.5, 0.0), 2.0),
        ((0.0, 3.0, -1.0), 2.0),
        ((-1.0, 0.0, 0.0), 0.0),
        (FALLING, TURNS),
    ],
)
def test_where_a_polynomial_falls_for_good(coefficients: tuple[float, float, float], speed: float) -> None:
    assert falls_beyond(np.array(coefficients)) == pytest.approx(speed, rel=1e-4)


def test_it_is_what_mujoco_makes_of_it(learned: CompiledRobot) -> None:
    model, at = learned.model, learned.at
    data = mujoco.MjData(model)
    for speed in (-2.5, 0.4, 1.7):
        data.qvel[:] = 0.0
        data.qvel[at.q_dof] = data.qvel[at.theta_dof] = speed
        mujoco.mj_forward(model, data)
        expected = -(data.qfrc_damper[at.q_dof] + data.qfrc_damper[at.theta_dof])
        np.testing.assert_allclose(drag_torque(learned, np.full((1, 2), speed))[0], expected, rtol=1e-9)


def test_whoever_moves_faster_is_told(learned: CompiledRobot) -> None:
    slow, fast = np.array([[5.0, 1.9], [0.0, -1.0]]), np.array([[5.0, 1.9], [0.0, -2.4]])
    assert list(beyond_learned(learned, slow)) == []
    (words,) = beyond_learned(learned, fast)
    assert words.startswith("hinge_b: 2.4 rad/s, and the friction that was learned over its speed falls beyond 2 rad/s")
    (words,) = learned_words(learned)
    assert words == "hinge_b +7.6 v +11 v|v| -4.3 v^3 [Nm], not to be used beyond 2 rad/s, where it falls for good"


def test_the_command_warns_and_writes_it(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    time = np.linspace(0.0, 1.0, 201)
    second = 0.5 * (1 - np.cos(2 * np.pi * time))  # as fast as 3.1 rad/s
    rows = [f"{t:.6f},0,{q:.9f}" for t, q in zip(time, second, strict=True)]
    motion = tmp_path / "motion.csv"
    motion.write_text("\n".join(["time_s,q_cmd_1_rad,q_cmd_2_rad", *rows]) + "\n")
    assert main(["apply", str(folder), "-o", str(tmp_path / "applied"), "--motion", str(motion)]) == 0
    assert "the friction that was learned over its speed falls beyond 2 rad/s" in capsys.readouterr().err
    page = (tmp_path / "applied" / "README.md").read_text()
    assert "- friction that was learned over speed, in place of `damping`: hinge_b +7.6 v" in page
    assert any("learned over speed" in words for words in gaps_of(applied_robot(load_robot(folder))))
