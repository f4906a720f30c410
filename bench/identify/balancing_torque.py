"""The torque of the counterbalance from traverses of its joint, Eqs. (31) to (33), and all that may be wrong in it.

M is restoring, and torques are those of the motor in the direction of growing angles. Where the paper writes tau it
means what the load does to the joint, which has the opposite sign; Eq. (32) then reads M = tau_motor - tau_0, where
tau_0 is the motor torque that the same motion would need without a counterbalance.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.errors import InputError
from bench.identify.arm import Arm
from bench.identify.traverses import Traverse
from bench.record.campaign import Array
from bench.robot.bodies import RigidBodies
from bench.robot.counterbalance import Counterbalance
from bench.robot.drives import Drives
from bench.robot.payload import with_payload

SMOOTH = 7  # degree of the polynomial that stands for a torque where its noise must not enter

TORQUE_CONSTANT = "torque constant"  # the nuisance that tells the gain of the current


@dataclass(frozen=True)
class Geometry:
    """A counterbalance of known geometry and unknown gas.

    Attributes:
        joint: Index of its hinge in the arm, from 0.
        rho, b: Distances of its anchors from the hinge [m].
        dead_centre: Joint angle at which it is shortest [rad].
    """

    joint: int
    rho: float
    b: float
    dead_centre: float

    @classmethod
    def of(cls, counterbalance: Counterbalance) -> "Geometry":
        """Return the geometry of a counterbalance without its gas figures."""
        return cls(counterbalance.joint, counterbalance.rho, counterbalance.b, counterbalance.dead_centre)

    @property
    def rod(self) -> Counterbalance:
        """Some counterbalance of this geometry, for its lengths and lever arms."""
        return self.filled(1.0, self.rho + self.b + 1.0)

    def filled(self, gas_constant: float, critical_length: float) -> Counterbalance:
        """Return the counterbalance with gas in it: C [Nm] and l_c [m]."""
        return Counterbalance(self.joint, self.rho, self.b, self.dead_centre, gas_constant, critical_length)


@dataclass(frozen=True)
class Priors:
    """How well things are known that M depends on, as relative standard deviations; the rest stands in `Drives`.

    Attributes:
        compliance: Of each elastic element. A joint stiffness comes from another experiment.
        first_moment: Of the arm's mass times the distance of its centre from the joint, without the payload. Zero takes
            the dynamic model as exact.
    """

    compliance: float = 0.1
    first_moment: float = 0.0


@dataclass(frozen=True)
class BalancingTorque:
    """M over the joint's angle from one traverse; B angles.

    Attributes:
        name: Of the traverse.
        speed: [rad/s].
        payload: [kg].
        theta: Shape (B,) [rad], link angle.
        torque: Shape (B,) [Nm], M of Eq. (32).
        sigma: Shape (B,) [Nm], its standard deviation from the current's noise.
        sensitivity: Shape (B, m) [Nm], what M is wrong by where the m quantities of `nuisances` are wrong by one
            standard deviation.
    """

    name: str
    speed: float
    payload: float
    theta: Array
    torque: Array
    sigma: Array
    sensitivity: Array


def balancing_torques(
    traverses: Sequence[Traverse],
    bodies: RigidBodies,
    drives: Drives,
    geometry: Geometry,
    load_point: str,
    priors: Priors | None = None,
) -> tuple[BalancingTorque, ...]:
    """Return M for each traverse of the counterbalance's joint.

    The link angles are the motor angles less the twist of the elastic elements, theta = q - tau / k (Eq. 1). Without
    it, at 1 mrad of twist, M and gravity are wrong by some Nm.

    Args:
        traverses: Of any joints; those of others are passed over.
        bodies: The arm without payload.
        drives: Of the arm.
        geometry: Of the counterbalance.
        load_point: Name of the point that carries the payload.
        priors: None takes the default ones.

    Raises:
        InputError: No traverse is of the counterbalance's joint, or a motor current is missing.
    """
    mine = [traverse for traverse in traverses if traverse.joint == geometry.joint]
    if not mine:
        raise InputError(f"no motion run turns {bodies.names[geometry.joint]!r} alone, there and back; record one.")
    if missing := [t.name for t in mine if np.isnan(t.torque).any()]:
        raise InputError(f"{', '.join(missing)}: a motor current is missing; every joint's twist needs its current.")
    empty = Arm(bodies)
    arms = {mass: Arm(with_payload(bodies, mass, load_point)) for mass in {t.payload for t in mine}}
    return tuple(_torque(t, arms[t.payload], empty, drives, priors or Priors()) for t in mine)


def nuisances(bodies: RigidBodies) -> tuple[str, ...]:
    """Return the names of the columns of `BalancingTorque.sensitivity`."""
    compliances = (f"compliance of {name}" for name in bodies.names)
    return (TORQUE_CONSTANT, "current offset", *compliances, "first moment, along", "first moment, across")


def _torque(traverse: Traverse, arm: Arm, empty: Arm, drives: Drives, priors: Priors) -> BalancingTorque:
    j = traverse.joint
    twist = traverse.torque / drives.stiffness
    theta = traverse.q - twist
    motor = traverse.torque[:, j]
    without = _dynamics(arm, theta, traverse) + drives.rotor_inertia[j] * traverse.acceleration
    # With the measured torque as a column, a gain that shrinks the noise too would look like a better fit.
    smooth = np.polynomial.Polynomial.fit(theta[:, j], motor, SMOOTH)
    slope = arm.gravity_stiffness(theta)[:, j]
    slope[:, j] = smooth.deriv()(theta[:, j])  # gravity's and M's
    sensitivity = np.column_stack(
        [
            drives.torque_gain_sigma[j] * smooth(theta[:, j]),
            np.full_like(motor, drives.torque_constant[j] * drives.current_offset_sigma),
            -priors.compliance * slope * twist,
            priors.first_moment * empty.gravity(theta)[:, j],
            priors.first_moment * empty.gravity_stiffness(theta)[:, j, j],
        ]
    )
    return BalancingTorque(
        traverse.name, traverse.speed, traverse.payload, theta[:, j], motor - without, traverse.sigma, sensitivity
    )


def _dynamics(arm: Arm, theta: Array, traverse: Traverse) -> Array:
    """Return D a + C(theta, v) + G at the joint, Eq. (29), shape (B,) [Nm]; C is quadratic in v, so alike both ways."""
    velocity, acceleration = np.zeros_like(theta), np.zeros_like(theta)
    velocity[:, traverse.joint] = traverse.speed
    acceleration[:, traverse.joint] = traverse.acceleration
    rows = zip(theta, velocity, acceleration, strict=True)
    return np.array([arm.inverse_dynamics(q, v, a)[traverse.joint] for q, v, a in rows])
