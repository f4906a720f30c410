"""Joint method, beyond the paper: deflection, currents and load as one estimate with friction on both sides.

The torque that deflects is u = Gamma - f, f the friction that came to act on the link side since the series began. Load
and currents together see s, the sum of the changes on both sides (`bench.identify.friction`). The law is

    f = lambda s + P(Gamma; beta S)

  - lambda_j is the share of the link side of joint j: 0 in the world of the force method, 1 in that of the current
    method. There f = lambda s holds exactly, state by state and whatever the law of friction (P is then zero).
  - P is Coulomb friction of level beta_j S_j on the link side, a play element that the load drives
    (`bench.identify.play`), where a share does not hold: the side nearest to the load takes its part first, and a
    servo with integral action leaves the motor anywhere in its friction band. S_j is the size of joint j's friction.

Neither beta nor what the law leaves out is known beforehand. beta S has a normal prior of variance v_1 S^2; the
friction of every state, the first one included, deviates by v_2 S^2; and where a joint may stick, its share may be 0
or 1, which has variance lambda (1 - lambda) S^2. The estimate is the mean over a grid of v_1 and v_2, weighted by
restricted likelihood, and its covariance that of the mixture, so that not knowing them is part of the interval. In a
pure world the readings themselves make both small.

Unknown besides: the gain d of the load's torque over the currents' (its prior is the torque constants' error,
sharpened by comparing currents with load), the direction error of the force sensor, the offset of each series. The
gain of the force sensor cannot be told from N; it is added to the covariance.

Noise stands in the regressors too. That of Gamma is too small to matter (its square over the signal's is 1e-6). That
of s shrinks lambda s to what f is expected to be given the s that was *read*, which is what is wanted here.
"""

from dataclasses import fields

import numpy as np
from numpy.typing import NDArray

from bench.identify.arm import Arm
from bench.identify.channels import usable
from bench.identify.estimate import JointEstimate
from bench.identify.force import force_change
from bench.identify.gls import Solution
from bench.identify.joint_problem import SHARE_PRIOR, JointProblem, Unknowns, build_joint
from bench.identify.options import Options
from bench.identify.outcome import estimate, is_signal
from bench.identify.readings import StaticReadings
from bench.identify.spread import SPREADS, solve_joint
from bench.identify.statics import SecondOrder
from bench.robot.bodies import Array
from bench.robot.counterbalance import Counterbalance


def identify_joint(
    arm: Arm, counterbalance: Counterbalance | None, readings: StaticReadings, options: Options
) -> JointEstimate:
    """Return the stiffness by the joint method, and where the friction sits.

    Args:
        arm: The arm.
        counterbalance: Its counterbalance.
        readings: Needs currents, load and the first reflector.
        options: Options; the first iteration, from a rigid arm, takes half the friction for the link's.

    Raises:
        InputError: A channel is missing.
    """
    readings = usable("joint", readings, "current", "force", "reflector")
    n = readings.n_joints
    used = is_signal(*force_change(arm, counterbalance, readings, SecondOrder.NONE))
    count = int(used.sum())
    at = Unknowns(np.zeros(n), np.full(n, SHARE_PRIOR[0]), np.zeros(n))
    for step in range(options.iterations):
        problem = build_joint(arm, counterbalance, readings, options, at)
        solution = solve_joint(problem, used, SPREADS if step else SPREADS[:1])
        compliance, share, level = solution.parameters[: 3 * count].reshape(3, count)
        at = Unknowns(
            compliance=_filled(at.compliance, used, compliance),
            share=_filled(at.share, used, share),
            level=_filled(at.level, used, np.maximum(level, 0.0)),
        )
    gain_covariance = readings.systematic.force_gain**2 * np.outer(at.compliance, at.compliance)
    base = estimate("joint", arm.joint_names, used, solution, gain_covariance)
    link_share, link_share_sigma = _link_side(problem, solution, used)
    return JointEstimate(
        **{field.name: getattr(base, field.name) for field in fields(base)},
        link_share=link_share,
        link_share_sigma=link_share_sigma,
        friction_scale=problem.friction.scale,
        current_gain=problem.friction.gain,
        current_gain_sigma=problem.friction.gain_sigma,
    )


def _filled(values: Array, used: NDArray[np.bool_], found: Array) -> Array:
    filled = values.copy()
    filled[used] = found
    return filled


def _link_side(problem: JointProblem, solution: Solution, used: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Return the share of the link side in all friction, sum(f s) / sum(s^2), and its sigma, both shape (n,)."""
    s = problem.friction.total[:, used]
    weight = s / np.maximum(np.sum(s**2, axis=0), np.finfo(float).tiny)
    held = np.sum(problem.held[:, used] * weight, axis=0)
    by_level = np.sum(problem.held_by_level[:, used] * weight, axis=0)
    count = int(used.sum())
    share = slice(count, 2 * count)
    level = slice(2 * count, 3 * count)
    covariance = solution.covariance
    variance = np.diag(covariance[share, share]) + by_level**2 * np.diag(covariance[level, level])
    variance = variance + 2 * by_level * np.diag(covariance[share, level])
    mean, sigma = SHARE_PRIOR
    prior = np.full(len(used), mean), np.full(len(used), sigma)
    return _filled(prior[0], used, solution.parameters[share] + held), _filled(prior[1], used, np.sqrt(variance))
