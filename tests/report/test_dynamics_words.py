"""What a first pass holds out, in words: of how many runs the groups are made."""

from types import SimpleNamespace
from typing import Any, Literal

import numpy as np
import pytest

from bench.report.dynamics.notes import rivals_notes
from bench.report.dynamics.words import folds_words


@pytest.mark.parametrize(
    ("by", "folds", "runs", "words"),
    [
        ("run", 7, 40, "40 whole runs in 7 groups (those over the same angles together)"),
        ("run", 4, 4, "4 whole runs"),
        ("block", 8, 1, "8 blocks of time"),
    ],
)
def test_groups_of_runs_say_of_how_many(by: Literal["run", "block"], folds: int, runs: int, words: str) -> None:
    class Folds(list[int]):
        """As many as there are folds."""

        @property
        def by(self) -> str:
            return by

    stretches = [SimpleNamespace(samples=SimpleNamespace(run=f"run {i}")) for i in range(runs)]
    assert folds_words(SimpleNamespace(folds=Folds(range(folds)), stretches=stretches)) == words  # type: ignore[arg-type]


def test_where_least_squares_is_better_is_said_of_each_campaign() -> None:
    """Of two campaigns that were predicted, on which it was better on four joints of six, nothing was said."""
    errors = {"first_pass": [1.0, 1.0], "rival": [0.9, 1.01], "nominal": [3.0, np.nan]}
    torques: Any = SimpleNamespace(rms=lambda model: np.array(errors[model]))
    assert list(rivals_notes(("base", "elbow"), "sweeps", torques)) == [
        "On sweeps, plain least squares predicts base better than the first pass does."
    ]
