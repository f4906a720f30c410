"""From the rows of a campaign to states, series and noise."""

import numpy as np
import pytest

from bench.errors import InputError
from bench.identify.from_campaign import static_readings
from bench.record.campaign import Campaign, Run
from bench.robot.figures import Figures

DRIVE = {
    "rotor": "r",
    "element": "e",
    "servo": "s",
    "motor_friction": "m",
    "link_friction": "l",
    "torque_constant_nm_per_a": 200.0,
    "torque_constant_error": 0.02,
    "speed_limit_rad_per_s": 1.0,
}
FIGURES = Figures.model_validate(
    {
        "title": "two joints",
        "mjcf": "two.xml",
        "drives": [{"joint": name} | DRIVE for name in ("j1", "j2")],
        "load_body": "load",
        "load_point": "load_point",
        "reflectors": ["reference"],
        "rating": {"force_n": 1000, "moment_nm": 100},
        "instruments": {
            "tracker": {"position_m": (3.0, 0.0, 0.0)},
            "force": {},
            "current": {"sigma_a": 0.02, "resolution_a": 0.01},
            "encoder": {},
        },
    }
)
STEPS, REPEATS = 3, 4  # unloaded, loaded, unloaded


def columns(rng, approach=(1, -1), **changes):
    """Return the table of two visits, every state read four times."""
    state = np.arange(len(approach) * STEPS)
    rows = np.repeat(state, REPEATS)
    load = np.where(rows % STEPS == 1, -500.0, 0.0)
    table = {
        "pose": np.zeros(len(rows)),
        "approach": np.array(approach, dtype=float)[rows // STEPS],
        "load_step": (rows % STEPS).astype(float),
        "repeat": np.tile(np.arange(REPEATS), len(state)).astype(float),
        "load_z_n": load,
        "load_x_n": np.zeros(len(rows)),
        "load_y_n": np.zeros(len(rows)),
        **{f"force_{axis}_n": rng.normal(0, 0.5, len(rows)) + (load if axis == "z" else 0) for axis in "xyz"},
        **{f"moment_{axis}_nm": np.zeros(len(rows)) for axis in "xyz"},
        **{f"q_cmd_{j}_rad": np.full(len(rows), 0.1 * j) for j in (1, 2)},
        **{f"q_motor_{j}_rad": np.full(len(rows), 0.1 * j + 1e-5) for j in (1, 2)},
        **{f"current_{j}_a": rows + 0.01 * rng.standard_normal(len(rows)) for j in (1, 2)},
        **{f"reflector_1_{axis}_m": rng.normal(0, 1e-5, len(rows)) for axis in "xyz"},
    }
    return {name: values for name, values in (table | changes).items() if values is not None}


def campaign(table, **given):
    return Campaign("two", (Run("run", "static", 0.0, table),), **given)


def test_states_are_means_and_visits_are_series(rng):
    table = columns(rng)
    readings = static_readings(campaign(table), FIGURES)
    assert len(readings.series) == 2 * STEPS
    assert len(np.unique(readings.series)) == 2
    np.testing.assert_array_equal(readings.is_reference, [True, False, True] * 2)
    np.testing.assert_array_equal(np.sort(np.unique(readings.approach)), [-1, 1])
    assert np.all(readings.n_repeats == REPEATS)
    above = readings.approach == -1
    expected = table["current_1_a"].reshape(-1, REPEATS).mean(axis=1)[STEPS:] * 200.0
    np.testing.assert_allclose(readings.current_torque[above, 0], expected)


def test_a_known_load_says_that_it_hangs(rng):
    assert static_readings(campaign(columns(rng)), FIGURES).is_vertical.all()
    pulled = columns(rng)
    pulled["load_y_n"] = 0.3 * pulled["load_z_n"]
    np.testing.assert_array_equal(static_readings(campaign(pulled), FIGURES).is_vertical, [True, False, True] * 2)


def test_the_known_load_stands_in_for_the_sensor(rng):
    unmeasured = columns(rng, **{f"force_{axis}_n": None for axis in "xyz"})
    readings = static_readings(campaign(unmeasured), FIGURES)
    np.testing.assert_allclose(readings.wrench[:, 2], [0, -500, 0] * 2)


def test_the_command_stands_in_for_the_encoder(rng):
    blind = columns(rng, q_motor_1_rad=None, q_motor_2_rad=None)
    np.testing.assert_allclose(static_readings(campaign(blind), FIGURES).q_motor, [[0.1, 0.2]] * 6)


def test_noise_is_that_of_the_instruments_or_the_labs_own(rng):
    readings = static_readings(campaign(columns(rng)), FIGURES)
    np.testing.assert_allclose(readings.sigma_current_torque, 200 * np.hypot(0.02, 0.01 / np.sqrt(12)))
    assert readings.sigma_reflector == pytest.approx(10e-6 * 3.0, rel=1e-3)
    np.testing.assert_allclose(readings.systematic.torque_gain, np.hypot(0.005, 0.02))
    own = static_readings(campaign(columns(rng), noise={"reflector": 5e-6, "current": 0.1}), FIGURES)
    assert own.sigma_reflector == 5e-6
    np.testing.assert_allclose(own.sigma_current_torque, 20.0)


def test_missing_channels_are_nan(rng):
    blind = columns(rng, current_1_a=None, **{f"reflector_1_{axis}_m": None for axis in "xyz"})
    readings = static_readings(campaign(blind), FIGURES)
    assert np.isnan(readings.current_torque[:, 0]).all()
    assert np.isnan(readings.reflectors).all()


def test_a_coordinate_alone_has_no_distance_from_the_tracker(rng):
    """NumPy warned of the mean of nothing, in `bench check` too, which now asks what drives paid for weights."""
    alone = columns(rng, reflector_1_y_m=None, reflector_1_z_m=None)
    assert static_readings(campaign(alone), FIGURES).sigma_reflector == 0.0


def test_without_static_runs_there_is_nothing_to_identify():
    with pytest.raises(InputError, match="no static run"):
        static_readings(Campaign("two", ()), FIGURES)


def test_a_sensor_alone_says_what_is_loaded_and_what_hangs(rng):
    table = columns(rng, load_x_n=None, load_y_n=None, load_z_n=None)
    readings = static_readings(campaign(table), FIGURES)
    np.testing.assert_array_equal(readings.is_reference, [True, False, True] * 2)
    assert readings.is_vertical.all()
    pulled = table | {"force_y_n": table["force_y_n"] + 0.3 * table["force_z_n"]}
    np.testing.assert_array_equal(static_readings(campaign(pulled), FIGURES).is_vertical[1::STEPS], [False, False])
