"""Errors of the recording in a diagnosis: the replay repeats what hiding them makes, and they are found."""

from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from bench.diagnose.diagnose import signatures_of
from bench.diagnose.explain import measured_by, recorded_by
from bench.diagnose.linearise.first_order import FirstOrder
from bench.diagnose.linearise.nominal_model import linearised_model_of
from bench.diagnose.name.neighbourhood import Neighbourhood
from bench.diagnose.replay.nuisances import nuisances_of
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.diagnose.replay.world import NOMINAL, World
from bench.effects.catalogue import catalogue
from bench.effects.effect import Acting
from bench.hide.campaign import hide_campaign
from bench.hide.recorded import recorded_of
from bench.hide.request import effects_of
from bench.record.campaign import Array, Campaign
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from tests.simulate.session_small import small_session

RATE = 0.01
BINS = 12  # of a run: longer than the channels are late, for what was before a run or after it is not recorded
BALANCED = 1e-5  # of a channel's largest reading; balances are found within 1e-6 of the torques on the links
Hide = Callable[..., tuple[Campaign, tuple[Acting, ...]]]


@pytest.fixture(scope="module")
def compiled(small_robot: Path) -> CompiledRobot:
    return compile_robot(load_robot(small_robot))


@pytest.fixture(scope="module")
def hide(compiled: CompiledRobot) -> Hide:
    """Campaigns of the small session, with the same noise whatever is hidden."""
    robot, session = compiled.robot, small_session(compiled.robot.folder)
    recorded = recorded_of(robot, session)

    @cache
    def hidden(*words: str, background: bool = False) -> tuple[Campaign, tuple[Acting, ...]]:
        acting = effects_of(words, compiled, catalogue(), None, recorded)
        rng = np.random.default_rng(3)
        return hide_campaign(robot, session, acting, rng, background=background).campaign, acting

    return hidden


def of_column(values: Array, replay: Replay, column: str, *, is_static: bool) -> Array:
    """Return values, shape (T, c), of one quantity, at rest or in motion."""
    c = [quantity.column for quantity in replay.quantities].index(column)
    rests = np.concatenate([np.full(len(segment), segment.is_static) for segment in replay.segments])
    kept = (rests == is_static) & np.isfinite(np.concatenate([s.observed for s in replay.segments])[:, c])
    found: Array = values[kept, c]
    return found


def replay_of(campaign: Campaign, compiled: CompiledRobot) -> Replay:
    quantities = quantities_of(campaign.runs, compiled)
    return Replay(compiled, segments_of(campaign, compiled, quantities, BINS), quantities)


def observed(replay: Replay) -> Array:
    return np.concatenate([segment.observed for segment in replay.segments])


@pytest.mark.parametrize("delay", [0.02, 0.2, -0.05])
def test_a_late_tracker_is_replayed(delay: float, hide: Hide, compiled: CompiledRobot) -> None:
    """Of what 0.2 s change, within a hundredth: links ring when a sweep begins, and the replay's do not."""
    late, acting = hide(f"channel_delay@tracker={delay}")
    replay = replay_of(late, compiled)
    measured = observed(replay) - observed(replay_of(hide()[0], compiled))
    predicted = replay.predict(World(acting=acting)) - replay.predict(NOMINAL)
    for column in ("reflector_1_x_m", "reflector_1_z_m"):
        shown, expected = (of_column(values, replay, column, is_static=False) for values in (measured, predicted))
        np.testing.assert_allclose(expected, shown, atol=0.01 * np.max(np.abs(shown)))
        assert not np.any(of_column(predicted, replay, column, is_static=True))
    others = [c for c, quantity in enumerate(replay.quantities) if quantity.kind != "reflector"]
    assert not np.any(predicted[:, others])


def test_what_a_channel_is_off_by_is_as_large_whatever_the_torque_constant(hide: Hide, compiled: CompiledRobot) -> None:
    """A jump of 0.765 A was replayed as 3 % more or less, with the scale of its drive, and came out seven sigma off."""
    wrong, acting = hide("channel_offset@current_1_a=0.5", background=True)
    replay = replay_of(wrong, compiled)
    shown = observed(replay) - observed(replay_of(hide(background=True)[0], compiled))
    names = {str(one): one for one in nuisances_of(compiled, replay.quantities)}
    scale = {names[f"torque constant of {compiled.robot.figures.drives[0].joint}"]: 0.1}
    predicted = replay.predict(World(scale, acting)) - replay.predict(World(scale))
    for is_static in (True, False):
        for values in (shown, predicted):
            found = of_column(values, replay, "current_1_a", is_static=is_static)
            np.testing.assert_allclose(found, 0.5, atol=0.01)  # the sensor shows hundredths


def test_a_late_current_is_replayed(hide: Hide, compiled: CompiledRobot) -> None:
    late, acting = hide("channel_delay@current_1_a=0.02")
    replay = replay_of(late, compiled)
    measured = observed(replay) - observed(replay_of(hide()[0], compiled))
    predicted = replay.predict(World(acting=acting)) - replay.predict(NOMINAL)
    shown, expected = (of_column(v, replay, "current_1_a", is_static=False) for v in (measured, predicted))
    slope = float(shown @ expected / (expected @ expected))
    assert 0.8 < slope < 1.2  # currents jump with the acceleration, between two instants that are read
    assert not np.any(of_column(predicted, replay, "current_2_a", is_static=False))


def test_a_load_that_was_written_down_wrong_is_replayed_as_it_was(hide: Hide, compiled: CompiledRobot) -> None:
    """With the error in it a world predicts what the nominal one predicts of the log without an error."""
    for words in ("hung_load@pose1-from-below=-0.5", "bolted_load@joint1-payload5-speed30-up=-0.5"):
        wrong, acting = hide(words)
        right = replay_of(hide()[0], compiled)
        found = replay_of(wrong, compiled).predict(World(acting=acting))
        expected = right.predict(NOMINAL)
        assert np.all(np.abs(found - expected) <= BALANCED * np.max(np.abs(expected), axis=0))
        off = replay_of(wrong, compiled).predict(NOMINAL) - right.predict(NOMINAL)
        runs = np.concatenate([np.full(len(segment), segment.run) for segment in right.segments])
        run = acting[0].place.name
        assert np.any(off[runs == run])
        assert not np.any(off[runs != run])


def test_gas_that_leaks_is_replayed(hide: Hide, compiled: CompiledRobot) -> None:
    """The pressure falls by the rate times the time of each segment, whichever payload it has."""
    campaign, (leak,) = hide("gas_leak=0.2")
    replay = replay_of(campaign, compiled)
    c = [quantity.kind for quantity in replay.quantities].index("gas_pressure")
    ratio = replay.predict(World(acting=(leak,)))[:, c] / replay.predict(NOMINAL)[:, c]
    hours = np.concatenate([np.full(len(s), s.conditions.time_s / 3600) for s in replay.segments])
    assert np.ptp(hours) > 0.5
    np.testing.assert_allclose(ratio, 1 - 0.2 * hours, rtol=1e-3)  # links give as the pull falls


def test_a_joint_that_slips_does_so_from_its_run_on(hide: Hide, compiled: CompiledRobot) -> None:
    campaign, (slip,) = hide("joint_slip@1@joint2-payload0-speed30-up=0.001")
    replay = replay_of(campaign, compiled)
    traces = replay.traces(World(acting=(slip,))), replay.traces(NOMINAL)
    for segment, after, before in zip(replay.segments, *traces, strict=True):
        turned = -0.001 if segment.conditions.time_s >= slip.place.since_s else 0.0
        np.testing.assert_allclose((after.theta - before.theta)[:, 0], turned, atol=2e-6)


def test_a_joint_that_slips_is_simulated(hide: Hide, compiled: CompiledRobot) -> None:
    """Its weight pulls otherwise from then on: a torque that is added would not say so."""
    campaign, (slip,) = hide("joint_slip@1@joint2-payload0-speed30-up=0.0001")
    assert FirstOrder(replay_of(campaign, compiled), NOMINAL).change(slip) is None


def test_signatures_of_other_loads_are_not_shared(hide: Hide, compiled: CompiledRobot) -> None:
    """A campaign of the same session with another weight in its log has signatures of its own."""
    right, (wrong, _) = hide()[0], hide("bolted_load@joint1-payload5-speed30-up=-0.5")
    effects = {"payload_mass": catalogue()["payload_mass"]}
    shared, own = signatures_of(right, compiled, effects), signatures_of(wrong, compiled, effects)
    segments = segments_of(wrong, compiled, own.quantities, BINS)
    shared.sensitivities(segments_of(right, compiled, shared.quantities, BINS))
    np.testing.assert_array_equal(shared.sensitivities(segments).causes[0], own.sensitivities(segments).causes[0])


WORDS = (
    ("channel_delay@tracker=0.05", "channel_delay", "tracker"),
    ("hung_load@pose1-from-above=-0.5", "hung_load", "run pose1-from-above"),
    ("channel_scale@current_1_a=1", "channel_scale", "current_1_a"),
    ("gas_leak=0.2", "gas_leak", "robot"),
    (
        "tracker_step@tracker@joint2-payload0-speed30-up=0.002",
        "tracker_step",
        "tracker from run joint2-payload0-speed30-up on",
    ),
    ("bolted_load@joint1-payload5-speed30-up=-0.5", "bolted_load", "run joint1-payload5-speed30-up"),
    ("channel_drift@current_2_a=5", "channel_drift", "current_2_a"),
)


@pytest.mark.parametrize(("words", "name", "place"), WORDS)
def test_comes_first(words: str, name: str, place: str, hide: Hide, compiled: CompiledRobot) -> None:
    """Against everything in the catalogue, with all that is nominal a little wrong."""
    campaign, _ = hide(words, background=True)
    everything = catalogue()
    signatures = signatures_of(campaign, compiled, everything)
    segments = segments_of(campaign, compiled, signatures.quantities)
    sensitivities = signatures.sensitivities(segments)
    linear = linearised_model_of(
        Replay(compiled, segments, signatures.quantities), signatures.nuisances, sensitivities.nuisances
    )
    recorded = recorded_by(campaign, compiled)
    around = Neighbourhood(compiled, everything, measured_by(campaign), RATE, recorded=recorded)
    _, screening = around.weighed(linear, signatures.causes, sensitivities)
    first = next(entry for entry in screening.entries if entry.cause)
    assert first.cause is not None
    assert first.cause.key == (name, place)
    assert first.log_evidence > screening.threshold
