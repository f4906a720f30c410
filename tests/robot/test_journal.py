"""What is taken back from a journal is as if it had never been done."""

import copy
from typing import Any

import numpy as np

from bench.robot.patching.journal import Journal

CHANGES = 200


def test_taking_back_restores_what_was_there_and_its_order(rng: np.random.Generator) -> None:
    """Tables keep the order of their keys as well: models are written in it."""
    table: dict[Any, Any] = {"given": 0}
    listed: list[Any] = ["given"]
    journal = Journal()
    seen = [(len(journal), copy.deepcopy(table), list(listed))]
    for value in range(CHANGES):
        if rng.random() < 0.5:
            journal.put(table, rng.choice(["given", "a", "b", "c"]), value)
        else:
            journal.append(listed, value)
        seen.append((len(journal), copy.deepcopy(table), list(listed)))
    for length, then, those in reversed(seen):
        journal.take_back(length)
        assert list(table.items()) == list(then.items())
        assert listed == those
    assert len(journal) == 0
