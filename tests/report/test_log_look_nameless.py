"""Columns without names: what a controller computes beside what it measures; constants that figures state."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from bench.report.log_look.look import look
from bench.robot.nominal_dynamics import NominalDynamics
from tests import stranger
from tests.report.proposals import proposed
from tests.stranger_started import started

JOINTS = (1, 2, 3)
CONSTANT = np.abs(stranger.CONSTANT)
DECIMALS = 4
GRAVITY_NOISE = 3e-4  # [g] of the sensor by which a controller knows where down is


@pytest.fixture(scope="module")
def guessed(tmp_path_factory: pytest.TempPathFactory) -> NominalDynamics:
    """Return the arm as a file with a placeholder for rotors states it; nothing tells constants sharply then."""
    nominal = started(tmp_path_factory.mktemp("guessed"), stranger.mjcf(armature=5.0))
    return replace(nominal, stated_constant=CONSTANT)


def controllers_log(file: Path, motion: stranger.Motion, by_constants: bool) -> Path:
    """Write clock, angles, speeds, currents, and what a controller computes of the links: torques, or currents too."""
    rng = np.random.default_rng(1)
    links = stranger.as_filed().links
    data = links.createData()
    acceleration = np.gradient(motion.velocity, motion.time, axis=0)
    computed = np.array(
        [
            pin.rnea(links, data, q, v, a) + pin.computeGeneralizedGravity(links, data, q) * GRAVITY_NOISE * noise
            for q, v, a, noise in zip(
                motion.position, motion.velocity, acceleration, rng.normal(size=len(motion.time)), strict=True
            )
        ]
    )
    if not by_constants:  # what holds the arm alone: nothing but its last decimals for an upright axis
        computed = np.array([pin.computeGeneralizedGravity(links, data, q) for q in motion.position])
        computed[:, 0] += 10.0**-DECIMALS * rng.normal(size=len(computed))
    more = [computed / CONSTANT, computed] if by_constants else [computed]
    rows = np.column_stack([motion.time, motion.position, motion.velocity, motion.torque / CONSTANT, *more])
    np.savetxt(file, rows.round(DECIMALS), delimiter=",", fmt=f"%.{DECIMALS}f")
    return file


def sources(folder: Path, text: str) -> list[str]:
    """Return from which columns torques or currents are read."""
    columns = proposed(folder, text).columns
    return [column.source for name, column in columns.items() if name.startswith(("tau_motor", "current"))]


def test_a_drive_that_needs_no_torque_does_not_make_a_computed_one_measured(
    tmp_path: Path, arm: NominalDynamics
) -> None:
    """Of the upright axis the last decimals are all there is: that was the roughest column, and its family taken."""
    log = controllers_log(tmp_path / "x.csv", stranger.moved(np.random.default_rng(5), 15.0), by_constants=False)
    text = look(log, nominal=arm).text
    assert "11 to 13: follow the torque too; 8 to 10 are taken, as what was measured" in text
    assert sources(tmp_path, text) == ["8", "9", "10"]


def test_what_a_controller_computes_is_no_current_that_was_measured(tmp_path: Path, arm: NominalDynamics) -> None:
    """Desired currents fit the stated constants without friction: they were taken, and the measured ones as torques."""
    log = controllers_log(tmp_path / "x.csv", stranger.moved(np.random.default_rng(5), 15.0), by_constants=True)
    stated = replace(arm, stated_constant=CONSTANT)
    text = look(log, nominal=stated).text
    assert sources(tmp_path, text) == ["8", "9", "10"]
    assert [f"current_{j}_a" in proposed(tmp_path, text).columns for j in JOINTS] == [True] * 3


def test_stated_constants_make_currents_of_what_the_log_does_not_tell(tmp_path: Path, guessed: NominalDynamics) -> None:
    """No line was proposed, and constants asked for that stood in the figures."""
    motion = stranger.moved(
        np.random.default_rng(3), 6.0, stranger.unlike_its_file(np.random.default_rng(4)), swing=0.2
    )
    log = controllers_log(tmp_path / "x.csv", motion, by_constants=False)
    text = look(log, nominal=guessed).text
    assert [f"current_{j}_a" in proposed(tmp_path, text).columns for j in JOINTS] == [True] * 3
    assert sources(tmp_path, text) == ["8", "9", "10"]
    assert "this log tells neither these nor others" in text


def test_a_dozen_rows_from_either_end_of_a_log_tell_no_positions(tmp_path: Path, arm: NominalDynamics) -> None:
    """Warnings of NumPy were all that stood above the proposal."""
    motion = stranger.moved(np.random.default_rng(5), 1.0)
    rows = np.r_[0:8, 300:308]
    table = np.column_stack([motion.time, motion.position, motion.torque])[rows]
    np.savetxt(tmp_path / "x.csv", table, delimiter=",", fmt="%.4f")
    assert "no column was recognised as a position" in look(tmp_path / "x.csv", nominal=arm).text
