"""The deflections as a linear function of everything the joint method does not know; the model stands in `bench.identify.joint`."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.identify.arm import Arm
from bench.identify.force import turned_wrench, wrench_covariance
from bench.identify.friction import FrictionChange, friction_change
from bench.identify.gls import SeriesModel
from bench.identify.options import Options
from bench.identify.play import play
from bench.identify.readings import StaticReadings
from bench.identify.statics import equilibrium, motion
from bench.robot.counterbalance import Counterbalance

Array = NDArray[np.float64]

SHARE_PRIOR = (0.5, 0.5)  # mean and sigma of lambda: both pure worlds lie one sigma out


@dataclass(frozen=True)
class JointProblem:
    """Deflections linearised about a compliance and a share, without the deviations of friction from that share.

    Parameters are N (n), lambda (n), beta (n), d (n) and the direction error of the force sensor (3).

    Attributes:
        model: Rows of the deflection; its covariance is that of the instruments' noise.
        prior_mean: Shape (p,).
        prior_sigma: Shape (p,); that of beta is for v_1 = 1.
        share: Shape (n,), lambda of the linearisation.
        deviation: Shape (m, 3, n) [m], motion of the reference point when the link-side friction of a joint is larger by S.
        is_first: Shape (m,) bool, first state of its series.
        friction: What currents and load say about friction.
    """

    model: SeriesModel
    prior_mean: Array
    prior_sigma: Array
    share: Array
    deviation: Array
    is_first: NDArray[np.bool_]
    friction: FrictionChange


def build_joint(
    arm: Arm,
    counterbalance: Counterbalance | None,
    readings: StaticReadings,
    options: Options,
    compliance: Array,
    share: Array,
    level: Array,
) -> JointProblem:
    """Return the problem, linearised.

    Args:
        arm: The arm.
        counterbalance: Its counterbalance, if it has one.
        readings: States with currents, load and the first reflector.
        options: Options.
        compliance: Shape (n,) [rad/Nm], N.
        share: Shape (n,), lambda.
        level: Shape (n,), beta.
    """
    n, q, first = readings.n_joints, readings.q_motor, readings.first_of_series
    repeats = readings.n_repeats[:, None, None]
    wrench = readings.load(arm.bodies.gravity)
    place = (arm, counterbalance, readings.load_point, q, wrench, compliance, options.second_order)
    _, load = equilibrium(*place)
    force_noise = load.jacobian.transpose(0, 2, 1) @ (wrench_covariance(arm, readings) / repeats) @ load.jacobian
    variance = np.diagonal(force_noise, axis1=1, axis2=2)
    turned = turned_wrench(readings, wrench)
    by_direction = load.jacobian.transpose(0, 2, 1) @ turned
    friction = friction_change(readings, load.total, np.sqrt(variance + variance[first]), by_direction)

    # u = Gamma - lambda s - (1 - lambda) P; only the part of Gamma that theta changes stays out of the constant
    seen = (1 + friction.gain) * friction.current
    held = play(readings, friction.force, np.maximum(level, 0.0) * friction.scale)
    held_change = held.torque - held.torque[first]
    torque, load = equilibrium(*place, 1 - share, share * (load.total[first] + seen) - (1 - share) * held_change)
    stiffness = (1 - share)[:, None] * load.stiffness
    moved = motion(arm, readings.reflector_names[0], q, torque, compliance, options.second_order, stiffness)
    deviation = moved.per_torque * friction.scale
    by_gain = moved.per_torque * (share * friction.current)[:, None, :]
    # A load that is turned changes Gamma, and with it the gain that was found by comparing the currents with it
    by_direction = moved.per_torque * (1 - share) @ load.jacobian.transpose(0, 2, 1) @ turned
    by_direction = by_direction + by_gain @ friction.gain_by_direction
    regressor = np.concatenate(
        [
            moved.per_compliance,
            -moved.per_torque * (load.total - load.total[first] - seen - held_change)[:, None, :],
            -deviation * ((1 - share) * (held.direction - held.direction[first]))[:, None, :],
            by_gain,
            by_direction,
        ],
        axis=2,
    )
    about = np.concatenate([compliance, share, np.maximum(level, 0.0), friction.gain, np.zeros(3)])
    torque_noise = (1 - share)[:, None] * force_noise * (1 - share)
    torque_noise = torque_noise + np.diag((share * readings.sigma_current_torque) ** 2) / repeats
    noise = moved.per_torque @ torque_noise @ moved.per_torque.transpose(0, 2, 1)
    noise += readings.sigma_reflector**2 / repeats * np.eye(3)
    noise += readings.sigma_q_motor**2 / repeats * moved.per_motor_angle @ moved.per_motor_angle.transpose(0, 2, 1)
    model = SeriesModel(
        series=readings.series,
        response=readings.reflectors[:, 0] - moved.position + regressor @ about,
        regressor=regressor,
        covariance=noise,
        shared=np.zeros((len(q), 3, 0)),
        has_offset=True,
    )
    mean, sigma = SHARE_PRIOR
    direction = np.full(3, readings.systematic.force_direction)
    return JointProblem(
        model=model,
        prior_mean=np.concatenate([np.zeros(n), np.full(n, mean), np.zeros(n), friction.gain, np.zeros(3)]),
        prior_sigma=np.concatenate([np.full(n, np.inf), np.full(n, sigma), np.ones(n), friction.gain_sigma, direction]),
        share=share,
        deviation=deviation,
        is_first=np.arange(len(q)) == first,
        friction=friction,
    )
