"""How warm everything was: a first-order model of gears, windings, air and gas over the wall-clock time of a session.

Rises and time constants are those of a six-axis arm of the 150 kg class in continuous work: gears 12 K in 40 min,
windings 25 K in 20 min, assumed. The robot works in the breaks too, on a program that is not recorded, as labs let it
do so that friction settles; it rests where a run only stands.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from bench.effects.conditions import REFERENCE_K, Conditions

Array = NDArray[np.float64]

MINUTE = 60.0  # [s]
GEAR_RISE_K, GEAR_TIME_S = 12.0, 40 * MINUTE
WINDING_RISE_K, WINDING_TIME_S = 25.0, 20 * MINUTE
RISE_SPREAD = 0.2  # relative, from drive to drive
AMBIENT_DRIFT_K, AMBIENT_TIME_S = 1.0, 60 * MINUTE
GAS_TIME_S = 60 * MINUTE  # gas follows the air, through oil and steel


@dataclass(frozen=True)
class Spell:
    """A stretch of time in which the robot works or rests.

    Attributes:
        seconds: How long.
        works: Whether it works.
        payload_kg: Mass bolted to the load point, as the lab knows it.
    """

    seconds: float
    works: bool
    payload_kg: float = 0.0


@dataclass(frozen=True)
class WarmUp:
    """One day in the laboratory.

    Attributes:
        gear_rise: Shape (n,) [K], above the air, after long work.
        winding_rise: Shape (n,) [K].
        ambient_drift: [K], by how much the air is another one in the end.
        air: [K], how warm everything is at the start.
    """

    gear_rise: Array
    winding_rise: Array
    ambient_drift: float
    air: float = REFERENCE_K

    @classmethod
    def draw(cls, n: int, rng: np.random.Generator, air: float = REFERENCE_K) -> Self:
        """Draw a day for n drives, which begins with air so warm [K]."""
        spread = 1 + RISE_SPREAD * rng.uniform(-1, 1, (2, n))
        return cls(
            GEAR_RISE_K * spread[0], WINDING_RISE_K * spread[1], AMBIENT_DRIFT_K * float(rng.standard_normal()), air
        )

    def over(self, spells: Sequence[Spell]) -> tuple[Conditions, ...]:
        """Return the conditions in the middle of each spell; at the start everything is as warm as the air."""
        n, now, gas = len(self.gear_rise), 0.0, self.air
        gear, winding = np.full(n, self.air), np.full(n, self.air)
        found = []
        for spell in spells:
            half = spell.seconds / 2
            for is_middle in (True, False):
                ambient = self.air - self.ambient_drift * float(np.expm1(-(now + half / 2) / AMBIENT_TIME_S))
                gear = _towards(gear, ambient + spell.works * self.gear_rise, half / GEAR_TIME_S)
                winding = _towards(winding, ambient + spell.works * self.winding_rise, half / WINDING_TIME_S)
                gas = float(_towards(np.array(gas), np.array(ambient), half / GAS_TIME_S))
                now += half
                if is_middle:
                    found.append(Conditions(gear, winding, gas, ambient, spell.payload_kg))
        return tuple(found)


def _towards(value: Array, end: Array, times: float) -> Array:
    return np.asarray(end + (value - end) * np.exp(-times))
