"""What has to be known to read a first pass, in sentences."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from bench.identify.dynamics.behind_gears import friction_share
from bench.identify.dynamics.coupled import coupled_motors
from bench.identify.dynamics.found import FirstPass, Torques
from bench.identify.dynamics.held_out import HeldOut
from bench.identify.dynamics.quantities import Quantity
from bench.identify.dynamics.warming import Warming, warming_of
from bench.identify.dynamics.widths import WIDER
from bench.report.dynamics.words import REPETITION

BARELY = 1.02  # an error larger by less is the same within what folds differ by (assumed)


def notes_of(found: FirstPass, told: Sequence[Quantity], predicted: Mapping[Path, Torques]) -> Iterator[str]:
    """Yield the sentences that hold for this first pass.

    Args:
        found: First pass.
        told: What it tells.
        predicted: Folder -> what is predicted of a campaign that was not fitted.
    """
    yield from rivals_notes(found.joints, "what was held out", found.held_out)
    for folder, torques in predicted.items():
        yield from rivals_notes(found.joints, str(folder), torques)
    yield from behind_gears_notes(friction_share(found))
    yield from warming_notes(warming_of(found))
    for one in coupled_motors(found):
        yield (
            f"The motor of {one.joint} seems to turn with {one.other} as well, {one.ratio:.2f} times to one with its "
            f"own: its friction then explains {one.explained:.0%} of what is left of {one.joint}. Motors that turn "
            f"with two joints are not modelled, so friction, rotors and masses of both may be wrong by it."
        )
    yield from _leaning_notes(found, [one for one in told if one.kind == "level"])
    for j in found.has["balancer"]:
        yield (
            f"{found.joints[j]} seems to carry a spring balancer that nobody stated. Where its parent does not tilt, a "
            "balancer and a first moment of the links do the same to its torque: masses, centres and payload beside it "
            "are told apart from it by what is stated of them and by inertia alone, and their intervals have that."
        )
    if found.folds.repeats:
        yield f"{REPETITION}; give one with --held-out."
    for joint, noise in zip(found.joints, found.solution.noise, strict=True):
        if noise is None:
            yield f"{joint} never moves with its torque read: nothing is told of its friction."
    if found.solution.widths.figures:
        yield (
            f"Masses, centres and rotors lie farther from the stated figures than these allow: their stated "
            f"uncertainty was widened {WIDER**found.solution.widths.figures:.0f} times, as the evidence has it."
        )
    broken = found.bodies.broken(found.solution.parameters)
    if broken:
        yield (
            f"Without constraints, least squares makes bodies that cannot exist ({', '.join(broken)}); the parameters "
            "given are the most probable ones that can."
        )
    if found.compliance is not None:
        wound = ", ".join(f"{1e6 * max(one, 0.0):.3g}" for one in found.compliance)
        yield (
            f"Gears wind up, to first order by {wound} urad/Nm (um/N), without intervals: of drives with little torque "
            "that says nothing. `bench diagnose` tells their stiffness with intervals."
        )
    gain = found.nominal.torque_gain_sigma
    is_weighed = found.nominal.payload_sigma < found.nominal.payload
    if np.any(gain > 0):
        yield (
            f"All masses and friction scale with the torque reading, known to {gain.min():.1%}"
            f"{'' if np.ptp(gain) == 0 else f' to {gain.max():.1%}'}; that is in the intervals."
            f"{'' if is_weighed else ' Runs with and without a known payload would tell the scale better.'}"
        )
    if is_weighed:
        known = f"{found.nominal.payload_sigma:.2g} kg"
        yield f"What runs carry was weighed, to {known}; an unstated payload is what they carry beyond that."
    elif found.layout.has_payload:
        carried = (
            "each recording carries its own, which surely predicts better what is held out."
            if found.layout.carried
            else "all runs are taken to carry the same."
        )
        yield f"The payload is told against the stated masses of the links; {carried}"


def _leaning_notes(found: FirstPass, leans: Sequence[Quantity]) -> Iterator[str]:
    """Yield how gravity leans, with what to write into the MJCF; nothing where it does not."""
    if not leans:
        return
    ways = {one.name.partition(", ")[2]: one for one in leans}
    words = ", ".join(f"{way} {1e3 * one.value:.2g} +- {1e3 * one.sigma:.1g} mrad" for way, one in ways.items())
    open_ones = "".join(f" These data do not tell its {way}." for way, one in ways.items() if not one.told)
    yield (
        f"The floor is out of level, as fitted with all else: {words} in the frame of the base."
        f"{open_ones} Level the base, or check that with a spirit level and write gravity into <option> of the MJCF, "
        f'"{" ".join(f"{g:.4f}" for g in found.gravity)}"; what is written there counts as exact. `bench diagnose` '
        "names it with all other causes."
    )


def behind_gears_notes(share: float | None) -> Iterator[str]:
    """Yield that no motor pays these torques; nothing where friction shows, as in those of motors.

    Args:
        share: As of `friction_share`.
    """
    if share is not None:
        yield (
            f"These torques have next to no friction in them (no drive more than {share:.1%} of its torque), so they "
            "are those of sensors behind the gears, or friction was taken out of them. Masses and payload are told by "
            "them, too. What motors pay for friction and rotors is not in them: what is handed over predicts torques "
            "on the links, and is no feed-forward of motors. For a model of the drives give torques or currents of the "
            "motors."
        )


def warming_notes(warming: Warming | None) -> Iterator[str]:
    """Yield how much friction falls from run to run; nothing where it does not."""
    if warming is None:
        return
    each = zip(warming.joints, warming.scale, strict=True)
    shares = ", ".join(f"{joint} {scale[0] - scale[-1]:.1%}" for joint, scale in each if scale[0] > scale[-1])
    yield (
        f"Friction falls from run to run, as of drives that warm up. From {warming.runs[0]!r} to {warming.runs[-1]!r} "
        f"it falls by {shares}. Another recording is predicted with that of the middle, and a warmer or colder one is "
        "missed by as much: warm up first. A diagnosis looks for it; temperatures of the gears in the log "
        "(gear_temperature_i_k) tell it best."
    )


def rivals_notes(joints: Sequence[str], what: str, torques: HeldOut | Torques) -> Iterator[str]:
    """Yield on which joints plain least squares and the nominal model predict some data better than the first pass."""
    ours, rival, nominal = (torques.rms(model) for model in ("first_pass", "rival", "nominal"))
    for name, other in (("plain least squares", rival), ("the nominal model", nominal)):
        worse = [joint for joint, a, b in zip(joints, ours, other, strict=True) if a > BARELY * b]
        if worse:
            yield f"On {what}, {name} predicts {', '.join(worse)} better than the first pass does."
