"""A comparison is linear about the robot as it was: its figures fitted to what was recorded before."""

from pathlib import Path

import numpy as np
import pytest

from bench.compare.as_it_was import as_it_was
from bench.record.campaign import Campaign
from bench.record.convert import convert
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from bench.robot.logs import log_format_of
from bench.robot.plugins import configure
from tests.diagnose.noise_free import linearised
from tests.diagnose.sweeps import SWEEP, made, nominal
from tests.recordings import write_kr300

CURRENT_2 = 1


def missed(campaign: Campaign, compiled: CompiledRobot) -> float:
    """Return the root mean square by which a robot misses the current of joint 2 in motion [A]."""
    linear = linearised(campaign, compiled)
    column = [quantity.column for quantity in linear.quantities].index("current_2_a")
    return float(np.sqrt(np.nanmean(linear.residual[:, column] ** 2)))


def test_of_a_machine_nothing_is_left_on_another_day_but_what_drifts(tmp_path: Path) -> None:
    """Machines with everything a little off; their torque constants and viscous friction drift alike from day to day.

    What a robot fitted to the first day misses on the second is the same for each machine, however far that is off.
    """
    nominal_errors, errors = [], []
    for machine in (8, 11, 12):
        may, june = (made(SWEEP, seed=seed, machine=machine) for seed in (1, 2))
        fitted = as_it_was(may, nominal(), tmp_path / str(machine)).robot
        before, after = missed(may, nominal()), missed(may, fitted)
        assert after < 0.2 * before
        nominal_errors.append(missed(june, nominal()))
        errors.append(missed(june, fitted))
        print(f"current 2: missed by {1e3 * before:.0f} mA, fitted {1e3 * after:.0f}; on another day", end=" ")
        print(f"{1e3 * nominal_errors[-1]:.0f}, fitted {1e3 * errors[-1]:.0f}")
    assert np.ptp(errors) < 0.1 * np.mean(errors)
    assert np.ptp(nominal_errors) > 0.5 * np.mean(nominal_errors)


@pytest.mark.study
def test_the_gas_that_a_model_leaves_out_is_fitted(tmp_path: Path, rng: np.random.Generator) -> None:
    """Links and torque constants stood for it: 178 kg of an upper arm of 339, and half of what a payload changed by."""
    write_kr300(tmp_path / "may.csv", rng, seconds=2.5)
    compiled = compile_robot(load_robot("kr300"))
    campaign = convert(tmp_path / "may.csv", log_format_of(compiled.robot), "kr300").campaign
    assert campaign
    fitted = as_it_was(campaign, compiled, tmp_path).robot
    full = compile_robot(load_robot("kr300"), [lambda spec, _: configure(spec, "cbs", gas_amount=1.0)])
    assert fitted.counterbalance
    assert full.counterbalance
    assert fitted.counterbalance.gas_constant / full.counterbalance.gas_constant == pytest.approx(0.9, abs=0.05)


def test_where_nothing_can_be_fitted_the_robot_stays(tmp_path: Path) -> None:
    compiled = nominal()
    assert as_it_was(Campaign("hh150", ()), compiled, tmp_path).robot is compiled
