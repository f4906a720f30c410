"""A short blind run: hidden by the simulation in time, found by the replay, with few effects to choose from."""

from types import SimpleNamespace
from typing import Any

import pytest

from bench.diagnose.diagnose import Diagnosis, diagnose
from bench.diagnose.extend import polish
from bench.diagnose.name import rivals
from bench.diagnose.name.rivals import IN_SET
from bench.diagnose.name.trials import Hypothesis
from bench.effects.catalogue import catalogue
from bench.errors import ConvergenceError
from tests.diagnose.sweeps import SWEEPS, made, nominal

CHOICE = ("coulomb_level", "viscous_level", "torque_constant", "gas_loss", "current_offset")


def found(hidden: dict[str, float], seed: int) -> Diagnosis:
    effects = catalogue()
    return diagnose(made(SWEEPS, seed, hidden), nominal(), {name: effects[name] for name in CHOICE})


@pytest.mark.parametrize(("name", "value"), [("coulomb_level", 0.6), ("gas_loss", 0.15)])
def test_hidden_effect_is_named_in_its_joint(name: str, value: float) -> None:
    verdict = found({name: value}, seed=3).verdict
    assert verdict.kind in ("cause", "several causes")
    named = [(cause.effect, cause.place) for e in verdict.explanations for cause in e.causes]
    assert (name, "joint 2" if name == "coulomb_level" else "robot") in named


def test_null_data_give_nothing_found() -> None:
    assert found({}, seed=4).verdict.kind == "nothing found"


def test_two_effects_are_not_taken_for_one_free_shape() -> None:
    """Derivatives about a model with a fifth of the friction say nothing of what the nominal one leaves."""
    campaign = made(SWEEPS, 6, {"viscous_level": -0.8, "gas_loss": 0.15})
    effects = catalogue()
    verdict = diagnose(campaign, nominal(), {name: effects[name] for name in CHOICE}, asks=False).verdict
    assert verdict.kind == "several causes"
    assert {cause.effect for cause in verdict.explanations[0].causes} == {"viscous_level", "gas_loss"}


def test_a_fit_that_finds_no_balance_stays_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(design: object, fit: object) -> None:
        raise ConvergenceError("no balance")

    monkeypatch.setattr(polish, "_polished", fails)
    assert polish.polished("design", "fit") == ("design", "fit")  # type: ignore[arg-type,comparison-overlap]


@pytest.mark.parametrize(
    ("nats", "evidence"), [(1.0, 14.8), (-1.0, 10.0), (-2 * IN_SET, None)], ids=["better", "alike", "far worse"]
)
def test_a_rival_that_fits_better_and_predicts_a_little_worse_stays_in_the_set(
    monkeypatch: pytest.MonkeyPatch, nats: float, evidence: float | None
) -> None:
    """Lost gas was left out of the set beside colder gas, for it fitted better and predicted a little worse."""
    monkeypatch.setattr(rivals, "held_out", lambda design, before, after: SimpleNamespace(nats=nats))
    any_: Any = SimpleNamespace()
    rival = rivals.as_it_predicts(any_, Hypothesis(any_, 10.0), Hypothesis(any_, 14.8))
    assert (rival and rival.log_evidence) == evidence
