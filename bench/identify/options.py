"""What a method lets its user choose."""

from dataclasses import dataclass

from bench.identify.statics import SecondOrder


@dataclass(frozen=True)
class Options:
    """Options of every method.

    Attributes:
        second_order: What is taken at the deflected angles; `SecondOrder.NONE` is the paper's plain model.
        iterations: Gauss-Newton steps from a rigid arm. The first solves the plain linear equation, Eq. (41); each further one
            gains three digits.
    """

    second_order: SecondOrder = SecondOrder.ALL
    iterations: int = 4
