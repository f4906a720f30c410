"""Force method as the paper states the traditional one: plain least squares on H K = E, Eqs. (19) to (25).

Every loaded state less the unloaded one, all six components of the deflection, all rows alike, newtons and
newton-metres in one sum of squares; corrected by K_C, Eq. (18). The measured deflection stands in the regressor H as if
it were exact. `bench.identify.force_pose` is the same equation with its noise taken into account.
"""

from dataclasses import replace

import numpy as np

from bench.identify.arm import Arm
from bench.identify.estimate import StiffnessEstimate
from bench.identify.force_pose import build_force_pose, in_compliance, signal_of, six_joint_readings
from bench.identify.gls import Solution
from bench.identify.options import Options
from bench.identify.outcome import estimate
from bench.identify.readings import StaticReadings
from bench.identify.statics import SecondOrder
from bench.robot.bodies import Array
from bench.robot.counterbalance import Counterbalance

AS_IF_EXACT = (
    "Eq. (25) takes the measured deflection for exact where it stands in the regressor, and its intervals do not hold "
    "what the noise of its orientation does; force-pose is the same equation with that noise."
)


def identify_force_paper(
    arm: Arm, counterbalance: Counterbalance | None, readings: StaticReadings, options: Options
) -> StiffnessEstimate:
    """Return the stiffness by Eq. (25).

    The covariance is that of least squares with the noise of the residuals, and the gain error of the force sensor.

    Args:
        arm: A six-joint arm.
        counterbalance: Not used: its k_b is no part of Eq. (19).
        readings: Needs the load and three reflectors.
        options: Not used; the paper has no choice to make.

    Raises:
        InputError: A channel is missing, the arm has not six joints, every pose is singular, or reflectors stand in
            line.
    """
    del options
    readings = six_joint_readings("force-paper", readings)
    used = signal_of(arm, counterbalance, readings)
    rigid, plain = np.zeros(readings.n_joints), Options(SecondOrder.WRENCH, 1, "equal")
    problem = build_force_pose(arm, None, readings, plain, rigid)
    H, E = problem.H[..., used].reshape(-1, int(used.sum())), problem.E.reshape(-1)
    information: Array = H.T @ H
    covariance: Array = np.array(np.linalg.inv(information))
    stiffness: Array = covariance @ H.T @ E
    residual = E - H @ stiffness
    freedom = len(E) - len(stiffness)
    scale = float(np.sqrt(residual @ residual / max(freedom, 1)))  # [N] and [Nm], as one
    solved = Solution(
        stiffness, scale**2 * covariance, information, np.array(residual / scale), freedom, freedom, np.nan
    )
    solution = in_compliance(solved, int(used.sum()))
    gain = np.where(used, readings.systematic.force_gain, 0.0)
    compliance = np.zeros(readings.n_joints)
    compliance[used] = solution.parameters
    gain_covariance = np.outer(gain * compliance, gain * compliance)
    found = estimate("force-paper", arm.joint_names, used, solution, gain_covariance)
    return replace(found, degrees_of_freedom=freedom, notes=(*found.notes, AS_IF_EXACT))
