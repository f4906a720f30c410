"""What a robot has none of cannot become less, unless it had some that its model lacks: two things are said then."""

from pathlib import Path

import numpy as np
import pytest

from bench.compare.explain import NONE_TO_LOSE, advice_of
from bench.compare.profiles import profiles_of
from bench.compare.search_changes import Found, find_changes, signs_of
from bench.diagnose.linearise.candidates import Candidate, Cause
from bench.diagnose.linearise.screening import Entry
from bench.effects.catalogue import catalogue
from bench.effects.conditions import Conditions
from bench.effects.effect import Place
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot, compile_robot, compile_spec, read_spec
from bench.robot.fitted import Fitted, FittedEffect
from bench.robot.folder import load_robot
from bench.robot.write import write_robot
from tests.compare.once import seen_once
from tests.diagnose.sweeps import nominal

READINGS = 50
RATE = 0.01
SIZE = 6.0  # of the change, in standard errors
MODEL_HAS = {"stribeck": "rise", "load_friction": "coefficient", "backlash": "gap"}


def place_of(name: str) -> Place:
    return catalogue()[name].places(nominal())[0]


def with_some(name: str, size: float, folder: Path) -> CompiledRobot:
    """Return the robot as written into a new folder with an effect in it, half of it added to the other half."""
    place, effect, robot = place_of(name), catalogue()[name], load_robot("hh150")
    half = effect.edit(place, effect.complete({effect.parameters[0].name: size / 2}), Conditions.reference(6))
    assert half
    spec = read_spec(robot)
    compile_spec(spec, robot, [half, half])
    write_robot(robot, spec, robot.figures, folder, "")
    return compile_robot(load_robot(folder))


def entry_of(name: str, columns: Array, at: int) -> Entry:
    """Return a cause with one size whose largest plausible value changes readings by far more than their errors."""
    effect, place = catalogue()[name], place_of(name)
    sizes = tuple(one for one in effect.parameters_at(nominal(), place) if not one.is_shape)
    candidate = Candidate(Cause(effect, place, sizes, ()), {}, np.ones(1), np.full(1, 10 * SIZE), columns)
    return Entry(candidate, np.array([at]), ((candidate.prior, 0.0),))


def found_of(change: float, robot: CompiledRobot) -> Found:
    """Return what is said of a change that two causes explain alike."""
    column = np.full((READINGS, 1), READINGS**-0.5)
    entries = tuple(entry_of(name, column, i) for i, name in enumerate(("load_friction", "coulomb_level")))
    columns = np.repeat(column, 2, axis=1)
    background = seen_once(entries, columns, change * column[:, 0], robot)
    return find_changes(background, profiles_of(1, np.array([np.nan, np.nan])), RATE)


def odds_of(found: Found, name: str) -> float:
    """Return the log posterior odds of a cause alone."""
    return next(one.log_posterior for one in found.alternatives if [key[0] for key in one.keys] == [name])  # type: ignore[index]


def test_what_the_model_has_none_of_hardly_becomes_less() -> None:
    """For Coulomb friction that fell "friction grows with the torque" was named first, with a negative coefficient."""
    found = found_of(-SIZE, nominal())
    assert [one.entry.cause.effect.name for one in found.best if one.entry.cause] == ["coulomb_level"]
    two_claims = found.screened[0].threshold - np.log(2)  # a prior of one sign is twice as high on its side
    assert odds_of(found, "coulomb_level") - odds_of(found, "load_friction") == pytest.approx(two_claims, abs=1e-6)
    alone = [one.best.terms[0] for one in found.alternatives if len(one.keys) == 1]
    assert [advice_of(found.possible[term]) for term in alone] == ["", NONE_TO_LOSE]


def test_it_may_become_more_and_less_of_what_there_is(tmp_path: Path) -> None:
    more, less = found_of(SIZE, nominal()), found_of(-SIZE, with_some("load_friction", 0.03, tmp_path / "robot"))
    assert odds_of(more, "load_friction") - odds_of(more, "coulomb_level") == pytest.approx(np.log(2), abs=1e-6)
    assert odds_of(less, "load_friction") == pytest.approx(odds_of(less, "coulomb_level"))


@pytest.mark.parametrize("name", MODEL_HAS)
def test_what_a_model_has_of_it_may_fall_and_is_added_to(name: str, tmp_path: Path) -> None:
    effect, place, size = catalogue()[name], place_of(name), MODEL_HAS[name]
    value = effect.parameters[0].typical
    robot = with_some(name, value, tmp_path / "robot")
    assert effect.there_already(nominal(), place) == {size: 0.0}
    assert effect.there_already(robot, place)[size] == pytest.approx(value)
    entry = entry_of(name, np.ones((READINGS, 1)), 0)
    assert [(sign.tolist(), claims) for sign, claims in signs_of(entry, robot)] == [([0.0], 1)]
    assert [(sign.tolist(), claims) for sign, claims in signs_of(entry, nominal())] == [([1.0], 1), ([-1.0], 2)]


def test_what_figures_hold_as_fitted_may_fall() -> None:
    """Of the effects that no MJCF holds, the figures say how much there is."""
    robot = load_robot("hh150")
    joint = robot.figures.drives[1].joint
    entry = FittedEffect(effect="torque_saturation", place=joint, values={"curvature": 3e-5}, form={})
    figures = robot.figures.model_copy(update={"fitted": Fitted(effects=(entry,))})
    machine = compile_robot(type(robot)(**{**vars(robot), "figures": figures}))
    effect = catalogue()["torque_saturation"]
    there = [effect.there_already(machine, Place("joint", j, robot.figures.drives[j].joint)) for j in (0, 1)]
    assert there == [{}, {"curvature": 3e-5}]


def test_gas_may_be_filled_in_again() -> None:
    """A loss is told from the charge as stated; a cylinder that was filled says nothing of what was there before."""
    signs = signs_of(entry_of("gas_loss", np.ones((READINGS, 1)), 0), nominal())
    assert [(sign.tolist(), claims) for sign, claims in signs] == [([0.0], 1)]
