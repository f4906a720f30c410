"""What Table 5 says without any pose: each reading as a straight line over the load of its configuration.

Elastic joints and friction in proportion to the load put all states of a configuration, the unloaded one included, on
one line. Scatter about the line, and a line that misses the unloaded reading, are friction (or noise), whatever the
poses are.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.identify.table5 import Table5
from bench.robot.bodies import Array


@dataclass(frozen=True)
class Lines:
    """Lines through the loaded states of the configurations with several loads, c of them; n joints.

    Attributes:
        configuration: Shape (c,) int.
        deflection_gap: Shape (c, 3) [m], the line at no load, less the unloaded reading.
        deflection_gap_sigma: Shape (c, 3) [m], its standard error by the scatter pooled over configurations.
        deflection_scatter: Shape (c, 3) [m], root mean square about the line (two degrees of freedom less).
        torque_gap: Shape (c, n) [Nm], the same for |xi| I as printed.
        torque_gap_sigma: Shape (c, n) [Nm].
        torque_scatter: Shape (c, n) [Nm].
    """

    configuration: NDArray[np.int64]
    deflection_gap: Array
    deflection_gap_sigma: Array
    deflection_scatter: Array
    torque_gap: Array
    torque_gap_sigma: Array
    torque_scatter: Array


def fit_lines(table: Table5) -> Lines:
    """Return the lines of every configuration with at least three loaded states."""
    size = np.linalg.norm(table.force, axis=1)
    numbers = [
        c for c in np.unique(table.configuration) if np.sum((table.configuration == c) & ~table.is_reference) >= 3
    ]
    found = []
    for number in numbers:
        loaded = (table.configuration == number) & ~table.is_reference
        unloaded = (table.configuration == number) & table.is_reference
        design = np.stack([np.ones(loaded.sum()), size[loaded]], axis=1)
        stretch = np.sqrt(np.linalg.inv(design.T @ design)[0, 0])  # standard error of the line at no load, per scatter
        for values in (table.deflection, table.torque):
            line = np.linalg.lstsq(design, values[loaded], rcond=None)[0]
            residual = values[loaded] - design @ line
            scatter = np.sqrt(np.sum(residual**2, axis=0) / (len(design) - 2))
            found.append((line[0] - values[unloaded][0], scatter, stretch))
    deflection, moved = found[::2], found[1::2]

    def columns(rows: list[tuple[Array, Array, float]]) -> tuple[Array, Array, Array]:
        gap, scatter = np.stack([row[0] for row in rows]), np.stack([row[1] for row in rows])
        pooled = np.sqrt(np.mean(scatter**2, axis=0))
        return gap, np.array([row[2] for row in rows])[:, None] * pooled, scatter

    return Lines(np.array(numbers), *columns(deflection), *columns(moved))
