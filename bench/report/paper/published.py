"""What the paper prints or says, beside ours."""

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Literal

from scipy import stats

from bench.report.jsonable import to_jsonable

Relation = Literal["equal", "less", "more"]

LEVEL = 0.95  # of the intervals


@dataclass(frozen=True)
class PublishedRow:
    """One number or statement of the paper beside ours.

    Attributes:
        quantity: What it is, with its equation, table or figure.
        unit: "" for a ratio.
        ours: Our value.
        paper: The paper's value, or the bound that its words draw.
        relation: Whether the paper says that the quantity equals `paper`, is less, or is more.
        low, high: Ends of the 95 % interval of ours; nan where it has none to speak of.
    """

    quantity: str
    unit: str
    ours: float
    paper: float
    relation: Relation = "equal"
    low: float = float("nan")
    high: float = float("nan")

    @property
    def difference(self) -> float:
        """Ours less the paper's."""
        return self.ours - self.paper

    @property
    def holds(self) -> bool | None:
        """Whether what the paper says in words is so here; None where it prints a number."""
        match self.relation:
            case "less":
                return self.ours < self.paper
            case "more":
                return self.ours > self.paper
            case _:
                return None


def interval(value: float, standard_error: float) -> tuple[float, float]:
    """Return the ends of the interval of a normally distributed estimate."""
    half = float(stats.norm.ppf(0.5 + LEVEL / 2)) * standard_error
    return value - half, value + half


def as_json(rows: Iterable[PublishedRow]) -> object:
    """Return rows as plain data; what is undefined is null."""
    return to_jsonable([asdict(row) | {"difference": row.difference, "holds": row.holds} for row in rows])
