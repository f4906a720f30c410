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


def test_other_starts_take_over_the_derivatives_of_what_begins_at_the_same_place() -> None:
    asked: list[tuple[str, str]] = []
    evidence = {"here": 3.0, "shorter": 7.0, "longer": 5.0}

    def fits(start: Any, known: Known | None = None) -> Any:
        asked.append((start, known.lacks if known else "all"))
        if start == "nowhere":
            raise ConvergenceError("no balance")
        return Known(evidence[start])

    others: Any = [("shorter", "ripple"), ("nowhere", "play"), ("longer", "ripple")]
    assert _best_of(fits, "here", others).log_evidence == evidence["shorter"]  # type: ignore[arg-type]
    assert asked == [("here", "all"), ("shorter", "ripple"), ("nowhere", "play"), ("longer", "ripple")]
