"""Each fault in otherwise healthy data gives one finding, which names the column, the first row and the reason."""

import numpy as np
import pytest

from bench.record.rules import alignment
from tests.record.build import ARM, STEP_S, examine, loading, motion, only, static, sweep
from tests.record.spoil import Change, Columns, clip, copy, drop_rows, put, rename, scale, shift, swap


def lose_beam(columns: Columns) -> None:
    for axis in "xyz":
        put(f"reflector_1_{axis}_m", slice(6, 8), 0.0)(columns)


def park_tracker(columns: Columns) -> None:
    for axis in "xz":
        put(f"reflector_1_{axis}_m", slice(None), 1.5)(columns)


def move_both(columns: Columns) -> None:
    """Let drive 1 make a movement of its own."""
    time = columns["time_s"]
    columns["q_cmd_1_rad"] = 0.3 * np.sin(2 * np.pi * time / time[-1])
    columns["q_motor_1_rad"] = np.interp(time - 0.03, time, columns["q_cmd_1_rad"])
    columns["current_1_a"] = np.random.default_rng(3).normal(0, 0.02, len(time))


def copy_command(columns: Columns) -> None:
    columns["q_motor_2_rad"] = columns["q_cmd_2_rad"]
    del columns["q_link_2_rad"]


def turn_torque(columns: Columns) -> None:
    """Turn the torque's sign in a path that does not close."""
    columns["tau_motor_2_nm"] = -columns["tau_motor_2_nm"]
    drop_rows(slice(1000, None))(columns)


def swap_encoders(columns: Columns) -> None:
    move_both(columns)
    swap("q_motor_1_rad", "q_motor_2_rad")(columns)
    del columns["q_link_2_rad"]


def small_movement_in_degrees(columns: Columns) -> None:
    for name in [name for name in columns if not name.startswith(("time", "q_cmd"))]:
        del columns[name]
    columns["q_cmd_2_rad"] = columns["q_cmd_2_rad"] * 0.1
    columns["q_motor_2_rad"] = np.rad2deg(columns["q_cmd_2_rad"])


def command_speeds(columns: Columns) -> None:
    columns["q_cmd_2_rad"] = np.gradient(columns["q_cmd_2_rad"], columns["time_s"])


def log_the_servo_error(columns: Columns) -> None:
    columns["q_motor_2_rad"] = columns["q_motor_2_rad"] - columns["q_cmd_2_rad"]
    for name in ("q_link_2_rad", "current_2_a", "tau_motor_2_nm"):
        del columns[name]


def other_unit(row: int, factor: float, began: float = 0.0) -> Change:
    """Give a clock in another unit from a row on; it showed `began` where the run begins, which was taken off."""

    def change(columns: Columns) -> None:
        columns["time_s"] = (columns["time_s"] + began) * np.where(np.arange(2500) < row, 1.0, factor) - began

    return change


def exchange_rows(columns: Columns) -> None:
    columns["time_s"][[99, 100]] = columns["time_s"][[100, 99]]


# Change -> level, column, first row, words of the message or the remedy.
Faults = dict[str, tuple[Change, str, str, int | None, str]]

# Of a sweep.
MOTION: Faults = {
    "nan": (put("current_2_a", 4, np.nan), "error", "current_2_a", 5, "row 5;"),
    "infinite": (put("current_2_a", slice(4, 7), np.inf), "error", "current_2_a", 5, "rows 5 to 7"),
    "logger's no value": (put("current_2_a", 4, 3.4e38), "error", "current_2_a", 5, "no reading"),
    "clock back": (put("time_s", 9, 0.001), "error", "time_s", 10, "backwards"),
    "clock stands": (put("time_s", 9, 8 * STEP_S), "error", "time_s", 10, "same as in the row before"),
    "lost samples": (drop_rows(slice(100, 150)), "warning", "time_s", 101, "not 0.004 s after"),
    "boot clock": (scale("time_s", 1.0, 5e3), "warning", "time_s", None, "subtract"),
    "milliseconds": (scale("time_s", 1e3), "doubt", "time_s", None, "milliseconds? multiply by 0.001"),
    "microseconds": (scale("time_s", 1e6), "doubt", "time_s", None, "microseconds? multiply by 1e-06"),
    "nanoseconds": (scale("time_s", 1e9), "doubt", "time_s", None, "nanoseconds? multiply by 1e-09"),
    "milliseconds from there on": (other_unit(900, 1e3), "doubt", "time_s", 901, "milliseconds from there on?"),
    "of a clock of the day": (other_unit(1600, 1e3, 3e4), "doubt", "time_s", 1601, "milliseconds from there on?"),
    "nanoseconds from there on": (other_unit(1600, 1e9), "doubt", "time_s", 1601, "nanoseconds from there on?"),
    "a date among numbers": (put("time_s", 5, 1.7e9), "error", "time_s", 6, "a date among numbers"),
    "a date before numbers": (put("time_s", 0, 1.7e9), "error", "time_s", 1, "a date among numbers"),
    "two rows exchanged": (exchange_rows, "error", "time_s", 101, "backwards"),
    "no time": (lambda columns: columns.pop("time_s"), "error", "time_s", None, "missing"),
    "degrees": (scale("q_link_2_rad", 180 / np.pi), "error", "q_link_2_rad", None, "pi / 180"),
    "small degrees": (small_movement_in_degrees, "error", "q_motor_2_rad", None, "degrees?"),
    "millimetres": (scale("reflector_1_x_m", 1e3), "error", "reflector_1_x_m", 1, "0.001"),
    "milliamperes": (scale("current_2_a", 1e3), "error", "current_2_a", None, "0.001"),
    "celsius": (scale("gear_temperature_2_k", 1, -273.15), "error", "gear_temperature_2_k", 1, "273.15"),
    "bar": (scale("gas_pressure_pa", 1e-5), "doubt", "gas_pressure_pa", None, "100000"),
    "unit name": (
        rename("q_link_2_rad", "q_link_2_deg"),
        "error",
        "q_link_2_deg",
        None,
        "q_link_2_rad and multiply by 0.0174",
    ),
    "capitals": (rename("tau_motor_2_nm", "tau_motor_2_Nm"), "error", "tau_motor_2_Nm", None, "name it tau_motor_2_nm"),
    "no unit": (rename("gas_pressure_pa", "gas_pressure"), "error", "gas_pressure", None, "gas_pressure_pa and give"),
    "a zero width space": (
        rename("q_link_2_rad", "q_link_\u200b2_rad"),
        "error",
        "q_link_2_rad",
        None,
        "has U+200B in it",
    ),
    "a byte order mark": (
        rename("current_2_a", "\ufeffcurrent_2_a"),
        "error",
        "current_2_a",
        None,
        "name it current_2_a",
    ),
    "a reflector with a mark": (
        rename("reflector_1_x_m", "reflector_1_x\u00a0_m"),
        "error",
        "reflector_1_x_m",
        None,
        "U+00A0",
    ),
    "unknown": (rename("q_link_2_rad", "q_lnk_2_rad"), "error", "q_lnk_2_rad", None, "did you mean 'q_link_2_rad'"),
    "far from all": (copy("oil", "time_s"), "error", "oil", None, "known: time_s, pose,"),
    "slide": (rename("q_link_2_rad", "q_link_2_m"), "error", "q_link_2_m", None, "joint 2 is a hinge; give it in rad"),
    "frozen encoder": (put("q_link_2_rad", slice(None), 0.1), "doubt", "q_link_2_rad", None, "0.1 in every row"),
    "zeros": (put("current_2_a", slice(None), 0.0), "doubt", "current_2_a", None, "is 0 in every row"),
    "frozen for a while": (put("current_2_a", slice(500, 700), 5.5), "doubt", "current_2_a", 501, "rows 501 to 700"),
    "frozen link": (put("q_link_2_rad", slice(500, 700), 0.4), "doubt", "q_link_2_rad", 501, "lost packets"),
    "saturated": (clip("current_2_a", 8.0), "doubt", "current_2_a", None, "largest value 8 "),
    "saturated encoder": (clip("q_link_2_rad", 0.6), "doubt", "q_link_2_rad", None, "largest value 0.6 "),
    "copied current": (copy("current_1_a", "current_2_a"), "doubt", "current_2_a", None, "copy of current_1_a"),
    "copied link encoder": (
        copy("q_link_2_rad", "q_motor_2_rad"),
        "doubt",
        "q_link_2_rad",
        None,
        "copy of q_motor_2",
    ),
    "copied command": (copy_command, "doubt", "q_motor_2_rad", None, "copy of q_cmd_2_rad"),
    "link turned": (scale("q_link_2_rad", -1), "doubt", "q_link_2_rad", None, "follows minus q_motor_2_rad"),
    "torque turned": (turn_torque, "doubt", "tau_motor_2_nm", None, "against current_2_a"),
    "early encoder": (shift("q_link_2_rad", 0.1), "warning", "q_link_2_rad", None, "0.096 s ahead of q_motor_2_rad"),
    "late encoder": (shift("q_link_2_rad", -0.1), "warning", "q_link_2_rad", None, "0.1 s behind q_motor_2_rad"),
    "late command": (shift("q_cmd_2_rad", -0.1), "warning", "q_motor_2_rad", None, "0.072 s ahead of q_cmd_2_rad"),
    "speeds for a command": (command_speeds, "warning", "q_motor_2_rad", None, "does not follow q_cmd_2_rad"),
    "servo error for an angle": (log_the_servo_error, "warning", "q_motor_2_rad", None, "does not follow q_cmd_2_rad"),
    "lost beam": (lose_beam, "error", "reflector_1_x_m", 7, "rows 7 and 8"),
    "tracker asleep": (park_tracker, "doubt", "reflector_1_x_m", None, "while the arm moves"),
}

# Of a loading run.
STATIC: Faults = {
    "no pose": (lambda columns: columns.pop("pose"), "error", "pose", None, "missing from a static run"),
    "no step": (lambda columns: columns.pop("load_step"), "error", "load_step", None, "missing from a static run"),
    "no approach": (lambda columns: columns.pop("approach"), "warning", "approach", None, "missing"),
    "approach 0": (put("approach", 5, 0), "error", "approach", 6, "+1 or -1"),
    "half a pose": (put("pose", 5, 1.5), "error", "pose", 6, "1.5 is no label"),
    "lost repeat": (drop_rows([4]), "warning", "load_step", 4, "usual 3, rows 4 and 5"),
    "same labels": (put("repeat", 1, 1), "warning", "repeat", 1, "rows 1 and 2"),
    "other pose": (put("q_cmd_2_rad", slice(6, 9), 0.5), "warning", "q_cmd_2_rad", 7, "within one pose, rows 7 to 9"),
    "hung at 0": (
        lambda c: (put("load_z_n", slice(3), -500.0)(c), put("force_z_n", slice(3), -500.1)(c)),
        "warning",
        "load_step",
        1,
        "0 under load",
    ),
    "weight up": (
        lambda c: (scale("load_z_n", -1)(c), scale("force_z_n", -1)(c)),
        "doubt",
        "load_z_n",
        None,
        "straight up",
    ),
    "another zero": (scale("q_motor_2_rad", 1, 0.05), "warning", "q_motor_2_rad", None, "0.05 rad beside q_cmd_2_rad"),
    "force turned": (scale("force_z_n", -1), "doubt", "force_z_n", None, "against load_z_n"),
    "force in kN": (scale("force_z_n", 1e-3), "error", "force_z_n", None, "kilonewtons in the sensor?"),
    "load in kN": (scale("load_z_n", 1e-3), "error", "force_z_n", None, "kilonewtons in the load?"),
    "load in kg": (scale("load_z_n", 1 / 9.81), "error", "force_z_n", None, "kilograms in the load?"),
    "force clipped": (
        lambda columns: columns.update(force_z_n=np.maximum(columns["force_z_n"], -550.0)),
        "doubt",
        "force_z_n",
        None,
        "smallest value -550",
    ),
    "dead sensor": (put("force_z_n", slice(None), 0.0), "doubt", "force_z_n", None, "0 in every row"),
    "clock back": (put("time_s", 9, 1.0), "error", "time_s", 10, "backwards"),
}

# Of a sweep of an arm that is known.
KNOWN_ARM: Faults = {
    "third drive": (copy("current_3_a", "current_1_a"), "error", "current_3_a", None, "has 2 drives"),
    "degrees": (scale("q_link_2_rad", 6.0), "error", "q_link_2_rad", None, "no position of this joint"),
    "beyond limits": (scale("q_link_2_rad", 1.0, 1.9), "doubt", "q_link_2_rad", None, "-1.5 to 2.5"),
    "no angle": (
        lambda columns: (columns.pop("q_cmd_1_rad"), columns.pop("q_motor_1_rad")),
        "error",
        "",
        None,
        "no angle of drive 1",
    ),
}


CASES = {
    "in a sweep": (MOTION, sweep, motion, None),
    "in loading": (STATIC, loading, static, None),
    "against the arm": (KNOWN_ARM, sweep, motion, ARM),
}


@pytest.mark.parametrize(("where", "name"), [(where, name) for where, (faults, *_) in CASES.items() for name in faults])
def test_fault(where: str, name: str) -> None:
    faults, healthy, run_of, arm = CASES[where]
    change, level, column, row, words = faults[name]
    columns = healthy()
    change(columns)
    finding = only(examine(run_of(columns), arm))
    assert (finding.level, finding.column) == (level, column)
    assert words in f"{finding.message}; {finding.remedy}"
    if row is not None:
        assert finding.row == row
        assert finding.line == row + 1


def test_swapped_drives_are_both_named() -> None:
    columns = sweep()
    swap_encoders(columns)
    messages = [
        f"{finding.column} {finding.message}" for finding in examine(motion(columns)) if "follows" in finding.message
    ]
    assert messages == [
        "q_motor_1_rad follows q_cmd_2_rad, not q_cmd_1_rad",
        "q_motor_2_rad follows q_cmd_1_rad, not q_cmd_2_rad",
    ]


def test_motor_that_drives_against_friction_has_a_wrong_sign() -> None:
    columns = sweep()
    columns["current_2_a"] = -columns["current_2_a"]
    del columns["tau_motor_2_nm"]
    finding = only(examine(motion(columns)))
    assert "gives the motor energy" in finding.message


def test_samples_of_a_movement_are_no_repeats() -> None:
    finding = only(examine(motion(sweep() | {"repeat": np.arange(2500.0)})))
    assert finding.remedy == "is the run static?"


def test_movement_under_the_name_of_a_static_run_is_seen() -> None:
    columns = sweep()
    labels = {name: np.zeros(2500) for name in ("pose", "load_step")} | {"approach": np.ones(2500)}
    findings = examine(static(columns | labels))
    assert any("is the run a motion?" in finding.remedy for finding in findings)


def test_joint_without_limits_may_turn_further() -> None:
    endless = type(ARM)(is_slide=(False, False), limits=((-np.inf, np.inf), (-np.inf, np.inf)))
    columns = sweep()
    for name in ("q_cmd_2_rad", "q_motor_2_rad", "q_link_2_rad"):
        columns[name] = columns[name] * 20
    columns = {name: values for name, values in columns.items() if name[:2] in ("ti", "q_")}
    assert examine(motion(columns), endless) == []
    assert {finding.level for finding in examine(motion(columns))} == {"error"}


@pytest.mark.parametrize("n", [200, 3896, 20_000])
def test_lag_found_fast_is_the_smallest_of_all(n: int) -> None:
    rng = np.random.default_rng(n)
    source = np.cumsum(rng.normal(size=n)) * 1e-3
    values = np.roll(source, -7) + 1e-5 * rng.normal(size=n)
    span = 25
    middle = slice(span, n - span)
    misfits = [float(np.std(source[middle] - np.roll(values, lag)[middle])) for lag in range(-span, span + 1)]
    best = int(np.argmin(misfits))
    assert misfits[best] < alignment.BETTER * misfits[span]
    assert alignment._lead(values, source, alignment.SEARCH_S / span) == (best - span) * alignment.SEARCH_S / span


@pytest.mark.parametrize("rows", [1, 2, 4])
def test_a_motion_of_few_rows_is_said_to_be_left_out(rows: int) -> None:
    finding = only(examine(motion({name: values[:rows] for name, values in sweep().items()})))
    assert (finding.level, finding.column) == ("warning", "")
    word = "1 row" if rows == 1 else f"{rows} rows"
    assert str(finding).startswith(
        f"runs/a.csv: has {word}: too few to tell a speed; it is left out; record 5 at least"
    )
