"""Whether the parts that `figures.yaml` names play the roles that it gives them."""

from collections.abc import Iterator, Mapping, Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.robot.figures import Drive
from bench.robot.folder import Robot
from bench.robot.plausible import LEAST_MASS, OF_ELEMENTS, OF_SERVOS, OF_TORQUE_LIMITS, presliding_range

JOINT_KINDS = (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))
SITE, ON_TENDON = int(mujoco.mjtWrap.mjWRAP_SITE), int(mujoco.mjtTrn.mjTRN_TENDON)
SPEED_ROUNDING = 0.01  # relative; both are written down with three digits or more


def negative_masses(robot: Robot, spec: mujoco.MjSpec) -> Iterator[str]:
    """Yield a sentence for every body with a negative mass; MuJoCo would take it for zero and say nothing."""
    for body in spec.bodies:
        if body.explicitinertial and body.mass < 0:
            place = f"{robot.mjcf}: body {body.name!r}"
            yield f"{place}: mass is {body.mass:g} kg; give the body positive mass and inertia."


def faulty_roles(robot: Robot, model: mujoco.MjModel) -> Iterator[str]:
    """Yield a sentence for every drive whose parts do not fit together, with its place and what to do.

    All names must exist in the model.
    """
    for i, drive in enumerate(robot.figures.drives):
        place = f"{robot.figures_file}: drives[{i}]"
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
        if not model.jnt_limited[joint.id]:
            yield f"{place}.joint: {drive.joint!r} has no range; write how far the joint turns."
        yield from _element(place, drive.element, model, joint.id, rotor.id)
        yield from _servo(place, drive.servo, model)
        yield from _speed(place, drive, model)
        for part, name, on, word in (
            ("servo", drive.servo, rotor.id, drive.rotor),
            ("motor_friction", drive.motor_friction, rotor.id, drive.rotor),
            ("link_friction", drive.link_friction, joint.id, drive.joint),
        ):
            if model.actuator(name).trnid[0] != on:
                yield f"{place}.{part}: actuator {name!r} does not act on {word!r}; let it."
    yield from _counterbalance(robot, model)


def unlike_a_robot(robot: Robot, model: mujoco.MjModel) -> Iterator[str]:
    """Yield a sentence for what no arm is, or what the bench does not compute, of a robot whose parts play their roles.

    Only of a robot as its folder has it: with effects in it, elements may become softer than any gear.
    """
    for i, drive in enumerate(robot.figures.drives):
        stiffness = model.tendon_stiffness[model.tendon(drive.element).id]
        rotor = model.dof_armature[model.jnt_dofadr[model.joint(drive.rotor).id]]
        frequency = float(np.sqrt(stiffness / rotor)) / (2 * np.pi)
        yield from OF_ELEMENTS.faults(
            [(f"{robot.figures_file}: drives[{i}].element: tendon {drive.element!r}", frequency)]
        )
        link = int(model.jnt_bodyid[model.joint(drive.joint).id])
        mass = float(np.sum(model.body_mass[model.body_weldid == link]))  # with all that is fixed on it
        yield from LEAST_MASS.faults([(f"{robot.mjcf}: body {_name(model, 'body', link)!r}", mass)])
        if model.qpos0[model.jnt_qposadr[model.joint(drive.joint).id]] != 0:
            yield f"{robot.mjcf}: joint {drive.joint!r} has ref != 0; move its zero into the pose of its body."
    driven = {name for drive in robot.figures.drives for name in (drive.joint, drive.rotor)}
    for index in range(model.njnt):
        name, is_held = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_JOINT, index), model.jnt_stiffness[index] > 0
        if name not in driven and not is_held:  # what bends is a joint that a spring holds
            body = _name(model, "body", int(model.jnt_bodyid[index]))
            yield f"{robot.mjcf}: body {body!r} has a joint that no drive of figures.yaml names; take it out."
    for index in range(model.neq):
        name = _name(model, "equality", index)
        yield f"{robot.mjcf}: equality {name!r}: the bench computes chains without constraints; take it out."
    data = mujoco.MjData(model)
    mujoco.mj_fwdPosition(model, data)
    if data.ncon:
        bodies = [_name(model, "body", int(model.geom_bodyid[geom])) for geom in data.contact.geom[0]]
        yield (
            f"{robot.mjcf}: shapes of bodies {bodies[0]!r} and {bodies[1]!r} touch with all joints at zero; write "
            'contype="0" conaffinity="0" at the geoms, contact is left out here.'
        )


def unlike_friction(
    robot: Robot, model: mujoco.MjModel, elements: Mapping[str, tuple[NDArray[np.float64], NDArray[np.float64]]]
) -> Iterator[str]:
    """Yield a sentence for every friction element that holds as no surfaces do.

    Args:
        robot: The robot.
        model: Its compiled model.
        elements: Levels [Nm] and presliding stiffnesses [Nm/rad] by side, motor or link, each of shape (n,).
    """
    for side, (levels, stiffness) in elements.items():
        for i, drive in enumerate(robot.figures.drives):
            name = drive.motor_friction if side == "motor" else drive.link_friction
            limit = float(np.max(np.abs(model.actuator_forcerange[model.actuator(drive.servo).id])))
            limits = presliding_range(float(levels[i]), limit)
            yield from limits.faults([(f"{robot.mjcf}: actuator {name!r}", float(stiffness[i]))])


def unlike_errors(robot: Robot, model: mujoco.MjModel) -> Iterator[str]:
    """Yield a sentence for each fitted error of a reading that no instrument on this robot has, at its key."""
    readings = robot.figures.fitted.readings
    place = f"{robot.figures_file}: fitted.readings"
    for i, drive in enumerate(robot.figures.drives):
        limit = float(np.max(np.abs(model.actuator_forcerange[model.actuator(drive.servo).id])))
        for key, offset, most, unit in (
            ("current_offset_a", readings.current_offset_a, limit / drive.torque_constant_nm_per_a, "A"),
            ("torque_offset_nm", readings.torque_offset_nm, limit, "Nm"),
        ):
            if abs(value := offset.get(drive.joint, 0.0)) > most:
                yield (
                    f"{place}.{key}.{drive.joint}: is {value:g} {unit}, more than the drive can give ({most:g} {unit}, "
                    f"drives[{i}]); take it out, or correct its unit."
                )
    reach = _reach(robot, model)
    for name, vector in (
        *((f"nest_m.{site}", nest) for site, nest in readings.nest_m.items()),
        ("tracker_drift_m_per_h", readings.tracker_drift_m_per_h),
    ):
        if (away := float(np.linalg.norm(vector))) > reach:
            yield (
                f"{place}.{name}: is {away:g} m, more than the arm reaches ({reach:.3g} m); take it out, or "
                f"give it in m."
            )


def _reach(robot: Robot, model: mujoco.MjModel) -> float:
    """Return how far the load point can be from the base at most: the chain from body to body, stretched [m]."""
    site = model.site(robot.figures.load_point).id
    body, reach = int(model.site_bodyid[site]), float(np.linalg.norm(model.site_pos[site]))
    while body:
        reach += float(np.linalg.norm(model.body_pos[body]))
        reach += sum(
            float(np.ptp(model.jnt_range[joint]))
            for joint in np.flatnonzero(model.jnt_bodyid == body)
            if model.jnt_type[joint] == int(mujoco.mjtJoint.mjJNT_SLIDE)
        )
        body = int(model.body_parentid[body])
    return reach


def _name(model: mujoco.MjModel, kind: str, index: int) -> str:
    return mujoco.mj_id2name(model, getattr(mujoco.mjtObj, f"mjOBJ_{kind.upper()}"), index) or f"number {index}"


def _servo(place: str, name: str, model: mujoco.MjModel) -> Iterator[str]:
    """Yield a sentence for each figure of a servo that no servo has."""
    servo = model.actuator(name).id
    where = f"{place}.servo: actuator {name!r}"
    if model.actuator_ctrlnum[servo] < 2 or int(model.actuator_biastype[servo]) != int(mujoco.mjtBias.mjBIAS_AFFINE):
        yield f'{where} is no servo; write <pid> with input="pos vel".'
        return
    gains = (-model.actuator_biasprm[servo, 1], -model.actuator_biasprm[servo, 2], model.actuator_gainprm[servo, 0])
    for limits, gain in zip(OF_SERVOS, gains, strict=True):
        yield from limits.faults([(where, float(gain) + 0.0)])  # not -0
    low, high = (float(x) for x in model.actuator_forcerange[servo])
    if not low < 0 < high:
        yield f'{where}: forcerange is "{low:g} {high:g}"; write the torque limit, as forcerange="-300 300".'
    else:
        yield from OF_TORQUE_LIMITS.faults([(where, max(-low, high))])


def _counterbalance(robot: Robot, model: mujoco.MjModel) -> Iterator[str]:
    """Yield a sentence where tendon or actuator of the counterbalance are not those of a cylinder."""
    named, file = robot.figures.counterbalance, robot.figures_file
    if named is None:
        return
    tendon, actuator = model.tendon(named.tendon).id, model.actuator(named.actuator).id
    start, count = model.tendon_adr[tendon], model.tendon_num[tendon]
    if count != 2 or any(int(kind) != SITE for kind in model.wrap_type[start : start + count]):
        yield (
            f"{file}: counterbalance.tendon: {named.tendon!r} must be <spatial> and run straight between two sites, "
            "from the fixed side to the moving one."
        )
    elif named.joint in (joints := [drive.joint for drive in robot.figures.drives]):
        yield from _not_across(
            f"{file}: counterbalance", named.joint, joints, model, model.wrap_objid[start : start + 2]
        )
    if model.actuator_trntype[actuator] != ON_TENDON or model.actuator_trnid[actuator, 0] != tendon:
        yield f"{file}: counterbalance.actuator: {named.actuator!r} does not act on {named.tendon!r}; let it."
    if model.actuator_plugin[actuator] < 0:
        yield (
            f"{file}: counterbalance.actuator: {named.actuator!r} is no gas spring; write "
            '<plugin plugin="bench.gas_spring"> with its figures.'
        )


def _not_across(
    place: str, joint: str, joints: Sequence[str], model: mujoco.MjModel, anchors: NDArray[np.int32]
) -> Iterator[str]:
    """Yield a sentence where a cylinder does not run across the joint that is named, from the fixed side on.

    Args:
        place: Of the counterbalance.
        joint: That is named.
        joints: All driven ones.
        model: Of the robot.
        anchors: Shape (2,), sites at which the cylinder sits: on the fixed side, and on the moving one.
    """
    fixed, moving = (_moved_by(model, int(model.site_bodyid[site]), joints) for site in anchors)
    if fixed ^ moving != {joint}:
        across = " and ".join(map(repr, sorted(fixed ^ moving))) or "no driven joint"
        yield (
            f"{place}.joint: is {joint!r}, but the cylinder's tendon runs across {across}; name the joint that it "
            "turns, one alone."
        )
    elif joint in fixed:
        yield (
            f"{place}.tendon: runs from the moving side of {joint!r} to the fixed one; exchange its sites in the MJCF."
        )


def _moved_by(model: mujoco.MjModel, body: int, joints: Sequence[str]) -> set[str]:
    """Return which of some joints move a body."""
    found = set()
    while body:
        first = model.body_jntadr[body]
        found |= {_name(model, "joint", first + k) for k in range(model.body_jntnum[body])}
        body = int(model.body_parentid[body])
    return found & set(joints)


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
