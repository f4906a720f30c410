"""A comparison is linear about the robot as it was: its figures fitted to what was recorded before."""

from pathlib import Path

import numpy as np

from bench.compare.as_it_was import as_it_was
from bench.record.campaign import Campaign
from bench.robot.compiled import CompiledRobot
from tests.diagnose.noise_free import linearised
from tests.diagnose.sweeps import SWEEP, made, nominal

CURRENT_2 = 1


def missed(campaign: Campaign, compiled: CompiledRobot) -> float:
    """Return the root mean square by which a robot misses the current of joint 2 in motion [A]."""
    linear = linearised(campaign, compiled)
    column = [quantity.column for quantity in linear.quantities].index("current_2_a")
    return float(np.sqrt(np.nanmean(linear.residual[:, column] ** 2)))


def test_it_predicts_what_it_was_fitted_to_and_the_same_motion_on_another_day(tmp_path: Path) -> None:
    """Of a machine with everything a little off; torque constants and viscous friction drift by per cents a day."""
    may, june = (made(SWEEP, seed=seed, machine=7) for seed in (1, 2))
    fitted = as_it_was(may, nominal(), tmp_path)
    assert (tmp_path / "robot").is_dir()
    before, after = missed(may, nominal()), missed(may, fitted)
    other = missed(june, fitted)
    print(f"current 2: missed by {1e3 * before:.0f} mA, fitted {1e3 * after:.0f}, on another day {1e3 * other:.0f}")
    assert after < 0.2 * before
    assert other < missed(june, nominal())


def test_where_nothing_can_be_fitted_the_robot_stays(tmp_path: Path) -> None:
    compiled = nominal()
    assert as_it_was(Campaign("hh150", ()), compiled, tmp_path) is compiled
