"""The second plant against the first model's own replay, and each of its effects against what it is to do."""

import subprocess
import sys

import numpy as np
import pytest

from bench.diagnose.replay.quantities import Quantity, quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.diagnose.replay.world import NOMINAL
from bench.diagnose.replay.world import World as Hypothesis
from bench.effects.catalogue import catalogue
from bench.effects.effect import WHOLE, Acting
from bench.effects.unlisted import unlisted
from bench.hide.request import effects_of
from bench.hide.second_plant import run_second
from bench.record.campaign import Campaign
from bench.robot.compiled import CompiledRobot
from bench.scenario.session import SessionScenario
from bench.second.campaign import Second
from bench.second.effects import CHANGES
from bench.second.worlds import World
from bench.study.labs import Lab

KNOWN = {**catalogue(), **unlisted()}
LAB = Lab(without=("line", "dwell", "repeat_at_end"))
IN_MOTION = 2e-3  # of a drive's largest current, where it moves: bins of the replay are 40 ms wide
SAG = 1e-2  # of a loss of gas: joint 2 sags by 5e-4 rad, the cylinder by 0.1 mm of the 130 mm that are left for gas
ALIKE = 1e-2  # of the largest change of a channel: small rotations are to first order, and places differ by 0.1 mm
DELAY_S = 4e-3  # a control period
ROUNDING = 1e-9  # [m, A, N, Nm]
AT_REST = 1e-4  # [m]; presliding on a link is not resolved by a replay that starts 2 degrees away


def short() -> SessionScenario:
    """Return one pose, loaded, and the sweeps of joint 2 under a payload."""
    session = LAB.scenario().without("line", "dwell", "repeat_at_end")
    assert session.loading
    loading = session.loading.model_copy(update={"poses": session.loading.poses[:1]})
    sweep = session.rotations[0].model_copy(update={"payloads_kg": (50,), "speeds_deg_per_s": (40,)})
    return session.model_copy(update={"loading": loading, "rotations": (sweep,)})


def all_joints() -> SessionScenario:
    return LAB.scenario().without("line", "dwell", "repeat_at_end")


def second(*acting: Acting, session: SessionScenario | None = None) -> Second:
    return run_second(LAB.robot(), session or short(), acting, rng(1), quiet=True)


def rng(seed: int) -> np.random.Generator:
    return np.random.default_rng(seed)


@pytest.fixture(scope="module")
def compiled() -> CompiledRobot:
    return LAB.compiled()


@pytest.fixture(scope="module")
def quiet() -> Second:
    return second()


def test_replay_of_the_bench_predicts_the_nominal_plant(compiled: CompiledRobot) -> None:
    assert_predicted(second(session=all_joints()).campaign, compiled)


def test_both_plants_carry_an_unstated_payload_alike(compiled: CompiledRobot) -> None:
    seconds = {"second_moment_x": 0.8, "second_moment_y": 0.1, "second_moment_z": 0.4}
    values = {"mass": 40.0, **seconds, "moment_x": 3.0, "moment_y": -2.0, "moment_z": 6.0}
    acting = Acting(catalogue()["unstated_payload"], WHOLE, values)
    assert_predicted(second(acting, session=all_joints()).campaign, compiled, Hypothesis(acting=(acting,)))


def assert_predicted(campaign: Campaign, compiled: CompiledRobot, world: Hypothesis = NOMINAL) -> None:
    quantities = quantities_of(campaign.runs, compiled)
    segments = segments_of(campaign, compiled, quantities, 400)
    predicted = Replay(compiled, segments, quantities).predict(world)
    left = np.concatenate([segment.observed for segment in segments]) - predicted
    observed = np.concatenate([segment.observed for segment in segments])
    static = np.concatenate([np.full(len(segment), segment.is_static) for segment in segments])
    steady = np.concatenate([~segment.rings for segment in segments]) & ~static
    moves = np.concatenate([np.tile(~segment.standing, (len(segment), 1)) for segment in segments])
    for c, quantity in enumerate(quantities):
        here = np.isfinite(left[:, c])
        if quantity.column.startswith("current"):
            rows = here & steady & moves[:, quantity.index]
            size = np.max(np.abs(observed[rows, c]))
            assert np.median(np.abs(left[rows, c])) < IN_MOTION * size, quantity.column
        elif quantity.column.startswith("reflector") and np.any(here):
            assert np.max(np.abs(left[here & static, c])) < AT_REST, quantity.column
        elif quantity.column.startswith("gas"):
            assert np.max(np.abs(left[here, c])) < 1e-3 * np.max(observed[here, c])


def test_it_runs_without_mujoco() -> None:
    probe = (
        "import sys; sys.modules['mujoco'] = None; import pkgutil, importlib, bench.second;"
        "[importlib.import_module('bench.second.' + m.name) for m in pkgutil.iter_modules(bench.second.__path__)]"
    )
    subprocess.run([sys.executable, "-W", "error", "-c", probe], check=True)


def changes(quiet: Second, acting: Acting) -> dict[str, float]:
    """Return the largest change of each column over the campaign."""
    found: dict[str, float] = {}
    for before, after in zip(quiet.campaign.runs, second(acting).campaign.runs, strict=True):
        for name, values in before.columns.items():
            found[name] = max(found.get(name, 0.0), float(np.max(np.abs(after.columns[name] - values))))
    return {name: size for name, size in found.items() if size > 1e-9}


@pytest.mark.parametrize("name", [name for name in CHANGES if name in KNOWN and KNOWN[name].level != "recording"])
def test_every_effect_changes_something(compiled: CompiledRobot, quiet: Second, name: str) -> None:
    """Which of the catalogue's names it knows; and what is to be seen of it is."""
    place = {"joint": "@2", "body": "@forearm"}.get(KNOWN[name].places(compiled)[0].kind, "")
    values = {p.name: p.typical for p in KNOWN[name].parameters}
    (acting,) = effects_of([name + place], compiled, KNOWN)
    seen = changes(quiet, Acting(acting.effect, acting.place, values))
    if name in ("tracker_drift", "tracker_scale"):
        assert {column.split("_")[0] for column in seen} == {"reflector"}
    elif name == "force_gain":
        assert {column.split("_")[0] for column in seen} <= {"force", "moment"}
        assert max(seen.values()) > 1.0
    elif name == "force_tilt":
        assert not seen, "a load that hangs counts as vertical"
    elif name in ("tracker_frame", "base_compliance"):
        assert {column.split("_")[0] for column in seen} <= {"reflector", "current", "q", "gas"}
        assert max(size for column, size in seen.items() if column.startswith("reflector")) > 1e-5
    elif name in ("current_offset", "torque_constant", "current_dead_band"):
        assert list(seen) == ["current_2_a"]
    elif name == "gas_loss":
        loss = values["lost"] * max(np.max(run.columns["gas_pressure_pa"]) for run in quiet.campaign.runs)
        assert seen["gas_pressure_pa"] == pytest.approx(loss, rel=SAG)
    else:
        assert max(size for column, size in seen.items() if column.startswith(("current", "reflector"))) > 1e-4


WRONG = (
    ("current_offset", "joint 2"),
    ("channel_offset", "current_2_a"),
    ("channel_drift", "current_2_a"),
    ("channel_offset", "gauge"),
    ("channel_drift", "gauge"),
    ("channel_scale", "gauge"),
    ("channel_scale", "force sensor"),
    ("force_gain", "robot"),
    ("force_tilt", "robot"),
    ("tracker_frame", "robot"),
    ("tracker_drift", "robot"),
    ("tracker_scale", "robot"),
    ("tracker_creep", "tracker"),
)


def told_and_read(compiled: CompiledRobot, acting: Acting) -> tuple[tuple[Quantity, ...], np.ndarray, np.ndarray]:
    """Return quantities, and by how much an effect changes them in the bench's replay and in the second plant."""
    session = LAB.scenario().without("rotations", "line", "dwell")
    before, after = (second(*one, session=session).campaign for one in ((), (acting,)))
    quantities = quantities_of(before.runs, compiled)
    replay = Replay(compiled, segments_of(before, compiled, quantities, 400), quantities)
    told = replay.predict(Hypothesis(acting=(acting,))) - replay.predict(NOMINAL)
    read = np.concatenate([segment.observed for segment in segments_of(after, compiled, quantities, 400)])
    return quantities, told, read - replay.observed


@pytest.mark.parametrize(("name", "where"), WRONG)
def test_both_plants_get_readings_wrong_alike(compiled: CompiledRobot, name: str, where: str) -> None:
    """Signs, axes and units are those of the catalogue."""
    effect = catalogue()[name]
    (place,) = (place for place in LAB.places(effect, compiled) if str(place) == where)
    acting = Acting(effect, place, {p.name: p.high * (1 + i) / 3 for i, p in enumerate(effect.parameters)})
    quantities, told, read = told_and_read(compiled, acting)
    seen = np.isfinite(read)
    assert np.max(np.abs(told[seen])) > 0
    for c in range(len(quantities)):
        here, column = seen[:, c], quantities[c].column
        size = np.max(np.abs(told[here, c]), initial=0.0)
        assert np.max(np.abs(read[here, c] - told[here, c]), initial=0.0) <= ALIKE * size + ROUNDING, column


def test_both_plants_rock_on_a_soft_base_alike(compiled: CompiledRobot) -> None:
    """Links that are accelerated push the foot too; without that a rocking base was named with links that are none."""
    acting = Acting(catalogue()["base_compliance"], WHOLE, {"compliance": 1.7e-7})
    quantities, told, read = told_and_read(compiled, acting)
    for c, quantity in enumerate(quantities):
        if quantity.column.startswith("reflector"):
            assert np.nanmax(np.abs(read[:, c] - told[:, c])) < ALIKE * np.nanmax(np.abs(told[:, c]))


def test_a_channel_of_another_scale_reads_so_many_times_more(compiled: CompiledRobot, quiet: Second) -> None:
    effect = catalogue()["channel_scale"]
    (place,) = (place for place in LAB.places(effect, compiled) if place.name == "current_2_a")
    scaled = second(Acting(effect, place, {"scale": -0.5})).campaign
    for before, after in zip(quiet.campaign.runs, scaled.runs, strict=True):
        assert np.array_equal(after.columns["current_2_a"], 0.5 * before.columns["current_2_a"])
        assert np.array_equal(after.columns["current_1_a"], before.columns["current_1_a"])


def test_where_encoders_are_late_drives_do_everything_early(quiet: Second) -> None:
    """Their accelerations too: without that, a diagnosis found drives that were as late, beside the encoders."""
    late = second(Acting(catalogue()["encoder_delay"], WHOLE, {"delay": DELAY_S})).campaign
    for before, after in zip(quiet.campaign.runs, late.runs, strict=True):
        if before.kind == "static":
            continue
        time, torque = (before.columns[name] for name in ("time_s", "current_2_a"))
        early = np.interp(time + DELAY_S, time, torque)
        left, apart = (np.sqrt(np.mean((after.columns["current_2_a"] - other)[1:-1] ** 2)) for other in (early, torque))
        assert left < 0.5 * apart  # 0.30; it was 2.2. To first order: ramps bend within the delay


def test_gauge_reads_gas_without_the_seals(compiled: CompiledRobot, quiet: Second) -> None:
    """The seals take 5 % of the rod's force; the gauge changes only as joint 2 sags otherwise on its spring."""
    (acting,) = effects_of(["seal_friction=0.05"], compiled, catalogue())
    seen = changes(quiet, acting)
    largest = max(np.max(run.columns["gas_pressure_pa"]) for run in quiet.campaign.runs)
    assert seen["gas_pressure_pa"] < 0.02 * 0.05 * largest
    assert seen["current_2_a"] > 1.0


def test_noise_and_errors_follow_the_seed(compiled: CompiledRobot) -> None:
    scenario = short().without("rotations")
    first, same, other = (run_second(LAB.robot(), scenario, (), rng(seed)).campaign.runs[0] for seed in (5, 5, 6))
    assert all(np.array_equal(first.columns[name], same.columns[name]) for name in first.columns)
    assert not np.array_equal(first.columns["current_1_a"], other.columns["current_1_a"])


def test_chance_moves_links_where_the_world_says_so() -> None:
    """Where links remember, they arrive at the same place whatever the motors' friction; else they do not."""
    session = short().without("rotations")

    def spread(world: World) -> tuple[float, float]:
        runs = [
            run_second(LAB.robot(), session, (), rng(seed), world=world, quiet=True).campaign.runs[0] for seed in (1, 2)
        ]
        first, second = (np.stack([run.columns["reflector_1_z_m"], run.columns["current_2_a"]]) for run in runs)
        unloaded = runs[0].columns["load_step"] == 0  # a load moves motors, too, as far as their friction lets it
        z, current = np.max(np.abs(first - second)[:, unloaded], axis=1)
        return float(z), float(current)

    assert spread(World()) == (0.0, 0.0)
    z, current = spread(World(on_motors=1.0))
    assert current > 0.1
    assert z < 1e-7
    z, _ = spread(World(on_links=1.0))
    assert z > 1e-5
