"""Passive hinges: a body that gives by a little under the moment it carries."""

from collections.abc import Sequence

import mujoco
import numpy as np

from bench.effects.effect import Array
from bench.effects.geometry_at_zero import AtZero
from bench.robot.plugins import unused_name

SETTLING = 2e-3  # derived: [s]; sqrt(armature / k) and damping / k: a step of 1 ms stays at half of what is stable
LIGHTEST = 1e-9  # rounding: [kg], [kg m^2]; weighs 1e-8 N
_COPIED = [
    "type",
    "axis",
    "pos",
    "range",
    "limited",
    "stiffness",
    "damping",
    "armature",
    "frictionloss",
    "ref",
    "springref",
    "springdamper",
    "springyield",
    "actfrclimited",
    "actfrcrange",
    "actgravcomp",
    "align",
    "group",
    "margin",
    "solimp_friction",
    "solimp_limit",
    "solref_friction",
    "solref_limit",
]


def add_hinges(
    spec: mujoco.MjSpec, body: str, name: str, point: Array, axes: Sequence[Array], compliance: float, *, before: bool
) -> None:
    """Give a body hinges with springs, through one point.

    Each has the stiffness 1 / compliance, and armature and damping that keep time steps of 1 ms stable: its inertia
    counts only in its own tiny motion. A body that was fixed may have no mass, which MuJoCo wants of one that moves; it
    gets as good as none.

    Args:
        spec: What is changed; keyframes are dropped, since they no longer fit.
        body: The body that turns, with all that it carries.
        name: Of the hinges, behind `effect/`.
        point: Shape (3,) [m], world frame, all joints at zero.
        axes: Directions, each of shape (3,), world frame, all joints at zero.
        compliance: [rad/Nm] of each.
        before: The hinges lie before the body's own joints, so that they belong to what carries the body; otherwise
            behind them.
    """
    zero = AtZero(spec)
    for key in list(spec.keys):
        spec.delete(key)
    names = [unused_name(spec, f"{name} {i + 1}") for i in range(len(axes))]
    link = spec.body(body)
    if zero.model.body(body).mass[0] == 0:
        link.mass, link.inertia, link.explicitinertial = LIGHTEST, np.full(3, LIGHTEST), True
        link.ipos, link.iquat = np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0])
    own = [_values(joint) for joint in link.joints]
    own_names = [joint.name for joint in link.joints]
    local = zero.point_in(body, point)
    stiffness = 1 / compliance
    added = [
        {
            "type": mujoco.mjtJoint.mjJNT_HINGE,
            "axis": zero.direction_in(body, axis),
            "pos": local,
            "limited": int(mujoco.mjtLimited.mjLIMITED_FALSE),
            "stiffness": np.array([stiffness, 0, 0]),
            "damping": np.array([stiffness * SETTLING, 0, 0]),
            "armature": stiffness * SETTLING**2,
        }
        for axis in axes
    ]
    blank = _values(link.add_joint())
    for _ in added[1:]:
        link.add_joint()
    # MuJoCo turns a body by its joints in the order in which they were made, and a new one comes last: so the joints
    # hand their places on, by name and value
    everything = [(n, blank | v) for n, v in zip(names, added, strict=True)]
    kept = list(zip(own_names, own, strict=True))
    order = everything + kept if before else kept + everything
    for i, joint in enumerate(link.joints):
        joint.name = unused_name(spec, f"moved {i}")
    for joint, (joint_name, values) in zip(link.joints, order, strict=True):
        joint.name = joint_name
        for attribute, value in values.items():
            setattr(joint, attribute, value)


def _values(joint: mujoco.MjsJoint) -> dict[str, object]:
    values = {name: getattr(joint, name) for name in _COPIED}
    return {name: np.array(value) if isinstance(value, np.ndarray) else value for name, value in values.items()}
