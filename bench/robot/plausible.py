"""What no robot reaches: one list of ranges for the numbers of a compiled model, whoever wrote it.

A number outside is a slip of the pen or of a unit: degrees taken for radians, grams for kilograms, a lost sign. Ranges
hold an arm of 50 g links as well as one of tonnes, and slides in m and kg beside hinges. Models are held to them once,
where they are tried (`trial.py`).
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

SLIDE = int(mujoco.mjtJoint.mjJNT_SLIDE)
Named = Iterable[tuple[str, float]]


@dataclass(frozen=True)
class Range:
    """What a number of a model can be.

    Attributes:
        what: As the MJCF calls it.
        unit: In words; of a hinge where hinges and slides differ.
        least, most: Both are allowed.
        remedy: What to do about one outside.
    """

    what: str
    unit: str
    least: float
    most: float
    remedy: str

    def faults(self, values: Named) -> Iterator[str]:
        """Yield a sentence for each value outside; `values` are pairs of place and value."""
        for place, value in values:
            if not self.least <= value <= self.most:
                yield (
                    f"{place}: {self.what} is {f'{value:g} {self.unit}'.rstrip()}; in a robot it is {self.least:g} to "
                    f"{self.most:g}: {self.remedy}."
                )


MOST_TORQUE = 1e7  # [Nm], at a joint; the strongest robots have 1e5
TURNS = float(10 * np.pi)  # [rad], five turns; wrists of welding robots turn 2.5 either way
ARM = 3  # declared: hinges, from which a robot is an arm and no test rig
LEAST_TURN = float(np.deg2rad(15.0))  # [rad], of an arm's joint that turns farthest; two turns in "degrees" are 12.6
LIGHT_KG = 1.0  # declared: [kg]; lighter bodies stand for inertias alone
IN_RADIANS = 'angles are in degrees unless <compiler angle="radian"/> stands in the file'
OF_MODELS: tuple[tuple[Range, Callable[[mujoco.MjModel], Named]], ...] = (
    (
        Range("timestep", "s", 1e-6, 0.02, "0.00025 to 0.001 suits rotors and gears"),
        lambda model: [("<option>", model.opt.timestep)],
    ),
    (
        Range("gravity", "m/s^2", 9.5, 10.1, "on earth it is 9.76 to 9.84, and lengths are in m"),
        lambda model: [("<option>", float(np.linalg.norm(model.opt.gravity)))],
    ),
    (
        Range("density of what flows around it", "kg/m^3", 0.0, 10.0, "air has 1.2"),
        lambda model: [("<option>", model.opt.density)],
    ),
    (
        Range("viscosity of what flows around it", "Pa s", 0.0, 1e-3, "air has 1.8e-5"),
        lambda model: [("<option>", model.opt.viscosity)],
    ),
    # heaviest arms: 11 t with their base (FANUC M-2000iA/2300), of which no link has half
    (Range("mass", "kg", 0.0, 1e4, "masses are in kg"), lambda model: _moving(model, model.body_mass)),
    (
        Range("largest moment of inertia", "kg m^2", 0.0, 1e6, "masses are in kg and lengths in m"),
        lambda model: _moving(model, np.max(model.body_inertia, axis=1)),
    ),
    (
        Range("distance from the body that carries it", "m", 0.0, 100.0, "lengths are in m"),
        lambda model: _named(model, "body", np.linalg.norm(model.body_pos, axis=1)),
    ),
    (
        Range("distance of its centre of mass", "m", 0.0, 20.0, "lengths are in m"),
        lambda model: _moving(model, np.where(model.body_mass > 0, np.linalg.norm(model.body_ipos, axis=1), 0.0)),
    ),
    (  # a beam of 10 m has 2.9
        Range("largest radius of gyration", "m", 0.0, 3.0, "moments of inertia are in kg m^2, masses in kg"),
        lambda model: _moving(model, _radius_of_gyration(model)),
    ),
    (  # MuJoCo norms directions; one of 1e300 has no length that could be computed
        Range("length of its axis once it is normed", "", 0.99, 1.01, "write a direction, such as 0 0 1"),
        lambda model: _named(model, "joint", np.linalg.norm(model.jnt_axis, axis=1)),
    ),
    (
        Range("armature", "kg m^2", 0.0, 1e5, "it is the rotor's inertia times the square of the gear ratio"),
        lambda model: _dofs(model, model.dof_armature),
    ),
    (
        Range("damping", "Nm s/rad", 0.0, 1e7, "it is viscous friction, which takes energy"),
        lambda model: _dofs(model, model.dof_damping),
    ),
    (
        Range("frictionloss", "Nm", 0.0, 1e7, "it is Coulomb friction, which takes energy"),
        lambda model: _dofs(model, model.dof_frictionloss),
    ),
    (
        Range("stiffness", "Nm/rad", 0.0, np.inf, "a spring pulls back"),
        lambda model: _named(model, "joint", model.jnt_stiffness),
    ),
    (Range("range", "rad", -TURNS, TURNS, IN_RADIANS), lambda model: _limits(model, slides=False)),
    (Range("range", "m", -100.0, 100.0, "lengths are in m"), lambda model: _limits(model, slides=True)),
    (
        Range("forcerange", "Nm", -MOST_TORQUE, MOST_TORQUE, "leave it out where no limit is known"),
        lambda model: _ends(model, "actuator", model.actuator_forcerange, model.actuator_forcelimited),
    ),
    (
        Range("torque limit", "Nm", -MOST_TORQUE, MOST_TORQUE, "leave it out where none is known"),
        lambda model: _ends(model, "joint", model.jnt_actfrcrange, model.jnt_actfrclimited),
    ),
    (
        Range("stiffness", "Nm/rad", 0.0, 1e10, "write a stiffness that parts can have"),
        lambda model: _named(model, "tendon", model.tendon_stiffness),
    ),
    (
        Range("damping", "Nm s/rad", 0.0, 1e8, "damping takes energy"),
        lambda model: _named(model, "tendon", model.tendon_damping),
    ),
)
OF_SERVOS = (
    Range("kp", "Nm/rad", 1e-6, 1e10, "the servo has to turn towards its set point"),
    Range("kv", "Nm s/rad", 0.0, 1e9, "the servo has to damp"),
    Range("ki", "Nm/(rad s)", 0.0, 1e11, "the servo has to turn towards its set point"),
)
OF_TORQUE_LIMITS = Range(
    "the larger number of forcerange", "Nm", 1e-4, MOST_TORQUE, "it is the torque limit at the joint"
)
# sqrt(k / J), of the rotor on its elastic element. Gears of robots: 5 to 1000 Hz; soft elements of series elastic
# actuators and what was fitted to soft machines: 2 Hz
OF_ELEMENTS = Range(
    "the frequency at which its rotor swings on it", "Hz", 0.5, 1e7, "correct stiffness, in Nm/rad, or armature"
)
# What its torque limit gives a rotor alone: 5 to 63 rad/s^2 in the robots that come along; assumed: a servo motor with
# a slim rotor has 1e5, which a gear divides by its ratio
OF_ROTORS = Range(
    "the acceleration that its torque limit gives its rotor",
    "rad/s^2",
    0.0,
    1e5,
    "armature is the rotor's inertia times the square of the gear ratio",
)
LEAST_MASS = Range(  # a tenth of a millimetre of water each way weighs 1e-9 kg
    "mass", "kg", 1e-9, 1e4, "what a drive turns weighs something; masses are in kg"
)
# How far a friction element gives before it slides: surfaces come off within micrometres, rubber and cables within a
# turn. Atoms are 1e-10 m apart, which is no travel at any radius up to a metre.
MOST_TRAVEL, LEAST_TRAVEL = float(2 * np.pi), 1e-10  # [rad] or [m]


def presliding_range(level: float, limit: float) -> Range:
    """Return between which presliding stiffnesses an element of friction holds [Nm/rad].

    Args:
        level: Its Coulomb friction [Nm]; of one that has none the smallest torque limit of any robot.
        limit: Torque limit of the drive [Nm]; what holds more stops it.
    """
    least = max(level, OF_TORQUE_LIMITS.least) / MOST_TRAVEL
    return Range(
        "presliding_stiffness",
        "Nm/rad",
        least,
        max(limit, level) / LEAST_TRAVEL,
        f"friction of {level:g} Nm gives way after level / presliding_stiffness, in rad",
    )


def implausible(model: mujoco.MjModel) -> Iterator[str]:
    """Yield a sentence for every number of a compiled model that no robot has."""
    for limits, read in OF_MODELS:
        yield from limits.faults(read(model))
    hinges = (model.jnt_type == int(mujoco.mjtJoint.mjJNT_HINGE)) & (model.jnt_limited != 0)
    farthest = np.max(np.ptp(model.jnt_range[hinges], axis=1), initial=0.0)
    if np.count_nonzero(hinges) >= ARM and farthest < LEAST_TURN and not np.any(model.jnt_type == SLIDE):
        yield (
            f"joints: the one with the widest range turns by {np.rad2deg(farthest):.3g} degrees; that of a robot turns "
            f"by {np.rad2deg(LEAST_TURN):.3g} at least: {IN_RADIANS}."
        )


def _named(model: mujoco.MjModel, kind: str, values: ArrayLike) -> Iterator[tuple[str, float]]:
    element = getattr(mujoco.mjtObj, f"mjOBJ_{kind.upper()}")
    for index, value in enumerate(np.asarray(values)):
        name = mujoco.mj_id2name(model, element, index)
        yield f"{kind} {name!r}" if name else f"{kind} {index} without a name", float(value)


def _moving(model: mujoco.MjModel, values: ArrayLike) -> Named:
    """Return values of bodies, of those that move."""
    found = zip(_named(model, "body", values), model.body_weldid, strict=True)
    return [named for named, welded_to in found if welded_to != 0]


def _radius_of_gyration(model: mujoco.MjModel) -> NDArray[np.float64]:
    squares: NDArray[np.float64] = np.max(model.body_inertia, axis=1) / np.maximum(model.body_mass, LIGHT_KG)
    return np.asarray(np.sqrt(squares))


def _dofs(model: mujoco.MjModel, values: ArrayLike) -> Named:
    """Return values of degrees of freedom, of the first of each joint.

    Of a joint that a spring holds the sign alone: what hardly bends is written down with as much of both as
    keeps a time step stable (`bench.effects.passive_hinges`).
    """
    found = np.asarray(values)[model.jnt_dofadr]
    return _named(model, "joint", np.where(model.jnt_stiffness > 0, np.minimum(found, 0.0), found))


def _limits(model: mujoco.MjModel, slides: bool) -> Named:
    """Return both ends of the ranges of hinges or of slides."""
    return _ends(model, "joint", model.jnt_range, (model.jnt_limited != 0) & ((model.jnt_type == SLIDE) == slides))


def _ends(model: mujoco.MjModel, kind: str, ranges: ArrayLike, counts: ArrayLike) -> Named:
    """Return both ends of ranges, of those that count; an open end is none."""
    return [
        (place, end)
        for ends in np.asarray(ranges).T
        for (place, end), is_one in zip(_named(model, kind, ends), np.asarray(counts), strict=True)
        if is_one and np.isfinite(end)
    ]
