"""How warm air, gears and motors of the second plant are on a day, and what thermometers show of it."""

from collections.abc import Collection
from dataclasses import dataclass
from typing import Self

import numpy as np

from bench.second.figures import ROOM_K, Array
from bench.second.instruments import Columns, Draws

GEAR_K, GEAR_S = 11.0, 2700.0  # rise and time constant of gears in work, assumed: an arm of this class
MOTOR_K, MOTOR_S = 22.0, 1500.0  # of motors
UNLIKE = 0.2  # of a rise from day to day and drive to drive, relative at most: how hard it worked before, assumed
AIR_K, AIR_S = 1.0, 3600.0  # standard deviation and time constant of the air, which leaves ROOM_K over the day, assumed
THERMOMETERS = ("gear_temperature", "motor_temperature", "ambient_temperature")
SIGMA_K, STEP_K = 0.5, 0.1  # of thermometers


@dataclass(frozen=True, eq=False)
class Weather:
    """One day; n drives.

    Attributes:
        gear, motor: Shape (n,) [K], above the air after long work.
        air: By how much the air leaves `ROOM_K` in the end [K].
    """

    gear: Array
    motor: Array
    air: float

    @classmethod
    def draw(cls, n: int, rng: np.random.Generator) -> Self:
        """Draw a day."""
        gear, motor = 1 + UNLIKE * rng.uniform(-1, 1, (2, n))
        return cls(GEAR_K * gear, MOTOR_K * motor, AIR_K * float(rng.standard_normal()))

    def columns(self, time: Array, thermometers: Collection[str], draws: Draws) -> Columns:
        """Return what thermometers show, shape (K,) each [K].

        Args:
            time: Shape (K,) [s], since the start of the campaign.
            thermometers: Which there are.
            draws: Of noise.
        """
        air = ROOM_K - self.air * np.expm1(-time / AIR_S)

        def seen(values: Array) -> Array:
            return draws.stepped(values + draws.noise(SIGMA_K, values.shape), STEP_K)

        found: Columns = {"ambient_temperature_k": seen(air)}
        for name, rises, constant in (("gear", self.gear, GEAR_S), ("motor", self.motor, MOTOR_S)):
            for j, rise in enumerate(rises, start=1):
                found[f"{name}_temperature_{j}_k"] = seen(air - rise * np.expm1(-time / constant))
        return {name: values for name, values in found.items() if name.startswith(tuple(thermometers))}
