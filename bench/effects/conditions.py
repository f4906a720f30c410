"""What was slow during a run: temperatures, time, and what was bolted on."""

from dataclasses import dataclass

import numpy as np

from bench.record.campaign import Array

REFERENCE_K = 293.15  # declared: [K], temperature at which the nominal figures hold


@dataclass(frozen=True)
class Conditions:
    """What was slow during a run.

    Attributes:
        gear_k: Shape (n,) [K], gearboxes.
        winding_k: Shape (n,) [K], motor windings.
        gas_k: [K], gas of the counterbalance.
        ambient_k: [K].
        payload_kg: Mass bolted to the load point, as the lab knows it.
        time_s: From the start of the campaign, in the middle of what they hold for [s].
    """

    gear_k: Array
    winding_k: Array
    gas_k: float = REFERENCE_K
    ambient_k: float = REFERENCE_K
    payload_kg: float = 0.0
    time_s: float = 0.0

    @property
    def key(self) -> tuple[object, ...]:
        """What tells conditions apart, for dictionaries."""
        return self.gear_k.tobytes(), self.winding_k.tobytes(), self.gas_k, self.ambient_k, self.payload_kg, self.time_s

    @classmethod
    def reference(cls, n: int, payload_kg: float = 0.0) -> "Conditions":
        """Return the conditions under which the nominal figures hold, for n drives."""
        return cls(np.full(n, REFERENCE_K), np.full(n, REFERENCE_K), payload_kg=payload_kg)
