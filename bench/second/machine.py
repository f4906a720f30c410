"""The second plant's arm and its instruments as they are in one recording: what lasts, and what is another one then."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from bench.robot.figures import Figures as RobotFigures
from bench.second.background import drawn
from bench.second.errors import Errors
from bench.second.figures import Array, Figures


@dataclass(frozen=True, eq=False)
class Machine:
    """A machine that is recorded several times.

    Attributes:
        rng: Source of what lasts; recordings whose generators have the same seed are of one machine.
        shares: Attribute of `Errors` -> share of its variance that is another one in each recording; (n,) or one.
        viscous: Standard deviation of viscous friction from recording to recording, relative, in each drive.
    """

    rng: np.random.Generator
    shares: Mapping[str, Array | float]
    viscous: float


@dataclass(frozen=True, eq=False)
class Recorded:
    """The arm and what its instruments get wrong, in one recording."""

    figures: Figures
    errors: Errors


def perfect(nominal: Figures) -> Recorded:
    """Return an arm that is nominal, with instruments that are right."""
    return Recorded(nominal, Errors.none(nominal.n, len(nominal.reflectors)))


def imperfect(
    nominal: Figures, known: RobotFigures, rng: np.random.Generator, machine: Machine | None = None
) -> Recorded:
    """Return an arm and instruments that are a little wrong in everything.

    Args:
        nominal: Figures of the arm.
        known: The robot's own, for what is uncertain.
        rng: Of the recording.
        machine: What lasts; None: all comes from `rng`, and nothing drifts.
    """
    spread = np.array([drive.torque_constant_error for drive in known.drives])

    def errors(source: np.random.Generator) -> Errors:
        return Errors.draw(known.instruments, spread, len(nominal.reflectors), source)

    if machine is None:
        return Recorded(drawn(nominal, known.uncertainty, rng), errors(rng))
    lasting, figures = errors(machine.rng), drawn(nominal, known.uncertainty, machine.rng)
    oil = 1 + machine.viscous * rng.standard_normal(figures.n)
    bolted = known.uncertainty.load * float(rng.standard_normal())
    figures = replace(figures, viscous=figures.viscous * oil, payload_change=bolted)
    return Recorded(figures, lasting.in_recording(errors(rng), machine.shares))
