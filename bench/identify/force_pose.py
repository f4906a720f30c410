"""Force method in full, Eqs. (19) to (25): all six components of the deflection, corrected by K_C.

It estimates the stiffness itself, linear in K, with the measured deflection in the regressor H. That deflection is
noisy, its orientation most of all, and plain least squares, Eq. (25), would be biased towards soft joints. Each
equation is therefore weighted by its own noise, and the deflection that the fit predicts takes the place of the
measured one where H is an instrument: K = (Z^T V^-1 H)^-1 Z^T V^-1 E. Both need a stiffness: the first is that of the
force method from positions alone, and each pass takes that of the pass before, until it stays.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.errors import ConvergenceError, InputError
from bench.identify.arm import Arm
from bench.identify.channels import usable
from bench.identify.estimate import StiffnessEstimate
from bench.identify.force import force_change, identify_force, turned_wrench, wrench_covariance
from bench.identify.gls import SURE, SeriesModel, Solution, whiten
from bench.identify.options import Options
from bench.identify.outcome import estimate, is_signal
from bench.identify.readings import StaticReadings
from bench.identify.rigid_motion import pose_deflection
from bench.identify.statics import SecondOrder, equilibrium, link_torque
from bench.robot.bodies import Array
from bench.robot.counterbalance import Counterbalance

SINGULAR = 1e4  # condition number of J_m beyond which a pose says nothing about single joints
SETTLED = 0.01  # effort: of a standard error, by which no stiffness changes any more; each pass gains a digit
PASSES = 30  # effort: at most; six are enough from twice and half the stiffness


@dataclass(frozen=True)
class PoseProblem:
    """H K = E in m loaded states, Eq. (23).

    Attributes:
        series: Shape (m,) int.
        H: Shape (m, 6, 6), Eq. (24).
        E: Shape (m, 6) [N, Nm], Eq. (20).
        to_wrench: Shape (m, 6, 6), J_f^-T.
        to_joints: Shape (m, 6, 6), J_m^-1.
        load: Shape (m, 6) [Nm], J_f^T W.
        stiffness: Shape (m, 6, 6) [Nm/rad], K_C, less gravity and counterbalance stiffness.
        deflection_covariance: Shape (m, 6, 6), of Delta X, without the shared unloaded reading.
        reference_root: Shape (m, 6, 6), square root of the covariance of the shared unloaded reading.
        wrench_covariance: Shape (m, 6, 6), of W.
        turned: Shape (m, 6, 3) [N/rad, Nm/rad], change of W per turn of the force sensor's axes.
        turned_sigma: [rad], standard deviation of such a turn about each axis.
    """

    series: NDArray[np.int64]
    H: Array
    E: Array
    to_wrench: Array
    to_joints: Array
    load: Array
    stiffness: Array
    deflection_covariance: Array
    reference_root: Array
    wrench_covariance: Array
    turned: Array
    turned_sigma: float


def build_force_pose(
    arm: Arm, counterbalance: Counterbalance | None, readings: StaticReadings, options: Options, compliance: Array
) -> PoseProblem:
    """Return Eqs. (20) and (24) for every loaded state.

    J_f is taken at the unloaded, J_m and K_C half way to the loaded link angles, as far as the compliance is known
    already. What the motors gave under load is subtracted from Delta X beforehand: Delta X - J_m Delta q.

    Args:
        arm: A six-joint arm.
        counterbalance: Its counterbalance, if it has one.
        readings: States with wrench and at least three reflectors.
        options: Options; each of WRENCH, GRAVITY, COUNTERBALANCE adds its part to the correction by K_C.
        compliance: Shape (6,) [rad/Nm]; zero takes everything at the motor angles.

    Raises:
        InputError: All poses are singular, or the reflectors stand in one line.
    """
    first, q, load_point = readings.first_of_series, readings.q_motor, readings.load_point
    wrench = readings.load(arm.bodies.gravity)
    deflecting, _ = equilibrium(arm, counterbalance, load_point, q, wrench, compliance, options.second_order)
    theta = q + compliance * deflecting if SecondOrder.POSE in options.second_order else q
    half_way = (theta + theta[first]) / 2
    moving = arm.jacobian(half_way, readings.reflector_names[0])
    keep = ~readings.is_reference & (np.linalg.cond(moving) < SINGULAR)
    if not keep.any():
        raise InputError(
            "methods 'force-pose' and 'force-paper': every pose is singular (axes 4 and 6 in line); bend joint 5."
        )
    measured = pose_deflection(readings)
    change = measured.change - (moving @ (q - q[first])[..., None])[..., 0]
    stiffness = link_torque(arm, counterbalance, load_point, q, half_way, wrench, options.second_order).stiffness[keep]
    loading = arm.jacobian(theta[first], load_point)[keep].transpose(0, 2, 1)
    to_wrench = np.linalg.inv(loading)
    to_joints = np.linalg.inv(moving[keep])
    bent = (to_joints @ change[keep][..., None])[..., 0]
    pushed = (wrench - wrench[first])[keep]
    noise = wrench_covariance(arm, readings) / readings.n_repeats[:, None, None]
    return PoseProblem(
        series=readings.series[keep],
        H=to_wrench * bent[:, None, :],
        E=(to_wrench @ (stiffness @ bent[..., None]))[..., 0] + pushed,
        to_wrench=to_wrench,
        to_joints=to_joints,
        load=(loading @ pushed[..., None])[..., 0],
        stiffness=stiffness,
        deflection_covariance=measured.covariance[keep],
        reference_root=np.linalg.cholesky(measured.covariance[first][keep]),
        wrench_covariance=noise[keep] + noise[first][keep],
        turned=turned_wrench(readings, wrench)[keep],
        turned_sigma=max(readings.systematic.force_direction, SURE),
    )


def solve_force_pose(problem: PoseProblem, used: NDArray[np.bool_], stiffness: Array | None) -> Solution:
    """Return the stiffness of the used joints and the three turns of the force sensor's axes.

    Args:
        problem: From `build_force_pose`.
        used: Shape (6,) bool.
        stiffness: Shape (6,) [Nm/rad] of the pass before, for weights and instrument; None: Eq. (25), plain.
    """
    m = len(problem.E)
    if stiffness is None:
        instrument = problem.H
        covariance, shared = np.tile(np.eye(6), (m, 1, 1)), np.zeros((m, 6, 0))
    else:
        net = np.diag(stiffness) - problem.stiffness
        instrument = problem.to_wrench * np.linalg.solve(net, problem.load[..., None]).transpose(0, 2, 1)
        carry = problem.to_wrench @ net @ problem.to_joints
        covariance = carry @ problem.deflection_covariance @ carry.transpose(0, 2, 1) + problem.wrench_covariance
        shared = carry @ problem.reference_root
    columns = np.concatenate([problem.H[..., used], problem.turned, instrument[..., used], problem.turned], axis=2)
    white = whiten(SeriesModel(problem.series, problem.E, columns, covariance, shared, has_offset=False))
    H, Z = np.split(white.regressor, 2, axis=1)
    count = int(used.sum())
    prior = np.diag(np.concatenate([np.zeros(count), np.full(3, problem.turned_sigma**-2.0)]))
    parameters = np.array(np.linalg.solve(Z.T @ H + prior, Z.T @ white.response))
    residual = white.response - H @ parameters
    information = Z.T @ Z
    surprise = parameters[count:] / problem.turned_sigma
    return Solution(
        parameters=parameters,
        covariance=np.array(np.linalg.inv(information + prior)),
        information=information,
        residual=residual,
        chi_square=float(residual @ residual + surprise @ surprise),
        degrees_of_freedom=white.n_free - count,
        log_likelihood=np.nan,
    )


def identify_force_pose(
    arm: Arm, counterbalance: Counterbalance | None, readings: StaticReadings, options: Options
) -> StiffnessEstimate:
    """Return the stiffness by the full force method.

    The covariance holds instrument noise, placement of the reflectors, and gain and direction error of the force
    sensor.

    Args:
        arm: A six-joint arm.
        counterbalance: Its counterbalance; needed for its k_b only.
        readings: Needs the load and three reflectors.
        options: Options; passes are made until the stiffness stays, however many `iterations` are.

    Raises:
        InputError: A channel is missing, the arm has not six joints, every pose is singular, or reflectors stand in
            line.
        ConvergenceError: The stiffness does not settle.
    """
    readings = six_joint_readings("force-pose", readings)
    used = signal_of(arm, counterbalance, readings)
    count = int(used.sum())
    problem = build_force_pose(arm, counterbalance, readings, options, np.zeros(6))
    stiffness = _start(identify_force(arm, counterbalance, readings, options), used)
    moved = np.inf
    for _ in range(PASSES):
        if stiffness is not None:
            compliance = np.where(used, 1 / stiffness, 0.0)
            problem = build_force_pose(arm, counterbalance, readings, options, compliance)
        try:
            solution = solve_force_pose(problem, used, stiffness)
        except np.linalg.LinAlgError:  # so far off that the arm would not stand
            moved = np.inf
            break
        found = solution.parameters[:count]
        if stiffness is not None:
            change = np.abs(found - stiffness[used])
            moved = float(np.max(change / np.sqrt(np.diag(solution.covariance)[:count]), initial=0.0))
        stiffness = _with_others(found, used)
        if moved < SETTLED:
            break
    if stiffness is None or moved >= SETTLED:
        raise ConvergenceError(
            f"method 'force-pose': after at most {PASSES} passes a stiffness still moves by {moved:.2g} of its "
            f"standard error, asked for is {SETTLED:g}; take 'force' or 'joint'."
        )
    compliance = np.where(used, 1 / stiffness, 0.0)
    gain_covariance = readings.systematic.force_gain**2 * np.outer(compliance, compliance)
    return estimate("force-pose", arm.joint_names, used, in_compliance(solution, count), gain_covariance)


def _start(by_positions: StiffnessEstimate, used: NDArray[np.bool_]) -> Array | None:
    """Return the stiffness to begin with, shape (6,) [Nm/rad]; None, which begins with Eq. (25), if none is known."""
    if not np.any(by_positions.observable & used):
        return None
    known = np.where(by_positions.observable & used, by_positions.stiffness, np.nan)
    return np.where(np.isnan(known), np.nanmedian(known), known)


def _with_others(found: Array, used: NDArray[np.bool_]) -> Array:
    """Return the stiffness of all joints, shape (6,) [Nm/rad]; one without signal needs some value for its noise."""
    stiffness = np.full(6, np.median(found) if len(found) else 1.0)
    stiffness[used] = found
    return stiffness


def six_joint_readings(method: str, readings: StaticReadings) -> StaticReadings:
    """Return the states that have the load and three reflectors.

    Raises:
        InputError: There are none, or the arm has not six joints.
    """
    readings = usable(method, readings, "force", "reflectors")
    if readings.n_joints != 6:
        raise InputError(f"method {method!r} inverts J_m and needs six joints, not {readings.n_joints}; use 'force'.")
    return readings


def signal_of(arm: Arm, counterbalance: Counterbalance | None, readings: StaticReadings) -> NDArray[np.bool_]:
    """Return which joints the load puts a torque on, shape (n,)."""
    return is_signal(*force_change(arm, counterbalance, readings, SecondOrder.NONE))


def in_compliance(solution: Solution, count: int) -> Solution:
    """Return a solution whose first `count` parameters are stiffnesses with compliances in their place, first order."""
    compliance = 1 / solution.parameters[:count]
    others = solution.parameters[count:]
    slope = np.concatenate([-(compliance**2), np.ones(len(others))])
    return replace(
        solution,
        parameters=np.concatenate([compliance, others]),
        covariance=np.outer(slope, slope) * solution.covariance,
    )
