"""Rules that fire on healthy data are defects: nothing here may be found, with noise and without."""

from collections.abc import Callable

import numpy as np
import pytest

from bench.record.campaign import Array, Run
from tests.record.build import ARM, examine, loading, motion, static, sweep

Columns = dict[str, Array]


def dwell() -> Run:
    """Nothing moves for ten minutes, and without noise nothing changes at all."""
    held = {name: np.full(600, values[0]) for name, values in sweep(None).items()}
    return motion(held | {"time_s": np.arange(600.0), "gear_temperature_2_k": 300 + np.round(np.arange(600) / 200)})


def long_dwell() -> Run:
    """Rest for ten minutes at 250 Hz; a coarse secondary encoder shows one number, the one at the motor flickers."""
    n = 150_000
    flicker = np.random.default_rng(4).integers(-1, 2, n) * 2e-7
    ends = {"q_cmd_1_rad": 0.5, "q_motor_1_rad": 0.5, "q_link_1_rad": 0.498}
    columns = {name: np.append(np.linspace(0, end, 500), np.full(n, end)) for name, end in ends.items()}
    columns["q_motor_1_rad"][500:] += flicker
    return motion(columns | {"time_s": np.arange(n + 500) * 0.004})


def two_joints_alike() -> Run:
    columns = sweep(None)
    for name in ("q_cmd_i_rad", "q_motor_i_rad", "current_i_a"):
        columns[name.replace("_i_", "_1_")] = columns[name.replace("_i_", "_2_")]
    return motion(columns)


def pauses_under_load(seed: int | None) -> Run:
    """Rest for a second where the motor has most to carry; without noise the current is constant there."""
    columns = sweep(seed)
    peak = int(np.argmax(columns["current_2_a"]))
    held = {name: np.insert(values, peak, np.full(250, values[peak])) for name, values in columns.items()}
    return motion(held | {"time_s": np.arange(2750) * 0.004})


def coarse(resolution_a: float) -> Run:
    """Without noise, the current keeps its largest value over many samples where gravity has its maximum."""
    columns = sweep(None)
    angle = columns["q_motor_2_rad"] - 0.4
    current = 9 * np.cos(angle) + 0.8 * np.tanh(np.gradient(angle, 0.004) / 1e-3)
    return motion(columns | {"current_2_a": np.round(current / resolution_a) * resolution_a})


def slide() -> Run:
    columns = {name.replace("_rad", "_m").replace("_nm", "_n"): values for name, values in sweep().items()}
    return motion(columns)


def hung_only_in_z() -> Run:
    """Read a sensor that rounds to 1 N and feels nothing sideways."""
    columns = loading(None)
    columns["force_z_n"] = np.round(columns["force_z_n"])
    return static(columns)


def without_labels_that_may_miss() -> Run:
    return static({name: values for name, values in loading().items() if name not in ("repeat", "time_s")})


def read_by_hand() -> Run:
    """Repeats share the time that was written down once."""
    columns = loading()
    columns["time_s"] = np.floor(columns["time_s"] / 15) * 15
    return static(columns)


def jitter() -> Run:
    columns = sweep()
    columns["time_s"] = columns["time_s"] + np.random.default_rng(2).uniform(-2e-4, 2e-4, 2500)
    return motion(columns)


def weak_servo() -> Run:
    """Follow 0.15 s behind, as a position loop without feedforward does."""
    columns = sweep()
    behind = np.interp(columns["time_s"] - 0.15, columns["time_s"], columns["q_cmd_2_rad"])
    return motion(columns | {"q_motor_2_rad": behind, "q_link_2_rad": behind - 0.002})


HEALTHY: dict[str, Callable[[], Run]] = {
    "sweep": lambda: motion(sweep()),
    "sweep without noise": lambda: motion(sweep(None)),
    "loading": lambda: static(loading()),
    "loading without noise": lambda: static(loading(None)),
    "dwell": dwell,
    "long dwell": long_dwell,
    "two joints alike": two_joints_alike,
    "pause under load": lambda: pauses_under_load(1),
    "pause under load without noise": lambda: pauses_under_load(None),
    "fine resolution, no noise": lambda: coarse(0.01),
    "coarse resolution, no noise": lambda: coarse(0.5),
    "slide": slide,
    "hung only in z": hung_only_in_z,
    "fewest labels": without_labels_that_may_miss,
    "read by hand": read_by_hand,
    "jitter": jitter,
    "weak servo": weak_servo,
}


@pytest.mark.parametrize("name", HEALTHY)
def test_nothing_is_found_in_healthy_data(name: str) -> None:
    assert [str(finding) for finding in examine(HEALTHY[name]())] == []


@pytest.mark.parametrize("name", [name for name in HEALTHY if name not in ("slide", "long dwell")])
def test_nothing_is_found_where_the_arm_is_known(name: str) -> None:
    assert [str(finding) for finding in examine(HEALTHY[name](), ARM)] == []


@pytest.mark.parametrize("seed", range(30))
def test_noise_alone_is_never_a_finding(seed: int) -> None:
    findings = examine(motion(sweep(seed))) + examine(static(loading(seed)))
    assert [str(finding) for finding in findings] == []


@pytest.mark.parametrize(("highest", "is_said"), [(4.01, False), (3.9, True)])
def test_the_rounded_top_of_a_curve_is_no_saturation(highest: float, is_said: bool) -> None:
    """Five rows at the peak of a fast motion, of a current in steps of 0.01 A, failed a healthy campaign."""
    time = np.arange(2500) * 0.004
    angle, noise = 3 * np.sin(2 * np.pi * 0.3 * time), np.random.default_rng(1).normal(0.0, 0.02, len(time))
    current = 4 * np.cos(2 * np.pi * 0.3 * time) + noise
    current[830:836] = 4.01  # by chance
    current = np.minimum(np.round(np.minimum(current, 4.01) / 0.01) * 0.01, highest)
    found = examine(motion({"time_s": time, "q_motor_1_rad": 0 * time, "q_motor_2_rad": angle, "current_2_a": current}))
    assert any("saturated" in str(finding) for finding in found) == is_said


@pytest.mark.parametrize(("rows", "is_said"), [(5, False), (12, True)])
def test_noise_that_repeats_itself_before_a_drive_brakes_is_no_saturation(rows: int, is_said: bool) -> None:
    """Of a sound sweep five of 238 rows, the last before the brakes, read 2.53 A: it was refused."""
    time = np.arange(240) * 0.02
    angle = 0.3 * time
    needed = np.where(time < 4.6, 1.6 + 0.2 * time, 1.6 + 0.92 - 6 * (time - 4.6))
    current = np.round((needed + np.random.default_rng(3).normal(0.0, 0.02, len(time))) / 0.01) * 0.01
    current[230 - rows : 230] = 2.57
    current = np.minimum(current, 2.57)
    found = examine(motion({"time_s": time, "q_motor_1_rad": 0 * time, "q_motor_2_rad": angle, "current_2_a": current}))
    assert any("saturated" in str(finding) for finding in found) == is_said


@pytest.mark.parametrize(("noise_a", "slope_a", "is_said"), [(0.02, 4.0, True), (0.0, 4.0, False), (0.0, 40.0, False)])
def test_a_current_that_rests_on_its_slope_is_frozen_where_it_is_noisy(
    noise_a: float, slope_a: float, is_said: bool
) -> None:
    """A third of a sweep without a change was believed; without noise, friction at one speed is constant."""
    time = np.arange(150) * 0.02
    angle = 0.4 * time
    current = slope_a * angle + np.random.default_rng(1).normal(0.0, noise_a, len(time))
    current = np.round(current / 0.01) * 0.01
    current[45:90] = current[45]
    found = examine(motion({"time_s": time, "q_motor_1_rad": 0 * time, "q_motor_2_rad": angle, "current_2_a": current}))
    assert any("rows 46 to 90; frozen?" in str(finding) for finding in found) == is_said
