"""What a file does not say of its drives: figures to start from, each with the reason that goes into the folder."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.errors import RobotError
from bench.robot.bodies import Array
from bench.robot.mass_matrix import mass_matrix
from bench.robot.starter.source import Source, SourceJoint

LARGEST = 1e9  # [kg m^2], [kg]; a thousand tonnes 30 m out, and no arm moves them
STEP = 2.5e-4  # [s], time step of a started robot
POSES = 60  # at which inertia and gravity are looked at
# [rad], what a drive's torque limit winds its joint up by: gear, bearings and what they are bolted to. Measured on the
# HH-150 (Table 5 of the paper): 5 to 21 mrad, as the geometric mean 11; data sheets of gears alone say 1 to 3
TWIST = 1e-2
STRETCH = 2e-4  # [m], the same of a slide
RULE = 0.35  # sqrt(k / J) * STEP stays below for every spring; 2 is unstable, and several act on one link
ELEMENT_DAMPING = 0.05  # ratio
ROTOR_SHARE = 0.5  # of the greatest mass that a slide moves: gears are chosen for rotors of about the load's size
# [rad/s^2], with which the torque limit of a hinge spins up its own rotor. Assumed: 16 to 63 on the KR300, of 2.6 to 20
# kNm; by what links weigh, the rotors of its wrist would be a hundred times too small
SPIN_UP = 50.0
ROTOR_GUESSED = 3.0  # uncertainty of such a guess, a share of it: from none to what spins up with 50 / 4 (HH-150: 16)
# Ratio of torque limits, from where drives cannot have the same rotor: one that is stated for all is a placeholder
UNLIKE = 2.0
# The same of viscous friction, which gears of one size class share more nearly. Assumed: 3 may be (250 and 80 Nm with 4
# Nm s/rad each), 7 is not (Panda: 87 and 12 Nm with 1 each)
RUBS_UNLIKE = 5.0
BANDWIDTH = 2 * np.pi * 6.0  # [rad/s] of the servo on rotor and link together
RESET = 0.2  # of the integral gain at which the servo would swing, J + M taken as one
SLANTED = (
    0.1  # assumed: of a lever, by which a load has to rise before its weight counts: an axis 6 degrees off upright
)
PRESLIDING = 1e-4  # [rad] or [m], where a friction element has reached its level
# Of the torque limit: level for which a frictionless element is made stiff. Assumed: Coulomb friction of geared drives
# is 1 to 10 % of it. Made for 1 %, friction of 5 % built up over half a milliradian and was found on the link side
LEAST_FRICTION = 0.05
# Torque limits by what the neediest drive is given without one, from where one limit for all drives is a placeholder.
# Assumed: `RESERVE` once more; arms of drives that are all alike have no ten times too strong shoulder
IDLE = 30.0
RESERVE = 3.0  # torque limit by what the arm alone takes, where the file limits no torque
REACH_TIME = 0.5  # [s] to the speed limit, where the file limits no torque
WEAKEST = 0.1  # of the strongest drive's torque limit: none is taken to be weaker where the file limits no torque.
# Assumed: the smallest drives of six-axis arms have 0.08 to 0.2 of it (KUKA KR300 0.09, Universal Robots UR5e 28 / 150)
SWALLOWED = (
    0.5  # of the torque limit: viscous friction that takes more at the speed limit is a servo's damping. Assumed:
)
# with friction a drive that can still accelerate keeps half of its torque
CRITICAL = 0.1  # of critical damping: damping of a joint that does more for a position servo without damping of its own
# belongs to that servo. Assumed: friction of a geared drive does not do it alone
# [rad/s] of a hinge, [m/s] of a slide, where the file has none. Assumed: 180 deg/s, as the joints of light arms have
# (UR5e, iiwa: 98 to 180)
SPEED = {False: np.pi, True: 1.0}
# the same, of the fastest: quills of small SCARAs turn at 52 rad/s (3000 deg/s, data sheets), linear drives run 10 m/s
FASTEST = {False: 60.0, True: 10.0}


DEFAULT = "default"
NEEDED = "three times what gravity, friction and acceleration take, and a tenth of the strongest drive's at least"
NO_TORQUE = f"default: the file limits no torque; {NEEDED}"


@dataclass(frozen=True)
class DriveFigures:
    """Figures of one drive, reflected to its joint; of a slide in m and N.

    Attributes:
        rotor_inertia: [kg m^2].
        viscous: Of the rotor [Nm s/rad]; 0 where the file's damping is a servo's or a placeholder.
        coulomb: On the motor side [Nm].
        stiffness: [Nm/rad].
        damping: Of the element [Nm s/rad].
        motor_presliding, link_presliding: [Nm/rad].
        kp, kv, ki: Of the servo [Nm/rad], [Nm s/rad], [Nm/(rad s)].
        torque_limit: [Nm].
        speed_limit: [rad/s].
        origins: Figure -> where it comes from, for people.
    """

    rotor_inertia: float
    viscous: float
    coulomb: float
    stiffness: float
    damping: float
    motor_presliding: float
    link_presliding: float
    kp: float
    kv: float
    ki: float
    torque_limit: float
    speed_limit: float
    origins: dict[str, str]


@dataclass(frozen=True)
class Survey:
    """What the links ask for over their working range; n joints.

    Attributes:
        least_inertia: Shape (n,), 1 / (M^-1)_jj at its smallest.
        greatest_inertia: Shape (n,), M_jj at its largest.
        gravity: Shape (n,), greatest holding torque.
        reach: Greatest distance of the load point from the first joint [m].
        lever: Of the load point from the first hinge [m]; of a robot without any from the first joint.
        bears: Shape (n,), whether a drive has to hold what is carried up: an upright hinge and a level slide have not.
    """

    least_inertia: Array
    greatest_inertia: Array
    gravity: Array
    reach: float
    lever: float
    bears: NDArray[np.bool_]


def survey(source: Source, model: mujoco.MjModel) -> Survey:
    """Look at the cleared robot in poses spread over its ranges; its degrees of freedom are the driven joints."""
    data, rng = mujoco.MjData(model), np.random.default_rng(1)
    low, high = np.clip(np.array([joint.limits for joint in source.joints]), -np.pi, np.pi).T
    home = np.array([joint.home for joint in source.joints])
    poses = np.vstack([home[None], rng.uniform(low, high, size=(POSES, len(home)))])
    order = [model.joint(joint.name).dofadr[0] for joint in source.joints]
    body, first = model.body(source.load_point.body).id, model.joint(source.joints[0].name).id
    hinges = [model.joint(joint.name).id for joint in source.joints if not joint.is_slide]
    least, greatest, gravity, reach, lever, rise = [], [], [], [], [], []
    jacobian = np.empty((3, model.nv))
    for pose in poses:
        data.qpos[order] = pose  # hinges and slides alone: qpos and qvel have the same order
        mujoco.mj_forward(model, data)
        mass = mass_matrix(model, data)
        least.append(1 / np.diag(np.linalg.inv(mass))[order])
        greatest.append(np.diag(mass)[order])
        gravity.append(np.abs(data.qfrc_bias[order]))
        load_point = data.xpos[body] + data.xmat[body].reshape(3, 3) @ source.load_point.position
        reach.append(np.linalg.norm(load_point - data.xanchor[first]))
        lever.append(np.linalg.norm(load_point - data.xanchor[hinges[0] if hinges else first]))
        mujoco.mj_jac(model, data, jacobian, None, load_point, body)
        rise.append(np.abs(jacobian[2, order]))
    bears = np.max(rise, axis=0) > SLANTED * np.where([joint.is_slide for joint in source.joints], 1.0, np.max(lever))
    extremes = np.min(least, axis=0), np.max(greatest, axis=0), np.max(gravity, axis=0)
    return Survey(*extremes, float(np.max(reach)), float(np.max(lever)), bears)


def drive_figures(source: Source, found: Survey) -> tuple[DriveFigures, ...]:
    """Return the figures of every drive: what the file says, and defaults for the rest.

    Raises:
        RobotError: No arm has such an inertia or limit.
    """
    drives = []
    needed = [_needed(joint, found, j) for j, joint in enumerate(source.joints)]
    joints, no_torque = _without_placeholder(source.joints, needed)
    is_damped_alike = _is_placeholder(joints, "damping", RUBS_UNLIKE)
    strongest = max(joint.torque_limit or needed[j] for j, joint in enumerate(joints))
    rotors = _rotors(joints)
    if faults := [
        f"{source.file}: joint {joint.name!r}: what moves with it has an inertia of {least:.3g} to {greatest:.3g}, its "
        f"rotor {rotor:.3g} and its torque limit is {joint.torque_limit:.3g}; correct masses, inertias and limits."
        for joint, least, greatest, (rotor, _) in zip(
            joints, found.least_inertia, found.greatest_inertia, rotors, strict=True
        )
        if not (0 < least < LARGEST and 0 < greatest < LARGEST and rotor >= 0 and joint.torque_limit >= 0)
    ]:
        raise RobotError(faults)
    for j, joint in enumerate(joints):
        least, greatest = float(found.least_inertia[j]), float(found.greatest_inertia[j])
        speed = joint.speed_limit or SPEED[joint.is_slide]
        origins = {"speed_limit": _origin_of_speed(joint)}
        viscous, origins["viscous"] = _viscous(joint, speed, greatest)
        if viscous and is_damped_alike:
            viscous, origins["viscous"] = 0.0, f"left out: damping {_for_all(joint.damping)}"
        torque = joint.torque_limit or max(needed[j], WEAKEST * strongest)
        origins["torque_limit"] = "the file" if joint.torque_limit else no_torque
        stated, origins["rotor_inertia"] = rotors[j]
        rotor = stated or (ROTOR_SHARE * greatest if joint.is_slide else torque / SPIN_UP)
        softest = min(rotor, least)
        stiff, stable = torque / (STRETCH if joint.is_slide else TWIST), softest * (RULE / STEP) ** 2 / 2
        stiffness = min(stiff, stable)
        wind = f"{STRETCH * 1e3:g} mm" if joint.is_slide else f"{TWIST * 1e3:g} mrad"
        origins["stiffness"] = (
            f"default: the torque limit winds it up by {wind}"
            if stiff <= stable
            else "default: as stiff as the time step allows on inertia so small; real gears are stiffer"
        )
        whole = rotor + greatest
        kp = min(whole * BANDWIDTH**2, rotor * (RULE / STEP) ** 2 / 2)
        kv = 1.4 * whole * np.sqrt(kp / whole)
        level = max(joint.frictionloss, LEAST_FRICTION * torque)
        origins["coulomb"] = "frictionloss of the file" if joint.frictionloss else "none in the file"
        figures = {
            "rotor_inertia": rotor,
            "viscous": viscous,
            "coulomb": joint.frictionloss,
            "stiffness": stiffness,
            "damping": 2 * ELEMENT_DAMPING * np.sqrt(stiffness * rotor * least / (rotor + least)),
            "motor_presliding": min(level / PRESLIDING, rotor * (RULE / STEP) ** 2 / 2),
            "link_presliding": min(level / PRESLIDING, least * (RULE / STEP) ** 2 / 2),
            "kp": kp,
            "kv": kv,
            "ki": RESET * kp * kv / whole,
            "torque_limit": torque,
            "speed_limit": speed,
        }
        drives.append(DriveFigures(**{key: float(f"{value:.4g}") for key, value in figures.items()}, origins=origins))
    return tuple(drives)


def _without_placeholder(joints: Sequence[SourceJoint], needed: Sequence[float]) -> tuple[list[SourceJoint], str]:
    """Return the joints without a torque limit that is the same for all and far from what any needs, and the reason."""
    limits = {joint.torque_limit for joint in joints}
    limit = limits.pop()
    if limits or len(joints) == 1 or max(needed) < UNLIKE * min(needed) or limit < IDLE * max(needed):
        return list(joints), NO_TORQUE
    why = f"default: {_for_all(limit)}; {NEEDED}"
    return [replace(joint, torque_limit=0.0) for joint in joints], why


def _is_placeholder(joints: Sequence[SourceJoint], figure: str, unlike: float) -> bool:
    """Return whether a file states one figure for all drives, with torque limits of such a ratio or a larger one."""
    stating = [joint for joint in joints if getattr(joint, figure)]
    limits = [joint.torque_limit for joint in stating if joint.torque_limit]
    is_same = len({getattr(joint, figure) for joint in stating}) == 1
    return is_same and max(limits, default=0.0) >= unlike * min(limits, default=1.0)


def _for_all(figure: float) -> str:
    return f"{figure:g} of the file stands there for weak and strong drives alike"


def _rotors(joints: Sequence[SourceJoint]) -> list[tuple[float, str]]:
    """Return what the file says of the inertia of each rotor, 0 where that is nothing, and the reason in words."""
    same = _is_placeholder(joints, "armature", UNLIKE)
    found = []
    for joint in joints:
        if joint.armature and not same:
            found.append((joint.armature, "armature of the file"))
            continue
        guess = (
            "half of the link's inertia" if joint.is_slide else f"the torque limit spins it up by {SPIN_UP:g} rad/s^2"
        )
        found.append((0.0, f"default: {guess}" + (f"; armature {_for_all(joint.armature)}" if joint.armature else "")))
    return found


def _origin_of_speed(joint: SourceJoint) -> str:
    if not joint.speed_limit:
        return DEFAULT
    if joint.speed_limit <= FASTEST[joint.is_slide]:
        return "the file"
    unit, other = ("m/s", "mm/s") if joint.is_slide else ("rad/s", "degrees per second")
    return (
        f"as the file has it, and more than the {FASTEST[joint.is_slide]:g} {unit} of the fastest robots; correct it "
        f"if that is in {other}, for torques and damping are judged by it"
    )


def _needed(joint: SourceJoint, found: Survey, j: int) -> float:
    """Return the torque limit that a drive is given where the file has none [Nm]."""
    speed = joint.speed_limit or SPEED[joint.is_slide]
    greatest = float(found.greatest_inertia[j])
    friction = joint.frictionloss + _viscous(joint, speed, greatest)[0] * speed
    return RESERVE * (float(found.gravity[j]) + friction + greatest * speed / REACH_TIME)


def _viscous(joint: SourceJoint, speed: float, inertia: float) -> tuple[float, str]:
    """Return the viscous friction of a joint [Nm s/rad], and where it comes from; a servo's damping is none."""
    if joint.damping == 0:
        return 0.0, "none in the file"
    if joint.torque_limit and joint.damping * speed > SWALLOWED * joint.torque_limit:
        return 0.0, (
            f"left out: damping {joint.damping:g} of the file would take more than half of the torque limit at full "
            "speed, so it is a servo's"
        )
    critical = 2 * np.sqrt(joint.servo_gain * (joint.armature + inertia))
    if joint.servo_gain and not joint.servo_damping and joint.damping > CRITICAL * critical:
        return 0.0, f"left out: damping {joint.damping:g} of the file damps its position servo, which has no other"
    return joint.damping, "damping of the file"
