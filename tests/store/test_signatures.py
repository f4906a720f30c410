"""Signatures on disk: found again where everything is the same, simulated anew where anything is not."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from bench.diagnose.linearise import signature_key
from bench.diagnose.linearise.reference_motion import SAME_ACCELERATION, SAME_ANGLE, SAME_LOAD, SAME_VELOCITY
from bench.diagnose.replay.nuisances import nuisances_of
from bench.diagnose.replay.segments import Segment
from bench.diagnose.replay.world import World
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.store.store import Store
from tests.store.small_signatures import CATALOGUE, NAMES, QUANTITIES, causes_of, learned, same, sweep


def test_the_second_time_nothing_is_simulated(compiled: CompiledRobot, store: Store, simulated: list[str]) -> None:
    first = learned(compiled, store, sweep())
    assert set(simulated) == {"nuisance", *NAMES}
    simulated.clear()
    again = learned(compiled, store, sweep())
    assert simulated == []
    assert same(first, again)
    assert same(first, learned(compiled, None, sweep()))
    assert {entry.label.split(",")[0] for entry in store.entries()} == {"small"}


def moved(segment: Segment, name: str, by: float, joint: int = 0) -> Segment:
    values = getattr(segment.motion, name).copy()
    values[..., joint] += by
    return replace(segment, motion=replace(segment.motion, **{name: values}))


NEAR = {
    "q": moved(sweep(), "q", 0.5 * SAME_ANGLE),
    "velocity": moved(sweep(), "velocity", 0.5 * SAME_VELOCITY * 0.4),
    "acceleration": moved(sweep(), "acceleration", 0.5 * SAME_ACCELERATION * 0.01),
    "wrench": moved(sweep(), "wrench", 0.5 * SAME_LOAD * 100, 2),
}
FAR = {
    "q": moved(sweep(), "q", 2 * SAME_ANGLE),
    "velocity": moved(sweep(), "velocity", 2 * SAME_VELOCITY * 0.4),
    "acceleration": moved(sweep(), "acceleration", 2 * SAME_ACCELERATION * 0.01),
    "wrench": moved(sweep(), "wrench", 2 * SAME_LOAD * 100, 2),
    "moment": moved(sweep(), "wrench", 0.001, 4),
    "standing": moved(sweep(), "velocity", 1e-9, 1),
    "time": replace(sweep(), motion=replace(sweep().motion, time=sweep().motion.time + 2e-6)),
    "direction": sweep(speed=-0.4),
    "payload": sweep(payload=5.0),
    "name": replace(sweep(), label="another"),
}


@pytest.mark.parametrize("near", NEAR.values(), ids=NEAR)
def test_another_campaign_of_the_session_finds_them(
    compiled: CompiledRobot, store: Store, simulated: list[str], near: Segment
) -> None:
    first = learned(compiled, store, sweep())
    simulated.clear()
    assert same(first, learned(compiled, store, near))
    assert simulated == []


@pytest.mark.parametrize("far", FAR.values(), ids=FAR)
def test_another_motion_is_simulated(compiled: CompiledRobot, store: Store, simulated: list[str], far: Segment) -> None:
    learned(compiled, store, sweep())
    simulated.clear()
    assert same(learned(compiled, store, far), learned(compiled, None, far))
    assert set(simulated) == {"nuisance", *NAMES}


def test_the_nearest_motion_counts(compiled: CompiledRobot, store: Store) -> None:
    at, beyond = sweep(), moved(sweep(), "q", 1.5 * SAME_ANGLE)
    first = learned(compiled, store, at)
    second = learned(compiled, store, beyond)
    assert not same(first, second)
    for _ in range(2):  # whichever was used last
        assert same(learned(compiled, store, moved(sweep(), "q", 0.7 * SAME_ANGLE)), first)
        assert same(learned(compiled, store, moved(sweep(), "q", 0.8 * SAME_ANGLE)), second)


def test_what_is_missing_is_simulated_along_the_same_motion(compiled: CompiledRobot, store: Store) -> None:
    """The key says along which motion, so a campaign that borrows it must not put its own there."""
    some, more = [CATALOGUE["coulomb_level"]], [CATALOGUE["coulomb_level"], CATALOGUE["joint_compliance"]]
    learned(compiled, store, sweep(), some)
    by_borrower = learned(compiled, store, NEAR["q"], more)
    assert same(by_borrower, learned(compiled, None, sweep(), more))


def test_other_temperatures_concern_what_feels_them(
    compiled: CompiledRobot, store: Store, simulated: list[str]
) -> None:
    learned(compiled, store, sweep())
    simulated.clear()
    warm = learned(compiled, store, sweep(warm=320.0))
    assert set(simulated) == {"friction_temperature", "torque_constant_temperature"}
    assert same(warm, learned(compiled, None, sweep(warm=320.0)))


def figures_changed(compiled: CompiledRobot) -> CompiledRobot:
    robot = compiled.robot
    uncertainty = robot.figures.uncertainty.model_copy(update={"mass": 0.02})
    return compile_robot(replace(robot, figures=robot.figures.model_copy(update={"uncertainty": uncertainty})))


def mjcf_changed(compiled: CompiledRobot, old: str, new: str, folder: Path) -> CompiledRobot:
    """Return a copy of the robot with its MJCF changed."""
    source = compiled.robot.folder
    target = folder / "changed"
    target.mkdir()
    for file in source.iterdir():
        text = file.read_text()
        (target / file.name).write_text(text.replace(old, new) if file == compiled.robot.mjcf else text)
    assert (target / compiled.robot.mjcf.name).read_text() != compiled.robot.mjcf.read_text()
    return compile_robot(replace(compiled.robot, folder=target))


@pytest.mark.parametrize(
    "change",
    ["figures", "mass", "coulomb", "default", "mujoco", "numpy", "code", "quantities", "around", "sizes", "sigma"],
)
def test_whatever_changes_is_simulated_anew(
    compiled: CompiledRobot,
    store: Store,
    simulated: list[str],
    change: str,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    learned(compiled, store, sweep())
    simulated.clear()
    expected = {"nuisance", *NAMES}
    other: dict[str, Any] = {}
    match change:
        case "figures":
            compiled = figures_changed(compiled)
        case "mass":
            compiled = mjcf_changed(compiled, 'mass="40.0"', 'mass="40.5"', tmp_path)
        case "coulomb":  # of a plugin
            compiled = mjcf_changed(compiled, 'key="coulomb" value="60.0"', 'key="coulomb" value="61.0"', tmp_path)
        case "default":  # the compiled model does not show it, an effect that adds a joint would
            default = '<default><default class="x"><joint damping="3"/></default></default><compiler'
            compiled = mjcf_changed(compiled, "<compiler", default, tmp_path)
        case "mujoco":
            monkeypatch.setattr(signature_key.mujoco, "__version__", "4.0.1")
        case "numpy":
            monkeypatch.setattr(signature_key.np, "__version__", "9.0")
        case "code":
            monkeypatch.setattr(signature_key, "source_of_bench", lambda: "other")
        case "quantities":
            other = {"quantities": QUANTITIES[:1]}
        case "around":
            effect = CATALOGUE["coulomb_level"]
            (cause, *_) = causes_of(compiled, [effect])
            other = {"around": World(acting=(cause.acting({"change": 0.3}),))}
        case "sizes":
            (first, *rest) = causes_of(compiled, [CATALOGUE[name] for name in NAMES])
            sizes = tuple(replace(size, high=2 * size.high) for size in first.sizes)
            other, expected = {"causes": (replace(first, sizes=sizes), *rest)}, {"coulomb_level"}
        case "sigma":
            (one, *more) = nuisances_of(compiled, QUANTITIES)
            other, expected = {"nuisances": (replace(one, sigma=2 * one.sigma), *more)}, {"nuisance"}
    learned(compiled, store, sweep(), **other)
    assert set(simulated) == expected


def test_fewer_places_are_other_columns(compiled: CompiledRobot, store: Store, simulated: list[str]) -> None:
    learned(compiled, store, sweep())
    simulated.clear()
    causes = [cause for cause in causes_of(compiled, [CATALOGUE["coulomb_level"]]) if cause.place.index]
    found = learned(compiled, store, sweep(), causes=tuple(causes))
    assert simulated == ["coulomb_level"]
    assert same(found, learned(compiled, None, sweep(), causes=tuple(causes)))


def test_damaged_signatures_are_simulated_again(compiled: CompiledRobot, store: Store, simulated: list[str]) -> None:
    first = learned(compiled, store, sweep())
    for file in store.folder.glob("*.entry"):
        content = bytearray(file.read_bytes())
        content[-1] ^= 1
        file.write_bytes(content)
    simulated.clear()
    assert same(first, learned(compiled, store, sweep()))
    assert set(simulated) == {"nuisance", *NAMES}


def test_a_store_that_cannot_be_written_changes_nothing(compiled: CompiledRobot, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    assert same(learned(compiled, Store(tmp_path / "file"), sweep()), learned(compiled, None, sweep()))
