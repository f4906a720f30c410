"""What is compared: the columns of measured channels that a replay predicts, side by side."""

from dataclasses import dataclass

import numpy as np

from bench.record.campaign import Array, Run
from bench.robot.compiled import CompiledRobot
from bench.simulate.instruments import Reading

AXES = ("x", "y", "z")
LOADS = ("A", "N", "Nm")  # units of forces, torques and the currents that make them: none is zero, in any frame


@dataclass(frozen=True)
class Quantity:
    """One column that is compared.

    Attributes:
        column: Name in the campaign.
        kind: "current", "tau_motor", "reflector", "q_link", "force", "moment", "gas_pressure", "gas_temperature"; with
            "known_" in front what the lab knows besides (`known.py`).
        unit: SI.
        index: Drive or reflector, from 0.
        axis: 0 to 2 for vectors.
    """

    column: str
    kind: str
    unit: str
    index: int = 0
    axis: int = 0

    @property
    def is_drive(self) -> bool:
        """Whether it says what a motor pays."""
        return self.kind in ("current", "tau_motor")

    @property
    def is_known(self) -> bool:
        """Whether no table has it: the lab knows it besides, and a world says it, not a reading."""
        return self.kind.startswith("known_")

    @property
    def is_of_drive(self) -> bool:
        """Whether it belongs to one joint; `index` is its drive."""
        return self.is_drive or self.kind == "q_link"

    def size(self, values: Array, weights: Array) -> float:
        """Return how large what was measured is, a root mean square beside which an error is held.

        It is that of a force, a torque or a current itself. Of all else, whose zero is a matter of frame and scale, it
        is about the mean.

        Args:
            values: Shape (m,).
            weights: Shape (m,), not all zero.
        """
        about = 0.0 if self.unit in LOADS else float(np.average(values, weights=weights))
        return float(np.sqrt(np.average((values - about) ** 2, weights=weights)))

    def of(self, reading: Reading) -> Array:
        """Return its predicted values, shape (T,); zeros of what only a world says."""
        values: Array
        if self.is_known:
            return np.zeros(len(reading.time))
        match self.kind:
            case "current":
                values = reading.current[:, self.index]
            case "tau_motor":
                values = reading.torque[:, self.index]
            case "reflector":
                values = reading.reflectors[:, self.index, self.axis]
            case "q_link":
                values = reading.q_link[:, self.index]
            case "force":
                values = reading.force[:, self.axis]
            case "moment":
                values = reading.moment[:, self.axis]
            case "gas_pressure":
                values = reading.gas_pressure
            case "gas_temperature":
                values = reading.gas_temperature
            case _:
                raise AssertionError(self.kind)
        return values


def quantities_of(runs: tuple[Run, ...], compiled: CompiledRobot) -> tuple[Quantity, ...]:
    """Return what the runs measured and a replay predicts, in a fixed order."""
    measured = {name for run in runs for name in run.columns}
    n, r = compiled.n_joints, len(compiled.robot.figures.reflectors)
    instruments = compiled.robot.figures.instruments
    found: list[Quantity] = []
    for i in range(n):
        found.append(Quantity(f"current_{i + 1}_a", "current", "A", i))
    for i in range(n):
        unit = "Nm" if f"tau_motor_{i + 1}_nm" in measured else "N"
        found.append(Quantity(f"tau_motor_{i + 1}_{unit.lower()}", "tau_motor", unit, i))
    for k in range(r):
        found += [Quantity(f"reflector_{k + 1}_{a}_m", "reflector", "m", k, i) for i, a in enumerate(AXES)]
    for i in range(n):
        unit = "rad" if f"q_link_{i + 1}_rad" in measured else "m"
        found.append(Quantity(f"q_link_{i + 1}_{unit}", "q_link", unit, i))
    found += [Quantity(f"force_{a}_n", "force", "N", axis=i) for i, a in enumerate(AXES)]
    found += [Quantity(f"moment_{a}_nm", "moment", "Nm", axis=i) for i, a in enumerate(AXES)]
    if compiled.counterbalance is not None and instruments.pressure is not None:
        found.append(Quantity("gas_pressure_pa", "gas_pressure", "Pa"))
    if compiled.counterbalance is not None:
        found.append(Quantity("gas_temperature_k", "gas_temperature", "K"))
    kept = [quantity for quantity in found if quantity.column in measured]
    # a drive that reports both is compared by its current, which is what it measures
    currents = {quantity.index for quantity in kept if quantity.kind == "current"}
    return tuple(q for q in kept if not (q.kind == "tau_motor" and q.index in currents))


def predicted(quantities: tuple[Quantity, ...], reading: Reading) -> Array:
    """Return the predicted columns side by side, shape (T, c)."""
    if not quantities:
        return np.empty((len(reading.time), 0))
    return np.stack([quantity.of(reading) for quantity in quantities], axis=1)
