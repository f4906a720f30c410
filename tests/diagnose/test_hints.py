"""Hints: what a first look sees that a diagnosis weighs itself."""

from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.plausibility.between_runs import too_far_apart
from bench.diagnose.plausibility.channels import doubts_of
from bench.diagnose.plausibility.drive_looks import Factor
from bench.diagnose.plausibility.hints import _scaled, doubts_and_hints_of, hints_of
from bench.record.campaign import Campaign
from bench.robot.compiled import CompiledRobot
from bench.store.place import open_store
from tests.diagnose.drive_looks import looks, stating_rotors
from tests.diagnose.sweeps import Change, changed, in_motion, scale

LATE = 5  # samples
GAUGE = "gas_pressure_pa"


def late(*names: str) -> Change:
    return in_motion(
        lambda columns: columns.update(
            {name: np.concatenate([np.full(LATE, columns[name][0]), columns[name][:-LATE]]) for name in names}
        )
    )


def test_a_healthy_session_gets_no_hint(short_session: Campaign, robot: CompiledRobot) -> None:
    assert doubts_and_hints_of(short_session, robot, store=open_store()) == ()


@pytest.mark.parametrize("names", [("loaded-out",), ("unloaded-out",), ("unloaded-out", "unloaded-back")])
def test_a_line_at_one_speed_tells_no_delay(
    short_session: Campaign, robot: CompiledRobot, names: tuple[str, ...]
) -> None:
    """Its speed differs by 1e-5 from its mean: a quarter of a millimetre beside the model looked like 1.5 s."""
    alone = replace(short_session, runs=tuple(run for run in short_session.runs if run.name in names))
    assert len(alone.runs) == len(names)
    assert doubts_and_hints_of(alone, robot, store=open_store()) == ()


def test_a_channel_is_as_scaled_as_its_own_rotor_allows(robot: CompiledRobot) -> None:
    """Told by inertia alone, at rest nothing: a factor of 1.4 is beyond a rotor that is known to a tenth."""
    for sigma, told in ((0.05, ["current_5_a"]), (3.0, [])):
        seen = looks(np.ones(6))
        untold = Factor(np.nan, np.inf)
        seen[4] = replace(seen[4], gravity=untold, whole=Factor(1.4, 1e-3))
        stated = stating_rotors(robot, *[0.05] * 4, sigma, 0.05)
        assert [hint.column for hint in _scaled(seen, stated)] == told


def test_what_a_small_part_of_gravity_tells_is_known_no_better_than_the_masses(robot: CompiledRobot) -> None:
    """Beside an unstated payload a tenth of gravity was left to tell: centres that were off looked like a scale."""
    stated = looks(np.ones(6))
    for share, told in ((1.0, ["current_5_a"]), (0.05, [])):
        gravity = Factor(1.4, 1e-3, share)
        spoilt = [replace(look, gravity=gravity, whole=gravity) if look.index == 4 else look for look in stated]
        assert [hint.column for hint in _scaled(spoilt, robot)] == told


@pytest.mark.parametrize(
    ("change", "column", "words"),
    [
        (scale(2, "current_5_a"), "current_5_a", "looks doubled: "),
        pytest.param(scale(0.5, "current_3_a"), "current_3_a", "looks halved: ", marks=pytest.mark.study),
        (scale(2, GAUGE), GAUGE, "looks doubled: 2.0"),
        pytest.param(scale(0.5, GAUGE), GAUGE, "looks halved: 0.5", marks=pytest.mark.study),
        (late("current_3_a"), "current_3_a", "looks late, by about 1"),
        (late("reflector_1_x_m", "reflector_1_y_m", "reflector_1_z_m"), "reflector_1_x_m", "looks late, by about 1"),
    ],
)
def test_what_a_diagnosis_weighs_is_a_hint(
    change: Change, column: str, words: str, short_session: Campaign, robot: CompiledRobot
) -> None:
    campaign = changed(short_session, change)
    (hint,) = doubts_and_hints_of(campaign, robot, store=open_store())
    assert (hint.level, hint.column) == ("warning", column)
    assert words in hint.message
    assert "bench diagnose weighs it" in hint.remedy


@pytest.mark.parametrize("factor", [0.5, *(pytest.param(one, marks=pytest.mark.study) for one in (2.0, 2**0.5, 0.7))])
def test_all_currents_off_by_one_factor_are_told(short_session: Campaign, robot: CompiledRobot, factor: float) -> None:
    """Sigma grows with the factor: what was told of a half was not told of the double."""
    currents = [f"current_{j + 1}_a" for j in range(robot.n_joints)]
    campaign = changed(short_session, scale(factor, *currents))
    hints = doubts_and_hints_of(campaign, robot, store=open_store())
    assert {hint.level for hint in hints} == {"warning"}
    assert hints[0].column == currents[0]
    assert "looks scaled, and so do current_2_a" in hints[0].message


def exchanged(campaign: Campaign, one: str, other: str) -> Campaign:
    """Return a campaign in which two runs have each other's time of start."""
    starts = {run.name: run.start_s for run in campaign.runs}
    starts |= {one: starts[other], other: starts[one]}
    return replace(campaign, runs=tuple(replace(run, start_s=starts[run.name]) for run in campaign.runs))


def test_runs_that_would_begin_before_the_arm_is_there_are_noticed(
    short_session: Campaign, robot: CompiledRobot
) -> None:
    """There and back were written down in the wrong order; nothing overlaps."""
    up, down = "joint2-payload50-speed24-up", "joint2-payload50-speed24-down"
    (hint,) = too_far_apart(exchanged(short_session, up, down), robot)
    assert (hint.level, hint.column) == ("warning", "start_s")
    assert "the end of" in hint.message
    assert "exchanged" in hint.remedy


def test_times_to_the_minute_are_no_reason_for_a_hint(short_session: Campaign, robot: CompiledRobot) -> None:
    rounded = replace(
        short_session, runs=tuple(replace(run, start_s=60.0 * round(run.start_s / 60)) for run in short_session.runs)
    )
    assert not list(too_far_apart(rounded, robot))


def test_a_gauge_of_lost_or_warm_gas_is_no_reason_for_a_hint(short_session: Campaign, robot: CompiledRobot) -> None:
    for factor in (0.7, 1.1):
        hints = hints_of(changed(short_session, scale(factor, "gas_pressure_pa")), robot, store=open_store())
        assert not [hint for hint in hints if hint.column == "gas_pressure_pa"]


def test_nothing_is_hinted_where_something_is_doubted(short_session: Campaign, robot: CompiledRobot) -> None:
    doubts = doubts_of(changed(short_session, in_motion(scale(1.2, "time_s"))), robot)
    assert hints_of(changed(short_session, scale(2, "current_5_a")), robot, doubts, store=open_store()) == ()
