"""Robots that differ in friction, stiffness or gravity alone are made from one another, and are the compiled ones."""

from collections.abc import Mapping
from typing import Any

import mujoco
import numpy as np
import pytest

from bench.diagnose.replay.world import World, steps_of
from bench.effects.catalogue import catalogue
from bench.effects.conditions import Conditions
from bench.effects.effect import Acting, Place
from bench.robot.compiled import SpecEdit
from bench.robot.folder import load_robot
from bench.robot.patched import Step
from bench.robot.patching.structure import CompiledStructure
from bench.simulate.payload import bolt_on
from tests.robot.both import Both, assert_same


@pytest.fixture
def written(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """How many numbers were written each time that all of them were."""
    counts, write = list[int](), CompiledStructure._write_all

    def counted(structure: CompiledStructure, model: mujoco.MjModel, numbers: Mapping[Any, Any]) -> None:
        counts.append(len(numbers))
        write(structure, model, numbers)

    monkeypatch.setattr(CompiledStructure, "_write_all", counted)
    return counts


@pytest.fixture
def both() -> Both:
    return Both(load_robot("hh150"))


def edit_of(both: Both, name: str, values: Mapping[str, float], gear_k: float = 308.15) -> SpecEdit:
    effect = catalogue()[name]
    places = effect.places(both.nominal)
    place = next((one for one in places if one.index == 1), places[0])
    known = {one.name: one.null if one.is_shape else one.typical for one in effect.parameters_at(both.nominal, place)}
    found = effect.edit(place, effect.complete({**known, **values}), Conditions(np.full(6, gear_k), np.full(6, gear_k)))
    assert found
    return found


@pytest.mark.parametrize("structural", [(), ("transmission_error",), ("unstated_payload",)])
def test_runs_that_differ_in_temperature_share_all_but_friction(
    both: Both, written: list[int], structural: tuple[str, ...]
) -> None:
    others = [
        edit_of(both, name, {}) for name in ("link_mass", "link_com", "gas_loss", "joint_compliance", *structural)
    ]
    for gear_k in (295.0, 300.0, 305.0, 295.0):
        warm = [edit_of(both, name, {}, gear_k) for name in ("friction_temperature", "compliance_temperature")]
        assert_same(both.patched([*others, *warm]), both.compiled([*others, *warm]))
    assert len(written) == 1


def test_what_moves_or_weighs_is_written_anew(both: Both, written: list[int]) -> None:
    warm = edit_of(both, "friction_temperature", {})
    light, heavy = (edit_of(both, "link_com", {"x": x, "y": 0.0, "z": 0.0}) for x in (0.01, 0.02))
    for edits in ([light, warm], [heavy, warm], [bolt_on(30.0), heavy, warm], [warm], [bolt_on(30.0), light, warm]):
        written.clear()
        assert_same(both.patched(edits), both.compiled(edits))
        assert written


def test_gas_is_that_of_each_robot(both: Both) -> None:
    """Robots that have all numbers in common may differ in the texts of their gas alone."""
    for lost, x in ((0.1, 0.01), (0.2, 0.02)):
        com = edit_of(both, "link_com", {"x": x, "y": 0.0, "z": 0.0})
        gas, more = (edit_of(both, "gas_loss", {"lost": share}) for share in (lost, 2 * lost))
        for edits in ([com, gas], [com, more], [com], [gas], []):
            assert_same(both.patched(edits), both.compiled(edits))


def test_robots_of_as_many_runs_as_a_day_has_are_made_once(both: Both) -> None:
    """Of 47 runs that differ in temperature each was made twice for one simulation: first those of 12 were kept."""
    runs = [[edit_of(both, "friction_temperature", {}, gear_k)] for gear_k in np.linspace(295.0, 310.0, 100)]
    first = [both.patched(edits) for edits in runs]
    assert all(both.patched(edits) is robot for edits, robot in zip(runs, first, strict=True))


def test_a_robot_that_somebody_changed_changes_no_other(both: Both) -> None:
    first, second = (edit_of(both, "friction_temperature", {}, gear_k) for gear_k in (300.0, 310.0))
    com = edit_of(both, "link_com", {"x": 0.01, "y": 0.0, "z": 0.0})
    both.patched([com, first]).model.body_mass[:] = 1.0
    assert_same(both.patched([com, second]), both.compiled([com, second]))


def test_steps_that_no_temperature_changes_are_taken_once(both: Both) -> None:
    friction, warm = (catalogue()[name] for name in ("coulomb_level", "friction_temperature"))
    place: Place = friction.places(both.nominal)[1]
    acting = (Acting(friction, place, {"change": 0.2}), Acting(warm, place, {"decrease": 0.02}))
    by_run: list[list[Step]] = [
        steps_of(World(acting=acting), Conditions(np.full(6, k), np.full(6, k), time_s=k)) for k in (295.0, 300.0)
    ]
    same = [one.key == other.key for one, other in zip(*by_run, strict=True)]
    assert same == [True, True, False]  # nothing bolted on, friction, what a temperature changes
