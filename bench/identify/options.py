"""What a method lets its user choose."""

from dataclasses import dataclass
from typing import Literal

from bench.errors import InputError
from bench.identify.statics import SecondOrder


@dataclass(frozen=True)
class Options:
    """Options of the methods.

    Attributes:
        second_order: What is taken at the deflected angles.
        iterations: Gauss-Newton steps from a rigid arm, at least 1. The first solves the plain linear equation, Eq.
            (41); each further one gains about two digits. The force method in full goes on until it has settled.
        weights: "noise": by the covariance of the readings, the unloaded one shared by its series. "equal": as the
            paper does, every loaded state less the unloaded one, all rows alike, and the error from the residuals.
            Only the current and force methods in their position-only form know the difference.
    """

    second_order: SecondOrder = SecondOrder.ALL
    iterations: int = 4
    weights: Literal["noise", "equal"] = "noise"

    def __post_init__(self) -> None:
        """Refuse what cannot be iterated.

        Raises:
            InputError: Fewer than one iteration.
        """
        if self.iterations < 1:
            raise InputError(f"options: iterations is {self.iterations}; at least one is needed.")


PLAIN = Options(SecondOrder.NONE, 1, "equal")  # Eqs. (35) and (41) as the paper solves them
