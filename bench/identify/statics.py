"""Equilibrium at rest, and how the reference point moves with the compliance.

With q the motor angles and theta the link angles, the elastic elements carry tau_s = K (q - theta). Two balances hold:

    link:   tau_s + f_link + J_f^T W = G + M         (M restores: the counterbalance acts on its joint with -M)
    motor:  xi I + f_motor = tau_s

Everything here is written in the torque that *deflects*, u = -tau_s, so that theta = q + N u with N = 1/k:

    u = Gamma + f_link,   Gamma = J_f^T W - G - M    (what the load says, without friction on the link side)
    u = -xi I - f_motor                              (what the current says, without friction on the motor side)

Gamma depends on theta. Its derivative A = K_C - dG/dtheta - k_b is what Eq. (19) calls the correction by K_C, with the
gravity and counterbalance stiffness that have the same size: d(theta)/du = (1 - N A)^-1 N instead of N.
"""

from dataclasses import dataclass
from enum import Flag, auto

import numpy as np

from bench.identify.arm import Arm, complementary_stiffness
from bench.robot.bodies import Array
from bench.robot.counterbalance import Counterbalance


class SecondOrder(Flag):
    """What is taken at the deflected angles theta rather than at the motor angles q; each is of order 1 % or less.

    NONE is the paper's plain model, Eqs. (35) and (41), ALL the full equilibrium.

    Attributes:
        POSE: Position and J_m of the reference point; else the deflection is J_m(q) N u.
        WRENCH: J_f^T W; its change with theta is K_C, Eq. (18).
        GRAVITY: G(theta); its change is the gravity stiffness dG/dtheta.
        COUNTERBALANCE: M(theta); its change is k_b, Eq. (12).
    """

    NONE = 0
    POSE = auto()
    WRENCH = auto()
    GRAVITY = auto()
    COUNTERBALANCE = auto()
    ALL = POSE | WRENCH | GRAVITY | COUNTERBALANCE


@dataclass(frozen=True)
class LinkTorque:
    """What load, weight and counterbalance do to the links, in m states.

    Attributes:
        total: Shape (m, n) [Nm], Gamma = J_f^T W - G - M.
        wrench: Shape (m, n) [Nm], its part J_f^T W.
        jacobian: Shape (m, 6, n), J_f where the wrench was taken.
        stiffness: Shape (m, n, n) [Nm/rad], A = dGamma/dtheta of the parts that are second order.
    """

    total: Array
    wrench: Array
    jacobian: Array
    stiffness: Array


@dataclass(frozen=True)
class Motion:
    """Reference point in m states, and how it moves.

    Attributes:
        position: Shape (m, 3) [m], at theta.
        per_motor_angle: Shape (m, 3, n) [m/rad], derivative by q.
        per_torque: Shape (m, 3, n) [m/Nm], derivative by a torque put on the links from outside.
        per_compliance: Shape (m, 3, n) [m/(rad/Nm)], derivative by N; the rows of L in Eq. (42) where N = 0.
    """

    position: Array
    per_motor_angle: Array
    per_torque: Array
    per_compliance: Array


def link_torque(
    arm: Arm,
    counterbalance: Counterbalance | None,
    load_point: str,
    q: Array,
    theta: Array,
    wrench: Array,
    second_order: SecondOrder,
) -> LinkTorque:
    """Return Gamma and its derivative.

    Args:
        arm: The arm.
        counterbalance: Its counterbalance, if it has one.
        load_point: Where the wrench acts.
        q: Shape (m, n) [rad], motor angles.
        theta: Shape (m, n) [rad], link angles.
        wrench: Shape (m, 6) [N, Nm].
        second_order: What is taken at theta.
    """
    jacobian = arm.jacobian(theta if SecondOrder.WRENCH in second_order else q, load_point)
    weight = arm.gravity(theta if SecondOrder.GRAVITY in second_order else q)
    stiffness = np.zeros((*q.shape, q.shape[1]))
    if SecondOrder.WRENCH in second_order:
        stiffness += complementary_stiffness(jacobian, wrench)
    if SecondOrder.GRAVITY in second_order:
        stiffness -= arm.gravity_stiffness(theta)
    if counterbalance is not None:
        j = counterbalance.joint
        if SecondOrder.COUNTERBALANCE in second_order:
            weight[:, j] += counterbalance.torque(theta[:, j])
            stiffness[:, j, j] -= counterbalance.stiffness(theta[:, j])
        else:
            weight[:, j] += counterbalance.torque(q[:, j])
    pushed = np.einsum("mkn,mk->mn", jacobian, wrench)
    return LinkTorque(pushed - weight, pushed, jacobian, stiffness)


def yielding(compliance: Array, stiffness: Array) -> Array:
    """Return (1 - N A)^-1, shape (m, n, n): how much further a joint goes because Gamma changes on the way."""
    return np.array(np.linalg.inv(np.eye(len(compliance)) - compliance[:, None] * stiffness))


def motion(
    arm: Arm,
    reflector: str,
    q: Array,
    torque: Array,
    compliance: Array,
    second_order: SecondOrder,
    stiffness: Array | None = None,
) -> Motion:
    """Return where the reference point is at theta = q + N u, and how it moves.

    Args:
        arm: The arm.
        reflector: The reference point.
        q: Shape (m, n) [rad], motor angles.
        torque: Shape (m, n) [Nm], deflecting torque u at theta.
        compliance: Shape (n,) [rad/Nm], N.
        second_order: What is taken at theta.
        stiffness: Shape (m, n, n) [Nm/rad], A; None where u was measured and does not depend on theta.
    """
    theta = q + compliance * torque
    position, jacobian = arm.position_and_jacobian(theta if SecondOrder.POSE in second_order else q, reflector)
    jacobian = jacobian[:, :3]
    if SecondOrder.POSE not in second_order:
        position = position + np.einsum("mkn,mn->mk", jacobian, theta - q)
    moved = jacobian if stiffness is None else jacobian @ yielding(compliance, stiffness)
    return Motion(position, moved, moved * compliance, moved * torque[:, None, :])


def equilibrium(
    arm: Arm,
    counterbalance: Counterbalance | None,
    load_point: str,
    q: Array,
    wrench: Array,
    compliance: Array,
    second_order: SecondOrder,
    force_share: Array | float = 1.0,
    constant: Array | float = 0.0,
) -> tuple[Array, LinkTorque]:
    """Return the deflecting torque u = w Gamma(theta) + c at theta = q + N u, shape (m, n), and Gamma there.

    Two Newton steps from theta = q; N A is of order 1e-2, so what is left is below 1e-9 rad.

    Args:
        arm: The arm.
        counterbalance: Its counterbalance, if it has one.
        load_point: Where the wrench acts.
        q: Shape (m, n) [rad], motor angles.
        wrench: Shape (m, 6) [N, Nm].
        compliance: Shape (n,) [rad/Nm], N.
        second_order: What is taken at theta.
        force_share: w, shape (n,); 1 where the load alone deflects.
        constant: c, shape (m, n) [Nm]; what deflects apart from the load.
    """
    theta = q
    for _ in range(2):
        load = link_torque(arm, counterbalance, load_point, q, theta, wrench, second_order)
        torque = force_share * load.total + constant
        missing = q + compliance * torque - theta
        step = (yielding(compliance * force_share, load.stiffness) @ missing[..., None])[..., 0]
        theta = theta + step
        torque = torque + force_share * (load.stiffness @ step[..., None])[..., 0]
    return torque, load
