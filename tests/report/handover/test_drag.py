"""Friction over speed for other programs: MuJoCo's damping, and what was learned."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

from bench.cli import main
from bench.effects.conditions import Conditions
from bench.effects.effect import Place
from bench.effects.learned import values_at
from bench.effects.learned_torques import LearnedDrag
from bench.report.handover.applied import applied_robot
from bench.report.handover.drag import drag_torque
from bench.report.handover.urdf_gaps import gaps_of
from bench.robot.compiled import read_spec
from bench.robot.folder import load_robot
from bench.robot.plugins import configure
from bench.robot.write import write_robot

SPEEDS = np.array([0.5, 1.5])  # [rad/s]


def test_damping_is_what_mujoco_makes_of_it_and_a_polynomial_is_said(small_robot: Path, tmp_path: Path) -> None:
    robot = load_robot(small_robot)
    drive, spec = robot.figures.drives[1], read_spec(robot)
    spec.joint(drive.rotor).damping = [7.6, 0.0, -4.3]
    spec.joint(drive.joint).damping = [0.0, 11.0, 0.0]
    spec.compile()
    (tmp_path / "damped").mkdir()
    write_robot(robot, spec, robot.figures, tmp_path / "damped", "")
    damped = applied_robot(load_robot(tmp_path / "damped"))
    said = "viscous friction that does not grow with the speed itself"
    assert said in list(gaps_of(damped))
    assert said not in list(gaps_of(applied_robot(robot)))
    learned = damped.compiled
    model, at = learned.model, learned.at
    data = mujoco.MjData(model)
    for speed in (-2.5, 0.4, 1.7):
        data.qvel[:] = 0.0
        data.qvel[at.q_dof] = data.qvel[at.theta_dof] = speed
        mujoco.mj_forward(model, data)
        expected = -(data.qfrc_damper[at.q_dof] + data.qfrc_damper[at.theta_dof])
        np.testing.assert_allclose(drag_torque(learned, np.full((1, 2), speed))[0], expected, rtol=1e-9)


@pytest.mark.parametrize("keeps", ["nothing", "coulomb", "viscous"])
def test_a_robot_without_friction_in_any_drive_is_told(
    small_robot: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], keeps: str
) -> None:
    """What was fitted to torques of sensors behind the gears was handed on as the torques of motors."""
    robot = load_robot(small_robot)
    spec = read_spec(robot)
    for k, drive in enumerate(robot.figures.drives):
        for name in (drive.motor_friction, drive.link_friction):
            level = 3.0 if keeps == "coulomb" and k == 1 else 0.0
            configure(spec, name, coulomb=level, rolling=0.0)
        for name in (drive.rotor, drive.joint):
            spec.joint(name).damping = [0.5 if keeps == "viscous" and k == 1 else 0.0, 0.0, 0.0]
    spec.compile()
    (tmp_path / "robot").mkdir()
    write_robot(robot, spec, robot.figures, tmp_path / "robot", "")
    assert main(["apply", str(tmp_path / "robot"), "-o", str(tmp_path / "applied")]) == 0
    page, warned = (tmp_path / "applied/README.md").read_text(), capsys.readouterr().err
    assert ("there is none in any drive" in page) == ("there is none in any drive" in warned) == (keeps == "nothing")


def test_what_was_learned_over_speed_is_friction_and_is_said(small_robot: Path, tmp_path: Path) -> None:
    """Half of it stood in `rest_i`, and `applied/README.md` had half a sentence of it."""
    robot = load_robot(small_robot)
    spec = read_spec(robot)
    edit = LearnedDrag(values_at(SPEEDS, "rad/s", "Nm", 1.0), SPEEDS, "motor").edit(
        Place("joint", 1, robot.figures.drives[1].joint), {"at_1": -1.0, "at_2": -3.0}, Conditions.reference(2)
    )
    assert edit
    edit(spec, robot)
    spec.compile()
    (tmp_path / "learned").mkdir()
    write_robot(robot, spec, robot.figures, tmp_path / "learned", "")
    time = np.linspace(0.0, 1.0, 201)
    motion = tmp_path / "motion.csv"
    rows = [f"{t:.6f},0,{0.5 * (1 - np.cos(2 * np.pi * t)):.9f}" for t in time]  # as fast as 3.1 rad/s
    motion.write_text("\n".join(["time_s,q_cmd_1_rad,q_cmd_2_rad", *rows]) + "\n")
    found = []
    for folder in (small_robot, tmp_path / "learned"):
        out = tmp_path / f"applied-{folder.name}"
        assert main(["apply", str(folder), "-o", str(out), "--motion", str(motion)]) == 0
        found.append(np.genfromtxt(out / "torque.csv", delimiter=",", names=True))
    without, learned = found
    speed = 0.5 * 2 * np.pi * np.abs(np.sin(2 * np.pi * time))
    slides = speed > 0.1
    more = np.abs(learned["friction_2_nm"]) - np.abs(without["friction_2_nm"])
    expected = 1.0 + 2.0 * (speed - SPEEDS[0]) / (SPEEDS[1] - SPEEDS[0])  # and beyond as steep
    np.testing.assert_allclose(more[slides], expected[slides], atol=0.02)
    np.testing.assert_allclose(learned["rest_2_nm"][slides], without["rest_2_nm"][slides], atol=0.02)
    page = (tmp_path / "applied-learned" / "README.md").read_text()
    assert "friction of hinge_b, motor side, beyond its Coulomb level: drag 2, drag speed 1.5" in page
