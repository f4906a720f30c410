"""What a study hides."""

from itertools import groupby

import pytest

from bench.effects.catalogue import catalogue
from bench.effects.unlisted import unlisted
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from bench.study.labs import Lab
from bench.study.plan import EFFECTS, Counts, plan, twins_of


@pytest.fixture(scope="module")
def hh150() -> CompiledRobot:
    return compile_robot(load_robot("hh150"))


def test_full_study_is_what_the_design_asks_for(hh150: CompiledRobot) -> None:
    trials = plan(Counts(), hh150, 1)
    kinds = {kind: [t for t in trials if t.kind == kind] for kind in ("null", "single", "unlisted", "pair", "twin")}
    assert {kind: len(found) for kind, found in kinds.items()} == {
        "null": 200,
        "single": 400,
        "unlisted": 40,
        "pair": 40,
        "twin": 8,
    }
    assert sum(t.size == "three limits" for t in kinds["single"]) == 200
    assert {t.effects[0] for t in kinds["unlisted"]} == set(unlisted())
    assert all(len(set(t.effects)) == 2 for t in kinds["pair"])


def test_single_effects_are_of_every_family_of_the_machine(hh150: CompiledRobot) -> None:
    effects = catalogue()
    assert len(set(EFFECTS)) >= 20
    assert {effects[name].family for name in EFFECTS} == {
        effect.family for effect in effects.values() if effect.level == "machine"
    }
    assert all(effects[name].places(hh150) for name in EFFECTS)
    families = [family for family, _ in groupby(effects[name].family for name in EFFECTS)]
    assert len(families) == len(set(families))


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
