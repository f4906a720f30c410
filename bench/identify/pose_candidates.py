"""Poses that a lab could measure at: inside the joint limits, clear of floor and base, where K_C does little harm."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.errors import InputError
from bench.identify.complementary_map import loaded
from bench.identify.pose_plan import Load, Setup, Visits
from bench.robot.bodies import Array, Point, read_only

DEGREE = np.pi / 180
MILLIMETRE = 1e-3  # [m]
DRAWS_PER_CANDIDATE = 50  # so many poses are drawn at most for one that the rules let pass


@dataclass(frozen=True)
class Rules:
    """Which poses may be measured at. What they do not know: whether the arm meets itself, or hides the reflector.

    Attributes:
        worst_wrench: Shape (6,) [N, Nm], the largest load for which K_C is judged, section 4.2.
        zone_limit: Relative error that leaving out K_C may cause under that load, at every joint, Fig. 6.
        margin: [rad] or [m], distance to the joint limits.
        floor: [m], height above the base frame's origin that joints, load point and reference point keep.
        clearance: [m], horizontal distance of load point and reference point from the vertical line through the base.
        hanging_height: [m], height of the load point that a hanging load needs at least.
        rope_clearance: [m], horizontal distance of the rope of a hanging load from every joint below the load point.
    """

    worst_wrench: Array
    zone_limit: float = 0.05
    margin: float = 5 * DEGREE
    floor: float = 0.3
    clearance: float = 0.8
    hanging_height: float = 0.8
    rope_clearance: float = 0.1


def allowed(setup: Setup, visits: Visits, rules: Rules) -> NDArray[np.bool_]:
    """Return which visits keep all rules, shape (v,)."""
    arm, q = setup.arm, visits.q
    low, high = arm.bodies.limits.T
    inside = np.all((q >= low + rules.margin) & (q <= high - rules.margin), axis=1)

    joints = np.stack(
        [arm.pose(q, Point(i, read_only(np.zeros(3)), read_only(np.eye(3))))[0] for i in range(arm.n_joints)]
    )
    load_point = arm.pose(q, setup.load_point)[0]
    reference = arm.pose(q, setup.reference_point)[0]
    moving = joints[1:]  # the first joint stays where it is
    standing = np.all(np.concatenate([moving, [load_point, reference]])[..., 2] >= rules.floor, axis=0)
    clear = np.all(np.linalg.norm(np.stack([load_point, reference])[..., :2], axis=-1) >= rules.clearance, axis=0)

    hangs = np.array([load.hangs(arm.bodies.gravity) for load in visits.loads])
    apart = np.linalg.norm((joints - load_point)[..., :2], axis=-1)
    rope_free = np.all((apart >= rules.rope_clearance) | (joints[..., 2] > load_point[:, 2]), axis=0)
    can_hang = (load_point[:, 2] >= rules.hanging_height) & rope_free
    return np.array(inside & standing & clear & (can_hang | ~hangs) & _in_zone(setup, q, rules))


def sample(setup: Setup, loads: Sequence[Load], rules: Rules, count: int, rng: np.random.Generator) -> Visits:
    """Return `count` visits that keep the rules, with joint angles and one of the loads drawn evenly.

    Hinges that turn further than half a turn either way are kept within it: beyond, poses come again.

    Raises:
        InputError: Hardly any pose keeps the rules.
    """
    low, high = setup.arm.bodies.limits.T
    hinge = setup.arm.bodies.is_hinge
    low, high = np.where(hinge, np.maximum(low, -np.pi), low), np.where(hinge, np.minimum(high, np.pi), high)
    found = Visits(np.zeros((0, setup.arm.n_joints)), ())
    for _ in range(DRAWS_PER_CANDIDATE):
        angles = rounded(setup, rng.uniform(low, high, (count, len(low))))
        drawn = Visits(angles, tuple(loads[i] for i in rng.integers(len(loads), size=count)))
        found += drawn.take(np.flatnonzero(allowed(setup, drawn, rules)))
        if len(found.loads) >= count:
            return found.take(range(count))
    raise InputError(f"only {len(found.loads)} of {count * DRAWS_PER_CANDIDATE} poses keep the rules; relax them.")


def around(setup: Setup, visits: Visits, rules: Rules, spread: float, count: int, rng: np.random.Generator) -> Visits:
    """Return visits near others that keep the rules; `count` are drawn for each, with normal `spread` [rad] or [m]."""
    index = np.repeat(np.arange(len(visits.loads)), count)
    near = visits.take(index)
    near = Visits(rounded(setup, near.q + spread * rng.standard_normal(near.q.shape)), near.loads)
    return near.take(np.flatnonzero(allowed(setup, near, rules)))


def rounded(setup: Setup, q: Array) -> Array:
    """Return joint positions rounded to what a person can type: whole degrees or millimetres, the same shape as q."""
    step = np.where(setup.arm.bodies.is_hinge, DEGREE, MILLIMETRE)
    return step * np.round(q / step)


def _in_zone(setup: Setup, q: Array, rules: Rules) -> NDArray[np.bool_]:
    stiffness = 1 / setup.compliance
    torque, deflection = loaded(setup.arm, q, setup.load_point, stiffness, rules.worst_wrench)
    error = np.abs(torque - stiffness * deflection)
    inside: NDArray[np.bool_] = np.all(error < rules.zone_limit * np.abs(stiffness * deflection), axis=1)
    return inside
