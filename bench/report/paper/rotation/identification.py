"""The counterbalance from a campaign of rotations, held against another campaign of rotations."""

from dataclasses import dataclass, replace
from pathlib import Path

from bench.errors import InputError
from bench.identify.balancing_torque import (
    TORQUE_CONSTANT,
    BalancingTorque,
    Geometry,
    Priors,
    balancing_torques,
    nuisances,
)
from bench.identify.counterbalance_check import Prediction, Spread, predict, spread
from bench.identify.counterbalance_fit import CounterbalanceFit, fit_counterbalance
from bench.identify.traverse_friction import FrictionOverSpeed, friction_over_speed
from bench.identify.traverses import Traverse, traverses
from bench.report.campaigns import open_usable
from bench.robot.bodies import Array, RigidBodies
from bench.robot.drives import Drives, drives_of
from bench.robot.links import rigid_bodies

UNCERTAIN_MASSES = Priors(first_moment=0.01)  # how well a lab may know the masses of an arm that it has not taken apart


@dataclass(frozen=True)
class RotationIdentification:
    """What rotations of one joint say about its counterbalance.

    Attributes:
        torques: M of each traverse.
        spread: The same at common angles.
        friction: Of the joint over speed.
        fit: C and l_c, the dynamic model being exact.
        uncertain: The same if the arm's masses are known as `UNCERTAIN_MASSES` says.
        predictions: Of M in traverses that the fit has not seen.
        corrected: Of `torques`, M less what the nuisances account for, at common angles.
        torque_gain: Relative error of the joint's torque constant and current together, as the fit found it.
        joint: Name of the joint.
        limits: Shape (2,) [rad], of the joint.
        stiffness, stiffness_sigma: k_2^0 of the joint's elastic element and its standard deviation [Nm/rad].
    """

    torques: tuple[BalancingTorque, ...]
    spread: Spread
    friction: FrictionOverSpeed
    fit: CounterbalanceFit
    uncertain: CounterbalanceFit
    predictions: tuple[Prediction, ...]
    corrected: Spread
    torque_gain: float
    joint: str
    limits: Array
    stiffness: float
    stiffness_sigma: float


@dataclass(frozen=True)
class _Campaign:
    """Traverses, and what identification may know of their robot: everything but the gas."""

    traverses: tuple[Traverse, ...]
    bodies: RigidBodies
    drives: Drives
    geometry: Geometry
    load_point: str

    def torques(self, priors: Priors) -> tuple[BalancingTorque, ...]:
        return balancing_torques(self.traverses, self.bodies, self.drives, self.geometry, self.load_point, priors)


def identify_rotation(folder: Path, validation: Path) -> RotationIdentification:
    """Identify the counterbalance from one campaign, and predict M in another.

    Args:
        folder: Campaign with traverses of the counterbalance's joint.
        validation: Campaign with others, of the same robot.

    Raises:
        CampaignError: A folder is not a usable campaign; every fault is listed.
        InputError: The robot has no counterbalance, or the runs are not traverses of its joint.
    """
    seen, unseen = _open(folder), _open(validation)
    j = seen.geometry.joint
    limits, names = seen.bodies.limits[j], nuisances(seen.bodies)
    torques = seen.torques(Priors())
    fit = fit_counterbalance(torques, seen.geometry, names, limits)
    return RotationIdentification(
        torques=torques,
        spread=spread(torques),
        friction=friction_over_speed([t for t in seen.traverses if t.joint == j]),
        fit=fit,
        uncertain=fit_counterbalance(seen.torques(UNCERTAIN_MASSES), seen.geometry, names, limits),
        predictions=predict(fit, unseen.torques(Priors())),
        corrected=spread([replace(t, torque=m) for t, m in zip(torques, fit.corrected, strict=True)]),
        torque_gain=float(fit.nuisances[TORQUE_CONSTANT] * seen.drives.torque_gain_sigma[j]),
        joint=seen.bodies.names[j],
        limits=limits,
        stiffness=float(seen.drives.stiffness[j]),
        stiffness_sigma=float(seen.drives.stiffness[j] * Priors().compliance),
    )


def _open(folder: Path) -> _Campaign:
    campaign, compiled = open_usable(folder)
    if compiled.counterbalance is None:
        raise InputError(f"{folder}: {campaign.robot} has no counterbalance; there is nothing to identify.")
    bodies, drives = rigid_bodies(compiled), drives_of(compiled)
    geometry = Geometry.of(compiled.counterbalance)
    found = traverses(campaign, drives, bodies.gravity)
    return _Campaign(found, bodies, drives, geometry, compiled.robot.figures.load_point)
