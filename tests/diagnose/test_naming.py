"""A short blind run: hidden by the simulation in time, found by the replay, with few effects to choose from."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bench.diagnose.diagnose import Diagnosis, diagnose
from bench.diagnose.experiment_design import undetectable
from bench.diagnose.extend import relinearise
from bench.diagnose.extend.fit import Fit
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.name import paying, selection
from bench.diagnose.name.models import Model
from bench.diagnose.name.naming import Naming, fitted_probabilities, log_odds_of_subsets, with_probabilities
from bench.diagnose.name.neighbourhood import Neighbourhood
from bench.diagnose.name.search import Alternative, Subset
from bench.effects.catalogue import catalogue
from bench.effects.effect import WHOLE
from bench.effects.gas import GasLoss
from bench.effects.payloads import PayloadMass, UnstatedPayload
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


def test_where_nothing_balances_beside_a_model_it_is_named_all_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    """The diagnosis ended with exit code 5, though it had a model that does balance."""

    def unbalanced(self: Neighbourhood, linear: LinearisedModel, model: Model, *, is_last: bool = False) -> None:
        raise ConvergenceError("no balance")

    monkeypatch.setattr(Neighbourhood, "about", unbalanced)
    verdict = found({"gas_loss": 0.15}, seed=3).verdict
    assert verdict.kind == "cause"
    assert [cause.effect for cause in verdict.explanations[0].causes] == ["gas_loss"]


def test_a_finding_on_whose_size_runs_disagree_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    def scattered(linear: object, fit: Fit) -> Fit:
        return replace(fit, covariance=1e6 * fit.covariance)

    monkeypatch.setattr(paying, "with_jackknife", scattered)
    verdict = found({"gas_loss": 0.15}, seed=3).verdict
    assert verdict.kind == "nothing found"
    refused = [step for step in verdict.steps if step.added[0].effect == "gas_loss"]
    assert refused
    assert not refused[0].accepted
    assert "scatter between runs" in refused[0].reason


@pytest.mark.parametrize("rounds", [1, *(pytest.param(rounds, marks=pytest.mark.study) for rounds in (2, 3))])
def test_a_search_that_does_not_settle_ends_with_findings_that_pay(
    rounds: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An arm of which everything was a little off ran out of rounds, and its verdict had a model but no findings."""
    monkeypatch.setattr(selection, "MOST_ROUNDS", rounds)
    diagnosis = found({"gas_loss": 0.15}, seed=3)
    verdict, best = diagnosis.verdict, diagnosis.naming.models[0]
    assert {cause.effect for cause in verdict.explanations[0].causes} == {"gas_loss"}
    assert [group.names[0].cause.effect for group in verdict.findings] == ["gas_loss"]
    assert {(one.added[0].effect, one.accepted) for one in verdict.steps} == {("gas_loss", True)}
    assert (verdict.unlisted is None) == (best.shape is None)


def test_where_rounds_are_used_up_the_likeliest_explanation_is_given_first(monkeypatch: pytest.MonkeyPatch) -> None:
    """What stayed was sorted before what promised more: half of the model stood ahead of a rival 113 nats above it."""
    monkeypatch.setattr(selection, "MOST_ROUNDS", 2)
    models = found({"viscous_level": -0.8, "gas_loss": 0.15}, seed=6).naming.models
    assert {cause.effect.name for cause in models[0].causes} == {"viscous_level", "gas_loss"}
    assert list(models) == sorted(models, key=lambda model: -model.log_posterior)
    assert all(len(model.keys) <= len(models[0].keys) for model in models)


def test_null_data_give_nothing_found() -> None:
    assert found({}, seed=4).verdict.kind == "nothing found"


def test_two_effects_are_not_taken_for_one_free_shape() -> None:
    """Derivatives about a model with a fifth of the friction say nothing of what the nominal one leaves."""
    campaign = made(SWEEPS, 6, {"viscous_level": -0.8, "gas_loss": 0.15})
    effects = catalogue()
    verdict = diagnose(campaign, nominal(), {name: effects[name] for name in CHOICE}, proposes=False).verdict
    assert verdict.kind == "several causes"
    assert {cause.effect for cause in verdict.explanations[0].causes} == {"viscous_level", "gas_loss"}


def test_a_fit_that_finds_no_balance_stays_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(linear: object, fit: object) -> None:
        raise ConvergenceError("no balance")

    monkeypatch.setattr(relinearise, "_relinearised_fit", fails)
    assert relinearise.relinearised_fit("design", "fit") == ("design", "fit")  # type: ignore[arg-type,comparison-overlap]


def fake(log_posterior: float, *keys: str) -> Model:
    causes = tuple(SimpleNamespace(key=key) for key in keys)
    return Model(SimpleNamespace(causes=causes), log_posterior=log_posterior)  # type: ignore[arg-type]


def test_a_set_holds_what_cannot_be_told_from_the_best_and_nothing_with_more_in_it() -> None:
    models = (fake(9.0, "gas"), fake(8.0, "gas", "friction"), fake(5.0, "heat"), fake(2.0, "valve"))
    any_: Any = None
    naming = Naming("cause", models, any_, any_, (), any_, any_)
    assert [sorted(model.keys) for model in naming.alternatives] == [["gas"], ["heat"]]


def test_what_is_found_is_found_with_all_that_it_covers() -> None:
    """A payload has a mass and a centre: they were listed as what nothing could show, below the payload itself."""
    payload = Cause(UnstatedPayload(), WHOLE, (), ())
    model = Model(SimpleNamespace(causes=(payload,)))  # type: ignore[arg-type]
    any_: Any = None
    found = Naming("cause", (model,), any_, any_, (), any_, any_).found
    assert found == {(name, "robot") for name in ("unstated_payload", "payload_mass", "payload_com")}
    assert set(UnstatedPayload.covers) <= set(catalogue())


def test_what_was_found_is_not_undetectable(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(undetectable, "_seen", lambda screening, causes: set())
    monkeypatch.setattr(undetectable, "_absent", lambda compiled, quantities: ())
    causes = [Cause(effect, WHOLE, (), ()) for effect in (UnstatedPayload(), PayloadMass(), GasLoss())]
    any_: Any = None
    blind = undetectable.undetectable_effects(any_, (), (), any_, causes, found={("payload_mass", "robot")})
    assert [spot.effect for spot in blind] == ["unstated_payload", "gas_loss"]


def test_what_has_a_finding_more_counts_for_the_finding() -> None:
    """The probability is that the findings are at work, not that nothing else is."""
    models = (fake(9.0, "gas"), fake(8.0, "gas", "friction"), fake(5.0, "heat"))
    found = [Alternative(model.keys, Subset((), 0.0), model.log_posterior - 1.0) for model in models]
    found.append(Alternative(frozenset(), Subset((), 0.0), 0.0))
    gas, both, heat = (model.probability for model in with_probabilities(models, log_odds_of_subsets(models, found)))
    total = sum(np.exp([9.0, 8.0, 5.0, 1.0]))  # the nominal one: 1 more than linearised, as the best is
    assert gas == pytest.approx((np.exp(9.0) + np.exp(8.0)) / total)
    assert both == 0.0
    assert heat == pytest.approx(np.exp(5.0) / total)


def test_models_share_their_probability_as_simulated() -> None:
    """The names of a finding are weighed by simulations, so an explanation must not have another probability.

    What was not simulated counts for heat, and made its explanation thirteen times as probable as its name.
    """
    models = (fake(9.0, "gas"), fake(8.0, "gas", "friction"), fake(3.6, "heat"))
    every = {model.keys: model.log_posterior for model in models} | {frozenset({"heat", "valve"}): 6.2}
    weighed = with_probabilities(models, every)
    gas, both, heat = fitted_probabilities(weighed)
    assert both == 0.0
    assert heat / gas == pytest.approx(np.exp(3.6) / (np.exp(9.0) + np.exp(8.0)))
    assert gas + heat == pytest.approx(sum(model.probability for model in weighed))


def test_what_promises_more_and_was_not_simulated_counts_for_no_more_than_is_said() -> None:
    """A search without rounds left does not simulate it; nobody knows that it is more probable."""
    models = (fake(9.0, "gas"),)
    every = ((models[0].keys, 9.0), (frozenset({"else"}), 30.0))
    found = [Alternative(keys, Subset((), 0.0), value) for keys, value in every]
    assert log_odds_of_subsets(models, found)[frozenset({"else"})] == 30.0
    assert set(log_odds_of_subsets(models, found, most=9.0).values()) == {9.0}


def test_a_cause_that_comes_to_nothing_takes_none_but_those_that_have_it_along() -> None:
    """Friction of one direction in the place of an offset needs more than there is; at another joint both will do."""
    models = (fake(9.0, "friction 2", "offset 3"),)
    lost, other, both = (
        frozenset(keys) for keys in (("friction 2", "friction 3"), ("offset 2", "offset 3"), ("offset 2", "friction 3"))
    )
    promised = {models[0].keys: 9.0, lost: 8.0, other: 7.0, both: 6.0}
    found = [Alternative(keys, Subset((), 0.0), value) for keys, value in promised.items()]
    weighed = log_odds_of_subsets(models, found, {lost: frozenset({"friction 3"})})
    assert weighed == {models[0].keys: 9.0, lost: -np.inf, other: 7.0, both: -np.inf}


def test_what_a_last_search_loses_is_weighed_no_more(monkeypatch: pytest.MonkeyPatch) -> None:
    """A friction that does not act beside the others: what the repeated searches find of it was asked for in vain."""
    kind = selection._Selection
    mine = object.__new__(kind)
    mine.best, mine.findings = fake(9.0, "gas", "heat"), {}
    held = []

    def refuse(self: Any) -> bool:
        held.append(self.best.keys)
        return False

    def search(self: Any, *, is_last: bool, adds: bool) -> None:
        assert is_last
        assert not adds
        self.best = fake(8.0, "gas")

    monkeypatch.setattr(kind, "_refuse", refuse)
    monkeypatch.setattr(kind, "_search", search)
    monkeypatch.setattr(kind, "_relinearise", lambda self, *, is_last: None)
    monkeypatch.setattr(kind, "_repeat", lambda self: held.append(self.best.keys))
    mine._end()
    assert held == [{"gas", "heat"}, {"gas"}, {"gas"}]


def test_two_names_of_which_either_leads_about_the_other_end_a_search(monkeypatch: pytest.MonkeyPatch) -> None:
    """The findings that are given are those of the model that is given."""
    kind = selection._Selection
    mine = object.__new__(kind)
    mine.best, mine.findings = fake(9.0, "gas"), {}

    def refuse(self: Any) -> bool:
        self.findings = {key: f"held: {key}" for key in self.best.keys}
        return False

    def search(self: Any, *, is_last: bool, adds: bool) -> None:
        self.best = fake(9.0, "heat") if "gas" in self.best.keys else fake(9.0, "gas")

    monkeypatch.setattr(kind, "_refuse", refuse)
    monkeypatch.setattr(kind, "_search", search)
    monkeypatch.setattr(kind, "_relinearise", lambda self, *, is_last: None)
    monkeypatch.setattr(kind, "_repeat", lambda self: None)
    mine._end()
    assert mine.best.keys == mine.findings.keys() == {"gas"}


def test_what_a_refused_finding_explained_may_be_explained_by_something_else(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its share was noise before anything else was looked at: a drive kept 2.5 N where an offset leaves 0.95 N."""
    kind = selection._Selection
    mine = object.__new__(kind)
    mine.best = fake(9.0, "gas", "heat")
    done: list[object] = []

    def refuse(self: Any) -> bool:
        count = done.count("refuse")
        done.append("refuse")
        self.is_open = count == 0
        return count < 2

    monkeypatch.setattr(kind, "_refuse", refuse)
    monkeypatch.setattr(kind, "_search", lambda self, *, is_last: done.append(is_last))
    monkeypatch.setattr(kind, "_relinearise", lambda self, *, is_last: None)
    monkeypatch.setattr(kind, "_repeat", lambda self: done.append("repeat"))
    mine.run()
    assert done == [False, True, "refuse", False, True, "refuse", True, "refuse", "repeat"]
