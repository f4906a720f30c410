"""Current method, Eqs. (39) to (42): the motor currents say which torque went through the elastic elements.

Right where friction sits behind the elastic element, on the link side. Friction on the motor side is paid for by the
motor and not felt by the spring; this method takes it for spring torque all the same, and calls the joints too soft.
"""

import numpy as np

from bench.identify.arm import Arm
from bench.identify.channels import usable
from bench.identify.estimate import StiffnessEstimate
from bench.identify.gls import SeriesModel
from bench.identify.options import Options
from bench.identify.outcome import fit_compliance, is_signal
from bench.identify.readings import StaticReadings
from bench.identify.statics import motion
from bench.robot.bodies import Array
from bench.robot.counterbalance import Counterbalance


def build_current(arm: Arm, readings: StaticReadings, options: Options, compliance: Array) -> SeriesModel:
    """Return Delta P = L N, Eq. (41), linearised about a compliance and with the covariance of its rows.

    Each state's row of L is J_m diag(-xi I), Eq. (42); the difference to the unloaded state is made by the free
    offset of the series, so the noise of the shared unloaded reading is treated as shared. The noise of the currents,
    which stands in the regressor, is carried over into the rows at the given compliance (effective variance).

    Args:
        arm: The arm.
        readings: States with currents and the first reflector.
        options: Options.
        compliance: Shape (n,) [rad/Nm]; zero gives the plain equation with tracker noise only.
    """
    torque = -readings.current_torque
    moved = motion(arm, readings.reflector_names[0], readings.q_motor, torque, compliance, options.second_order)
    repeats = readings.n_repeats[:, None, None]
    noise = readings.sigma_reflector**2 * np.eye(3)
    noise = noise + (moved.per_torque * readings.sigma_current_torque**2) @ moved.per_torque.transpose(0, 2, 1)
    noise += readings.sigma_q_motor**2 * moved.per_motor_angle @ moved.per_motor_angle.transpose(0, 2, 1)
    return SeriesModel(
        series=readings.series,
        response=readings.reflectors[:, 0] - moved.position + moved.per_compliance @ compliance,
        regressor=moved.per_compliance,
        covariance=noise / repeats,
        shared=np.zeros((len(readings.series), 3, 0)),
        has_offset=True,
    )


def identify_current(
    arm: Arm, counterbalance: Counterbalance | None, readings: StaticReadings, options: Options
) -> StiffnessEstimate:
    """Return the stiffness by the current method.

    Neither load nor counterbalance enters: the current contains what they do. The covariance holds instrument noise
    and the prior error of the torque constants, which cannot be told from the compliance: N_j (1 + g_j) is all that
    is seen.

    Args:
        arm: The arm.
        counterbalance: Not used.
        readings: Needs currents and the first reflector.
        options: Options.

    Raises:
        InputError: A channel is missing.
    """
    del counterbalance
    readings = usable("current", readings, "current", "reflector")
    change = readings.current_torque - readings.current_torque[readings.first_of_series]
    sigma = readings.sigma_current_torque * np.sqrt(2 / readings.n_repeats[:, None])
    return fit_compliance(
        "current",
        arm.joint_names,
        build=lambda compliance: build_current(arm, readings, options, compliance),
        used=is_signal(change, sigma),
        gain_covariance=lambda compliance: np.diag((compliance * readings.systematic.torque_gain) ** 2),
        options=options,
    )
