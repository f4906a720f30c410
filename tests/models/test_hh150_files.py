"""The files of models/hh150 agree with each other and with the paper's tables."""

import csv
import json
import subprocess
import sys
from types import ModuleType

import mujoco
import numpy as np
import pytest
import yaml

from bench.identify.table5_experiment import read_experiment
from bench.robot.figures import Figures
from tests.models.conftest import HH150

LARGEST_PICTURE = 150_000  # bytes


@pytest.fixture(scope="module")
def figures() -> Figures:
    return Figures.model_validate(yaml.safe_load((HH150 / "figures.yaml").read_text()))


def test_every_derived_number_stands_in_the_xml_and_in_the_readme(derive: ModuleType) -> None:
    assert derive.differences() == []


def test_check_names_what_differs(derive: ModuleType, tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "hh150.xml").write_text((HH150 / "hh150.xml").read_text().replace('armature="609"', 'armature="600"'))
    (tmp_path / "README.md").write_text((HH150 / "README.md").read_text().replace("| 609 |", "| 600 |"))
    (tmp_path / "paper").symlink_to(HH150 / "paper")
    monkeypatch.setattr(derive, "HERE", tmp_path)
    in_xml, in_readme = derive.differences()
    assert "rotor1" in in_xml
    assert "armature" in in_xml
    assert "609" in in_xml
    assert in_readme.startswith("README.md: lacks this line: | rotor: J_m")


def test_script_runs_by_itself() -> None:
    done = subprocess.run(
        [sys.executable, str(HH150 / "derive.py"), "--check"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_torque_constants_are_table_2(figures: Figures, derive: ModuleType) -> None:
    constants = [drive.torque_constant_nm_per_a for drive in figures.drives]
    assert constants == derive.arm.XI.tolist() == [169.6355, 220.8436, 220.8436, 127.0724, 138.3101, 139.4627]
    assert (figures.rating.force_n, figures.rating.moment_nm) == (1500, 200)


def test_the_arm_of_the_loading_experiment_is_table_1_and_2(derive: ModuleType) -> None:
    experiment, arm = read_experiment(HH150 / "paper"), derive.arm
    table = np.array([(row.a, row.alpha, row.d, row.zero, *row.limits) for row in experiment.rows])
    np.testing.assert_allclose(table, np.column_stack([arm.A, arm.ALPHA, arm.D, arm.OFFSET, arm.RANGE]), rtol=1e-15)
    assert experiment.torque_constant.tolist() == arm.XI.tolist()


def test_speed_limits_are_the_servos_own(figures: Figures, model: mujoco.MjModel) -> None:
    for drive in figures.drives:
        velocity_input = model.actuator_ctrladr[model.actuator(drive.servo).id] + 1
        assert model.actuator_ctrlrange[velocity_input, 1] == drive.speed_limit_rad_per_s


def test_tracker_stands_within_reach_and_outside_the_robot(figures: Figures, model, data) -> None:
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    assert figures.instruments.tracker
    distance = np.linalg.norm(data.site("reference_point").xpos - figures.instruments.tracker.position_m)
    assert 2 < distance < 4  # [m]


def test_stiffness_is_the_row_current_of_table_6(model: mujoco.MjModel) -> None:
    with (HH150 / "paper" / "table6.csv").open() as file:
        rows = {row.pop("method"): [float(value) for value in row.values()] for row in csv.DictReader(file)}
    held = model.tendon_stiffness[[model.tendon(f"element{i}").id for i in range(1, 7)]]
    assert held.tolist() == rows["current"]
    ratio = np.array(rows["force"]) / rows["current"]
    np.testing.assert_allclose([ratio.min(), ratio.max()], [1.12, 1.42], atol=0.005)


def test_table_5_is_complete() -> None:
    with (HH150 / "paper" / "table5.csv").open() as file:
        rows = list(csv.DictReader(file))
    loaded = [row for row in rows if row["dx_mm"]]
    assert (len(rows), len(loaded)) == (24, 18)
    assert [sum(row["configuration"] == str(i) for row in rows) for i in range(1, 7)] == [5, 5, 5, 5, 2, 2]


def test_reconstructed_sets_lie_in_the_working_range(model: mujoco.MjModel) -> None:
    sets = json.loads((HH150 / "paper" / "configurations.json").read_text())
    assert set(sets) == {"A1", "A3", "B1"}
    low, high = np.array([model.joint(f"joint{i}").range for i in range(1, 7)]).T
    for name in ("A1", "A3", "B1"):
        q = np.deg2rad(sets[name]["q_deg"])
        assert ((low < q) & (q < high)).all()


def test_the_sets_explain_the_unloaded_currents_within_friction(derive: ModuleType) -> None:
    """I_j of Table 5 stands for -s_j tau_j / xi_j; what is left is static friction, a few ampere at most."""
    a1 = json.loads((HH150 / "paper" / "configurations.json").read_text())["A1"]
    with (HH150 / "paper" / "table5.csv").open() as file:
        unloaded = [row for row in csv.DictReader(file) if not row["dx_mm"]]
    currents = np.array([[float(row[f"i{j}_A"]) for j in range(1, 7)] for row in unloaded])
    torque = np.array([derive.arm.holding_torque(np.deg2rad(q)) for q in a1["q_deg"]])
    left = currents + np.array(a1["current_signs"]) * torque / derive.arm.XI
    rms = np.sqrt(np.mean(left**2, axis=0))
    assert (rms < 1.5 * derive.UNLOADED_CURRENT).all()
    assert (rms[1:3] < 0.4 * np.sqrt(np.mean(currents[:, 1:3] ** 2, axis=0))).all()


def test_picture_is_small() -> None:
    pictures = list(HH150.rglob("*.png"))
    assert [picture.name for picture in pictures] == ["hh150.png"]
    assert pictures[0].stat().st_size < LARGEST_PICTURE
