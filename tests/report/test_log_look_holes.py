"""A log with holes, pauses or channels that are dead: the rest of it is looked at, and what is left out is said."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.report.log_look.look import look
from bench.robot.nominal_dynamics import NominalDynamics
from tests import seven_joints, stranger
from tests.report.proposals import proposed


def light_log(tmp_path: Path) -> tuple[Path, list[list[str]]]:
    motion = stranger.moved(np.random.default_rng(1), 10.0, stranger.as_filed(2.5))
    file = stranger.ur_log(tmp_path / "x.csv", motion, ",", ".")
    return file, [line.split(",") for line in file.read_text().splitlines()]


@pytest.mark.parametrize("cell", ["", "nan", "1e250"])
def test_a_log_with_a_hole_is_looked_at(tmp_path: Path, arm: NominalDynamics, cell: str) -> None:
    file, rows = light_log(tmp_path)
    rows[700][2] = cell
    file.write_text("\n".join(",".join(row) for row in rows) + "\n")
    assert "no number in every row: 3; of a slow instrument" in look(file, nominal=arm).text


def test_a_log_with_a_pause_of_years_is_looked_at_up_to_there(tmp_path: Path, arm: NominalDynamics) -> None:
    file, rows = light_log(tmp_path)
    for row in rows[4000:]:
        row[0] = repr(float(row[0]) + 1e9)
    file.write_text("\n".join(",".join(row) for row in rows) + "\n")
    assert "q_motor_1_rad" in look(file, nominal=arm).text


@pytest.mark.parametrize(
    ("dead", "quantity", "why"),
    [
        ("zero", "current", "stands still at 0"),
        ("constant", "current", "stands still at 0.012"),
        ("noise", "current", r"carries nothing of the motion \(\d % explained\)"),
        ("constant", "torque", "stands still at 0.012"),
        ("noise", "torque", r"carries nothing of the motion \(\d % explained\)"),
    ],
)
def test_a_dead_channel_is_left_out_alone(tmp_path: Path, dead: str, quantity: str, why: str) -> None:
    """No current of any drive was proposed, without a word; noise was proposed with "sign as the model has it"."""
    arm = seven_joints.started(tmp_path)
    rng = np.random.default_rng(2)
    log = seven_joints.moved(arm, rng)
    paid = log.current * (np.array(seven_joints.CONSTANT) if quantity == "torque" else 1.0)
    paid[:, 4] = {"zero": 0.0, "constant": 0.012, "noise": 0.01 * rng.normal(size=len(paid))}[dead]
    angle = log.angle * np.where(np.arange(seven_joints.N) == 1, -1.0, 1.0)  # which is to be found all the same
    name = "A{}.M[Nm]" if quantity == "torque" else "A{}.Iq[A]"
    proposal = look(replace(log, current=paid, angle=angle).written(tmp_path / "x.csv", current=name), nominal=arm)
    form = proposed(tmp_path, proposal.text)
    column = "tau_motor_{}_nm" if quantity == "torque" else "current_{}_a"
    assert [j for j in range(1, 8) if column.format(j) not in form.columns] == [5]
    assert all(form.columns[column.format(j)].factor == 1 for j in (1, 2, 3, 4, 6, 7))
    assert [form.columns[f"q_motor_{j}_rad"].factor for j in (1, 2, 3)] == [1, -1, 1]
    assert re.search(rf"\n  # {column.format(5)}: {{.*}}  # {why}\n", proposal.text)
    assert any(re.search(rf"{re.escape(name.format(5))} {why}: left out below", one) for one in proposal.questions)


def test_readings_that_all_stand_still_are_said_not_to_be_taken(tmp_path: Path) -> None:
    arm = seven_joints.started(tmp_path)
    log = seven_joints.moved(arm, np.random.default_rng(2))
    text = look(replace(log, current=0 * log.current).written(tmp_path / "x.csv"), nominal=arm).text
    assert "A1.Iq[A] to A7.Iq[A]: stand still; not taken" in text
    assert not any(name.startswith("current") for name in proposed(tmp_path, text).columns)


def test_gear_ratios_are_found_beside_a_dead_channel(tmp_path: Path, arm: NominalDynamics) -> None:
    """As without one: the scale of the first two joints comes from the other drives."""
    motion = stranger.moved(np.random.default_rng(5), 15.0)
    found = []
    for dead in (False, True):
        readings = motion.torque / np.array(stranger.CONSTANT)
        readings[:, 2] *= not dead
        geared = replace(motion, position=np.deg2rad(100.0 * motion.position))
        file = stranger.named_log(tmp_path / "x.csv", geared, "pos_{}", "current_{}", readings)
        found.append(re.findall(r"gear ratio ([\d.]+) if it is in rad", look(file, nominal=arm).text)[:2])
    np.testing.assert_allclose(*np.array(found, dtype=float), rtol=0.1)
