"""What a file did not say of its robot, one sentence each: for README, `figures.yaml` and `bench check`."""

from collections.abc import Iterator, Sequence

import numpy as np

from bench.robot.figures import Uncertainty
from bench.robot.starter.defaults import ROTOR_GUESSED, DriveFigures
from bench.robot.starter.source import Source, SourceJoint
from bench.robot.units import unit_of

# figure -> in words, its unit of a hinge and of a slide
WORDS = {
    "rotor_inertia": ("rotor inertia", "kg m^2", "kg"),
    "stiffness": ("stiffness of the gears", "Nm/rad", "N/m"),
    "viscous": ("viscous friction", "Nm s/rad", "N s/m"),
    "coulomb": ("Coulomb friction", "Nm", "N"),
    "torque_limit": ("torque limit", "Nm", "N"),
    "speed_limit": ("speed limit", "rad/s", "m/s"),
}
KEPT = ("the file", "armature of the file", "damping of the file", "frictionloss of the file")

ROTOR_KEPT: float = Uncertainty.model_fields["rotor_inertia"].default


def is_kept(drive: DriveFigures, key: str) -> bool:
    """Return whether a figure of a drive is the file's."""
    return drive.origins[key] in KEPT


def assumptions(source: Source, drives: Sequence[DriveFigures], heaviest: float) -> tuple[str, ...]:
    """Return what was assumed, in the order in which it is worth replacing.

    Args:
        source: What the file says.
        drives: Figures of every drive.
        heaviest: Payload that may be unstated [kg].
    """
    found, is_slide = [], [joint.is_slide for joint in source.joints]
    for key, (words, of_hinge, of_slide) in WORDS.items():
        by_reason: dict[str, list[str]] = {}
        for joint, drive in zip(source.joints, drives, strict=True):
            if not is_kept(drive, key):
                by_reason.setdefault(drive.origins[key], []).append(f"{joint.name} {getattr(drive, key):g}")
        for reason, who in by_reason.items():
            found.append(f"{words} ({', '.join(who)}) in {unit_of(of_hinge, of_slide, is_slide)}: {_plainly(reason)}")
    if unlimited := [joint for joint in source.joints if not joint.has_limits]:
        found.append(f"range ({', '.join(map(_range, unlimited))}): the file has none")
    if source.made_up_names:
        found.append(f"name of {', '.join(source.made_up_names)}: the file has none")
    if source.guessed_masses:
        found.append(
            f"mass of {', '.join(source.guessed_masses)}: the file gives shapes alone; made of them at 1000 kg/m^3"
        )
    found += _of_rotors(source, drives)
    return (
        *found,
        "instruments: drives that report torque, noise and offset 0.2 % of the torque limit; encoders, a laser tracker",
        f"payload: recordings may leave one unstated, up to {heaviest:g} kg (uncertainty.payload_kg), what the "
        "strongest drive holds up at full reach",
        "uncertainty of masses, centres of mass and friction: that of a model taken from a drawing",
        "uncertainty of stiffness: a factor of four",
    )


def _range(joint: SourceJoint) -> str:
    """Return the range that was assumed for a joint: "joint7 -360 to 360 degrees"."""
    low, high = joint.limits if joint.is_slide else np.rad2deg(joint.limits)
    return f"{joint.name} {low:.4g} to {high:.4g} {'m' if joint.is_slide else 'degrees'}"


def _of_rotors(source: Source, drives: Sequence[DriveFigures]) -> Iterator[str]:
    """Yield how well rotors are known, where the file states some."""
    pairs = list(zip(source.joints, drives, strict=True))
    kept = [joint.name for joint, drive in pairs if is_kept(drive, "rotor_inertia")]
    guessed = [joint.name for joint, drive in pairs if not is_kept(drive, "rotor_inertia")]
    known = f"are taken as known to {100 * ROTOR_KEPT:.0f} %"
    if not guessed:
        yield f"uncertainty of rotor inertias: those of the file {known}"
    elif kept:
        yield (
            f"uncertainty of rotor inertias: those of the file ({', '.join(kept)}) {known}, guesses "
            f"({', '.join(guessed)}) to {ROTOR_GUESSED:g} times the guess; with a guess that you replace, change "
            "its number in uncertainty.rotor_inertia"
        )


def _plainly(reason: str) -> str:
    if reason == "none in the file":
        return "none in the file, taken as 0; `bench identify --method dynamics` finds it"
    return reason.removeprefix("default: ").removeprefix("default") or "the file has none"
