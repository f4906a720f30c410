"""A first look: factors of gravity and inertia, and channels that are hardly what their names say."""

from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.plausibility.channels import doubts_of
from bench.diagnose.plausibility.drive_looks import drive_looks
from bench.diagnose.plausibility.drive_picture import DrivePicture, drive_picture
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.record.campaign import Campaign
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.instruments import CurrentSensor
from tests.diagnose.drive_looks import stating_rotors
from tests.diagnose.sweeps import Change, changed, in_motion, scale


def test_gravity_and_motion_have_factors_of_their_own(rng: np.random.Generator) -> None:
    t = np.linspace(0, 20, 400)
    q, v = np.sin(t), np.cos(t)
    gravity, motion = (np.stack([a, 0 * a], axis=1) for a in (100 * np.cos(q), -30 * np.sin(3 * t)))
    observed = 2 * (gravity + 1.2 * motion) + 9 * np.sign(v)[:, None] + rng.normal(0, 0.1, (400, 2))
    picture = DrivePicture(
        observed,
        gravity + motion,
        np.stack([v, 0 * v], axis=1),
        np.zeros((400, 2), bool) | [False, True],
        np.ones(2),
        np.ones(2),
        np.zeros((2, 2)),
        np.ones(2),
        np.zeros((400, 2, 0)),
        ("current_1_a", ""),
    )
    (look,) = drive_looks(picture, gravity)
    assert look.fits
    assert abs(look.gravity.value - 2) < 5 * look.gravity.sigma < 0.01
    assert abs(look.motion.value - 2.4) < 5 * look.motion.sigma < 0.01


@pytest.mark.parametrize("unknown", [(0, 1, 2, 3, 4, 5), (2,)])
def test_rotors_that_nobody_knows_are_free(
    short_session: Campaign, robot: CompiledRobot, unknown: tuple[int, ...]
) -> None:
    """Models of others state rotors ten times too small; by that, clock and channels would be to blame."""
    guessed = stating_rotors(robot, *(3.0 if j in unknown else 0.1 for j in range(robot.n_joints)))
    quantities = tuple(quantity for quantity in quantities_of(short_session.runs, robot) if quantity.is_drive)
    segments = segments_of(short_session, robot, quantities)
    sure, free = (drive_picture(Replay(one, segments, quantities)) for one in (robot, guessed))
    rotors = free.missing[:, :, sure.missing.shape[2] :]
    own = np.array(unknown)[:, None] == np.arange(robot.n_joints)
    np.testing.assert_array_equal(np.any(rotors, axis=0).T, own)
    np.testing.assert_allclose(free.model + rotors.sum(axis=2), sure.model, atol=1e-6)


def test_a_gauge_that_reads_nothing_in_one_run_is_doubted(short_session: Campaign, robot: CompiledRobot) -> None:
    run = short_session.runs[3]
    empty = replace(run, columns={**run.columns, "gas_pressure_pa": np.zeros(len(run))})
    runs = tuple(empty if one is run else one for one in short_session.runs)
    (doubt,) = doubts_of(replace(short_session, runs=runs), robot)
    assert doubt.column == "gas_pressure_pa"
    assert f"is 0 times what the model has in run {run.name!r}, and not in all others" in doubt.message


@pytest.mark.parametrize(("factor", "doubts"), [(1.0005, 0), (0.9995, 0), (1.02, 1), (0.98, 1)])
def test_a_tracker_that_is_two_percent_off_is_doubted(
    short_session: Campaign, robot: CompiledRobot, factor: float, doubts: int
) -> None:
    """What a wrong refractive index makes of distances is left to a diagnosis (tracker_scale)."""
    found = doubts_of(changed(short_session, scale(factor, *(f"reflector_1_{axis}_m" for axis in "xyz"))), robot)
    assert [doubt.column for doubt in found] == ["reflector_1_x_m"] * doubts
    assert all("times as far as the model has it" in doubt.message for doubt in found)


def smooth(name: str) -> Change:
    return in_motion(lambda columns: columns.update({name: np.convolve(columns[name], np.full(5, 0.2), "same")}))


def test_a_smoothed_channel_is_doubted(short_session: Campaign, robot: CompiledRobot) -> None:
    (doubt,) = doubts_of(changed(short_session, smooth("current_3_a")), robot)
    assert (doubt.column, "smoothed?" in doubt.remedy) == ("current_3_a", True)


def test_a_noise_that_nobody_stated_is_what_samples_scatter(short_session: Campaign, robot: CompiledRobot) -> None:
    """The default of 0.02 A hid four fifths of what an arm showed whose current was read to 0.006."""
    figures = robot.robot.figures
    stated = figures.instruments.current
    assert stated
    given = {key: value for key, value in stated.model_dump().items() if key in stated.model_fields_set - {"sigma_a"}}
    instruments = figures.instruments.model_copy(update={"current": CurrentSensor.model_validate(given)})
    unsaid = compile_robot(replace(robot.robot, figures=figures.model_copy(update={"instruments": instruments})))
    quiet = changed(short_session, smooth("current_3_a"))
    assert doubts_of(quiet, robot)
    assert not doubts_of(quiet, unsaid)


@pytest.mark.parametrize(("unit", "words"), [(1e3, "kilonewtons?"), (4.44822, "pounds?")])
def test_loads_in_another_unit_are_told_from_currents_alone(
    short_session: Campaign, robot: CompiledRobot, unit: float, words: str
) -> None:
    def spoil(columns: dict[str, np.ndarray]) -> None:
        for name in [*columns]:
            if name.startswith(("force", "moment", "load_mass")):
                del columns[name]
            elif name.startswith("load_"):
                columns[name] = columns[name] / unit

    doubts = doubts_of(changed(short_session, spoil), robot)
    assert [doubt.column for doubt in doubts] == ["load_z_n"]
    assert words in doubts[0].remedy
