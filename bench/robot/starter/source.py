"""Somebody's MJCF or URDF: which joints are driven, what is kept of it, what is left out."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import mujoco
import numpy as np

from bench.errors import RobotError, unknown_names
from bench.robot.plain_words import plain_words
from bench.robot.starter.actuators import one_sided, servo_gains, torque_limit
from bench.robot.starter.balance import lost_balance
from bench.robot.starter.places import Place, places
from bench.robot.starter.urdf import Urdf, read_urdf
from bench.robot.trial import expect_harmless

HINGE, SLIDE = int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)
FREE = int(mujoco.mjtJoint.mjJNT_FREE)
NOT_KEPT = ("keys", "sensors", "actuators", "equalities", "tendons", "excludes", "pairs")
WATER = 1000.0  # [kg/m^3], MuJoCo's density of a shape that has none
TURN = 2 * np.pi  # [rad], range of a hinge that has none
TRAVEL = 1.0  # [m], range of a slide that has none


@dataclass(frozen=True)
class SourceJoint:
    """What the file says of one driven joint.

    Attributes:
        name: In the MJCF; made up where it had none.
        is_slide: Else it is a hinge.
        limits: (lower, upper) [rad] or [m].
        has_limits: Whether the file gave them.
        armature: [kg m^2] or [kg], 0 if not given.
        damping: [Nm s/rad] or [N s/m].
        servo_gain, servo_damping: Of a position actuator on it [Nm/rad], [Nm s/rad]; 0 if there is none.
        frictionloss: [Nm] or [N].
        torque_limit: Of its actuator or its joint [Nm] or [N]; 0 if not given.
        speed_limit: [rad/s] or [m/s]; 0 if not given, as in any MJCF.
        home: [rad] or [m], in the first keyframe, else zero, moved into the limits.
    """

    name: str
    is_slide: bool
    limits: tuple[float, float]
    has_limits: bool
    armature: float
    damping: float
    servo_gain: float
    servo_damping: float
    frictionloss: float
    torque_limit: float
    speed_limit: float
    home: float


@dataclass(frozen=True)
class Source:
    """A robot as somebody else described it, cleared of everything that the bench brings itself.

    Attributes:
        file: Where it came from.
        spec: Its links with the driven joints alone, without actuators, contacts and keyframes.
        joints: The driven joints, from the base.
        load_point: Where loads act.
        reflectors: Where the tracker's reflectors are; none: nobody said.
        left_out: What was left out, in words.
        lost_balance: What of it held gravity, a sentence for each, with where to put it back.
        guessed_masses: Bodies whose mass the file does not give; MuJoCo makes it of their shapes, 1000 kg/m^3.
        made_up_names: Names of driven joints that have none in the file.
    """

    file: Path
    spec: mujoco.MjSpec
    joints: tuple[SourceJoint, ...]
    load_point: Place
    reflectors: tuple[Place, ...]
    left_out: tuple[str, ...]
    lost_balance: tuple[str, ...]
    guessed_masses: tuple[str, ...]
    made_up_names: tuple[str, ...]


def read_source(file: Path, joints: Sequence[str] = (), load_point: str = "", reflectors: Sequence[str] = ()) -> Source:
    """Read an MJCF or URDF and clear it.

    Args:
        file: The file.
        joints: Names of the driven joints; empty: those of the trunk, from the base up to where it branches.
        load_point: Name of a site or body of the last link; empty: a site with a usual name, else the end of the chain.
        reflectors: Names likewise; empty: nobody said.

    Raises:
        RobotError: The file cannot be used; names the place and what to do.
    """
    if file.is_dir():
        raise RobotError(f"{file}: is a folder; give the MJCF (.xml) or URDF file in it.")
    if not file.exists():
        raise RobotError(f"{file}: no such file; give an MJCF (.xml) or a URDF.")
    urdf = read_urdf(file)
    spec, model = _read(file, urdf)
    driven = _driven(file, model, joints)
    names, made_up = _name_joints(spec, driven)
    if faults := [words for j, name in zip(driven, names, strict=True) for words in one_sided(model, j, name)]:
        raise RobotError(f"{file}: {words}" for words in faults)
    speeds = urdf.speed_limits if urdf else {}
    described = tuple(_describe(model, j, name, speeds) for j, name in zip(driven, names, strict=True))
    guessed = _guessed_masses(spec)
    held = tuple(lost_balance(model, driven, names))
    left_out = (*_clear(spec, set(names)), *(urdf.left_out if urdf else ()))
    at, seen = places(file, spec, names[-1], load_point, reflectors)
    return Source(file, spec, described, at, seen, left_out, held, guessed, tuple(made_up))


def _read(file: Path, urdf: Urdf | None) -> tuple[mujoco.MjSpec, mujoco.MjModel]:
    try:
        if urdf:
            spec = urdf.spec()
        else:
            expect_harmless(file)
            spec = mujoco.MjSpec.from_file(str(file.resolve()))
        model = spec.compile()
    except ValueError as error:
        raise RobotError(f"{file}: {plain_words(error)}") from error
    if exchanged := tuple(_exchanged(spec)):
        raise RobotError(f"{file}: {words}" for words in exchanged)
    for j in range(model.njnt):
        if int(model.jnt_type[j]) not in (HINGE, SLIDE):
            kind = "free joint" if int(model.jnt_type[j]) == FREE else "ball joint"
            remedy = "fix the base to the world" if kind == "free joint" else "write it as three hinges"
            raise RobotError(f"{file}: body {_body_of(model, j)!r} has a {kind}; {remedy}.")
    if model.njnt == 0:
        raise RobotError(f"{file}: has no joints; give the file of a robot.")
    return spec, model


def _exchanged(spec: mujoco.MjSpec) -> Iterator[str]:
    """Yield a sentence for each pair of limits whose lower one is above; MuJoCo takes it for none."""
    limits = [(f"joint {one.name!r}", one, ("range", "actfrcrange")) for one in spec.joints]
    limits += [(f"actuator {one.name!r}", one, ("forcerange", "ctrlrange")) for one in spec.actuators]
    for place, one, names in limits:
        for name in names:
            low, high = (float(end) for end in getattr(one, name))
            if low > high:
                yield f'{place}: {name} is "{low:g} {high:g}"; exchange the two.'


def _driven(file: Path, model: mujoco.MjModel, wanted: Sequence[str]) -> list[int]:
    known = [_name(model, mujoco.mjtObj.mjOBJ_JOINT, j) for j in range(model.njnt)]
    if wanted:
        if problems := unknown_names("joint", wanted, known):
            raise RobotError(f"--joints: {' '.join(problems)}")
        if len(set(wanted)) < len(wanted):
            raise RobotError(f"--joints: {' '.join(wanted)} names a joint twice; name each once.")
        driven = [known.index(name) for name in wanted]
    else:
        driven = _trunk(file, model, known)
    bodies = [int(model.jnt_bodyid[j]) for j in driven]
    for joint, body in zip(driven, bodies, strict=True):
        if model.body_jntnum[body] > 1:
            raise RobotError(
                f"{file}: body {_body_of(model, joint)!r} has several joints; give each a body of its own."
            )
        if model.qpos0[model.jnt_qposadr[joint]] != 0:
            raise RobotError(f"{file}: joint {known[joint]!r} has ref != 0; move its zero into the pose of its body.")
    for upper, lower in pairwise(driven):
        if int(model.jnt_bodyid[upper]) not in _ancestors(model, int(model.jnt_bodyid[lower])):
            raise RobotError(
                f"{file}: joint {known[lower]!r} does not hang on {known[upper]!r}; "
                "name the joints of one chain with --joints, from the base to the tool."
            )
    return driven


def _trunk(file: Path, model: mujoco.MjModel, known: list[str]) -> list[int]:
    """Return the joints from the base up to where the tree branches into two that move."""
    moving = [body for body in range(1, model.nbody) if model.body_jntnum[body]]
    above = {body: [other for other in _ancestors(model, body) if other in moving and other != body] for body in moving}
    trunk: list[int] = []
    here: int | None = None
    while True:
        after = [body for body in moving if (above[body][0] if above[body] else None) == here]
        if len(after) != 1:
            break
        here = after[0]
        trunk.append(int(model.body_jntadr[here]))
    if not trunk:
        raise RobotError(f"{file}: has several arms; name the joints of one with --joints. Known: {', '.join(known)}.")
    return trunk


def _ancestors(model: mujoco.MjModel, body: int) -> list[int]:
    """Return a body and those that carry it, nearest first, without the world."""
    found = []
    while body > 0:
        found.append(body)
        body = int(model.body_parentid[body])
    return found


def _name_joints(spec: mujoco.MjSpec, driven: list[int]) -> tuple[list[str], list[str]]:
    """Give every driven joint a name in the spec; return all of them, and those that the file did not have."""
    taken = {joint.name for joint in spec.joints}
    names, made_up = [], []
    for number, j in enumerate(driven, start=1):
        joint = spec.joints[j]
        if not joint.name:
            joint.name = next(name for name in (f"joint{number}", f"joint{number}_unnamed") if name not in taken)
            made_up.append(joint.name)
        names.append(joint.name)
    return names, made_up


def _describe(model: mujoco.MjModel, j: int, name: str, speeds: Mapping[str, float]) -> SourceJoint:
    is_slide = bool(model.jnt_type[j] == SLIDE)
    dof = int(model.jnt_dofadr[j])
    has_limits = bool(model.jnt_limited[j]) and bool(np.all(np.isfinite(model.jnt_range[j])))
    unlimited = TRAVEL if is_slide else TURN
    low, high = (float(x) for x in model.jnt_range[j]) if has_limits else (-unlimited, unlimited)
    home = float(model.key_qpos[0, model.jnt_qposadr[j]]) if model.nkey else 0.0
    return SourceJoint(
        name=name,
        is_slide=is_slide,
        limits=(low, high),
        has_limits=has_limits,
        armature=float(model.dof_armature[dof]),
        damping=float(np.ravel(model.dof_damping[dof])[0]),
        servo_gain=servo_gains(model, j)[0],
        servo_damping=servo_gains(model, j)[1],
        frictionloss=float(model.dof_frictionloss[dof]),
        torque_limit=torque_limit(model, j),
        speed_limit=speeds.get(name, 0.0),
        home=float(np.clip(home, low, high)),
    )


def _guessed_masses(spec: mujoco.MjSpec) -> tuple[str, ...]:
    """Return the bodies whose mass comes from nothing but the shapes of the file and the density of water."""
    return tuple(
        body.name or "without a name"
        for body in spec.bodies[1:]  # the first is the world, which weighs nothing
        if not body.explicitinertial and any(np.isnan(g.mass) and g.density == WATER for g in body.geoms)
    )


def _clear(spec: mujoco.MjSpec, driven: set[str]) -> tuple[str, ...]:
    """Take out what the bench brings itself, and hold what it does not drive; return what went, in words."""
    words = []
    for collection in NOT_KEPT:
        elements = list(getattr(spec, collection))
        if elements:
            words.append(f"{len(elements)} {collection}")
        for element in elements:
            spec.delete(element)
    for joint in list(spec.joints):
        if joint.name in driven:
            if np.any(joint.stiffness) or np.any(joint.springdamper):
                words.append(f"the spring of joint {joint.name}")
            joint.armature, joint.frictionloss = 0.0, 0.0
            joint.damping = np.zeros_like(np.atleast_1d(joint.damping))
            joint.stiffness = np.zeros_like(np.atleast_1d(joint.stiffness))
            joint.springdamper = np.zeros_like(joint.springdamper)
            joint.springref = 0.0  # where a spring rests; the elastic element would rest there
        else:
            words.append(f"joint {joint.name or 'without a name'}, held at its zero")
            spec.delete(joint)
    for geom in spec.geoms:
        geom.contype = geom.conaffinity = 0
    return tuple(words)


def _body_of(model: mujoco.MjModel, joint: int) -> str:
    return _name(model, mujoco.mjtObj.mjOBJ_BODY, int(model.jnt_bodyid[joint]))


def _name(model: mujoco.MjModel, kind: mujoco.mjtObj, index: int) -> str:
    return mujoco.mj_id2name(model, kind, index) or f"number {index}"
