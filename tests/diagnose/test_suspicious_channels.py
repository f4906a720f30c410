"""Channels that a lab got wrong are named by column; healthy ones are not, whatever is hidden in the robot."""

import numpy as np
import pytest

from bench.diagnose.plausibility.channels import _of_drive, doubts_of
from bench.diagnose.plausibility.single_rows import overloads
from bench.record.campaign import Array, Campaign
from bench.record.finding import Finding
from bench.robot.compiled import CompiledRobot
from tests.diagnose.sweeps import LOADS, SWEEPS, Change, changed, freeze, made, scale, swap
from tests.diagnose.two_drives import picture_of

CURRENTS = tuple(f"current_{i}_a" for i in range(1, 7))
TRACKER = tuple(f"reflector_1_{axis}_m" for axis in "xyz")


def clip(name: str) -> Change:
    """Return what cuts a channel of each run off, a fifth of it at either end."""

    def cut(columns: dict[str, Array]) -> None:
        columns[name] = np.clip(columns[name], *np.quantile(columns[name], (0.2, 0.8)))

    return cut


def backwards(name: str) -> Change:
    return lambda columns: columns.update({name: columns[name][::-1].copy()})


def mirror(name: str) -> Change:
    return lambda columns: columns.update({name: 2 * columns[name].mean() - columns[name]})


def rest_in_the_middle(name: str) -> Change:
    """Return what repeats a channel's reading after a third of each run for a fifth of it."""

    def rest(columns: dict[str, Array]) -> None:
        rows = len(columns[name])
        columns[name][rows // 3 : rows // 3 + rows // 5] = columns[name][rows // 3]

    return rest


IN_SWEEPS: dict[str, tuple[Change, str, str]] = {
    "sign": (scale(-1, "current_2_a"), "current_2_a", "wrong sign"),
    "sign of a drive that stands": (scale(-1, "current_3_a"), "current_3_a", "wrong sign"),
    "all signs": (scale(-1, *CURRENTS), "current_2_a", "wrong sign"),
    "kiloamperes": (scale(1e-3, "current_2_a"), "current_2_a", "1e+03 times smaller"),
    "ten times": (scale(10, "current_2_a"), "current_2_a", "10 times larger"),
    "swapped": (swap("current_2_a", "current_3_a"), "current_2_a", "current_2_a and current_3_a are exchanged"),
    "not connected": (scale(0, "current_3_a"), "current_3_a", "is 0 all along"),
    "tracker in inches": (scale(39.37, *TRACKER), "reflector_1_x_m", "inches?"),
    "tracker turned": (scale(-1, "reflector_1_x_m"), "reflector_1_x_m", "read as -x, y, z"),
    "tracker's axes": (swap("reflector_1_x_m", "reflector_1_z_m"), "reflector_1_x_m", "read as z, y, x"),
    "one axis frozen": (freeze("reflector_1_x_m"), "reflector_1_x_m", "frozen?"),
    "gauge frozen": (freeze("gas_pressure_pa"), "gas_pressure_pa", "frozen?"),
    "gauge in kPa": (scale(1e-3, "gas_pressure_pa"), "gas_pressure_pa", "kPa?"),
    "one axis saturated": (clip("reflector_1_x_m"), "reflector_1_x_m", "saturated?"),
    "one axis frozen for a while": (rest_in_the_middle("reflector_1_z_m"), "reflector_1_z_m", "a part of run"),
    "gauge saturated": (clip("gas_pressure_pa"), "gas_pressure_pa", "saturated?"),
    "gauge frozen for a while": (rest_in_the_middle("gas_pressure_pa"), "gas_pressure_pa", "a part of run"),
    "gauge mirrored": (mirror("gas_pressure_pa"), "gas_pressure_pa", "falls where the model's rises"),
}
IN_LOADS: dict[str, tuple[Change, str, str]] = {
    "sign": (scale(-1, "current_2_a"), "current_2_a", "wrong sign"),
    "load in kN": (scale(1e-3, "load_z_n"), "load_z_n", "kilonewtons?"),
    "axis turned": (scale(-1, "q_cmd_2_rad", "q_motor_2_rad", "current_2_a"), "current_2_a", "sense of turning"),
}
# at the largest plausible size, or beyond what is usual
HIDDEN = {
    "gas_loss": 0.3,
    "torque_constant": 0.1,
    "coulomb_level": 0.6,
    "payload_mass": 0.1,
    "torque_offset": 300.0,
    "current_offset": 0.3,
    "polytropic_exponent": 1.6,
    "dress_pack": 169.0,
}

TURN = np.linspace(0, 2 * np.pi, 600, endpoint=False)
FIRST, SECOND, HUM = np.sin(2 * TURN), np.sin(4 * TURN + 0.5), np.sin(8 * TURN)


@pytest.fixture(scope="module")
def sweeps() -> Campaign:
    return made(SWEEPS, seed=5)


@pytest.fixture(scope="module")
def loads() -> Campaign:
    return made(LOADS, seed=6)


def test_healthy_campaigns_raise_no_doubt(sweeps: Campaign, loads: Campaign, robot: CompiledRobot) -> None:
    assert doubts_of(sweeps, robot) == ()
    assert doubts_of(loads, robot) == ()


def test_a_gauge_that_shows_another_movement_is_told(sweeps: Campaign, robot: CompiledRobot) -> None:
    """A gauge that was played backwards was believed; a gas that the model does not know moves as the model's does."""
    assert [one.column for one in doubts_of(changed(sweeps, backwards("gas_pressure_pa")), robot)] == [
        "gas_pressure_pa"
    ]


def test_instruments_that_are_slower_than_their_log_are_not_frozen(sweeps: Campaign, robot: CompiledRobot) -> None:
    """A slow instrument repeats its last reading, as the format has it."""

    def slow(columns: dict[str, Array]) -> None:
        for name in (*TRACKER, "gas_pressure_pa"):
            columns[name] = columns[name][np.arange(len(columns[name])) // 8 * 8]

    assert not [one for one in doubts_of(changed(sweeps, slow), robot) if "frozen" in one.remedy]


@pytest.mark.parametrize("name", HIDDEN)
def test_a_hidden_effect_is_no_mistake_of_the_lab(name: str, robot: CompiledRobot) -> None:
    assert doubts_of(made(SWEEPS, seed=7, hidden={name: HIDDEN[name]}), robot) == ()


@pytest.mark.parametrize("name", IN_SWEEPS)
def test_mistake_in_sweeps_is_named(name: str, sweeps: Campaign, robot: CompiledRobot) -> None:
    change, column, words = IN_SWEEPS[name]
    first = doubts_of(changed(sweeps, change), robot)[0]
    assert (first.level, first.column) == ("doubt", column)
    assert words in str(first)


@pytest.mark.parametrize("name", IN_LOADS)
def test_mistake_at_rest_is_named(name: str, loads: Campaign, robot: CompiledRobot) -> None:
    change, column, words = IN_LOADS[name]
    first = doubts_of(changed(loads, change), robot)[0]
    assert first.column == column
    assert words in str(first)


def test_two_mistakes_are_both_named(sweeps: Campaign, robot: CompiledRobot) -> None:
    two = changed(changed(sweeps, scale(-1, "current_2_a")), scale(1e-3, "gas_pressure_pa"))
    assert {doubt.column for doubt in doubts_of(two, robot)} == {"current_2_a", "gas_pressure_pa"}


def test_nothing_is_made_of_angles_that_are_doubted_already(sweeps: Campaign, robot: CompiledRobot) -> None:
    known = (Finding("doubt", "a.csv", None, "q_motor_2_rad", "is a copy", "look"),)
    frozen = changed(sweeps, lambda columns: columns.update(q_motor_2_rad=np.zeros_like(columns["q_motor_2_rad"])))
    assert doubts_of(frozen, robot)
    assert doubts_of(frozen, robot, known) == ()


def test_an_angle_that_no_drive_makes_is_doubted(sweeps: Campaign, robot: CompiledRobot) -> None:
    def spoil(columns: dict[str, Array]) -> None:
        columns["q_motor_2_rad"][50] += 0.4

    every = doubts_of(changed(sweeps, spoil), robot)
    assert {(doubt.level, doubt.column) for doubt in every} == {("doubt", "q_motor_2_rad")}
    assert all("row 51" in doubt.message and "there and back so fast" in doubt.message for doubt in every)


def test_a_current_beyond_the_torque_limit_in_the_first_row_is_told(sweeps: Campaign, robot: CompiledRobot) -> None:
    def spoil(columns: dict[str, Array]) -> None:
        columns["current_5_a"][0] = 200.0

    hints = list(overloads(changed(sweeps, spoil), robot))
    assert {(hint.level, hint.column) for hint in hints} == {("warning", "current_5_a")}
    assert all("row 1" in hint.message and "the limit of its drive" in hint.message for hint in hints)
    assert not list(overloads(changed(sweeps, scale(1e3, "current_2_a")), robot)), "that is another unit"


def of_one_drive(observed: Array, robot: CompiledRobot, model: float = 1.0) -> str:
    """Return what is said first of joint 1, whose model fits badly either way; joint 2 moves otherwise."""
    torque = model * np.stack([FIRST, SECOND], axis=1)
    velocity = np.stack([np.cos(TURN), np.cos(3 * TURN + 1)], axis=1)
    picture = picture_of(np.stack([observed, SECOND], axis=1), torque, velocity)
    return next((doubt.message for doubt in _of_drive(picture, robot, 0, np.ones(len(TURN), dtype=np.bool_))), "")


def test_a_channel_that_follows_another_joint_is_told_by_a_poor_model_too(robot: CompiledRobot) -> None:
    others = 0.6 * SECOND + np.sign(np.cos(3 * TURN + 1))
    assert "follows the motion of joint 2" in of_one_drive(others + 0.1 * HUM, robot)
    assert not of_one_drive(FIRST + np.sign(np.cos(TURN)) + 0.5 * HUM, robot)


def test_friction_that_gives_energy_is_told_by_a_poor_model_too(robot: CompiledRobot) -> None:
    assert "friction of" in of_one_drive(-FIRST - np.sign(np.cos(TURN)) + 0.5 * HUM, robot)
