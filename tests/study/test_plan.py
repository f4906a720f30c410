"""What a study hides."""

import pytest

from bench.effects.catalogue import catalogue
from bench.effects.unlisted import unlisted
from bench.errors import InputError
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from bench.second.effects import CHANGES
from bench.study.labs import Lab
from bench.study.plan import Counts, plan, singles_of, twins_of
from bench.study.worlds import OF_SECOND, WORLDS


@pytest.fixture(scope="module")
def hh150() -> CompiledRobot:
    return compile_robot(load_robot("hh150"))


def test_full_study_is_what_the_design_asks_for(hh150: CompiledRobot) -> None:
    trials = plan(Counts(), hh150, 1)
    kinds = {kind: [t for t in trials if t.kind == kind] for kind in ("null", "single", "unlisted", "pair", "twin")}
    n = len(singles_of(hh150, Lab()))
    assert {kind: len(found) for kind, found in kinds.items()} == {
        "null": 200,
        "single": 6 * n,
        "unlisted": 40,
        "pair": 40,
        "twin": 8,
    }
    assert 600 <= len(trials) <= 800  # a few hours on two cores
    assert sum(t.size == "three limits" for t in kinds["single"]) == 3 * n
    assert {t.effects[0] for t in kinds["unlisted"]} == set(unlisted())
    assert all(len(set(t.effects)) == 2 for t in kinds["pair"])


def test_everything_that_can_act_is_hidden_singly(hh150: CompiledRobot) -> None:
    effects = catalogue()
    singles = singles_of(hh150, Lab())
    assert {effects[name].family for name in singles} == {effect.family for effect in effects.values()}
    missing = set(effects) - set(singles)
    told = {name for name, effect in effects.items() if effect.only_if_told}  # by a first pass, which a study has not
    assert told
    assert all(
        not Lab().places(effects[name], hh150) for name in told
    )  # nor beside what is hidden, as in a messy world
    cold = Lab(without=("gear_temperature",))
    unread = {name for name in missing if cold.places(effects[name], hh150)}
    assert unread == {"friction_warming"}  # looked for where no thermometer shows how warm gears are
    assert all(not effects[name].places(hh150) for name in missing - told - unread)


def test_places_take_turns_at_either_size(hh150: CompiledRobot) -> None:
    trials = [t for t in plan(Counts(seeds=12), hh150, 1) if t.effects == ("softening",) and t.kind == "single"]
    for size in ("three limits", "plausible"):
        assert [t.number % 6 for t in trials if t.size == size] == [0, 1, 2, 3, 4, 5]


def test_every_world_hides_all_kinds(hh150: CompiledRobot) -> None:
    trials = plan(Counts(seeds=1, nulls=2, unlisted=3, pairs=2, worlds=WORLDS), hh150, 1)
    assert len({trial.name for trial in trials}) == len(trials)
    for world in WORLDS:
        kinds = {trial.kind for trial in trials if trial.world == world}
        assert kinds - {"twin"} == {"null", "single", "unlisted", "pair"}
    for trial in trials:
        if trial.world in OF_SECOND:
            assert set(trial.effects) <= set(CHANGES)
        assert trial.kind != "twin" or trial.world == "plain"


def test_an_effect_that_cannot_act_is_named(hh150: CompiledRobot) -> None:
    with pytest.raises(InputError, match="counterbalance_gas"):
        plan(Counts(effects=("gas_loss", "counterbalance_gas")), hh150, 1)


def test_every_campaign_has_random_numbers_of_its_own(hh150: CompiledRobot) -> None:
    trials = plan(Counts(), hh150, 1)
    first = [trial.rng(1).random() for trial in trials]
    assert len(set(first)) == len(trials)
    assert [trial.rng(1).random() for trial in plan(Counts(), hh150, 1)] == first
    assert all(a != trial.rng(2).random() for a, trial in zip(first, trials, strict=True))


def test_twins_exist_on_the_robot(hh150: CompiledRobot) -> None:
    effects = catalogue()
    for twin in twins_of(hh150):
        for name, place in (twin.hidden, twin.other):
            assert place in [str(one) for one in effects[name].places(hh150)]
        assert twin.ordinary != twin.extra
        assert twin.ordinary.scenario()
        assert twin.extra.compiled()


def test_session_is_told_in_words() -> None:
    assert "runs on hh150" in Lab().words()
