"""What stands in a model between a drive and its joint, and the figures know nothing of.

The bench takes a servo's force for the torque at the joint and its set point for the motor's angle, inertia of drives
from their rotors alone, and Coulomb friction from its own law alone. A gear, a narrower range, a limit, an armature or
frictionloss besides is computed by MuJoCo without a word, and not by what holds a recording against the robot.
"""

from collections.abc import Iterator

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.robot.figures import Drive
from bench.robot.folder import Robot

ROUNDING = 0.01  # of a range or a limit; they are written down with three digits or more
SWALLOWS = (
    10.0  # times a drive's torque, that viscous friction takes at the drive's speed; no drive reaches a tenth then
)


def hindrances(robot: Robot, model: mujoco.MjModel) -> Iterator[str]:
    """Yield a sentence for each; the parts of the robot must play their roles."""
    for i, drive in enumerate(robot.figures.drives):
        place = f"{robot.figures_file}: drives[{i}]"
        for part in ("servo", "motor_friction", "link_friction"):
            yield from _gear(f"{place}.{part}", getattr(drive, part), model)
        yield from _ranges(place, drive, model)
        yield from _limits(place, drive, model)
        if model.jnt_stiffness[model.joint(drive.rotor).id] > 0:
            yield f"{place}.rotor: joint {drive.rotor!r} has a spring, and no motor has; take its stiffness out."
    named = robot.figures.counterbalance
    if named is not None:
        place = f"{robot.figures_file}: counterbalance"
        yield from _gear(f"{place}.actuator", named.actuator, model)
        if model.tendon_actfrclimited[model.tendon(named.tendon).id]:
            yield f"{place}.tendon: {named.tendon!r} has an actuatorfrcrange, and gas has none; take it out."


def friction_holds(robot: Robot, model: mujoco.MjModel, coulomb: NDArray[np.float64]) -> Iterator[str]:
    """Yield a sentence for each drive that its own friction holds; `coulomb` of both sides, shape (n,) [Nm]."""
    for i, drive in enumerate(robot.figures.drives):
        place = f"{robot.figures_file}: drives[{i}]"
        dofs = [int(model.jnt_dofadr[model.joint(name).id]) for name in (drive.rotor, drive.joint)]
        torque = float(np.max(np.abs(model.actuator_forcerange[model.actuator(drive.servo).id])))
        level = float(coulomb[i] + model.dof_frictionloss[dofs].sum())
        if level >= torque:
            words = f"Coulomb friction of motor, link and joints is {level:g} Nm in all, and the servo has {torque:g}"
            yield f"{place}: {words}; correct coulomb, frictionloss or forcerange."
        viscous = float(model.dof_damping[dofs].sum()) * drive.speed_limit_rad_per_s
        if viscous > SWALLOWS * torque:
            words = f"damping takes {viscous:g} Nm at the speed limit, and the servo has {torque:g}"
            yield f"{place}: {words}; a servo's damping is its kv, friction of the joint is less."


def _gear(place: str, name: str, model: mujoco.MjModel) -> Iterator[str]:
    gear = float(model.actuator_gear[model.actuator(name).id, 0])
    if gear != 1:
        yield f'{place}: actuator {name!r} has gear="{gear:g}"; write its figures as they are at the joint, without it.'


def _ranges(place: str, drive: Drive, model: mujoco.MjModel) -> Iterator[str]:
    """Yield what keeps servo or rotor from following the joint through its range."""
    low, high = (float(end) for end in model.jnt_range[model.joint(drive.joint).id])
    room = ROUNDING * (high - low)
    servo, rotor = model.actuator(drive.servo).id, model.joint(drive.rotor).id
    control = model.actuator_ctrladr[servo]
    found = [("servo", f"servo {drive.servo!r}: posrange", model.actuator_ctrlrange[control])]
    found = found if model.actuator_ctrllimited[control] else []
    if model.jnt_limited[rotor]:
        found.append(("rotor", f"joint {drive.rotor!r}: range", model.jnt_range[rotor]))
    for part, what, ends in found:
        if ends[0] > low + room or ends[1] < high - room:
            words = f'is "{ends[0]:g} {ends[1]:g}", and {drive.joint!r} turns from {low:g} to {high:g}'
            yield f"{place}.{part}: {what} {words}; write the joint's range, or leave it out."


def uncounted(robot: Robot, model: mujoco.MjModel) -> Iterator[str]:
    """Yield a sentence for each load, inertia and friction that stands where only MuJoCo's own simulation counts it.

    Effects may put some there, for both.
    """
    for i, drive in enumerate(robot.figures.drives):
        yield from _element(f"{robot.figures_file}: drives[{i}]", drive, model)
    yield from _elsewhere(robot, model)


def _element(place: str, drive: Drive, model: mujoco.MjModel) -> Iterator[str]:
    """Yield what an elastic element does besides giving way: it is no stop, and no load where both sides agree."""
    element = model.tendon(drive.element).id
    low, high = (float(end) for end in model.tendon_lengthspring[element])
    if low > 0 or high < 0:
        words = f"is at rest where {drive.rotor!r} is {low if low > 0 else high:g} ahead of {drive.joint!r}"
        yield f"{place}.element: {drive.element!r} {words}; take out springlength, and springref of the joints."
    if model.tendon_limited[element]:
        yield f"{place}.element: {drive.element!r} has a range, and no gear stops; play is written as springlength."


def _elsewhere(robot: Robot, model: mujoco.MjModel) -> Iterator[str]:
    """Yield friction that is not `bench.friction`, and inertia of drives that is not their rotors'."""
    rotors = {model.joint(drive.rotor).id for drive in robot.figures.drives}
    driven = {model.joint(drive.joint).id for drive in robot.figures.drives}
    joints = [(f"joint {model.joint(j).name!r}", model.jnt_dofadr[j], j) for j in range(model.njnt)]
    friction = [(name, float(model.dof_frictionloss[dof])) for name, dof, _ in joints]
    inertia = [(name, float(model.dof_armature[dof])) for name, dof, j in joints if j in driven - rotors]
    for i in range(model.ntendon):
        name = f"tendon {model.tendon(i).name!r}"
        friction.append((name, float(model.tendon_frictionloss[i])))
        inertia.append((name, float(model.tendon_armature[i])))
    for name, value in friction:
        if value > 0:
            yield f"{robot.mjcf}: {name} has frictionloss={value:g}; write it as coulomb of a bench.friction."
    for name, value in inertia:
        if value > 0:
            yield f"{robot.mjcf}: {name} has armature={value:g}; add it to that of the rotor."


def _limits(place: str, drive: Drive, model: mujoco.MjModel) -> Iterator[str]:
    """Yield what gives way below the servo's torque limit."""
    torque = model.actuator_forcerange[model.actuator(drive.servo).id]
    for part, name in (("rotor", drive.rotor), ("joint", drive.joint)):
        joint = model.joint(name).id
        low, high = (float(end) for end in model.jnt_actfrcrange[joint])
        if model.jnt_actfrclimited[joint] and (low > (1 - ROUNDING) * torque[0] or high < (1 - ROUNDING) * torque[1]):
            words = f'actuatorfrcrange "{low:g} {high:g}", less than the forcerange of servo {drive.servo!r}'
            yield f"{place}.{part}: joint {name!r} has {words}; write the torque limit there alone."
