"""What may be anew in a recording: instruments are set up again, another payload is bolted on, gas is refilled.

A machine that was used meanwhile may also have other friction and softer joints.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.replay.nuisances import PULL_DIRECTION, PULLED, Nuisance
from bench.effects.effect import WHOLE, Effect
from bench.effects.gas import GasLoss, GasTemperature
from bench.errors import InputError, unknown_name
from bench.predict.another_payload import AnotherPayload
from bench.robot.compiled import CompiledRobot


@dataclass(frozen=True)
class Free:
    """One thing that may be anew.

    Attributes:
        words: What it is.
        figures: Beginnings of the names of the figures with which it is described; their stated uncertainty is the
            prior.
        effect: Or the effect; its plausible size is the prior, in both directions.
        without: Why it cannot be free where the effect has no place.
    """

    words: str
    figures: tuple[str, ...] = ()
    effect: Effect | None = None
    without: str = "this robot has none"


COULOMB_FIGURES = ("motor-side Coulomb friction of", "link-side Coulomb friction of")
FREE: Mapping[str, Free] = {
    "encoder_zero": Free("zeros of the link encoders against those of the motors", ("zero of link encoder",)),
    "current_offset": Free("offsets of the motor currents", ("current offset of",)),
    "torque_offset": Free("offsets of the motor torques that drives report", ("torque offset of",)),
    "tracker_frame": Free("place and direction of the laser tracker", ("tracker frame",)),
    "tracker_drift": Free("drift of the laser tracker", ("tracker drift",)),
    "reflector_nest": Free("where reflectors sit in their nests", ("nest of reflector",)),
    "force_sensor": Free("gain and tilt of the force sensor", ("gain of the force sensor", "tilt of the force sensor")),
    "gas_thermometer": Free("error of the thermometer of the gas", ("thermometer of the gas",)),
    "friction": Free(
        "friction of every drive, Coulomb, viscous and rolling",
        (*COULOMB_FIGURES, "viscous friction of", "rolling friction of", "learned friction over speed of"),
    ),
    "stiffness": Free("stiffness of every elastic element", ("stiffness of",)),
    "weights": Free(
        "what hangs or is bolted on, against what is written down",
        ("weights that hang", "weights bolted", PULLED, PULL_DIRECTION),
    ),
    "payload": Free(
        "mass, inertia and centre of mass of what the model carries",
        effect=AnotherPayload(),
        without="`uncertainty.payload_kg: 0` in figures.yaml of the robot says that recordings leave no payload "
        "unstated; state there how many kg they may leave",
    ),
    "gas_amount": Free("amount of gas in the counterbalance", effect=GasLoss()),
    "gas_temperature": Free("temperature of the gas in the counterbalance", effect=GasTemperature()),
}


def checked(names: Iterable[str]) -> tuple[str, ...]:
    """Return the names of what is free, each once.

    Raises:
        InputError: A name is unknown; all faults together.
    """
    found = tuple(dict.fromkeys(names))
    if faults := [f"--free {name}: {unknown_name('name', name, FREE)}" for name in found if name not in FREE]:
        raise InputError(faults)
    return found


def freed_figures(names: Sequence[str], nuisances: Sequence[Nuisance]) -> list[int]:
    """Return the indices of the figures that are free.

    Raises:
        InputError: The recording shows nothing of what is free, or the robot states no uncertainty for it.
    """
    found, faults = [], []
    for name in names:
        mine = [i for i, one in enumerate(nuisances) if one.name.startswith(FREE[name].figures)]
        if FREE[name].figures and not mine:
            faults.append(
                f"--free {name}: nothing to fit: this recording has no such channel, or figures.yaml of the robot "
                f"states no uncertainty for it ({FREE[name].words})."
            )
        found += mine
    if faults:
        raise InputError(faults)
    return found


def freed_causes(names: Sequence[str], compiled: CompiledRobot) -> tuple[Cause, ...]:
    """Return the effects that are free, each with sizes in both directions.

    Raises:
        InputError: The robot has no such part, or states that it is known.
    """
    found, faults = [], []
    for name in names:
        effect = FREE[name].effect
        if effect is None:
            continue
        if not effect.places(compiled):
            faults.append(f"--free {name}: {FREE[name].without} ({FREE[name].words}).")
            continue
        sizes = tuple(replace(p, signed=True) for p in effect.parameters_at(compiled, WHOLE))
        found.append(Cause(effect, WHOLE, sizes, ()))
    if faults:
        raise InputError(faults)
    return tuple(found)
