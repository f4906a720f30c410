"""Hidden effects: they act as they say, null values change nothing, and the data are those of another simulation."""

import pickle
from pathlib import Path

import numpy as np
import pytest

from bench.effects.nominal import nominal_parameters
from bench.errors import InputError
from bench.hide.background import Background
from bench.hide.campaign import Hidden, hide_campaign
from bench.hide.write import write_hidden
from bench.record.check import check_campaign
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.scenario.session import SessionScenario
from tests.hide.tiny import acting
from tests.simulate.session_small import small_session

CLEAR = 0.02  # share by which half the step, a servo that settles and a friction that turns may change a difference


def hide(robot: Path, *effects: object, seed: int = 1, **options: object) -> Hidden:
    session = options.pop("session", small_session(robot))
    return hide_campaign(load_robot(robot), session, effects, np.random.default_rng(seed), **options)  # type: ignore[arg-type]


def only(robot: Path, part: str) -> SessionScenario:
    return small_session(robot).without(*({"repeat_at_end", "loading", "rotations", "line", "dwell"} - {part}))


@pytest.fixture(scope="module")
def null(small_robot: Path) -> Hidden:
    return hide(small_robot)


def test_its_check_has_nothing_to_say(null: Hidden, tmp_path: Path) -> None:
    write_hidden(null, tmp_path)
    assert check_campaign(tmp_path / "campaign").findings == ()
    assert (tmp_path / "truth" / "truth.yaml").is_file()


def test_null_values_change_nothing(null: Hidden, small_robot: Path) -> None:
    again = hide(small_robot, acting("level", 1), acting("eccentric", 2), acting("warmth"))
    for run, other in zip(null.campaign.runs, again.campaign.runs, strict=True):
        for name, values in run.columns.items():
            np.testing.assert_array_equal(other.columns[name], values, err_msg=f"{run.name}: {name}")


def test_the_truth_says_what_and_where(small_robot: Path) -> None:
    hidden = hide(
        small_robot, acting("level", 2, rise=0.5), acting("warmth", rate=0.01), session=only(small_robot, "dwell")
    )
    assert hidden.truth.effects == ("level joint 2", "warmth")
    assert hidden.truth.parameters["effect.level joint 2.rise"].value == 0.5
    assert hidden.truth.parameters["effect.level joint 2.heat"].value == 0
    assert hidden.truth.parameters["effect.warmth.rate"].unit == "1/K"
    off = hidden.truth.parameters["background.motor-side Coulomb friction of hinge_b"].value
    assert off != 0
    assert hidden.truth.parameters["motor_coulomb.hinge_b"].value == pytest.approx(1.5 * 30 * (1 + off))
    (run,) = hidden.campaign.runs
    assert not any(name.startswith("q_link") for name in run.columns)
    assert {"q_link_1_rad", "reflector_1_x_m"} <= set(hidden.truth.runs["dwell"])


def test_effects_in_the_model_act(small_robot: Path) -> None:
    """Half the difference of a sweep's two ways is the friction of both sides; half as much again on the motor's."""
    session = only(small_robot, "rotations")
    plain, more = (
        hide(small_robot, acting("level", 1, rise=rise), session=session, background=False) for rise in (0.0, 0.5)
    )

    def friction(hidden: Hidden) -> float:
        up, down = (hidden.instants[f"joint1-payload5-speed30-{way}"] for way in ("up", "down"))
        middle = slice(len(up) // 3, 2 * len(up) // 3)
        return float(np.mean(up.motor_torque[middle, 0]) - np.mean(down.motor_torque[middle, 0])) / 2

    assert friction(more) - friction(plain) == pytest.approx(0.5 * 60, rel=CLEAR)


def test_slow_effects_follow_the_conditions(small_robot: Path) -> None:
    hidden = hide(small_robot, acting("level", 1, heat=0.02), background=False)
    levels = {}
    for name in ("first-joint1-payload0-speed30-up", "last-joint1-payload0-speed30-up"):
        trace = hidden.instants[name]
        levels[name] = np.abs(trace.motor_friction[:, 0]).max()
        warm = hidden.conditions[name].gear_k[0] - 293.15
        assert levels[name] == pytest.approx(60 * (1 + 0.02 * warm), rel=1e-6)
    assert levels["last-joint1-payload0-speed30-up"] > 1.05 * levels["first-joint1-payload0-speed30-up"]


def test_the_servo_follows_the_encoder(small_robot: Path) -> None:
    """The encoder says what was asked for; the motor stands elsewhere by the error."""
    hidden = hide(small_robot, acting("eccentric", 1, size=1e-3), session=only(small_robot, "loading"))
    for run in hidden.campaign.runs:
        seen, asked = run.columns["q_motor_1_rad"], run.columns["q_cmd_1_rad"]
        true = hidden.instants[run.name].q[:, 0]
        np.testing.assert_allclose(seen, asked, atol=1.5e-4)  # still settling under the load
        np.testing.assert_allclose(seen - true, 1e-3 * np.cos(true), atol=2e-7)
        np.testing.assert_allclose(run.columns["q_motor_2_rad"], hidden.instants[run.name].q[:, 1], atol=2e-7)


def test_distorted_readings_know_the_conditions(null: Hidden, small_robot: Path) -> None:
    warm = hide(small_robot, acting("warmth", rate=0.01))
    for run, other in zip(null.campaign.runs, warm.campaign.runs, strict=True):
        if run.name != "dwell":
            factor = 1 + 0.01 * (warm.conditions[run.name].winding_k[0] - 293.15)
            np.testing.assert_allclose(other.columns["current_1_a"], factor * run.columns["current_1_a"])


def test_a_dwell_warms_and_cools_piece_by_piece(null: Hidden) -> None:
    gear = null.campaign.runs[[run.name for run in null.campaign.runs].index("dwell")].columns["motor_temperature_1_k"]
    assert gear[:6].mean() - gear[-6:].mean() > 2  # it stands, and cools by several kelvin in ten minutes
    assert gear.std() > 0.5


def test_background_errors_have_their_sigma(small_robot: Path) -> None:
    compiled = compile_robot(load_robot(small_robot))
    drawn = [Background.draw(compiled, np.random.default_rng(seed)) for seed in range(200)]
    for parameter in nominal_parameters(compiled):
        sizes = [one.deviations[parameter.name] for one in drawn]
        assert np.std(sizes) == pytest.approx(parameter.sigma, rel=0.2)
    assert np.std([one.hung for one in drawn]) == pytest.approx(compiled.robot.figures.uncertainty.load, rel=0.2)


def test_without_background_only_noise_is_wrong(small_robot: Path) -> None:
    hidden = hide(small_robot, session=only(small_robot, "loading"), background=False)
    assert hidden.background.deviations == {}
    assert not np.any(hidden.errors.frame_shift)
    run = hidden.campaign.runs[0]
    ideal = hidden.truth.runs[run.name]
    assert 5e-6 < np.std(run.columns["reflector_1_x_m"] - ideal["reflector_1_x_m"]) < 1e-4
    loaded = run.columns["load_z_n"] != 0
    np.testing.assert_allclose(hidden.instants[run.name].wrench[loaded, 2], run.columns["load_z_n"][loaded])


def test_weights_are_a_little_wrong(null: Hidden) -> None:
    trace, run = null.instants["loaded-out"], next(r for r in null.campaign.runs if r.name == "loaded-out")
    np.testing.assert_allclose(trace.wrench[:, 2], (1 + null.background.hung) * run.columns["load_z_n"])
    assert null.background.hung != 0


def test_noise_has_heavy_tails_and_the_instruments_sigma(small_robot: Path) -> None:
    hidden = hide(small_robot, session=only(small_robot, "rotations"), background=False)
    noise = np.concatenate(
        [run.columns["force_z_n"] for run in hidden.campaign.runs if "force_z_n" in run.columns]
        + [run.columns["force_x_n"] for run in hidden.campaign.runs if "force_x_n" in run.columns]
    )
    assert len(noise) > 400
    assert np.std(noise) == pytest.approx(0.5, rel=0.2)
    assert np.mean((noise / noise.std()) ** 4) > 3.5  # of normal noise it is 3


def test_no_force_is_felt_where_a_payload_is_bolted_on(null: Hidden) -> None:
    for run in null.campaign.runs:
        assert ("load_mass_kg" in run.columns) != ("force_z_n" in run.columns)


def test_lab_without_instruments_and_parts(small_robot: Path) -> None:
    hidden = hide(small_robot, without=("tracker", "force", "line", "rotations", "gear_temperature", "dwell"))
    names = {name for run in hidden.campaign.runs for name in run.columns}
    assert not any(name.startswith(("reflector", "force", "moment", "gear", "gas_temperature")) for name in names)
    assert "motor_temperature_1_k" in names
    assert not any("out" in run.name or run.name.startswith("joint") for run in hidden.campaign.runs)


def test_further_channels_on_request(small_robot: Path) -> None:
    hidden = hide(small_robot, session=only(small_robot, "dwell"), channels=("gas_temperature",))
    gas = hidden.campaign.runs[0].columns["gas_temperature_k"]
    assert abs(gas.mean() - 293.15) < 1


def test_unknown_names_are_told(small_robot: Path) -> None:
    with pytest.raises(InputError, match="unknown instrument, channel or part 'traker'"):
        hide(small_robot, without=("traker",))
    with pytest.raises(InputError, match="unknown channel"):
        hide(small_robot, channels=("pressure",))
    with pytest.raises(InputError, match="unknown parameter"):
        hide(small_robot, acting("level", 1, fall=1.0))


def test_same_seed_same_campaign_other_seed_other_robot(null: Hidden, small_robot: Path) -> None:
    again, other = hide(small_robot), hide(small_robot, seed=2)
    name = null.campaign.runs[0].name
    assert again.background.deviations == null.background.deviations
    np.testing.assert_array_equal(
        again.campaign.runs[0].columns["current_1_a"], null.campaign.runs[0].columns["current_1_a"]
    )
    assert np.any(other.instants[name].theta != null.instants[name].theta)


def test_half_the_step_by_default(small_robot: Path) -> None:
    session = only(small_robot, "loading")
    default, half, whole = (
        hide(small_robot, session=session, timestep=step).instants["pose1-from-below"].theta
        for step in (None, 5e-4, 1e-3)
    )
    np.testing.assert_array_equal(default, half)
    assert np.any(half != whole)
    np.testing.assert_allclose(half, whole, atol=1e-5)


def test_goes_between_processes(null: Hidden) -> None:
    again = pickle.loads(pickle.dumps(null))
    assert again.background == null.background
    assert again.truth.effects == null.truth.effects
