"""What a search does where findings do not pay."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bench.diagnose.extend.fit import Fit, unknowns_of
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.name import selection as selection_module
from bench.diagnose.name.models import Model
from bench.diagnose.name.naming import Finding
from bench.diagnose.name.refusals import Refusals
from bench.diagnose.name.selection import _Selection
from bench.effects.catalogue import catalogue
from bench.effects.effect import WHOLE


@pytest.mark.parametrize(("each", "is_open"), [(5.0, False), (20.0, True)])
def test_many_small_refusals_open_a_search_as_one_large_one_does(
    each: float, is_open: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Five findings of 5 to 26 nats were refused on the KR300, and all that they had explained counted as noise."""
    effects = [catalogue()[name] for name in ("gas_loss", "payload_mass", "base_compliance")]
    causes = tuple(Cause(effect, WHOLE, effect.parameters, ()) for effect in effects)
    nothing: Any = None

    def fit_of(left: tuple[Cause, ...]) -> Fit:
        unknowns = unknowns_of(left)
        none, k = np.zeros(0), len(unknowns)
        values = np.array([unknown.parameter.null for unknown in unknowns])
        return Fit(left, unknowns, values, np.eye(k), none, 0.0, each * len(left), none, none, none)

    def held(_linear: Any, _null: Any, model: Model, asked: Any, *_: Any) -> dict[Any, Finding]:
        worth: Any = SimpleNamespace(low=-1.0)
        left = {cause.key: fit_of(tuple(other for other in model.causes if other is not cause)) for cause in asked}
        return {cause.key: Finding(cause, model.fit, left[cause.key], each, worth, is_taken=False) for cause in asked}

    monkeypatch.setattr(selection_module, "held_findings", held)
    selection = _Selection.__new__(_Selection)
    selection.linear = selection.null = selection.executor = nothing
    selection.screening = SimpleNamespace(threshold=3.0)  # type: ignore[assignment]
    selection.progress = lambda words: None
    selection.refusals, selection.is_open = Refusals(), False
    selection.best = Model(fit_of(causes))
    assert selection._refuse()
    assert not selection.best.causes
    assert selection.is_open == is_open
