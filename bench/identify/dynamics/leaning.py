"""Gravity that does not point as the model has it: a base out of level.

With gravity g + |g| (l_1 e_1 + l_2 e_2), two directions e across the model's, each drive feels what links, payload and
known masses weigh in these directions too, in proportion to how far it leans, l [rad]:

    tau = Y(q, v, a; g) pi + sum_k l_k (G_k(q) pi + G_fk(q) m)

with the parameters pi of the links and a known mass m. It is linear in either of l and pi. An upright first axis feels
nothing of gravity else, so moments about it that only a lean shows stay as uncertain as they are.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bench.identify.arm import Arm
from bench.identify.dynamics.chosen import SURELY
from bench.identify.dynamics.equations import Equations
from bench.identify.dynamics.parameters import Layout
from bench.identify.dynamics.regressor import N_INERTIAL, link_regressor, payload_columns
from bench.identify.dynamics.solve import Solution, odds_against_none
from bench.record.campaign import Array
from bench.robot.bodies import RigidBodies, read_only
from bench.robot.nominal_dynamics import NominalDynamics

AXES = "xyz"


def axes_across(bodies: RigidBodies) -> tuple[int, int]:
    """Return the two axes of the world that are most nearly across gravity."""
    first, second = np.sort(np.argsort(np.abs(bodies.gravity), kind="stable")[:2])
    return int(first), int(second)


def across(bodies: RigidBodies) -> Array:
    """Return the gravity of either lean of one radian, shape (2, 3) [m/s^2]; none without gravity."""
    gravity = np.array(bodies.gravity, dtype=np.float64)
    size = float(np.linalg.norm(gravity))
    if not size > 0:
        return np.zeros((2, 3))
    down = gravity / size
    axes = np.eye(3)[list(axes_across(bodies))]
    axes -= np.outer(axes @ down, down)
    return np.asarray(size * axes / np.linalg.norm(axes, axis=1, keepdims=True))


def leant(bodies: RigidBodies, lean: Array) -> RigidBodies:
    """Return links whose gravity leans by so much, shape (2,) [rad]."""
    return replace(bodies, gravity=read_only(np.array(bodies.gravity) + lean @ across(bodies)))


def leaning(equations: Sequence[Equations], arm: Arm, nominal: NominalDynamics) -> tuple[Equations, ...]:
    """Return equations with what weighs how much across gravity, where joints stand after the filter.

    Args:
        equations: Of stretches.
        arm: The links; their masses do not enter.
        nominal: For the load point.
    """
    arms = [Arm(replace(arm.bodies, gravity=read_only(direction))) for direction in across(arm.bodies)]
    body, payload = payload_columns(arm, nominal.load_point)
    found = []
    for part in equations:
        still = np.zeros_like(part.position)
        links = np.stack([link_regressor(one, part.position, still, still) for one in arms], axis=2)
        carried = links[..., N_INERTIAL * body : N_INERTIAL * (body + 1)] @ payload[:, :1]
        mass = part.samples.load_mass[np.searchsorted(part.samples.time, part.time)]
        found.append(replace(part, leaning=np.concatenate([links, carried * mass[:, None, None, None]], axis=3)))
    return tuple(found)


def seems_to_lean(solution: Solution, layout: Layout) -> bool:
    """Return whether data want gravity to lean by 100 to 1, at the noise that is left with it.

    Without it a lean is noise that remembers for long, of which a drive has few independent readings: too few to want
    it.

    Args:
        solution: With the columns of a lean.
        layout: Of the parameters.
    """
    return odds_against_none(solution, np.arange(layout.size)[layout.lean]) > SURELY
