"""Results as plain data for JSON."""

from collections.abc import Mapping

import numpy as np


def to_jsonable(value: object) -> object:
    """Return arrays and sequences as lists; nan and inf, which JSON does not know, as null."""
    match value:
        case None | str() | bool() | int():
            return value
        case Mapping():
            return {key: to_jsonable(entry) for key, entry in value.items()}
        case np.ndarray() | list() | tuple():
            return [to_jsonable(entry) for entry in value]
    number = float(value)  # type: ignore[arg-type]
    return number if np.isfinite(number) else None
