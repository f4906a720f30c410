"""What a file did not say of its robot, one sentence each: for README, `figures.yaml` and `bench check`."""

from collections.abc import Sequence

from bench.robot.figures import Uncertainty
from bench.robot.starter.defaults import DriveFigures
from bench.robot.starter.source import Source

WORDS = {
    "rotor_inertia": "rotor inertia",
    "stiffness": "stiffness of the gears",
    "viscous": "viscous friction",
    "coulomb": "Coulomb friction",
    "torque_limit": "torque limit",
    "speed_limit": "speed limit",
}
KEPT = ("the file", "armature of the file", "damping of the file", "frictionloss of the file")


def assumptions(source: Source, drives: Sequence[DriveFigures]) -> tuple[str, ...]:
    """Return what was assumed, in the order in which it is worth replacing."""
    found = []
    for key, words in WORDS.items():
        by_reason: dict[str, list[str]] = {}
        for joint, drive in zip(source.joints, drives, strict=True):
            if (reason := drive.origins[key]) not in KEPT:
                by_reason.setdefault(reason, []).append(f"{joint.name} {getattr(drive, key):g}")
        for reason, who in by_reason.items():
            found.append(f"{words} ({', '.join(who)}): {_plainly(reason)}")
    if unlimited := [joint.name for joint in source.joints if not joint.has_limits]:
        found.append(f"range of {', '.join(unlimited)}: the file has none")
    if source.made_up_names:
        found.append(f"name of {', '.join(source.made_up_names)}: the file has none")
    if source.guessed_masses:
        found.append(
            f"mass of {', '.join(source.guessed_masses)}: the file gives shapes alone; made of them at 1000 kg/m^3"
        )
    if all(drive.origins["rotor_inertia"] in KEPT for drive in drives):
        known = Uncertainty.model_fields["rotor_inertia"].default
        found.append(f"uncertainty of rotor inertias: those of the file are taken as known to {100 * known:.0f} %")
    elif some := [j.name for j, d in zip(source.joints, drives, strict=True) if d.origins["rotor_inertia"] in KEPT]:
        found.append(
            f"uncertainty of rotor inertias: as some are guessed, those of the file ({', '.join(some)}) count as "
            "uncertain as these; state uncertainty.rotor_inertia once you know the others"
        )
    return (
        *found,
        "instruments: drives that report torque with noise of 0.2 % of the torque limit, encoders, a laser tracker",
        "payload: recordings may leave one unstated, up to what the strongest drive holds at full reach",
        "uncertainty of masses, centres of mass and friction: that of a model taken from a drawing",
        "uncertainty of stiffness: a factor of four",
    )


def _plainly(reason: str) -> str:
    if reason == "none in the file":
        return "none in the file, taken as 0; `bench identify --method dynamics` finds it"
    return reason.removeprefix("default: ").removeprefix("default") or "the file has none"
