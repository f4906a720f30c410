"""Which actions `BenchEnv` takes: each number within its range, and none that is nan."""

from collections.abc import Mapping
from math import isnan
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from bench.errors import InputError

Array = NDArray[np.float64]

ROUNDING = float(np.finfo(np.float32).eps)  # of the larger bound; policies hand over numbers in single precision


class ActionRange:
    """Ranges of an action of two parts.

    Args:
        ranges: Part of the action -> (lowest, highest), each of its shape.
    """

    def __init__(self, ranges: Mapping[str, tuple[Array, Array]]) -> None:
        self._shapes = {name: low.shape for name, (low, _) in ranges.items()}
        self._first, self._second = self._shapes.values()
        low, high = (np.concatenate([ends[i] for ends in ranges.values()]) for i in (0, 1))
        room = ROUNDING * np.maximum(np.abs(low), np.abs(high))
        self._lowest, self._highest = (low - room).tolist(), (high + room).tolist()

    def check(self, first: Array, second: Array) -> None:
        """Check the parts of an action, in the order in which their ranges were given; made to be quick.

        Raises:
            InputError: A part has another shape, or a number that is nan or out of its range.
        """
        if first.shape != self._first or second.shape != self._second:
            self._refuse_shapes((first, second))
        values = first.tolist() + second.tolist()
        for low, value, high in zip(self._lowest, values, self._highest, strict=False):
            if not low <= value <= high:  # also if it is nan
                self._refuse_values(values)

    def _refuse_shapes(self, parts: tuple[Array, ...]) -> NoReturn:
        given = zip(self._shapes.items(), parts, strict=True)
        raise InputError(
            f"action: {name}: has the shape {part.shape}, which does not fit; give {shape}."
            for (name, shape), part in given
            if part.shape != shape
        )

    def _refuse_values(self, values: list[float]) -> NoReturn:
        places = [f"{name}[{i}]" for name, shape in self._shapes.items() for i in range(shape[0])]
        problems = []
        for place, low, value, high in zip(places, self._lowest, values, self._highest, strict=True):
            if isnan(value):
                problems.append(f"action: {place}: is nan; whatever computed it failed.")
            elif not low <= value <= high:
                problems.append(
                    f"action: {place}: {value:g} is outside of {low:g} to {high:g}; clip it to env.action_space."
                )
        raise InputError(problems)
