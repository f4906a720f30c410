"""Shapes that were learned from data where no entry of the catalogue explains them, as effects that can act.

The parameters are the values of the shape: at nodes, linear in between and constant beyond, or of a few polynomials.
Torques are in `learned_torques`, errors of readings in `learned_readings`. What no actuator can do, a friction of the
link that follows the load in any other way than `load_coefficient` does, is not here: it cannot run in the simulator.
"""

from collections.abc import Sequence

import numpy as np

from bench.effects.effect import Array, Effect, Parameter, Values

SMALL = 0.1  # effort: of the standard deviation, where a plausible size begins
SOURCE = "this campaign"


class Learned(Effect):
    """A shape with k values.

    Args:
        parameters: Its values, k of them.
    """

    family = "own"
    source = SOURCE

    def __init__(self, parameters: tuple[Parameter, ...]) -> None:
        self.parameters = parameters

    def sizes(self, values: Values) -> Array:
        """Return the values in order, shape (k,)."""
        return np.array([values[parameter.name] for parameter in self.parameters])


def values_at(nodes: Array, over: str, unit: str, sigma: float) -> tuple[Parameter, ...]:
    """Return one parameter for each node.

    Args:
        nodes: Shape (k,), rising.
        over: Unit of the nodes.
        unit: Of the values.
        sigma: Standard deviation as plausible, in `unit`.
    """
    return values_of([f"at_{i + 1}" for i in range(len(nodes))], [f"at {x:.4g} {over}" for x in nodes], unit, sigma)


def values_of(names: Sequence[str], words: Sequence[str], unit: str, sigma: float) -> tuple[Parameter, ...]:
    """Return parameters with a normal prior of one width; arguments as in `values_at`."""
    high = float(np.sqrt(3)) * sigma  # an even spread over -high to high has the standard deviation sigma
    return tuple(
        Parameter(name, unit, 0.0, SMALL * high, high, text, signed=True)
        for name, text in zip(names, words, strict=True)
    )
