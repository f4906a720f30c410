"""One number of a pose is one posture in all runs, and gas begins no day at 68 degrees Celsius."""

from dataclasses import replace

import numpy as np
import pytest

from bench.record.campaign import Run
from bench.record.rules.session import gas_begins_cool, one_pose_everywhere
from bench.record.rules.sheet import Sheet
from tests.record.build import static

POSES = np.repeat([1.0, 2.0, 3.0], 2)


def run(name: str, off: tuple[float, float, float] = (0.0, 0.0, 0.0), kelvin: float = 293.0) -> Run:
    """Return a run at three poses, in the second of which joints are off by something."""
    angles = {f"q_motor_{j + 1}_rad": 0.3 * POSES + j + off[j] * (POSES == 2) for j in range(3)}
    return replace(static({"pose": POSES, **angles, "gas_temperature_k": np.full(6, kelvin)}), name=name)


def sheets(*runs: Run) -> list[Sheet]:
    return [Sheet(one, f"{one.name}.csv", ()) for one in runs]


def test_one_joint_that_is_elsewhere_is_told() -> None:
    (found,) = one_pose_everywhere(sheets(run("below"), run("above", (0.0, 0.035, 0.0))))
    assert found.column == "q_motor_2_rad"
    assert "in run 'below', in one pose" in found.message


@pytest.mark.parametrize("off", [(0.0, 0.005, 0.0), (0.3, 0.2, -0.4)])
def test_servos_that_stop_short_and_numbers_of_another_run_are_no_error(off: tuple[float, float, float]) -> None:
    assert not list(one_pose_everywhere(sheets(run("below"), run("above", off))))


def test_a_joint_that_one_run_did_not_log_is_not_compared() -> None:
    """It ended a check in a KeyError."""
    whole = run("above")
    fewer = replace(whole, name="below", columns={k: v for k, v in whole.columns.items() if k != "q_motor_3_rad"})
    assert not list(one_pose_everywhere(sheets(fewer, whole)))
    assert not list(one_pose_everywhere(sheets(whole, fewer)))


@pytest.mark.parametrize(("kelvin", "count"), [(293.0, 0), (318.0, 0), (341.15, 1)])
def test_gas_in_fahrenheit(kelvin: float, count: int) -> None:
    assert len(list(gas_begins_cool(sheets(run("first", kelvin=kelvin))))) == count
