"""Changes of healthy columns: each puts one fault into them."""

from collections.abc import Callable

import numpy as np

from bench.record.campaign import Array

Columns = dict[str, Array]
Change = Callable[[Columns], object]


def put(name: str, rows: slice | int, value: float) -> Change:
    def change(columns: Columns) -> None:
        columns[name] = columns[name].copy()
        columns[name][rows] = value

    return change


def scale(name: str, factor: float, offset: float = 0.0) -> Change:
    return lambda columns: columns.update({name: columns[name] * factor + offset})


def copy(name: str, source: str) -> Change:
    return lambda columns: columns.update({name: columns[source]})


def rename(name: str, new: str) -> Change:
    return lambda columns: columns.update({new: columns.pop(name)})


def clip(name: str, level: float) -> Change:
    return lambda columns: columns.update({name: np.minimum(columns[name], level)})


def drop_rows(rows: slice | list[int]) -> Change:
    return lambda columns: columns.update({name: np.delete(values, rows) for name, values in columns.items()})


def shift(name: str, seconds: float) -> Change:
    def change(columns: Columns) -> None:
        columns[name] = np.interp(columns["time_s"] + seconds, columns["time_s"], columns[name])

    return change


def swap(first: str, second: str) -> Change:
    return lambda columns: columns.update({first: columns[second], second: columns[first]})
