"""Whether the parts that `figures.yaml` names play the roles that it gives them."""

from collections.abc import Iterator

import mujoco

from bench.robot.figures import Drive
from bench.robot.folder import Robot

JOINT_KINDS = (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))
SPEED_ROUNDING = 0.01  # relative; both are written down with three digits or more


def negative_masses(robot: Robot, spec: mujoco.MjSpec) -> Iterator[str]:
    """Yield a sentence for every body with a negative mass; MuJoCo would take it for zero and say nothing."""
    for body in spec.bodies:
        if body.explicitinertial and body.mass < 0:
            place = f"{robot.mjcf.name}: body {body.name!r}"
            yield f"{place}: mass is {body.mass:g} kg; give the body positive mass and inertia."


def faulty_roles(robot: Robot, model: mujoco.MjModel) -> Iterator[str]:
    """Yield a sentence for every drive whose parts do not fit together, with its place and what to do.

    All names must exist in the model.
    """
    for i, drive in enumerate(robot.figures.drives):
        place = f"figures.yaml: drives[{i}]"
        joint, rotor = model.joint(drive.joint), model.joint(drive.rotor)
        kinds = [int(joint.type[0]), int(rotor.type[0])]
        if any(kind not in JOINT_KINDS for kind in kinds):
            yield f"{place}: {drive.joint!r} and {drive.rotor!r} must be hinges or slides."
            continue
        if joint.id == rotor.id:
            yield f"{place}.rotor: {drive.rotor!r} is the link's joint; add a rotor, a body of its own in the world."
            continue
        body = int(model.jnt_bodyid[rotor.id])
        if model.body_parentid[body] != 0 or model.body_jntnum[body] != 1:
            yield f"{place}.rotor: {drive.rotor!r} must be the only joint of a body that stands in the world."
        if model.dof_armature[model.jnt_dofadr[rotor.id]] <= 0:
            yield f"{place}.rotor: {drive.rotor!r} has no armature; write J_m N^2 there."
        yield from _element(place, drive.element, model, joint.id, rotor.id)
        yield from _speed(place, drive, model)
        for part, name, on, word in (
            ("servo", drive.servo, rotor.id, drive.rotor),
            ("motor_friction", drive.motor_friction, rotor.id, drive.rotor),
            ("link_friction", drive.link_friction, joint.id, drive.joint),
        ):
            if model.actuator(name).trnid[0] != on:
                yield f"{place}.{part}: actuator {name!r} does not act on {word!r}; let it."


def _speed(place: str, drive: Drive, model: mujoco.MjModel) -> Iterator[str]:
    """Yield a sentence where a servo lets less speed through than the drive is said to have."""
    servo = model.actuator(drive.servo).id
    velocity = model.actuator_ctrladr[servo] + 1
    if model.actuator_ctrlnum[servo] < 2 or not model.actuator_ctrllimited[velocity]:
        return
    let, limit = float(model.actuator_ctrlrange[velocity][1]), drive.speed_limit_rad_per_s
    if let < (1 - SPEED_ROUNDING) * limit:
        yield (
            f"{place}.speed_limit_rad_per_s: is {limit:g}, but velrange of the servo {drive.servo!r} lets {let:g} "
            f'through; write velrange="-{limit:g} {limit:g}" into the MJCF, or take it out.'
        )


def _element(place: str, name: str, model: mujoco.MjModel, joint: int, rotor: int) -> Iterator[str]:
    element = model.tendon(name).id
    wrapped = slice(model.tendon_adr[element], model.tendon_adr[element] + model.tendon_num[element])
    coefficients = dict(zip(model.wrap_objid[wrapped].tolist(), model.wrap_prm[wrapped].tolist(), strict=True))
    if coefficients.get(rotor) != 1 or coefficients.get(joint) != -1:
        yield f"{place}.element: tendon {name!r} must be <fixed>, with the rotor at coef 1 and the link's joint at -1."
    elif model.tendon_stiffness[element] <= 0:
        yield f"{place}.element: tendon {name!r} has no stiffness; write k there."
