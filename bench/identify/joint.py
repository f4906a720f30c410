"""Joint method, beyond the paper: deflection, currents and load as one estimate with friction on both sides.

The torque that deflects is u = Gamma - f, f the friction that came to act on the link side since the series began. Load and
currents together see s, the sum of the changes on both sides (`bench.identify.friction`). Given s,

    f = lambda s + S (beta h + e)

with lambda_j the share of the link side of joint j: 0 in the world of the force method, 1 in that of the current method.
In both worlds f = lambda s holds exactly, state by state and whatever the law of friction. Where friction sits on both
sides, it need not be shared alike in every state. Deviations are measured in S_j, the size of joint j's friction:
  - beta_j along h, the direction in which the load last drove the joint: Coulomb friction of which the currents see another
    pattern, because a servo with integral action leaves the motor anywhere in its friction band (variance v_1);
  - of the first state of each series, which remembers the approach (variance v_1);
  - from state to state (variance v_2);
  - where the joint may stick, since the load has changed too little since it last turned: friction nearest to the load then takes its
    part first, and any share is possible (variance lambda (1 - lambda) + v_1).
v_1 and v_2 are not known. The estimate is the mean over a grid of them, weighted by restricted likelihood, and its covariance
that of the mixture, so that not knowing them is part of the interval. In a pure world the readings themselves make them small.

Unknown besides N and lambda: the gain d of the load's torque over the currents' (its prior is the torque constants' error,
sharpened by comparing currents with load), the direction error of the force sensor, the offset of each series. The gain of
the force sensor cannot be told from N; it is added to the covariance.

Noise stands in the regressors too. That of Gamma is too small to matter (its square over the signal's is 1e-6). That of s
shrinks lambda s to what f is expected to be given the s that was *read*, which is what is wanted here.
"""

from dataclasses import fields

import numpy as np

from bench.identify.arm import Arm
from bench.identify.channels import usable
from bench.identify.estimate import JointEstimate
from bench.identify.force import force_change
from bench.identify.joint_problem import SHARE_PRIOR, build_joint
from bench.identify.options import Options
from bench.identify.outcome import estimate, is_signal
from bench.identify.readings import StaticReadings
from bench.identify.spread import SPREADS, solve_joint
from bench.identify.statics import SecondOrder
from bench.robot.counterbalance import Counterbalance


def identify_joint(
    arm: Arm, counterbalance: Counterbalance | None, readings: StaticReadings, options: Options
) -> JointEstimate:
    """Return the stiffness by the joint method, and where the friction sits.

    Args:
        arm: The arm.
        counterbalance: Its counterbalance.
        readings: Needs currents, load and the first reflector.
        options: Options; the first iteration, from a rigid arm, takes half the friction for the link's and no deviations.

    Raises:
        InputError: A channel is missing.
    """
    readings = usable("joint", readings, "current", "force", "reflector")
    n = readings.n_joints
    used = is_signal(*force_change(arm, counterbalance, readings, SecondOrder.NONE))
    count = int(used.sum())
    compliance, share, level = np.zeros(n), np.full(n, SHARE_PRIOR[0]), np.zeros(n)
    for step in range(options.iterations):
        problem = build_joint(arm, counterbalance, readings, options, compliance, share, level)
        solution = solve_joint(problem, used, SPREADS if step else SPREADS[:1])
        found = solution.parameters[: 3 * count].reshape(3, count)
        compliance[used], share[used], level[used] = found
    share_sigma = np.full(n, SHARE_PRIOR[1])
    share_sigma[used] = np.sqrt(np.diag(solution.covariance)[count : 2 * count])
    gain_covariance = readings.systematic.force_gain**2 * np.outer(compliance, compliance)
    base = estimate("joint", arm.joint_names, used, solution, gain_covariance)
    return JointEstimate(
        **{field.name: getattr(base, field.name) for field in fields(base)},
        link_share=share,
        link_share_sigma=share_sigma,
        friction_scale=problem.friction.scale,
        current_gain=problem.friction.gain,
        current_gain_sigma=problem.friction.gain_sigma,
    )
