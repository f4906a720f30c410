"""The nominal rigid dynamics of a robot as plain numbers, and how well they are known; for identification."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from bench.robot.bodies import Array, RigidBodies, read_only
from bench.robot.counterbalance import Counterbalance
from bench.robot.drive_uncertainty import DriveUncertainty
from bench.robot.figures import Uncertainty

if TYPE_CHECKING:
    from bench.robot.compiled import CompiledRobot


@dataclass(frozen=True)
class NominalDynamics:
    """Links, drives, friction and counterbalance; n drives, everything reflected to the joint, of a slide N for Nm.

    Attributes:
        bodies: The links.
        rotor_inertia: Shape (n,) [kg m^2], J_m N^2.
        coulomb: Shape (n,) [Nm], Coulomb levels of motor and link side together.
        viscous: Shape (n,) [Nm s/rad], of motor and link side together.
        stiffness: Shape (n,) [Nm/rad], of the gears.
        torque_constant: Shape (n,) [Nm/A].
        stated_constant: Shape (n,) [Nm/A], the same; nan where the figures do not state it.
        gear_ratio: Shape (n,), turns of the motor to one of the joint; nan where the figures do not state it.
        torque_gain_sigma: Shape (n,), relative standard deviation of the torque that is read, of a current with its
            constant.
        torque_offset_sigma: Shape (n,) [Nm], of a constant error of the torque that is read.
        speed_limit: Shape (n,) [rad/s].
        load_point: Name of the point where payloads are bolted on.
        payload: Largest payload that recordings may leave unstated [kg]; 0: none.
        payload_sigma: How well its mass is known beyond what they state [kg]; the same, unless it was weighed.
        payload_side: Of a cube whose centre lies as far from the load point as the rating allows when one face is
            bolted on [m]: how large payloads are, and how far away their centres.
        counterbalance: With all of its gas; None where the robot has no cylinder.
        gas_amount: Share of the gas that the nominal model has in it.
        uncertainty: How well all of this is known.
    """

    bodies: RigidBodies
    rotor_inertia: Array
    coulomb: Array
    viscous: Array
    stiffness: Array
    torque_constant: Array
    stated_constant: Array
    gear_ratio: Array
    torque_gain_sigma: Array
    torque_offset_sigma: Array
    speed_limit: Array
    load_point: str
    payload: float
    payload_sigma: float
    payload_side: float
    counterbalance: Counterbalance | None
    gas_amount: float
    uncertainty: Uncertainty

    @property
    def n_joints(self) -> int:
        """Number of driven joints."""
        return self.bodies.n_joints

    @property
    def drive_uncertainty(self) -> DriveUncertainty:
        """How well the figures of each drive are known."""
        return self.uncertainty.of_drives(self.n_joints)


def nominal_dynamics(compiled: "CompiledRobot") -> NominalDynamics:
    """Return the nominal dynamics of a compiled robot as its figures and its MJCF give them."""
    from bench.robot.links import rigid_bodies

    figures, model, at, n = compiled.robot.figures, compiled.model, compiled.at, compiled.n_joints
    current, torque = figures.instruments.current, figures.instruments.torque
    constant = compiled.torque_constant
    error = np.array([drive.torque_constant_error for drive in figures.drives])
    if torque is not None:
        gain, offset = np.full(n, torque.gain_sigma), np.array(torque.offset_sigma_of(n))
    elif current is not None:
        gain, offset = np.hypot(error, current.gain_sigma), constant * current.offset_sigma_a
    else:
        gain, offset = error, np.zeros(n)
    stated = figures.uncertainty.payload_kg
    weight = float(np.linalg.norm(model.opt.gravity)) or 1.0
    payload = figures.rating.force_n / weight if stated is None else stated
    full, amount = _filled(compiled)
    return NominalDynamics(
        bodies=rigid_bodies(compiled),
        rotor_inertia=read_only(model.dof_armature[at.q_dof]),
        coulomb=read_only(compiled.motor_coulomb + compiled.link_coulomb),
        viscous=read_only(model.dof_damping[at.q_dof] + model.dof_damping[at.theta_dof]),
        stiffness=read_only(compiled.stiffness),
        torque_constant=read_only(constant),
        stated_constant=read_only(np.where([d.states_torque_constant for d in figures.drives], constant, np.nan)),
        gear_ratio=read_only([np.nan if drive.gear_ratio is None else drive.gear_ratio for drive in figures.drives]),
        torque_gain_sigma=read_only(gain),
        torque_offset_sigma=read_only(offset),
        speed_limit=read_only([drive.speed_limit_rad_per_s for drive in figures.drives]),
        load_point=figures.load_point,
        payload=payload,
        payload_sigma=payload,
        payload_side=2 * figures.rating.moment_nm / figures.rating.force_n,
        counterbalance=full,
        gas_amount=amount,
        uncertainty=figures.uncertainty,
    )


def _filled(compiled: "CompiledRobot") -> tuple[Counterbalance | None, float]:
    """Return the counterbalance with all of its gas, and the share that the nominal model has in it."""
    from bench.robot.compiled import compile_robot
    from bench.robot.plugins import configure

    named = compiled.robot.figures.counterbalance
    if named is None:
        return None, 0.0
    filled = compile_robot(compiled.robot, [lambda spec, _: configure(spec, named.actuator, gas_amount=1.0)])
    full, now = filled.counterbalance, compiled.counterbalance
    assert full is not None
    return full, now.gas_constant / full.gas_constant if now else 0.0
