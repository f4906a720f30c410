"""Several recordings of one machine: what is drawn, what counts as right, and a small study from end to end."""

import json
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.effects.effect import Acting
from bench.errors import InputError
from bench.report.study.several import NUMBERS, lines_of, write_several
from bench.study.changes import Outcome as ChangeOutcome
from bench.study.labs import Lab, Setup, prepare
from bench.study.machines import MachineTrial, components_in, machine_of, recorded
from bench.study.several import (
    ROWS,
    JointAnswer,
    JointFinding,
    SeveralOutcome,
    SeveralSettings,
    answered,
    run_several,
)
from bench.study.several_scores import several_goals
from bench.study.worlds import OF_MACHINES, MachineWorld, world_of_machines
from tests.study.stub_several import Instant

SMALL = Lab(without=("loading", "repeat_at_end", "line", "dwell", "tracker", "pressure"), is_brief=True)
FEW = {name: catalogue()[name] for name in ("coulomb_level", "viscous_level", "payload_mass", "current_offset")}
GAS = ("gas_loss", "robot")
FOUND = JointFinding((GAS, ("gas_temperature", "robot")), True, 2, True)
RIGHT = JointAnswer("gas_loss", GAS, "", (FOUND,), False, 10, 1, 0)


@cache
def setup() -> Setup:
    return prepare(SMALL, FEW, np.random.default_rng(1))


def outcome(
    name: str, kind: str, joint: JointAnswer | None = None, change: ChangeOutcome | None = None
) -> SeveralOutcome:
    return SeveralOutcome(name, kind, joint, change, "", 1.0, 1.0)  # type: ignore[arg-type]


@pytest.mark.parametrize("world", OF_MACHINES)
def test_what_acts_in_one_recording_acts_in_no_other(world: MachineWorld) -> None:
    machine = machine_of(MachineTrial("one", 0, 3, ("coulomb_level",), world), setup(), 5)
    assert machine.hidden
    assert machine.only in machine.recordings
    assert [name for name, own in machine.own.items() if machine.hidden.acting in own] == [machine.only]
    assert machine.hidden.acting not in machine.everywhere
    place = str(machine.hidden.acting.place)
    assert ("coulomb_level", place) not in machine.truth, "it is not the machine's"
    assert ("coulomb_level", f"{place.replace('joint', 'drive')} in recording {machine.only}") in machine.truth


@pytest.mark.parametrize("world", OF_MACHINES)
def test_what_is_set_up_anew_is_another_one_in_each_recording(world: MachineWorld) -> None:
    machine = machine_of(MachineTrial("machine", 0, 2, ("coulomb_level",), world), setup(), 5)
    payloads = [
        one.values["change"] for own in machine.own.values() for one in own if one.effect.name == "payload_mass"
    ]
    assert len(payloads) == len(set(payloads)) == 2
    assert machine.campaign.recordings == ("day1", "day2")
    assert machine.hidden
    assert machine.hidden.acting in machine.everywhere


@pytest.mark.parametrize("world", OF_MACHINES)
def test_an_effect_is_in_the_readings_of_its_recording_and_nowhere_else(world: MachineWorld) -> None:
    effect = FEW["current_offset"]
    place = effect.places(setup().compiled)[1]
    offset = 0.5  # [A], whole steps of the sensor
    acting = (Acting(effect, place, {"offset": offset}),)
    without, there, again = (
        recorded(SMALL, own, np.random.default_rng(1), 7, world).runs for own in ((), acting, acting)
    )
    for before, after, same in zip(without, there, again, strict=True):
        changed = {name: np.unique(np.round(after.columns[name] - x, 9)) for name, x in before.columns.items()}
        assert changed.pop("current_2_a") == [offset]
        assert all(list(change) == [0] for change in changed.values())
        assert all(np.array_equal(values, same.columns[name]) for name, values in after.columns.items())


def test_the_second_plant_draws_what_it_knows() -> None:
    every = prepare(SMALL, FEW | {"anchor": catalogue()["anchor"]}, np.random.default_rng(1))
    assert "anchor" in {effect.name for effect, _ in components_in("messy", every)}
    for world in ("second", "resting"):
        assert {effect.name for effect, _ in components_in(world, every)} == set(FEW)


def test_a_machine_has_another_name_and_other_numbers_in_each_world() -> None:
    trials = [MachineTrial("none", 0, 2, world=world) for world in OF_MACHINES]
    assert [trial.name for trial in trials] == ["none 1", "second none 1", "resting none 1"]
    assert len({float(trial.rng(1).random()) for trial in trials}) == len(trials)


def test_what_cannot_be_hidden_in_a_world_is_refused_before_anything_is_made() -> None:
    assert SeveralSettings(code="test", effects=("anchor",)).effects == ("anchor",)
    with pytest.raises(InputError, match="anchor"):
        SeveralSettings(code="test", effects=("anchor",), world="second")
    for nowhere in ("coulomb_friction", "spring_balancer"):  # friction is stated; a study makes no first pass
        with pytest.raises(InputError, match=nowhere):  # it was a ZeroDivisionError in the first machine
            SeveralSettings(code="test", effects=(nowhere,))


def test_worlds_in_which_no_machine_is_recorded_several_times_are_refused() -> None:
    assert world_of_machines(()) == "messy"
    assert world_of_machines(("second",)) == "second"
    for asked in (("presliding",), ("plain",), ("messy", "second")):
        with pytest.raises(InputError, match="messy, second, resting"):
            world_of_machines(asked)


def test_a_cause_of_one_recording_is_right_there_and_wrong_as_the_machines() -> None:
    assert RIGHT.is_right
    one = replace(RIGHT, only="day2")
    assert not one.is_right
    assert one.is_called_machines
    there = replace(FOUND, names=(("gas_loss", "robot in recording day2"),), is_machine=False)
    assert replace(one, findings=(there,)).is_right
    assert not replace(one, findings=(there,)).is_called_machines


def test_goals_count_what_they_say() -> None:
    quiet = ChangeOutcome("", 0.0, 0.0, 0.0, False, "", False, False, False, False)
    seen = ChangeOutcome("gas", 0.25, 2.0, 8.0, True, "gas", True, True, True, True)
    outcomes = [
        outcome("machine 1", "machine", RIGHT),
        outcome("one 1", "one", replace(RIGHT, only="day2", promised=0, more=0)),
        outcome("unchanged 1", "unchanged", change=quiet),
        outcome("changed 1", "changed", change=seen),
        outcome("changed 2", "changed", change=replace(quiet, hidden="small", times=0.5)),
    ]
    found = {goal.name: (goal.share.hits, goal.share.of, goal.is_met) for goal in several_goals(outcomes)}
    assert found["causes of the machine named as the machine's"] == (1, 1, True)
    assert found["causes of one recording called the machine's"] == (1, 1, False)
    assert found["promised 90 % intervals of the last recording that hold"] == (9, 10, True)
    assert found["unchanged machines with a change named"] == (0, 1, True)
    assert found["changes at a quarter of the absolute limit: right first"] == (1, 2, False)
    assert found["of those that the comparison says it would find: right first"] == (1, 1, True)


def test_intervals_that_hold_too_often_are_too_wide() -> None:
    for broken, is_met in ((0, False), (10, True), (20, False)):
        (goal,) = (
            goal
            for goal in several_goals([outcome("none 1", "none", replace(RIGHT, promised=100, more=broken))])
            if goal.name.startswith("promised")
        )
        assert goal.share.hits == 100 - broken
        assert goal.is_met is is_met


def test_a_brief_study_is_another_one() -> None:
    settings = SeveralSettings(3, code="test", brief=True, kinds=("none",))
    assert {trial.kind for trial in settings.trials} == {"none"}
    assert settings != replace(settings, brief=False)


def test_a_row_comes_back_as_it_was_written() -> None:
    one = outcome("machine 1", "machine", RIGHT)
    assert SeveralOutcome.from_json(one.as_json()) == one


def test_a_study_goes_on_where_it_was_stopped(tmp_path: Path) -> None:
    settings = SeveralSettings(machines=2, code="test")
    done: list[str] = []
    first = run_several(settings, tmp_path, work=Instant(settings, done))
    assert [one.name for one in first] == [trial.name for trial in settings.trials]
    lines = (tmp_path / ROWS).read_text().splitlines()
    (tmp_path / ROWS).write_text("\n".join(lines[:4]) + "\n")
    done.clear()
    assert run_several(settings, tmp_path, work=Instant(settings, done)) == first
    assert len(done) == len(settings.trials) - 3
    goals = several_goals(first)
    assert any(line.startswith("met") for line in lines_of(goals))
    content = json.loads(write_several(goals, first, settings, tmp_path).read_text())
    assert (tmp_path / NUMBERS).exists()
    assert len(content["machines"]) == len(settings.trials)


@pytest.mark.parametrize("world", [pytest.param("messy", marks=pytest.mark.study), "second"])
def test_a_machine_is_recorded_diagnosed_and_predicted(world: MachineWorld) -> None:
    joint = answered(MachineTrial("machine", 0, 2, ("coulomb_level",), world), setup(), 5).joint
    assert joint
    assert joint.cause
    assert joint.promised > 0
    assert joint.more + joint.less <= joint.promised
    change = answered(MachineTrial("changed", 0, 2, world=world), setup(), 5).change
    assert change
    assert change.hidden
