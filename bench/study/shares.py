"""A share of campaigns with its 95 % interval, and a mean with its own."""

from dataclasses import dataclass

import numpy as np
from scipy.stats import beta
from scipy.stats import t as student

TAIL = 0.025  # on either side


@dataclass(frozen=True)
class Share:
    """How many of how many."""

    hits: int
    of: int

    @property
    def value(self) -> float:
        """The share; nan of nothing."""
        return self.hits / self.of if self.of else float("nan")

    @property
    def interval(self) -> tuple[float, float]:
        """95 % interval; 0 to 1 of nothing."""
        return self.interval_at(TAIL)

    def interval_at(self, tail: float) -> tuple[float, float]:
        """Return the interval of Clopper and Pearson (1934), beyond which on either side no more than `tail` lies."""
        low = float(beta.ppf(tail, self.hits, self.of - self.hits + 1)) if self.hits else 0.0
        high = float(beta.ppf(1 - tail, self.hits + 1, self.of - self.hits)) if self.hits < self.of else 1.0
        return low, high


@dataclass(frozen=True)
class Mean:
    """A mean over campaigns with its 95 % interval, and the largest of all; nan of nothing."""

    value: float
    interval: tuple[float, float]
    largest: float
    of: int

    @classmethod
    def over(cls, values: list[float]) -> "Mean":
        """Return the mean of some values."""
        n = len(values)
        if n == 0:
            return cls(float("nan"), (float("nan"), float("nan")), float("nan"), 0)
        mean = float(np.mean(values))
        half = float(student.ppf(1 - TAIL, n - 1) * np.std(values, ddof=1) / np.sqrt(n)) if n > 1 else float("nan")
        return cls(mean, (mean - half, mean + half), max(values), n)
