"""A first look: factors of gravity and inertia, the rate of a clock, and hints at what a diagnosis weighs itself."""

from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.plausibility.channels import doubts_of
from bench.diagnose.plausibility.drive_picture import DrivePicture, drive_picture
from bench.diagnose.plausibility.first_look import DriveLook, Factor, clock_of, first_look
from bench.diagnose.plausibility.hints import _scaled, hints_of
from bench.diagnose.plausibility.speeds import fastest
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.record.campaign import Campaign
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.figures import CurrentSensor
from bench.scenario.files import read_as
from bench.scenario.session import SessionScenario
from bench.store.place import open_store
from tests.diagnose.sweeps import SWEEPS, Change, changed, made, nominal, scale

DRAWS = 3000
DECLARED = 0.01  # share of healthy clocks outside of an interval at 99 %
MOST = 0.015  # 2.7 standard errors of 3000 draws above it
LATE = 5  # samples
GAUGE = "gas_pressure_pa"


@pytest.fixture(scope="module")
def robot() -> CompiledRobot:
    return nominal()


@pytest.fixture(scope="module")
def session() -> Campaign:
    return made(read_as(SessionScenario, "session-short"), seed=3)


def looks(motion: np.ndarray) -> list[DriveLook]:
    one = Factor(1.0, 1e-3)
    return [DriveLook(j, f"current_{j + 1}_a", one, one, Factor(m, 1e-3), fits=True) for j, m in enumerate(motion)]


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
    (look,) = first_look(picture, gravity)
    assert look.fits
    assert abs(look.gravity.value - 2) < 5 * look.gravity.sigma < 0.01
    assert abs(look.motion.value - 2.4) < 5 * look.motion.sigma < 0.01


def test_a_clock_is_the_root_of_what_all_inertias_have_in_common(robot: CompiledRobot) -> None:
    clock = clock_of(looks(np.full(6, 1.21)), robot, 0.999)
    assert clock
    assert clock.rate == pytest.approx(1.1)
    assert clock.low > 1
    one_inertia = clock_of(looks(np.array([1.21, 1, 1, 1, 1, 1])), robot, 0.999)
    assert one_inertia
    assert one_inertia.low < 1 < one_inertia.high
    assert clock_of(looks(np.array([1.21])), robot, 0.999) is None, "one joint may have another inertia"


def test_healthy_clocks_are_doubted_as_rarely_as_declared(robot: CompiledRobot, rng: np.random.Generator) -> None:
    sigma = robot.robot.figures.uncertainty.rotor_inertia
    outside = 0
    for factors in np.exp(rng.normal(0, sigma, (DRAWS, 6))):
        clock = clock_of(looks(factors), robot, 1 - DECLARED)
        assert clock
        outside += not clock.low <= 1 <= clock.high
    assert outside <= MOST * DRAWS


def in_motion(change: Change) -> Change:
    return lambda columns: change(columns) if "pose" not in columns else None


def late(*names: str) -> Change:
    return in_motion(
        lambda columns: columns.update(
            {name: np.concatenate([np.full(LATE, columns[name][0]), columns[name][:-LATE]]) for name in names}
        )
    )


def smooth(name: str) -> Change:
    return in_motion(lambda columns: columns.update({name: np.convolve(columns[name], np.full(5, 0.2), "same")}))


def test_a_healthy_session_gets_no_hint(session: Campaign, robot: CompiledRobot) -> None:
    assert doubts_of(session, robot) == ()
    assert hints_of(session, robot, store=open_store()) == ()


@pytest.mark.parametrize("names", [("loaded-out",), ("unloaded-out",), ("unloaded-out", "unloaded-back")])
def test_a_line_at_one_speed_tells_no_delay(session: Campaign, robot: CompiledRobot, names: tuple[str, ...]) -> None:
    """Its speed differs by 1e-5 from its mean: a quarter of a millimetre beside the model looked like 1.5 s."""
    alone = replace(session, runs=tuple(run for run in session.runs if run.name in names))
    assert len(alone.runs) == len(names)
    doubts = doubts_of(alone, robot)
    assert doubts == ()
    assert hints_of(alone, robot, doubts, store=open_store()) == ()


def test_the_fastest_joint_need_not_be_the_first(session: Campaign, robot: CompiledRobot) -> None:
    """Joint 1 stands: a clock was divided by next to nothing, and the check died of a window of 1e20 samples."""
    of_joint_3 = replace(session, runs=tuple(run for run in session.runs if run.name.startswith("joint3")))
    assert of_joint_3.runs
    assert fastest(of_joint_3, robot) > 0.1


def test_a_gauge_that_reads_nothing_in_one_run_is_doubted(session: Campaign, robot: CompiledRobot) -> None:
    run = session.runs[3]
    empty = replace(run, columns={**run.columns, "gas_pressure_pa": np.zeros(len(run))})
    runs = tuple(empty if one is run else one for one in session.runs)
    (doubt,) = doubts_of(replace(session, runs=runs), robot)
    assert doubt.column == "gas_pressure_pa"
    assert f"is 0 times what the model has in run {run.name!r}, and not in all others" in doubt.message


def rows_for_seconds(columns: dict[str, np.ndarray]) -> None:
    columns["time_s"] = np.arange(len(columns["time_s"]), dtype=np.float64)


@pytest.mark.parametrize("change", [scale(60.0, "time_s"), scale(10.0, "time_s"), rows_for_seconds])
def test_a_clock_by_which_no_inertia_shows_is_doubted(session: Campaign, robot: CompiledRobot, change: Change) -> None:
    (doubt,) = doubts_of(changed(session, in_motion(change)), robot)
    assert doubt.column == "time_s"
    assert "seconds for each second" in doubt.message


@pytest.mark.parametrize(("factor", "doubts"), [(1.0005, 0), (0.9995, 0), (1.02, 1), (0.98, 1)])
def test_a_tracker_that_is_two_percent_off_is_doubted(
    session: Campaign, robot: CompiledRobot, factor: float, doubts: int
) -> None:
    """What a wrong refractive index makes of distances is left to a diagnosis (tracker_scale)."""
    found = doubts_of(changed(session, scale(factor, *(f"reflector_1_{axis}_m" for axis in "xyz"))), robot)
    assert [doubt.column for doubt in found] == ["reflector_1_x_m"] * doubts
    assert all("times as far as the model has it" in doubt.message for doubt in found)


@pytest.mark.parametrize("speed", [2.0, 8.0])
def test_a_recording_that_was_slow_has_a_right_clock(robot: CompiledRobot, speed: float) -> None:
    """It shows no inertia either, at 2 to 8 % of what its drives can."""
    sweeps = SWEEPS.model_copy(update={"speeds_deg_per_s": (speed,), "end_deg": -20 + 6 * speed})
    assert doubts_of(made(sweeps, seed=1), robot) == ()


def test_a_clock_that_is_20_percent_fast_is_doubted(session: Campaign, robot: CompiledRobot) -> None:
    (doubt,) = doubts_of(changed(session, in_motion(scale(1.2, "time_s"))), robot)
    assert (doubt.level, doubt.column) == ("doubt", "time_s")
    assert "seconds for each second" in doubt.message


def test_rotors_that_nobody_knows_are_free(session: Campaign, robot: CompiledRobot) -> None:
    """Models of others state rotors ten times too small; by that, clock and channels would be to blame."""
    known = robot.robot.figures.uncertainty
    figures = robot.robot.figures.model_copy(update={"uncertainty": known.model_copy(update={"rotor_inertia": 1.0})})
    guessed = compile_robot(replace(robot.robot, figures=figures))
    quantities = tuple(quantity for quantity in quantities_of(session.runs, robot) if quantity.is_drive)
    segments = segments_of(session, robot, quantities)
    sure, free = (drive_picture(Replay(one, segments, quantities)) for one in (robot, guessed))
    rotors = free.missing[:, :, sure.missing.shape[2] :]
    assert rotors.shape[2] == robot.n_joints
    assert np.all(np.any(rotors[:, np.eye(robot.n_joints, dtype=bool)], axis=0))
    assert not np.any(rotors[:, ~np.eye(robot.n_joints, dtype=bool)])
    np.testing.assert_allclose(free.model + rotors.sum(axis=2), sure.model, atol=1e-6)


def stating_rotors(robot: CompiledRobot, *sigmas: float) -> CompiledRobot:
    known = robot.robot.figures.uncertainty.model_copy(update={"rotor_inertia": sigmas})
    return replace(
        robot, robot=replace(robot.robot, figures=robot.robot.figures.model_copy(update={"uncertainty": known}))
    )


def test_of_rotors_those_that_nobody_knows_alone_are_free(session: Campaign, robot: CompiledRobot) -> None:
    partly = stating_rotors(robot, 0.1, 0.1, 3.0, 0.1, 0.1, 0.1)
    quantities = tuple(quantity for quantity in quantities_of(session.runs, robot) if quantity.is_drive)
    segments = segments_of(session, robot, quantities)
    sure, free = (drive_picture(Replay(one, segments, quantities)) for one in (robot, partly))
    (rotor,) = np.moveaxis(free.missing[:, :, sure.missing.shape[2] :], 2, 0)
    assert np.any(rotor[:, 2])
    assert not np.any(np.delete(rotor, 2, axis=1))
    np.testing.assert_allclose(free.model + rotor, sure.model, atol=1e-6)


def test_one_rotor_that_is_known_does_not_doubt_a_clock(robot: CompiledRobot) -> None:
    """It may be half as heavy again as stated; others agree with it only because nobody knows theirs."""
    motion = np.array([1.5, 1, 1, 1, 1, 1])
    alone = clock_of(looks(motion), stating_rotors(robot, 0.1, *[3.0] * 5), 0.999)
    assert alone
    assert alone.low < 1 < alone.high
    two = clock_of(looks(np.full(6, 1.5)), stating_rotors(robot, 0.1, 0.1, *[3.0] * 4), 0.999)
    assert two
    assert two.low > 1


def test_a_channel_is_as_scaled_as_its_own_rotor_allows(robot: CompiledRobot) -> None:
    """Told by inertia alone, at rest nothing: a factor of 1.4 is beyond a rotor that is known to a tenth."""
    for sigma, told in ((0.05, ["current_5_a"]), (3.0, [])):
        seen = looks(np.ones(6))
        untold = Factor(np.nan, np.inf)
        seen[4] = replace(seen[4], gravity=untold, whole=Factor(1.4, 1e-3))
        stated = stating_rotors(robot, *[0.05] * 4, sigma, 0.05)
        assert [hint.column for hint in _scaled(seen, stated)] == told


def test_a_smoothed_channel_is_doubted(session: Campaign, robot: CompiledRobot) -> None:
    (doubt,) = doubts_of(changed(session, smooth("current_3_a")), robot)
    assert (doubt.column, "smoothed?" in doubt.remedy) == ("current_3_a", True)


def test_a_noise_that_nobody_stated_is_what_samples_scatter(session: Campaign, robot: CompiledRobot) -> None:
    """The default of 0.02 A hid four fifths of what an arm showed whose current was read to 0.006."""
    figures = robot.robot.figures
    stated = figures.instruments.current
    assert stated
    given = {key: value for key, value in stated.model_dump().items() if key in stated.model_fields_set - {"sigma_a"}}
    instruments = figures.instruments.model_copy(update={"current": CurrentSensor.model_validate(given)})
    unsaid = compile_robot(replace(robot.robot, figures=figures.model_copy(update={"instruments": instruments})))
    quiet = changed(session, smooth("current_3_a"))
    assert doubts_of(quiet, robot)
    assert not doubts_of(quiet, unsaid)


@pytest.mark.parametrize(
    ("change", "column", "words"),
    [
        (scale(2, "current_5_a"), "current_5_a", "looks doubled: "),
        (scale(0.5, "current_3_a"), "current_3_a", "looks halved: "),
        (scale(2, GAUGE), GAUGE, "looks doubled: 2.0"),
        pytest.param(scale(0.5, GAUGE), GAUGE, "looks halved: 0.5", marks=pytest.mark.study),
        (late("current_3_a"), "current_3_a", "looks late, by about 1"),
        (late("reflector_1_x_m", "reflector_1_y_m", "reflector_1_z_m"), "reflector_1_x_m", "looks late, by about 1"),
    ],
)
def test_what_a_diagnosis_weighs_is_a_hint(
    change: Change, column: str, words: str, session: Campaign, robot: CompiledRobot
) -> None:
    campaign = changed(session, change)
    assert doubts_of(campaign, robot) == ()
    (hint,) = hints_of(campaign, robot, store=open_store())
    assert (hint.level, hint.column) == ("warning", column)
    assert words in hint.message
    assert "bench diagnose weighs it" in hint.remedy


@pytest.mark.parametrize("factor", [0.5, *(pytest.param(one, marks=pytest.mark.study) for one in (2.0, 2**0.5, 0.7))])
def test_all_currents_off_by_one_factor_are_told(session: Campaign, robot: CompiledRobot, factor: float) -> None:
    """Sigma grows with the factor: what was told of a half was not told of the double."""
    currents = [f"current_{j + 1}_a" for j in range(robot.n_joints)]
    campaign = changed(session, scale(factor, *currents))
    assert doubts_of(campaign, robot) == ()
    hints = hints_of(campaign, robot, store=open_store())
    assert hints[0].column == currents[0]
    assert "looks scaled, and so do current_2_a" in hints[0].message


def exchanged(campaign: Campaign, one: str, other: str) -> Campaign:
    """Return a campaign in which two runs have each other's time of start."""
    starts = {run.name: run.start_s for run in campaign.runs}
    starts |= {one: starts[other], other: starts[one]}
    return replace(campaign, runs=tuple(replace(run, start_s=starts[run.name]) for run in campaign.runs))


def test_runs_that_would_begin_before_the_arm_is_there_are_noticed(session: Campaign, robot: CompiledRobot) -> None:
    """There and back were written down in the wrong order; nothing overlaps."""
    up, down = "joint2-payload50-speed24-up", "joint2-payload50-speed24-down"
    (hint,) = hints_of(exchanged(session, up, down), robot, store=open_store())
    assert (hint.level, hint.column) == ("warning", "start_s")
    assert "the end of" in hint.message
    assert "exchanged" in hint.remedy


def test_times_to_the_minute_are_no_reason_for_a_hint(session: Campaign, robot: CompiledRobot) -> None:
    rounded = replace(session, runs=tuple(replace(run, start_s=60.0 * round(run.start_s / 60)) for run in session.runs))
    assert not [hint for hint in hints_of(rounded, robot, store=open_store()) if hint.column == "start_s"]


def test_a_gauge_of_lost_or_warm_gas_is_no_reason_for_a_hint(session: Campaign, robot: CompiledRobot) -> None:
    for factor in (0.7, 1.1):
        hints = hints_of(changed(session, scale(factor, "gas_pressure_pa")), robot, store=open_store())
        assert not [hint for hint in hints if hint.column == "gas_pressure_pa"]


def test_nothing_is_hinted_where_something_is_doubted(session: Campaign, robot: CompiledRobot) -> None:
    doubts = doubts_of(changed(session, in_motion(scale(1.2, "time_s"))), robot)
    assert hints_of(changed(session, scale(2, "current_5_a")), robot, doubts, store=open_store()) == ()


def test_loads_in_kilonewtons_are_told_from_currents_alone(session: Campaign, robot: CompiledRobot) -> None:
    def spoil(columns: dict[str, np.ndarray]) -> None:
        for name in [*columns]:
            if name.startswith(("force", "moment", "load_mass")):
                del columns[name]
            elif name.startswith("load_"):
                columns[name] = columns[name] / 1000

    doubts = doubts_of(changed(session, spoil), robot)
    assert [doubt.column for doubt in doubts] == ["load_z_n"]
    assert "kilonewtons?" in doubts[0].remedy


def test_an_unstated_payload_leaves_the_clock_open(robot: CompiledRobot) -> None:
    figures = robot.robot.figures
    heavy = figures.model_copy(update={"uncertainty": figures.uncertainty.model_copy(update={"payload_kg": 300.0})})
    untold = [replace(look, gravity=Factor(np.nan, np.inf)) for look in looks(np.full(6, 1.5))]
    assert clock_of(untold, replace(robot, robot=replace(robot.robot, figures=heavy)), 0.999) is None
    assert clock_of(untold, robot, 0.999)


def test_what_a_small_part_of_gravity_tells_is_known_no_better_than_the_masses(robot: CompiledRobot) -> None:
    """Beside an unstated payload a tenth of gravity was left to tell: centres that were off looked like a scale."""
    stated = looks(np.ones(6))
    for share, told in ((1.0, ["current_5_a"]), (0.05, [])):
        gravity = Factor(1.4, 1e-3, share)
        spoilt = [replace(look, gravity=gravity, whole=gravity) if look.index == 4 else look for look in stated]
        assert [hint.column for hint in _scaled(spoilt, robot)] == told
