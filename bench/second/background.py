"""What is a little wrong in everything that the lab takes for nominal, drawn for the second plant."""

from dataclasses import replace

import numpy as np

from bench.robot.figures import Uncertainty
from bench.second.figures import Array, Figures, Friction


def drawn(figures: Figures, known: Uncertainty, rng: np.random.Generator) -> Figures:
    """Return figures as a robot has them that is like its nominal one as far as `known` says.

    Args:
        figures: Nominal.
        known: Standard deviations.
        rng: Random numbers.
    """
    n = figures.n
    drives = known.of_drives(n)

    def about(values: Array, sigma: Array) -> Array:
        return values * (1 + sigma * rng.standard_normal(values.shape))

    def rubbing(friction: Friction) -> Friction:
        return replace(friction, level=about(friction.level, drives.friction))

    lumps = tuple(
        replace(
            lump,
            mass=lump.mass * (factor := 1 + known.mass * float(rng.standard_normal())),
            inertia=lump.inertia * factor,
            com=lump.com + known.centre_of_mass_m * rng.standard_normal(3),
        )
        for lump in figures.lumps
    )
    gas = figures.gas
    if gas:
        shifts = known.geometry_m * rng.standard_normal(2)
        gas = replace(
            gas,
            rho=gas.rho + float(shifts[0]),
            b=gas.b + float(shifts[1]),
            constant=gas.constant * (1 + known.gas_constant * float(rng.standard_normal())),
            critical_length=gas.critical_length + known.critical_length_m * float(rng.standard_normal()),
        )
    return replace(
        figures,
        position=figures.position + known.geometry_m * rng.standard_normal((n, 3)),
        lumps=lumps,
        springs=replace(figures.springs, stiffness=about(figures.springs.stiffness, drives.stiffness)),
        motor=rubbing(figures.motor),
        link=rubbing(figures.link),
        gas=gas,
        rotor_inertia=about(figures.rotor_inertia, drives.rotor_inertia),
        viscous=about(figures.viscous, drives.friction),
        payload_change=known.load * float(rng.standard_normal()),
        hung_change=known.load * float(rng.standard_normal()),
    )
