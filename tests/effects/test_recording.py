"""Errors of the recording and changes during a session: arithmetic on readings and loads, and where they may act."""

from dataclasses import replace

import numpy as np
import pytest

from bench.effects.conditions import Conditions
from bench.effects.effect import Place
from bench.effects.recorded import LogError, Recorded, RecordedRun, recorded_in
from bench.record.campaign import Run
from bench.robot.compiled import CompiledRobot, read_spec
from bench.robot.folder import Robot
from bench.robot.plugins import number_of
from bench.simulate.instruments import Reading
from bench.simulate.trace import Trace
from tests.effects.rest import CATALOGUE, edit_of, perfect_reading, places_of, recorded_on, rest, some_trace

EXACT = 1e-12
HOUR = 3600.0  # [s]; `some_trace` begins an hour after the campaign did
GRAVITY = np.array([0.0, 0.0, -9.81])


@pytest.fixture(scope="module")
def seen(small: Robot) -> tuple[CompiledRobot, Trace, Reading]:
    plant, trace = some_trace(small, np.random.default_rng(0))
    return plant.compiled, trace, perfect_reading(plant.compiled, trace)


def place_in(compiled: CompiledRobot, name: str, where: str) -> Place:
    return next(place for place in places_of(CATALOGUE[name], compiled) if str(place) == where)


def distorted(name: str, where: str, values: dict[str, float], seen: tuple, trace: Trace | None = None) -> Reading:
    compiled, usual, reading = seen
    effect, place = CATALOGUE[name], place_in(compiled, name, where)
    return effect.distort(place, effect.complete(values), reading, trace or usual, Conditions.reference(2))


def test_scale_of_a_current(seen: tuple) -> None:
    after, before = distorted("channel_scale", "current_2_a", {"scale": 1.0}, seen), seen[2]
    np.testing.assert_allclose(after.current[:, 1], 2 * before.current[:, 1], rtol=EXACT)
    np.testing.assert_array_equal(after.current[:, 0], before.current[:, 0])
    np.testing.assert_array_equal(after.torque, before.torque)


def test_scale_of_the_force_sensor(seen: tuple) -> None:
    after, trace = distorted("channel_scale", "force sensor", {"scale": -0.5}, seen), seen[1]
    np.testing.assert_allclose(np.hstack([after.force, after.moment]), 0.5 * trace.wrench, rtol=EXACT)


def test_offset_of_the_gauge(seen: tuple) -> None:
    after = distorted("channel_offset", "gauge", {"offset": 1e5}, seen)
    np.testing.assert_allclose(after.gas_pressure, seen[2].gas_pressure + 1e5, rtol=EXACT)


def test_drift_is_a_rate_by_the_hour(seen: tuple) -> None:
    after = distorted("channel_drift", "current_1_a", {"rate": 0.6}, seen)
    expected = seen[2].current[:, 0] + 0.6 * seen[1].time / HOUR
    np.testing.assert_allclose(after.current[:, 0], expected, rtol=EXACT)


def begun(trace: Trace) -> tuple[Trace, np.ndarray]:
    """Let three rows lie before the run "late" begins, at 3000 s, and the others after it."""
    is_after = np.arange(len(trace)) >= 3
    return replace(trace, time=np.where(is_after, 3000.0, 2999.9)), is_after


def test_a_zero_that_jumps_is_there_from_its_run_on(seen: tuple) -> None:
    trace, is_after = begun(seen[1])
    after = distorted("channel_step", "current_1_a from run late on", {"jump": 0.5}, seen, trace)
    np.testing.assert_allclose(after.current[:, 0] - seen[2].current[:, 0], 0.5 * is_after, atol=EXACT)


def test_a_frame_that_jumps_is_shifted_and_turned(seen: tuple) -> None:
    trace, is_after = begun(seen[1])
    after = distorted("tracker_step", "tracker from run late on", {"tx": 1e-3, "rz": 2e-3}, seen, trace)
    p = seen[2].reflectors
    jump = np.stack([1e-3 - 2e-3 * p[..., 1], 2e-3 * p[..., 0], 0 * p[..., 2]], axis=-1)
    np.testing.assert_allclose(after.reflectors - p, jump * is_after[:, None, None], atol=EXACT)


def test_creep_of_the_tracker(seen: tuple) -> None:
    after = distorted("tracker_creep", "tracker", {"y": 1e-3}, seen)
    np.testing.assert_allclose((after.reflectors - seen[2].reflectors)[0, :, 1], 1e-3, rtol=1e-9)


def test_a_stand_that_tilts_turns_all_readings(seen: tuple) -> None:
    """A base that leaned by 1 mrad/h was five jumps of the frame beside a creep."""
    p = seen[2].reflectors
    after = distorted("tracker_creep", "tracker", {"rz": 2e-3}, seen)
    np.testing.assert_allclose((after.reflectors - p)[0, :, 0], -2e-3 * p[0, :, 1], rtol=1e-6)


def test_what_is_late(small_compiled: CompiledRobot) -> None:
    delay = CATALOGUE["channel_delay"]
    found = [delay.lateness(place, {"delay": 0.01}) for place in places_of(delay, small_compiled)]
    assert [(one.field, one.drive) for one in found if one] == [
        ("reflectors", None),
        ("gas_force", None),
        ("motor_torque", 0),
        ("motor_torque", 1),
    ]
    most = [delay.parameters_at(small_compiled, place)[0].high for place in places_of(delay, small_compiled)]
    assert most == [0.2, 0.2, 0.02, 0.02]


def test_loads_are_wrong_in_their_runs_alone(small_compiled: CompiledRobot) -> None:
    hung, bolted = CATALOGUE["hung_load"], CATALOGUE["bolted_load"]
    assert [str(place) for place in places_of(hung, small_compiled)] == ["run hung"]
    assert [str(place) for place in places_of(bolted, small_compiled)] == ["run up", "run down", "run up to down"]
    up, _, both = places_of(bolted, small_compiled)
    assert bolted.log_error(up, {"change": -0.5}, "up") == LogError(bolted=0.5)
    assert bolted.log_error(up, {"change": -0.5}, "down") is None
    assert bolted.log_error(both, {"change": -0.5}, "down") == LogError(bolted=0.5)
    assert hung.log_error(place_in(small_compiled, "hung_load", "run hung"), {"change": 1.0}, "hung") == LogError(2.0)
    assert LogError(2.0, 3.0).with_another(LogError(5.0, 7.0)) == LogError(10.0, 21.0)


def amount_at(seconds: float, name: str, place: Place, values: dict[str, float], robot: Robot) -> float:
    spec = read_spec(robot)
    edit = CATALOGUE[name].edit(place, values, Conditions(np.zeros(2), np.zeros(2), time_s=seconds))
    if edit:
        edit(spec, robot)
        return number_of(spec, "balance", "gas_amount")
    return 1.0


def test_a_leak_goes_on_and_on(small: Robot, small_compiled: CompiledRobot) -> None:
    (place,) = places_of(CATALOGUE["gas_leak"], small_compiled)
    amounts = [amount_at(hours * HOUR, "gas_leak", place, {"rate": 0.1}, small) for hours in (0.0, 0.5, 2.0)]
    np.testing.assert_allclose(amounts, [1.0, 0.95, 0.8], rtol=1e-6)


def test_gas_is_gone_from_a_run_on(small: Robot, small_compiled: CompiledRobot) -> None:
    place = place_in(small_compiled, "gas_step", "robot from run late on")
    amounts = [amount_at(seconds, "gas_step", place, {"lost": 0.2}, small) for seconds in (90.0, 3000.0)]
    np.testing.assert_allclose(amounts, [1.0, 0.8], rtol=1e-6)


def test_a_joint_that_slips_stands_further_back(small: Robot, small_compiled: CompiledRobot) -> None:
    """The link turns back by the slip; the motor pays what the load then weighs: almost nothing for a microradian."""
    which = [str(place) for place in places_of(CATALOGUE["joint_slip"], small_compiled)].index(
        "drive 2 from run late on"
    )
    q, slip = np.array([0.2, -0.3]), 1e-6
    after = Conditions(np.zeros(2), np.zeros(2), time_s=3000.0)
    edit = edit_of("joint_slip", small_compiled, {"slip": slip}, which, after)
    usual, slipped = rest(small, [], q), rest(small, [edit], q)
    np.testing.assert_allclose(slipped.theta - usual.theta, [0.0, -slip], atol=0.01 * slip)
    place = places_of(CATALOGUE["joint_slip"], small_compiled)[which]
    assert CATALOGUE["joint_slip"].edit(place, {"slip": slip}, Conditions.reference(2)) is None


def run(name: str, start: float, end: float, *moving: int, payload: float = 0.0) -> RecordedRun:
    return RecordedRun(name, start, end, frozenset({"current_1_a"}), False, False, payload, frozenset(moving))


def test_breaks_between_runs_that_show_nothing_are_one() -> None:
    """Long pauses lie before b, c and d; joint 1 moves in a and d: what sets in before d may have done so at b."""
    recorded = Recorded((run("a", 0, 10, 0), run("b", 110, 120, 1), run("c", 220, 230, 1), run("d", 330, 340, 0)))
    assert [one.name for one in recorded.after_breaks] == ["b", "c", "d"]
    assert [one.name for one in recorded.setting_in(lambda one: 0 in one.moving)] == ["d"]
    assert [one.name for one in recorded.setting_in(lambda one: True)] == ["b", "c", "d"]
    short = Recorded((run("a", 0, 10, 0), run("b", 15, 20, 0), run("c", 220, 230, 0)))
    assert [one.name for one in short.after_breaks] == ["c"]


def test_a_load_stays_on_until_a_break_or_another_load() -> None:
    runs = (
        run("a", 0, 10, payload=5),
        run("b", 12, 20, payload=5),
        run("c", 22, 30, payload=8),
        run("d", 200, 210, payload=8),
    )
    recorded = Recorded(runs)
    together = recorded.mountings([one.payload_kg for one in recorded.runs])
    assert [[one.name for one in some] for some in together] == [["a", "b"], ["c"], ["d"]]


def test_what_was_recorded_is_read_from_columns() -> None:
    """A payload of 10 kg that pulls by its weight alone is no load that hangs."""
    time = np.array([0.0, 1.0])
    weight = {"load_mass_kg": np.full(2, 10.0), "load_z_n": np.full(2, -98.1)}
    angles = {"q_cmd_1_rad": np.array([0.0, 0.5]), "q_cmd_2_rad": np.zeros(2)}
    swept = Run("swept", "motion", 5.0, {"time_s": time, **angles, **weight})
    hung = Run("hung", "static", 9.0, {"time_s": time, "load_z_n": np.array([0.0, -50.0])})
    first, second = recorded_in((swept, hung), GRAVITY).runs
    assert (first.hangs, first.payload_kg, first.moving, first.end_s) == (False, 10.0, frozenset({0}), 6.0)
    assert (second.hangs, second.payload_kg, second.is_static) == (True, 0.0, True)


def test_without_a_recording_there_is_no_place(small_compiled: CompiledRobot) -> None:
    of_recording = [effect for effect in CATALOGUE.values() if effect.family == "recording"]
    assert len(of_recording) == 9
    assert not any(effect.places(small_compiled) for effect in of_recording)
    nobody = Recorded(tuple(replace(one, columns=frozenset()) for one in recorded_on(small_compiled).runs))
    assert not places_of_channels(small_compiled, nobody)


def places_of_channels(compiled: CompiledRobot, recorded: Recorded) -> tuple[Place, ...]:
    names = ("channel_delay", "channel_scale", "channel_offset", "channel_step", "tracker_step")
    return tuple(place for name in names for place in CATALOGUE[name].places_in(compiled, recorded))
