"""Thermometers of the lab: temperatures as columns of a run."""

from collections.abc import Collection

import numpy as np
from numpy.typing import NDArray

from bench.effects.conditions import Conditions

Array = NDArray[np.float64]

SIGMA_K = 0.5  # of one reading
RESOLUTION_K = 0.1
USUAL = ("gear_temperature", "motor_temperature", "ambient_temperature")  # drives and rooms have them
CHANNELS = (*USUAL, "gas_temperature")


def temperatures(
    conditions: Conditions, rows: int, channels: Collection[str], rng: np.random.Generator
) -> dict[str, Array]:
    """Return the columns of some thermometers, each shape (rows,) [K].

    Args:
        conditions: During these rows.
        rows: How many readings.
        channels: Names out of `CHANNELS`.
        rng: Source of noise.
    """
    true: dict[str, float] = {}
    for name, values in (("gear_temperature", conditions.gear_k), ("motor_temperature", conditions.winding_k)):
        true |= {f"{name}_{j}_k": float(value) for j, value in enumerate(values, start=1) if name in channels}
    if "ambient_temperature" in channels:
        true["ambient_temperature_k"] = conditions.ambient_k
    if "gas_temperature" in channels:
        true["gas_temperature_k"] = conditions.gas_k
    return {name: _rounded(value + SIGMA_K * rng.standard_normal(rows)) for name, value in true.items()}


def _rounded(values: Array) -> Array:
    return np.round(RESOLUTION_K * np.round(values / RESOLUTION_K), 6)
