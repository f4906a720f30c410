"""A fit that begins at several places takes no derivative twice, and ends from the best of them."""

from dataclasses import dataclass
from typing import Any

from bench.diagnose.name.candidate_model import _best_of
from bench.errors import ConvergenceError


@dataclass(frozen=True)
class Known:
    """Stands for a fit."""

    log_evidence: float
    lacks: str = ""

    def elsewhere(self, cause: str) -> "Known":
        return Known(self.log_evidence, cause)


EVIDENCE = {"here": 3.0, "shorter": 7.0, "longer": 5.0}
OTHERS: Any = [("shorter", "ripple"), ("nowhere", "play"), ("longer", "ripple")]


def fitting(asked: list[tuple[str, str]]) -> Any:
    """Return fits that note from where they begin, and which derivatives they lack."""

    def fits(start: str, known: Known | None = None) -> Known:
        asked.append((start, known.lacks if known else "all"))
        if start not in EVIDENCE:
            raise ConvergenceError("no balance")
        return Known(EVIDENCE[start])

    return fits


def best_of(start: str, asked: list[tuple[str, str]]) -> Any:
    begin: Any = start
    return _best_of(fitting(asked), begin, OTHERS)


def test_other_starts_take_over_the_derivatives_of_what_begins_at_the_same_place() -> None:
    asked: list[tuple[str, str]] = []
    assert best_of("here", asked).log_evidence == EVIDENCE["shorter"]
    assert asked == [("here", "all"), ("shorter", "ripple"), ("nowhere", "play"), ("longer", "ripple")]


def test_where_the_first_start_finds_no_balance_others_are_tried_all_the_same() -> None:
    asked: list[tuple[str, str]] = []
    assert best_of("nowhere else", asked).log_evidence == EVIDENCE["shorter"]
    assert asked == [("nowhere else", "all"), ("shorter", "all"), ("nowhere", "all"), ("longer", "all")]
