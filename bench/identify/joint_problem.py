"""The deflections as a linear function of all that the joint method does not know; see `bench.identify.joint`."""

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
from bench.robot.bodies import Array
from bench.robot.counterbalance import Counterbalance

SHARE_PRIOR = (0.5, 0.5)  # mean and sigma of lambda: both pure worlds lie one sigma out


@dataclass(frozen=True)
class Unknowns:
    """Where the problem is linearised; n joints.

    Attributes:
        compliance: Shape (n,) [rad/Nm], N.
        share: Shape (n,), lambda.
        level: Shape (n,), beta, not negative.
    """

    compliance: Array
    share: Array
    level: Array


@dataclass(frozen=True)
class JointProblem:
    """Deflections linearised, without the deviations of friction from its law.

    Parameters are N (n), lambda (n), beta (n), d (n) and the direction error of the force sensor (3).

    Attributes:
        model: Rows of the deflection; its covariance is that of the instruments' noise.
        prior_mean: Shape (p,).
        prior_sigma: Shape (p,); that of beta is for v_1 = 1.
        share: Shape (n,), lambda of the linearisation.
        deviation: Shape (m, 3, n) [m], motion of the reference point by friction S_j on the link side.
        is_first: Shape (m,) bool, first state of its series.
        friction: What currents and load say about friction.
        held: Shape (m, n) [Nm], P less that of the first state of the series.
        held_by_level: Shape (m, n) [Nm], its derivative by beta.
    """

    model: SeriesModel
    prior_mean: Array
    prior_sigma: Array
    share: Array
    deviation: Array
    is_first: NDArray[np.bool_]
    friction: FrictionChange
    held: Array
    held_by_level: Array


def build_joint(
    arm: Arm, counterbalance: Counterbalance | None, readings: StaticReadings, options: Options, at: Unknowns
) -> JointProblem:
    """Return the problem, linearised.

    Args:
        arm: The arm.
        counterbalance: Its counterbalance, if it has one.
        readings: States with currents, load and the first reflector.
        options: Options.
        at: Where.
    """
    n, q, first = readings.n_joints, readings.q_motor, readings.first_of_series
    repeats = readings.n_repeats[:, None, None]
    wrench = readings.load(arm.bodies.gravity)
    turned = turned_wrench(readings, wrench)
    place = (arm, counterbalance, readings.load_point, q, wrench, at.compliance, options.second_order)
    _, load = equilibrium(*place)
    by_wrench = load.jacobian.transpose(0, 2, 1)
    force_noise = by_wrench @ (wrench_covariance(arm, readings) / repeats) @ load.jacobian
    variance = np.diagonal(force_noise, axis1=1, axis2=2)
    friction = friction_change(readings, load.total, np.sqrt(variance + variance[first]), by_wrench @ turned)
    law = play(readings, friction.force, at.level * friction.scale)
    held = law.torque - law.torque[first]
    held_by_level = friction.scale * (law.direction - law.direction[first])

    # u = Gamma - lambda s - P; of s, only Gamma changes with theta, and the rest goes into the constant
    seen = (1 + friction.gain) * friction.current
    kept = 1 - at.share
    torque, load = equilibrium(*place, kept, at.share * (load.total[first] + seen) - held)
    by_wrench = load.jacobian.transpose(0, 2, 1)
    stiffness = kept[:, None] * load.stiffness
    moved = motion(arm, readings.reflector_names[0], q, torque, at.compliance, options.second_order, stiffness)
    by_share = load.total - load.total[first] - seen
    by_gain = moved.per_torque * (at.share * friction.current)[:, None, :]
    # a load that pulls elsewhere changes Gamma, and with it the gain that was found by comparing currents with it
    by_direction = moved.per_torque * kept @ by_wrench @ turned + by_gain @ friction.gain_by_direction
    regressor = np.concatenate(
        [
            moved.per_compliance,
            -moved.per_torque * by_share[:, None, :],
            -moved.per_torque * held_by_level[:, None, :],
            by_gain,
            by_direction,
        ],
        axis=2,
    )
    about = np.concatenate([at.compliance, at.share, at.level, friction.gain, np.zeros(3)])
    torque_noise = kept[:, None] * force_noise * kept
    torque_noise = torque_noise + np.diag((at.share * readings.sigma_current_torque) ** 2) / repeats
    noise = moved.per_torque @ torque_noise @ moved.per_torque.transpose(0, 2, 1)
    noise += readings.sigma_reflector**2 / repeats * np.eye(3)
    noise += readings.sigma_q_motor**2 / repeats * moved.per_motor_angle @ moved.per_motor_angle.transpose(0, 2, 1)
    mean, sigma = SHARE_PRIOR
    direction = np.full(3, readings.systematic.force_direction)
    return JointProblem(
        model=SeriesModel(
            series=readings.series,
            response=readings.reflectors[:, 0] - moved.position + regressor @ about,
            regressor=regressor,
            covariance=noise,
            shared=np.zeros((len(q), 3, 0)),
            has_offset=True,
        ),
        prior_mean=np.concatenate([np.zeros(n), np.full(n, mean), np.zeros(n), friction.gain, np.zeros(3)]),
        prior_sigma=np.concatenate([np.full(n, np.inf), np.full(n, sigma), np.ones(n), friction.gain_sigma, direction]),
        share=at.share,
        deviation=moved.per_torque * friction.scale,
        is_first=np.arange(len(q)) == first,
        friction=friction,
        held=held,
        held_by_level=held_by_level,
    )
