"""One more number in one run is told of instruments, angles and loads; healthy campaigns and effects are left alone."""

import re
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.plausibility.linear_fit import LinearFit, fitted
from bench.diagnose.plausibility.loads import unlike_weights
from bench.diagnose.plausibility.one_more_number import one_more_number
from bench.diagnose.plausibility.repeated import Repeated
from bench.effects.catalogue import catalogue
from bench.hide.campaign import hide_campaign
from bench.hide.recorded import recorded_of
from bench.hide.request import effects_of
from bench.record.campaign import Array, Campaign
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from bench.scenario.files import read_scenario
from bench.store.place import open_store

SWEEP, LINE, POSE = "joint2-payload100-speed40-up", "loaded-out", "pose2-from-above"
PLACES = [f"reflector_1_{axis}_m" for axis in "xyz"]
GAUGE = ["gas_pressure_pa"]
SAME = 1e-6  # rounding: of scores, with columns without a prior that have a precision of 1e-9


@pytest.fixture(scope="module")
def compiled() -> CompiledRobot:
    return compile_robot(load_robot("hh150"))


def session(seed: int, *effects: str, scenario: str = "session-study", without: Sequence[str] = ()) -> Campaign:
    robot, plan = load_robot("hh150"), read_scenario(scenario)
    recorded = recorded_of(robot, plan, tuple(without), ())
    acting = effects_of(effects, compile_robot(robot), catalogue(), None, recorded)
    return hide_campaign(robot, plan, acting, np.random.default_rng(seed), without=tuple(without)).campaign


@pytest.fixture(scope="module")
def campaign() -> Campaign:
    return session(21)


def changed(campaign: Campaign, run: str, columns: Sequence[str], change: Callable[[Array], Array]) -> Campaign:
    """Return a campaign with columns of one run changed."""
    runs = [
        replace(one, columns={**one.columns, **{name: change(one.columns[name]) for name in columns}})
        if one.name == run
        else one
        for one in campaign.runs
    ]
    return replace(campaign, runs=tuple(runs))


def without_force(campaign: Campaign) -> Campaign:
    runs = [
        replace(one, columns={k: v for k, v in one.columns.items() if not k.startswith(("force_", "moment_"))})
        for one in campaign.runs
    ]
    return replace(campaign, runs=tuple(runs))


def said_of(campaign: Campaign, compiled: CompiledRobot) -> list[str]:
    return [str(finding) for finding in one_more_number(Repeated.of(campaign, compiled), frozenset(), open_store())]


def late(values: Array) -> Array:
    return np.concatenate([np.full(10, values[0]), values[:-10]])


@pytest.mark.parametrize(
    ("run", "columns", "change", "words"),
    [
        (SWEEP, GAUGE, lambda p: 1.05 * p, "gas_pressure_pa: is 1.05 times what all else makes of it"),
        (SWEEP, GAUGE, late, "gas_pressure_pa: is 0.2 s late"),
        (SWEEP, GAUGE, lambda p: p[::-1].copy(), "gas_pressure_pa: is hardly what all else makes of it"),
        (LINE, PLACES[2:], lambda z: z + 0.005, "reflector_1_z_m: is +0.00"),
        (POSE, PLACES[2:], lambda z: 1.01 * z, "reflector_1_z_m: is +0.025"),
        (LINE, PLACES, late, "reflector_1_x_m: is "),
        (LINE, ["q_motor_2_rad"], lambda q: q + 0.0087, "q_motor_2_rad: is +0.008"),
        (SWEEP, ["current_2_a"], late, "current_2_a: is 0.2"),
        pytest.param(
            SWEEP, ["load_mass_kg", "load_z_n"], lambda m: m / 2, "load_mass_kg: is 0.4", marks=pytest.mark.study
        ),
    ],
)
def test_what_one_run_alone_has_is_told(
    campaign: Campaign,
    compiled: CompiledRobot,
    run: str,
    columns: list[str],
    change: Callable[[Array], Array],
    words: str,
) -> None:
    (said,) = said_of(changed(campaign, run, columns, change), compiled)
    assert words in said
    assert f"in run '{run}'" in said


@pytest.mark.parametrize(("factor", "within"), [(0.5, 0.2), pytest.param(2.0, 0.1, marks=pytest.mark.study)])
def test_a_load_is_told_by_what_the_tracker_saw(
    campaign: Campaign, compiled: CompiledRobot, factor: float, within: float
) -> None:
    (said,) = said_of(changed(without_force(campaign), POSE, ["load_z_n"], lambda force: factor * force), compiled)
    told = re.search(r"load_z_n: is (\S+) times the load that instruments show", said)
    assert told
    assert float(told[1]) == pytest.approx(factor, rel=within)
    assert POSE in said


def test_a_load_that_is_a_tenth_is_several_times_smaller(campaign: Campaign, compiled: CompiledRobot) -> None:
    (said,) = said_of(changed(without_force(campaign), POSE, ["load_z_n"], lambda force: 0.1 * force), compiled)
    assert "load_z_n: is several times smaller" in said
    assert POSE in said


def test_a_mass_whose_weight_is_another_one_is_told(campaign: Campaign) -> None:
    assert not list(unlike_weights(campaign))
    (found,) = unlike_weights(changed(campaign, SWEEP, ["load_mass_kg"], lambda m: m / 2))
    assert found.column == "load_mass_kg"
    assert f"is 50 kg in run '{SWEEP}'" in found.message
    assert "the weight of 100 kg" in found.message


@pytest.mark.parametrize("seed", [21, 31, pytest.param(32, marks=pytest.mark.study)])
def test_nothing_is_told_of_a_healthy_session(compiled: CompiledRobot, seed: int) -> None:
    assert not said_of(session(seed), compiled)


@pytest.mark.parametrize(
    "effect",
    [
        "gas_step@joint3-payload0-speed20-up=0.3",
        "joint_slip@3@joint3-payload0-speed20-up=0.005",
        "tracker_step@tracker@unloaded-out=0.005",
        "thermal_growth",
        "thermal_relaxation=0.6",
        "backlash@3",
        "channel_delay@tracker=0.2",
    ],
)
@pytest.mark.study
def test_effects_are_no_faults_of_one_run(compiled: CompiledRobot, effect: str) -> None:
    assert not said_of(session(41, effect), compiled)


@pytest.mark.parametrize("scenario", ["loading-with-load", "rotation-validation"])
def test_nothing_is_told_of_experiments_of_few_runs(scenario: str, compiled: CompiledRobot) -> None:
    assert not said_of(session(0, scenario=scenario), compiled)


def test_one_more_column_is_what_a_fit_of_all_columns_makes_of_it() -> None:
    rng = np.random.default_rng(5)
    columns, residual = rng.standard_normal((40, 2, 3)), rng.standard_normal((40, 2))
    residual[3, 1] = np.nan
    fit = LinearFit.of(residual, columns, np.ones((40, 2)))
    more = np.zeros((40, 2))
    more[:10, 0] = 1.0
    rows = np.arange(40) < 10
    scores, information = fit.products(rows, more[rows][:, :, None])
    both = LinearFit.of(residual, np.concatenate([columns, 1e4 * more[:, :, None]], axis=2), np.ones((40, 2)))
    size = scores[0] / information[0, 0]
    left = residual - both.explained
    assert np.nansum(left * more) / more.sum() == pytest.approx(0.0, abs=1e-3)
    with_it = fit.with_more(more)
    np.testing.assert_allclose(with_it.explained + size * more, both.explained, atol=SAME)
    again, nothing = with_it.products(rows, more[rows][:, :, None])
    assert again[0] == nothing[0, 0] == 0  # it has nothing of its own any more


def test_errors_are_raised_to_what_is_left_of_the_run_in_the_middle() -> None:
    rng = np.random.default_rng(6)
    residual = rng.standard_normal((90, 1)) * np.repeat([1.0, 2.0, 50.0], 30)[:, None]
    run_of = np.repeat(["a", "b", "c"], 30)
    fit = fitted(residual, np.zeros((90, 1, 0)), np.full((90, 1), 0.1), [run_of])
    assert np.unique(fit.errors) == pytest.approx(np.sqrt(np.mean(residual[30:60] ** 2)))


def test_two_runs_whose_loads_were_exchanged_are_told_together(campaign: Campaign, compiled: CompiledRobot) -> None:
    pair = "joint2-payload50-speed18-up", "joint2-payload100-speed18-up"
    runs = {run.name: run for run in campaign.runs}
    loads = [{name: v for name, v in runs[one].columns.items() if name.startswith("load_")} for one in pair]
    for one, of_other in zip(pair, reversed(loads), strict=True):
        runs[one] = replace(runs[one], columns={**runs[one].columns, **of_other})
    told = list(one_more_number(Repeated.of(replace(campaign, runs=tuple(runs.values())), compiled), frozenset()))
    (said,) = [str(finding) for finding in told if finding.column.startswith("load_")]
    assert f"is 0.5 times the load that instruments show in run '{pair[1]}'" in said
    assert f"in run '{pair[0]}'; loads or tables of the two exchanged?" in said


def test_a_load_that_its_force_sensor_repeats_is_told_by_all_else(campaign: Campaign, compiled: CompiledRobot) -> None:
    doubled = [f"{kind}_{axis}_n" for kind in ("load", "force") for axis in "xyz"]
    half_known = Repeated.of(changed(campaign, LINE, doubled, lambda x: 2 * x), compiled)
    told = list(one_more_number(half_known, frozenset(), open_store()))
    (said,) = [str(finding) for finding in told if finding.column.startswith("load_")]
    told = re.search(r"load_z_n and force: is (\S+) times the load", said)
    assert told
    assert float(told[1]) == pytest.approx(2.0, rel=0.1)
    assert f"in run {LINE!r} or, the other way round, in run 'loaded-back'; nothing tells which" in said
