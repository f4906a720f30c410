"""What is wrong with a machine in one of its recordings: what lasts, what drifts and what is set up anew."""

from dataclasses import fields

import numpy as np

from bench.effects.drifts import AIR_DAY_K, DAY_K, VISCOUS, own_shares
from bench.effects.nominal import nominal_parameters
from bench.hide.background import Background
from bench.robot.compiled import CompiledRobot
from bench.simulate.fitted_errors import fitted_errors
from bench.simulate.instruments import SystematicErrors


def background_in(
    compiled: CompiledRobot, machine: Background, own: Background, rng: np.random.Generator
) -> Background:
    """Return the background errors of a machine in one recording.

    Its figures and the weights of its lab last; viscous friction follows the temperature of the day, in each drive
    beside the others; the gas is as warm as the air of the day; what is bolted on is another one.

    Args:
        compiled: The robot.
        machine: Of the machine.
        own: Drawn for this recording alone.
        rng: Source of the day.
    """
    deviations = dict(machine.deviations)
    for one in nominal_parameters(compiled):
        if one.is_viscous:
            day = VISCOUS * DAY_K * float(rng.standard_normal())
            deviations[one.name] = (1 + deviations[one.name]) * (1 + day) - 1
    air = AIR_DAY_K * float(rng.spawn(1)[0].standard_normal())  # of its own, so that all else is drawn as ever
    return Background(deviations, machine.hung, own.bolted, own.pulled, own.pull_turn, air)


def errors_in(compiled: CompiledRobot, machine: SystematicErrors, own: SystematicErrors) -> SystematicErrors:
    """Return the errors of the instruments of a machine in one recording.

    Args:
        compiled: The robot; its figures may hold errors as fitted, about which both draws are.
        machine: Of the machine.
        own: Drawn for this recording alone.
    """
    figures = compiled.robot.figures
    shares, fitted = own_shares(figures), fitted_errors(figures)
    found = {}
    for field in fields(SystematicErrors):
        name = field.name
        about, share = fitted.get(name, 0.0), shares[name]
        lasting, new = getattr(machine, name) - about, getattr(own, name) - about
        found[name] = about + np.sqrt(1 - share) * lasting + np.sqrt(share) * new
    return SystematicErrors(**found)
