"""The first pass on recordings of real robots, and on a stand-in of the same format."""

from pathlib import Path

import numpy as np
import pytest

from bench.identify.dynamics.first_pass import first_pass
from bench.identify.dynamics.found import FirstPass, Torques
from bench.identify.dynamics.quantities import quantities
from bench.record.campaign import Campaign
from bench.record.convert import convert
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.robot.logs import log_format_of
from bench.robot.nominal_dynamics import nominal_dynamics
from tests.recordings import KR300_TRUTH, data_folder, write_emps, write_kr300

PUBLISHED_MASS = 95.109  # [kg], data set of the EMPS, 2019
SPEED, PUBLISHED_FRICTION = 0.1, 20.394 + 203.50 * 0.1  # [m/s], [N]: levels apart depend on how turns are treated


def read(log: Path, robot: str) -> Campaign:
    campaign = convert(log, log_format_of(load_robot(robot)), robot).campaign
    assert campaign
    return campaign


def found(campaign: Campaign) -> FirstPass:
    return first_pass(campaign, nominal_dynamics(compile_robot(load_robot(campaign.robot))))


def values(result: FirstPass) -> dict[str, float]:
    return {one.name: one.value for one in quantities(result)}


def test_moving_mass_of_emps() -> None:
    result = found(read(data_folder("emps") / "emps.csv", "emps"))
    np.testing.assert_allclose(values(result)["m 1 (carriage)"], PUBLISHED_MASS, rtol=0.01)
    plain, layout = result.rival_parameters, result.layout
    coulomb, viscous = (float(plain[layout.of_drives(name)][0]) for name in ("coulomb", "viscous"))
    np.testing.assert_allclose(coulomb + viscous * SPEED, PUBLISHED_FRICTION, rtol=0.01)
    assert result.held_out.rms("first_pass") < 0.6 * result.held_out.rms("rival")
    assert result.folds.repeats


def test_mass_of_emps_does_not_rest_on_the_stated_one() -> None:
    """With a moving mass that is stated a quarter too large the same is found."""
    campaign = read(data_folder("emps") / "emps.csv", "emps")
    nominal = nominal_dynamics(compile_robot(load_robot("emps")))
    heavy = nominal.__class__(**{**vars(nominal), "rotor_inertia": nominal.rotor_inertia + 25.0})
    result = first_pass(campaign, heavy)
    np.testing.assert_allclose(values(result)["m 1 (carriage)"], PUBLISHED_MASS, rtol=0.02)


def test_stand_in_of_emps(tmp_path: Path, rng: np.random.Generator) -> None:
    truth = write_emps(tmp_path / "emps.csv", rng, seconds=12.0)
    told = values(found(read(tmp_path / "emps.csv", "emps")))
    np.testing.assert_allclose(told["m 1 (carriage)"], truth["inertia"], rtol=0.02)
    np.testing.assert_allclose(told["Coulomb friction (carriage)"], truth["coulomb"], rtol=0.05)
    np.testing.assert_allclose(told["torque offset (carriage)"], truth["offset"], atol=0.5)


@pytest.fixture(scope="module")
def across() -> dict[str, Torques]:
    """Return what the first pass of each recording of the KR300 predicts of the other one."""
    one, other = (
        read(data_folder("kr300") / "recording_a.csv", "kr300"),
        read(data_folder("kr300_b") / "recording_b.csv", "kr300"),
    )
    return {"A to B": found(one).predict(other), "B to A": found(other).predict(one)}


@pytest.mark.parametrize("way", ["A to B", "B to A"])
@pytest.mark.parametrize("axis", range(1, 7))
def test_kr300_predicts_its_other_recording(across: dict[str, Torques], way: str, axis: int) -> None:
    torques = across[way]
    assert (torques.rms("first_pass") / torques.rms("nominal"))[axis - 1] < 0.21


@pytest.mark.parametrize("way", ["A to B", "B to A"])
def test_kr300_predicts_better_than_plain_least_squares(across: dict[str, Torques], way: str) -> None:
    assert np.all(across[way].rms("first_pass") < across[way].rms("rival"))


def test_stand_in_of_kr300(tmp_path: Path, rng: np.random.Generator) -> None:
    write_kr300(tmp_path / "a.csv", rng)
    result = found(read(tmp_path / "a.csv", "kr300"))
    told = {one.name: one for one in quantities(result)}
    low, high = told["unstated payload"].interval(result.quantile(0.99))
    assert low < KR300_TRUTH["unstated_payload"]["mass"] < high
    low, high = told["gas of the counterbalance"].interval(result.quantile(0.99))
    assert low < KR300_TRUTH["counterbalance_gas"]["gas_amount"] < high
    for joint, level in enumerate(KR300_TRUTH["coulomb_friction"]["level"]):
        np.testing.assert_allclose(told[f"Coulomb friction (joint{joint + 1})"].value, level, rtol=0.15)
