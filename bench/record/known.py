"""What the lab knows besides the tables, each a reading with a sigma: a payload, a stiffness, the gas."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import hypot
from typing import Literal

from bench.record.possible import (
    MAX_MASS,
    MAX_PRESSURE,
    MIN_PRESSURE,
    PRESSURES,
    TEMPERATURES,
    what_a_temperature_may_be,
)

KnownQuantity = Literal["payload_kg", "stiffness_nm_per_rad", "gas_pressure_pa", "gas_temperature_k"]
PAYLOAD = "payload_kg"
CONTRADICTS = 5.0  # declared: standard errors between two readings of one thing; less than one pair in a million is
FINEST = 1e-6  # of a value; the best balances and gauges read to 1e-5


@dataclass(frozen=True)
class Known:
    """One thing that the lab knows besides; a reading of it.

    Attributes:
        quantity: What, with its unit.
        value: Of the reading.
        sigma: Its standard deviation.
        joint: Number of the drive from 1, of a stiffness; 0 for everything else.
        at: Positions of all joints [rad], of a slide [m], at which a gas pressure was read; empty for everything else.
        recording: Name of the recording in which it was so; "": the campaign has but one, or it is the machine's.
        note: Free words.
    """

    quantity: KnownQuantity
    value: float
    sigma: float
    joint: int = 0
    at: tuple[float, ...] = ()
    recording: str = ""
    note: str = ""

    def faults(self, recordings: tuple[str, ...]) -> Iterator[tuple[str, str, str]]:
        """Yield key, fault and remedy of everything that is wrong with it.

        Args:
            recordings: Of the campaign.
        """
        if (self.quantity == "stiffness_nm_per_rad") != (self.joint > 0):
            yield (
                "joint",
                "a stiffness is of one joint (from 1), and nothing else is",
                "give joint: 2 with a stiffness alone",
            )
        if (self.quantity == "gas_pressure_pa") != bool(self.at):
            words = "a gas pressure is of one pose, and nothing else is"
            yield "at", words, "give at: [angle of every joint in rad] with a pressure alone"
        if self.value < 0 or (self.value == 0 and self.quantity != PAYLOAD):
            yield "value", f"{self.value:g} cannot be", "correct it; units are SI"
        else:
            yield from (("value", *words) for words in self._out_of_limits())
        if self.sigma < FINEST * self.value:
            words = f"{self.sigma:g} is less than {FINEST:g} of the value, and no instrument reads so finely"
            yield "sigma", words, "give the standard deviation of the reading"
        if self.recording and self.recording not in recordings:
            names = ", ".join(name for name in recordings if name) or "none has a name"
            yield "recording", f"there is no recording {self.recording!r}", f"recordings: {names}"
        if not self.recording and len(recordings) > 1 and self.quantity != "stiffness_nm_per_rad":
            names = ", ".join(name for name in recordings if name)
            yield "recording", "is missing, and the campaign has several", f"say in which it was so: {names}"

    def _out_of_limits(self) -> Iterator[tuple[str, str]]:
        """Yield fault and remedy of a value that no column could hold either."""
        match self.quantity:
            case "payload_kg" if self.value > MAX_MASS:
                yield f"{self.value:g} kg is no mass that hangs on an arm", "correct it"
            case "gas_pressure_pa" if self.value < MIN_PRESSURE:
                yield f"{self.value:g} Pa is an empty cylinder", PRESSURES
            case "gas_pressure_pa" if self.value > MAX_PRESSURE:
                yield f"{self.value:g} Pa is more than a cylinder holds", "look at its unit"
            case "gas_temperature_k":
                limits = TEMPERATURES["gas_temperature"]
                if not limits[0] <= self.value <= limits[1]:
                    guess = what_a_temperature_may_be(self.value, limits)
                    yield f"{self.value:g} K is no temperature of the gas", guess


def contradictions(known: Sequence[Known]) -> Iterator[tuple[str, str]]:
    """Yield key and words of each reading that is further from the first of its thing than both sigmas explain."""
    first: dict[Known, int] = {}
    for i, one in enumerate(known):
        k = first.setdefault(replace(one, value=0, sigma=0, note=""), i)
        other = known[k]
        apart = abs(one.value - other.value) / hypot(one.sigma, other.sigma)
        if apart > CONTRADICTS:
            words = f"{one.value:g} ± {one.sigma:g} and {other.value:g} ± {other.sigma:g} (known[{k}])"
            yield f"known[{i}].value", f"{words} are readings of one thing, {apart:.2g} standard errors apart"
