"""Fits that are far behind another model end."""

import numpy as np
import pytest

from bench.diagnose.extend import refit as refit_module
from bench.diagnose.extend.objective import Objective, State
from bench.diagnose.extend.refit import refit
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.name.candidate_model import CandidateModel, fit_of
from bench.diagnose.replay.replay import Replay
from bench.effects.catalogue import catalogue
from bench.effects.effect import WHOLE
from bench.executor.contract import ignore
from tests.diagnose.small_models import linear_of
from tests.diagnose.sweeps import SWEEPS, made

GAS = catalogue()["gas_loss"]
LOST = Cause(GAS, WHOLE, GAS.parameters, ())


@pytest.fixture(scope="module")
def linear() -> LinearisedModel:
    return linear_of(made(SWEEPS, seed=9, hidden={"gas_loss": 0.1}))


def test_a_fit_that_leads_nowhere_near_another_model_ends(
    linear: LinearisedModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A scale of a current in the place of friction was fitted with 450 simulations, 100 000 nats behind."""
    simulated = list[object]()
    predict = Replay.predict
    monkeypatch.setattr(Replay, "predict", lambda self, world: simulated.append(world) or predict(self, world))
    whole = refit(linear, (LOST,), {})
    needed, promised = len(simulated), whole.log_evidence - refit(linear, (), {}).log_evidence
    assert promised > 0
    simulated.clear()
    behind = refit(linear, (LOST,), {}, least=whole.log_evidence + 2 * promised + 2 * refit_module.HOPELESS)
    assert len(simulated) < needed
    assert not behind.is_settled
    assert behind.log_evidence < whole.log_evidence
    near = refit(linear, (LOST,), {}, least=whole.log_evidence + refit_module.HOPELESS / 2)
    assert near.values == pytest.approx(whole.values)


def test_a_fit_that_makes_little_of_the_way_ends(linear: LinearisedModel, monkeypatch: pytest.MonkeyPatch) -> None:
    """A scale of a current in the place of friction promised 100 000 nats, step after step, and made little of it."""
    least, states = refit(linear, (LOST,), {}).log_evidence, list[State]()
    gain = least - refit(linear, (), {}).log_evidence
    after = Objective.after

    def a_hundredth(objective: Objective, state: State, step: np.ndarray) -> State:
        states.append(state)
        return after(objective, state, step / 100)

    monkeypatch.setattr(Objective, "after", a_hundredth)
    steps = {}
    for far in (gain / 2, 2 * gain):
        monkeypatch.setattr(refit_module, "FAR", far)
        states.clear()
        fit = refit(linear, (LOST,), {}, least=least)
        steps[far] = len({id(state) for state in states})
        assert not fit.is_settled
    assert steps[gain / 2] == 1 < steps[2 * gain]


def test_a_model_that_stays_far_behind_comes_to_nothing(linear: LinearisedModel) -> None:
    whole = refit(linear, (LOST,), {})
    for behind in (refit_module.FAR / 2, 2 * refit_module.FAR):
        candidate = CandidateModel(
            (LOST,), None, whole.start, whole.nuisances, (0.0,), None, whole.log_evidence + behind
        )
        assert (fit_of(linear, candidate, ignore) is None) == (behind > refit_module.FAR)
