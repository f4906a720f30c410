"""A diagnosis that is stopped ends with what it has; clocks stand still or jump, no second passes."""

from collections.abc import Mapping
from itertools import count

import pytest

from bench.diagnose.diagnose import Diagnosis, diagnose
from bench.diagnose.verdict import Verdict
from bench.effects.catalogue import catalogue
from bench.effects.effect import Effect
from bench.executor.contract import Executor
from bench.executor.processes import Processes
from bench.executor.serial import SERIAL
from bench.executor.watched import Stop, Stopped
from bench.record.campaign import Campaign
from bench.report.diagnosis.headline import headline
from bench.store.store import Store
from tests.diagnose.sweeps import SWEEPS, made, nominal

CHOICE = ("coulomb_level", "gas_loss", "gas_temperature")


@pytest.fixture(scope="module")
def campaign() -> Campaign:
    return made(SWEEPS, seed=3, hidden={"gas_loss": 0.15})


@pytest.fixture(scope="module")
def effects() -> Mapping[str, Effect]:
    return {name: catalogue()[name] for name in CHOICE}


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Store:
    return Store(tmp_path_factory.mktemp("signatures"))


@pytest.fixture(scope="module")
def whole(campaign: Campaign, effects: Mapping[str, Effect], store: Store) -> Verdict:
    return stopped_at("nobody says this", campaign, effects, store=store).verdict


def stopped_at(
    words: str,
    campaign: Campaign,
    effects: Mapping[str, Effect],
    executor: Executor = SERIAL,
    store: Store | None = None,
) -> Diagnosis:
    """Diagnose until a phase begins."""
    now = [0.0]
    stop = Stop(60.0, clock=lambda: now[0])

    def tell(said: str) -> None:
        if said.startswith(words):
            now[0] = 61.0

    return diagnose(campaign, nominal(), effects, progress=tell, executor=executor, check=stop.check, store=store)


@pytest.mark.parametrize("executor", [SERIAL, Processes(2)], ids=["serial", "processes"])
def test_without_signatures_nothing_is_weighed(
    campaign: Campaign, effects: Mapping[str, Effect], executor: Executor
) -> None:
    with pytest.raises(Stopped, match="60 s"):
        stopped_at("signatures", campaign, effects, executor)


def test_the_clock_is_looked_at_between_simulated_worlds(campaign: Campaign, effects: Mapping[str, Effect]) -> None:
    """Each look at the clock takes a second, and there is one for each world."""
    ticks = count()
    with pytest.raises(Stopped, match="9 s"):
        diagnose(campaign, nominal(), effects, check=Stop(9.0, lambda: float(next(ticks))).check)
    assert next(ticks) == 10


@pytest.mark.parametrize("executor", [SERIAL, Processes(2)], ids=["serial", "processes"])
def test_before_the_first_step_nothing_is_found_so_far(
    campaign: Campaign, effects: Mapping[str, Effect], executor: Executor
) -> None:
    verdict = stopped_at("fitting", campaign, effects, executor).verdict
    assert verdict.kind == "nothing found so far"
    assert verdict.unfinished
    assert verdict.unfinished.during.startswith("fitting")
    assert "gas_loss" in [cause.effect for cause in verdict.unfinished.promising]
    assert headline(verdict).startswith("Unfinished (ended after 60 s, during: fitting ")
    assert headline(verdict).endswith(": nothing was found so far.")


@pytest.mark.parametrize("words", ["what the extended model", "gain of each"])
def test_what_the_search_has_found_is_kept(
    words: str, campaign: Campaign, effects: Mapping[str, Effect], store: Store
) -> None:
    diagnosis = stopped_at(words, campaign, effects, store=store)
    verdict = diagnosis.verdict
    assert verdict.unfinished
    assert verdict.kind == "cause"
    assert verdict.unfinished.during.startswith(words)
    assert verdict.explanations[0].causes[0].effect in ("gas_loss", "gas_temperature")
    assert verdict.gain == ()
    assert headline(verdict).startswith("Unfinished (ended after 60 s, during: ")
    assert diagnosis.extension is not None


def test_figures_have_changed_as_the_model_with_what_was_found_has_them(
    campaign: Campaign, effects: Mapping[str, Effect], store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They were those of the model without: beside a payload of 1.2 kg, a link that had lost 99.9 % of its mass."""
    asked: list[object] = []
    monkeypatch.setattr("bench.diagnose.diagnose.changed_figures", lambda linear, fit: asked.append(fit) or ())
    diagnosis = stopped_at("gain of each", campaign, effects, store=store)
    assert diagnosis.extension is not None
    assert asked == [diagnosis.extension]


@pytest.mark.parametrize("words", ["gain on", "the next", "what this campaign"])
def test_what_follows_the_naming_is_left_out(
    words: str, campaign: Campaign, effects: Mapping[str, Effect], store: Store, whole: Verdict
) -> None:
    verdict = stopped_at(words, campaign, effects, store=store).verdict
    assert verdict.unfinished
    assert verdict.unfinished.promising == ()
    assert verdict.explanations == whole.explanations
    if words == "what this campaign":
        assert verdict.gain == whole.gain


def test_a_diagnosis_that_is_not_stopped_is_finished(whole: Verdict) -> None:
    assert whole.unfinished is None
    assert whole.as_json()["unfinished"] is None
    assert not headline(whole).startswith("Unfinished")


def test_what_was_not_held_against_anything_is_not_confirmed(
    campaign: Campaign, effects: Mapping[str, Effect], store: Store, whole: Verdict
) -> None:
    """Every finding of a diagnosis that was stopped while it fitted was called confirmed."""
    found = stopped_at("gain of each finding", campaign, effects, store=store).verdict
    assert found.unfinished
    assert found.findings
    assert not any(group.is_confirmed for group in found.findings)
    assert all(group.is_confirmed for group in whole.findings)
