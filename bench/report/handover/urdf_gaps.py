"""What a robot has that its URDF cannot say, in sentences."""

from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np

from bench.report.handover.applied import Applied
from bench.robot.plugins import attributes_of
from bench.robot.units import unit_of

GRAVITY = (0.0, 0.0, -9.81)  # [m/s^2], which readers of URDF take unless told
WITHOUT_FRICTION = (
    "friction: there is none in any drive. If the robot was fitted to torques of sensors behind the gears, that is "
    "right for those; motors have to pay their friction and their rotors beside"
)
LAWS = "SI; names and laws: bench.friction in bench/actuators/README.md"
ROUND = 4  # digits that are shown; drives.csv has all
# Of a friction element: the level is in the URDF, the second is how a simulation holds it, the third a name
NOT_LISTED = ("coulomb", "presliding_stiffness", "element")
# Shares of another one, which say nothing where that is none
OF_LEVEL = ("asymmetry", "static_rise", "stribeck_velocity", "ripple", "ripple_period", "ripple_phase")
SHARES = dict.fromkeys(OF_LEVEL, "coulomb") | {"rolling_asymmetry": "rolling"}


def gaps_of(applied: Applied) -> Iterator[str]:
    """Yield a sentence for everything that the URDF lacks and a prediction of torques or deflections needs."""
    compiled, model, at = applied.compiled, applied.compiled.model, applied.compiled.at
    figures = compiled.robot.figures
    joints = [drive.joint for drive in figures.drives]
    unit = partial(unit_of, is_slide=compiled.is_slide)
    inertias = _listed(joints, model.dof_armature[at.q_dof].tolist())
    yield f"rotor inertia at the joint (`armature` of Pinocchio) [{unit('kg m^2', 'kg')}]: {inertias}"
    stiffness = _listed(joints, compiled.stiffness.tolist())
    yield f"stiffness of the gears [{unit('Nm/rad', 'N/m')}]: {stiffness}; links of a URDF are where the motors are"
    if not compiled.has_plain_elements:
        yield "play, softening or coupling of the gears"
    if applied.passive:
        yield f"passive hinges, which are stiff here: {', '.join(applied.passive)}"
    if applied.is_without_friction:
        yield WITHOUT_FRICTION
    yield from _friction(applied)
    if compiled.counterbalance is not None and figures.counterbalance:
        yield f"the counterbalance on {joints[compiled.counterbalance.joint]}: `balance` in torque.csv has its torque"
    named = {name for drive in figures.drives for name in (drive.servo, drive.motor_friction, drive.link_friction)}
    named |= {figures.counterbalance.actuator} if figures.counterbalance else set()
    others = [str(one.name) for one in applied.spec.actuators if one.name not in named]
    if others:
        yield f"torques that were learned or added: {', '.join(others)}; `rest` in torque.csv has them"
    if np.any(model.dof_dampingpoly):
        yield "viscous friction that does not grow with the speed itself"
    if not np.array_equal(model.opt.gravity, GRAVITY):
        yield f"gravity: ({', '.join(f'{x:g}' for x in model.opt.gravity)}) m/s^2 here"
    if figures.instruments.current:
        constants = [drive.torque_constant_nm_per_a for drive in figures.drives]
        yield f"torque constants [{unit('Nm/A', 'N/A')}]: {_listed(joints, constants)}"
    if words := list(figures.fitted.words()):
        yield f"what `figures.yaml` holds as fitted beside the model: {', '.join(words)}"
    yield "shapes: take them from your own URDF"


def _friction(applied: Applied) -> Iterator[str]:
    for drive in applied.compiled.robot.figures.drives:
        for side, name in (("motor", drive.motor_friction), ("link", drive.link_friction)):
            found = attributes_of(applied.spec, name)
            listed = {key: text for key, text in found.items() if not _is_zero(text)}
            laws = {
                key: text for key, text in listed.items() if key not in NOT_LISTED and SHARES.get(key, key) in listed
            }
            if laws:
                words = ", ".join(f"{key.replace('_', ' ')} {float(text):.{ROUND}g}" for key, text in laws.items())
                yield f"friction of {drive.joint}, {side} side, beyond its Coulomb level: {words} ({LAWS})"


def _is_zero(text: str) -> bool:
    try:
        return float(text) == 0
    except ValueError:
        return not text.strip()


def _listed(joints: Sequence[str], values: Sequence[float]) -> str:
    return ", ".join(f"{joint} {value:.{ROUND}g}" for joint, value in zip(joints, values, strict=True))
