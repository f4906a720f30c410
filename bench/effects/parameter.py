"""A parameter of an effect: how large it plausibly is, and what people know in its place."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Quotient:
    """A size divided by another one, without which it changes nothing: a centre of mass is a first moment by a mass.

    Models are linear in first moments, and people know centres.

    Attributes:
        by: Name of the other size. What a size with a quotient changes is simulated beside its largest plausible value.
        name: In snake_case.
        unit: SI.
        words: What it is.
    """

    by: str
    name: str
    unit: str
    words: str


@dataclass(frozen=True)
class Parameter:
    """One parameter of an effect.

    Attributes:
        name: In snake_case, unique within its effect.
        unit: SI, "" for relative quantities (0.05 is 5 %).
        null: Value that changes nothing. For a parameter that only shapes another one (a period, a time constant,
            a Stribeck velocity) this is the value that is assumed first; it changes nothing as long as the others
            are at their null value.
        low, high: Plausible size: value - null lies in [low, high], or in [-high, -low] too if `signed`. For a shape
            parameter the plausible values themselves.
        signed: Both signs are physical.
        is_shape: It only shapes the effect; size 0 of the others makes it meaningless.
        words: What it is.
        least, most: Values beyond which it means nothing: friction that drives, a mass below zero. Fits stay within.
        ratio: Of neighbouring values of a shape that are tried at first; near 1 for periods, for between two of them an
            effect is lost.
        quotient: What people know in its place, if it is a size that changes nothing without another one.
    """

    name: str
    unit: str
    null: float
    low: float
    high: float
    words: str
    signed: bool = False
    is_shape: bool = False
    ratio: float = 2.5
    least: float = -np.inf
    most: float = np.inf
    quotient: Quotient | None = None

    @property
    def sigma(self) -> float:
        """Standard deviation of its prior: of values spread evenly up to `high` either way; of a shape, twice that."""
        return float((self.high - self.low if self.is_shape else self.high) / np.sqrt(3))

    @property
    def typical(self) -> float:
        """A value in the middle of the plausible range, on a logarithmic scale."""
        if self.is_shape:
            return self.null
        return self.null + float(np.sqrt(self.low * self.high)) if self.low > 0 else self.null + self.high / 2
