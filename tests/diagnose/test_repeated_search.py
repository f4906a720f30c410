"""Selection without a part of the runs: what hangs on one of them, and what hangs on the picture alone."""

from types import SimpleNamespace

import numpy as np
import pytest

from bench.diagnose.cross_validation.folds import Folds
from bench.diagnose.name import repeated

FRICTION, SCALE, GAS, TILT = (("friction", "joint 5"), ("scale", "current 5"), ("gas", "robot"), ("tilt", "robot"))
OF_ALL = {"exact": {FRICTION, GAS}, "to first order": {SCALE, GAS}}


@pytest.mark.parametrize("picture", OF_ALL)
def test_what_takes_its_place_with_all_runs_in_sight_is_no_doubt(picture: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Friction of 191 922 nats was "not confirmed": to first order a current's scale stood in its place each time."""
    of_all = OF_ALL[picture]
    searches = [of_all, of_all, of_all | {TILT}, of_all - {GAS}]  # all runs, and without each of three parts
    folds = Folds("run", np.arange(3), np.zeros((3, 3), dtype=bool))
    monkeypatch.setattr(repeated, "folds_of", lambda linear: folds)
    monkeypatch.setattr(repeated, "_without_parts", lambda *given: iter(searches))
    monkeypatch.setattr(repeated, "search", lambda model, *given: model)
    monkeypatch.setattr(repeated, "alternatives_of", lambda model, found: [SimpleNamespace(keys=frozenset(found))])
    best = SimpleNamespace(keys=frozenset({FRICTION, GAS}), causes=())
    about = SimpleNamespace(present=None, shape=None)
    shares = repeated.repeats(None, None, about, [best])  # type: ignore[arg-type, list-item]
    assert shares == {FRICTION: 1.0, GAS: pytest.approx(2 / 3)}
