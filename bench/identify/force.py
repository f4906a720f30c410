"""Force method in its position-only form, Eqs. (35) and (41): the load says which torque deflects the joints.

Right where friction sits before the elastic element, on the motor side. Friction on the link side carries part of the
load past the spring; this method does not know, and calls the joints too stiff.
"""

import numpy as np

from bench.identify.arm import Arm
from bench.identify.channels import usable
from bench.identify.estimate import StiffnessEstimate
from bench.identify.gls import SeriesModel
from bench.identify.options import Options
from bench.identify.outcome import fit_compliance, is_signal
from bench.identify.readings import StaticReadings
from bench.identify.statics import SecondOrder, equilibrium, link_torque, motion
from bench.robot.bodies import Array
from bench.robot.counterbalance import Counterbalance


def build_force(
    arm: Arm, counterbalance: Counterbalance | None, readings: StaticReadings, options: Options, compliance: Array
) -> SeriesModel:
    """Return Delta P = L N with the torque of the load, linearised about a compliance, and the covariance of its rows.

    Parameters are N and the three components of the force sensor's direction error, which counts for slanting loads
    only.

    With all of `options.second_order`, this is the full equilibrium: K_C, gravity stiffness and k_b correct both the
    torque and the sensitivity, (1 - N A)^-1 (Eq. (19), solved for the deflection). With none, it is the paper's plain
    Eq. (41).

    Args:
        arm: The arm.
        counterbalance: Its counterbalance, if it has one.
        readings: States with wrench and the first reflector.
        options: Options.
        compliance: Shape (n,) [rad/Nm]; zero gives the plain equation with tracker noise only.
    """
    wrench = readings.load(arm.bodies.gravity)
    torque, load = equilibrium(
        arm, counterbalance, readings.load_point, readings.q_motor, wrench, compliance, options.second_order
    )
    moved = motion(
        arm, readings.reflector_names[0], readings.q_motor, torque, compliance, options.second_order, load.stiffness
    )
    by_force = moved.per_torque @ load.jacobian.transpose(0, 2, 1)
    noise = readings.sigma_reflector**2 * np.eye(3)
    noise = noise + by_force @ wrench_covariance(arm, readings) @ by_force.transpose(0, 2, 1)
    noise += readings.sigma_q_motor**2 * moved.per_motor_angle @ moved.per_motor_angle.transpose(0, 2, 1)
    turned = by_force @ turned_wrench(readings, wrench)
    return SeriesModel(
        series=readings.series,
        response=readings.reflectors[:, 0] - moved.position + moved.per_compliance @ compliance,
        regressor=np.concatenate([moved.per_compliance, turned], axis=2),
        covariance=noise / readings.n_repeats[:, None, None],
        shared=np.zeros((len(readings.series), 3, 0)),
        has_offset=True,
    )


def wrench_covariance(arm: Arm, readings: StaticReadings) -> Array:
    """Return the covariance of one reading of the wrench, (m, 6, 6); of a hanging load only the weight was read."""
    free = np.diag(readings.sigma_wrench**2)
    down = np.concatenate([arm.bodies.gravity / np.linalg.norm(arm.bodies.gravity), np.zeros(3)])
    hanging = np.outer(down, down) * (down @ free @ down)
    return np.where(readings.is_vertical[:, None, None], hanging, free)


def turned_wrench(readings: StaticReadings, wrench: Array) -> Array:
    """Return the change of a wrench per turn about x, y and z, shape (m, 6, 3) [N/rad, Nm/rad]; 0 where it hangs."""
    force, moment = wrench[:, None, :3], wrench[:, None, 3:]
    turned = np.concatenate([np.cross(np.eye(3), force), np.cross(np.eye(3), moment)], axis=2)
    return np.where(readings.is_vertical[:, None, None], 0.0, turned).transpose(0, 2, 1)


def force_change(
    arm: Arm, counterbalance: Counterbalance | None, readings: StaticReadings, second_order: SecondOrder
) -> tuple[Array, Array]:
    """Return Gamma less that of the unloaded state, and its standard deviation, both shape (m, n) [Nm]."""
    wrench, q = readings.load(arm.bodies.gravity), readings.q_motor
    load = link_torque(arm, counterbalance, readings.load_point, q, q, wrench, second_order)
    change = load.total - load.total[readings.first_of_series]
    covariance = wrench_covariance(arm, readings) / readings.n_repeats[:, None, None]
    variance = np.einsum("mkn,mkl,mln->mn", load.jacobian, covariance, load.jacobian)
    return change, np.sqrt(variance + variance[readings.first_of_series])


def identify_force(
    arm: Arm, counterbalance: Counterbalance | None, readings: StaticReadings, options: Options
) -> StiffnessEstimate:
    """Return the stiffness by the force method from positions of one reflector.

    The covariance holds instrument noise, the direction error of slanting loads, and the prior gain error of the
    force sensor, which cannot be told from the compliance: N (1 + g) is all that is seen.

    Args:
        arm: The arm.
        counterbalance: Its counterbalance; needed for its k_b only.
        readings: Needs the load and the first reflector.
        options: Options.

    Raises:
        InputError: A channel is missing.
    """
    readings = usable("force", readings, "force", "reflector")
    change, sigma = force_change(arm, counterbalance, readings, SecondOrder.NONE)
    return fit_compliance(
        "force",
        arm.joint_names,
        build=lambda compliance: build_force(arm, counterbalance, readings, options, compliance),
        used=is_signal(change, sigma),
        gain_covariance=lambda compliance: readings.systematic.force_gain**2 * np.outer(compliance, compliance),
        options=options,
        nuisance_sigma=np.full(3, readings.systematic.force_direction),
    )
