"""Trials that lose what they do not need come to the same model; rounds that nobody asks for are not made."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bench.diagnose.extend.fit import Fit, unknowns_of
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.name import models as models_module
from bench.diagnose.name.candidate_model import CandidateModel, Fitted
from bench.diagnose.name.models import Fitter, Model
from bench.diagnose.name.selection import MOST_ROUNDS, _Selection
from bench.effects.catalogue import catalogue
from bench.effects.effect import WHOLE
from bench.executor.serial import SERIAL

EFFECTS = [catalogue()[name] for name in ("gas_loss", "payload_mass", "base_compliance")]
LOST, FIRST, SECOND = (Cause(effect, WHOLE, effect.parameters, ()) for effect in EFFECTS)
NOTHING: Any = None


def fit_of(causes: tuple[Cause, ...], evidence: float) -> Fit:
    """Return a fit of causes that are clear of none and plausible."""
    unknowns, none = unknowns_of(causes), np.zeros(0)
    values = np.array([unknown.parameter.null + unknown.parameter.high / 2 for unknown in unknowns])
    covariance = np.diag((values / 100) ** 2)
    return Fit(causes, unknowns, values, covariance, none, 0.0, evidence, none, none, none, is_settled=False)


def test_trials_that_come_to_the_same_model_are_settled_once_and_the_likeliest_is_kept(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The last of them stood for all, so a search gave a better fit away, and its rounds went on for that."""
    trials = [
        CandidateModel(causes, None, {}, None, (-5.0,) * len(causes)) for causes in ((LOST, FIRST), (LOST, SECOND))
    ]
    ends = [Fitted(fit_of((LOST,), evidence), (0,)) for evidence in (40.0, 38.0)]
    settled: list[float] = []

    def settled_of(_linear: Any, done: tuple[CandidateModel, Fitted], _progress: Any) -> Fit:
        settled.append(done[1].fit.log_evidence)
        return replace(done[1].fit, log_evidence=done[1].fit.log_evidence + 1)

    monkeypatch.setattr(models_module, "settled_of", settled_of)
    monkeypatch.setattr(Fitter, "_fits", lambda self, new: ends[: len(new)])
    fitter = Fitter(NOTHING, fit_of((), 0.0), SERIAL)
    (model,) = fitter.fitted(trials)
    assert model.fit.log_evidence == 41.0
    assert settled == [40.0]
    assert [fitter.models[trial.keys] for trial in trials] == [model, model]
    assert set(fitter.fell_short(model)) == {trial.keys for trial in trials}


@pytest.mark.parametrize("learns", [True, False])
def test_a_second_look_ends_where_its_last_search_leaves_something_unlisted(
    learns: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is not taken then, whatever pays: holding its findings out and searching without runs took minutes."""
    done: list[str] = []
    shape: Any = "a shape"
    best = Model(fit_of((LOST,), 40.0), shape)

    def search(self: _Selection, *, is_last: bool = False, adds: bool = True) -> None:
        self.best = best
        done.append("last search" if is_last else "search")

    monkeypatch.setattr(_Selection, "_search", search)
    monkeypatch.setattr(_Selection, "_relinearise", lambda self, *, is_last=False: None)
    monkeypatch.setattr(_Selection, "_refuse", lambda self: done.append("held out"))
    monkeypatch.setattr(_Selection, "_repeat", lambda self: done.append("without runs"))
    selection = _Selection.__new__(_Selection)
    selection.best, selection.is_open, selection.learns = Model(fit_of((), 0.0)), False, learns
    selection.screening = SimpleNamespace(threshold=3.0)  # type: ignore[assignment]
    selection.run()
    assert done.count("last search") == 1
    assert len(done) < MOST_ROUNDS
    assert done[-1] == ("without runs" if learns else "last search")
