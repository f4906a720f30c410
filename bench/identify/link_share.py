"""Which share of friction the elastic elements feel, from the lost motion between out and back.

On the way out friction on the link side bends the arm one way, on the way back the other; friction on the motor side
bends nothing. With f of Eq. (48), both sides together, the lost motion is lambda times J_m N 2 f. One lambda is found
for all joints that turn: a line in one plane cannot tell them apart. What friction itself bends the arm changes
the load's torque a little, which is left out: lambda comes out too large by up to 1 % of itself.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri

from bench.identify.estimate import StiffnessEstimate
from bench.identify.line_deflection import LineModel, measured_lost_motion, parameter_covariance
from bench.identify.statics import SecondOrder, link_torque, motion

LOST_BOTH_WAYS = 2  # friction turns round


@dataclass(frozen=True)
class LinkShare:
    """Share of friction on the link side of the joints that turn.

    Attributes:
        value: lambda; 0 where all friction is on the motor side, 1 where all is on the link side.
        noise: Its standard error from the noise of the tracker.
        relative: Its relative standard error from stiffness and torque constants, to both of which it is inverse.
    """

    value: float
    noise: float
    relative: float

    @property
    def sigma(self) -> float:
        """Standard error of lambda."""
        return float(np.hypot(self.noise, self.value * self.relative))

    def interval(self, level: float = 0.95) -> tuple[float, float]:
        """Return lower and upper end: every lambda that the value is no further from than its error there (Fieller)."""
        quantile = float(ndtri(0.5 + level / 2))
        scale = 1 - (quantile * self.relative) ** 2
        if not scale > 0:
            return -np.inf, np.inf
        half = np.sqrt(self.value**2 - scale * (self.value**2 - (quantile * self.noise) ** 2))
        return float((self.value - half) / scale), float((self.value + half) / scale)


def link_share(model: LineModel, estimate: StiffnessEstimate, state: str = "loaded") -> LinkShare:
    """Return the share by which the lost motion under one state of load is explained best.

    Args:
        model: The line, run both ways under that load.
        estimate: The stiffness.
        state: "unloaded" or "loaded".

    Raises:
        InputError: A pass is missing.
    """
    passes, friction = model.passes, model.friction[state]
    out, back = passes.of(state, "out"), passes.of(state, "back")
    compliance = np.nan_to_num(estimate.compliance)
    lost, sigma = measured_lost_motion(passes, state)
    place = (model.arm, model.counterbalance, passes.load_point)
    load = link_torque(*place, out.q_motor, out.q_motor, out.wrench, SecondOrder.ALL)
    moved = motion(
        model.arm, passes.reference_point, out.q_motor, load.total, compliance, SecondOrder.ALL, load.stiffness
    )
    by_drive = np.einsum("tan,tn->ta", moved.per_motor_angle, out.q_motor - back.q_motor)
    per_joint = -LOST_BOTH_WAYS * moved.per_torque * friction.along()[:, None, :]  # (T, 3, n) [m], all of it felt
    felt, seen = per_joint.sum(axis=2), lost - by_drive
    size = float(np.sum(felt**2)) or np.nan  # without friction there is nothing to share
    value = float(np.sum(felt * seen)) / size
    # the lost motion is proportional to N_j f_j of each joint, so that is what lambda is inversely sensitive to
    weighted = np.einsum("ta,tan->n", felt, per_joint) / size
    known = compliance > 0
    covariance = parameter_covariance(estimate, passes.current_gain)[: len(compliance), : len(compliance)]
    relative = covariance / np.outer(np.where(known, compliance, 1), np.where(known, compliance, 1))
    gain = np.zeros_like(compliance) if estimate.method == "current" else passes.current_gain  # cancels there
    relative = relative + np.diag(gain**2)
    by_noise = float(np.sum(felt**2 @ sigma**2)) / size**2
    return LinkShare(value, float(np.sqrt(by_noise)), float(np.sqrt(weighted @ relative @ weighted)))
