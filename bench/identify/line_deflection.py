"""Deflection along a line as each method predicts it, and how it compares with what the tracker saw.

The deflection is the place of the reference point on the loaded pass less that on the unloaded pass of the same
direction, at equal commands. The robot moves in both, so friction slides at its level in both, and has the same sign.

What the elastic elements carry, u, each method takes from where it takes it in identification (see
`bench.identify.statics`):

- force: u = Gamma, the load J_f^T W with weight and counterbalance; friction on the link side is left out.
- current: u = -xi I, the torque of the motor; friction on the motor side is left in. This is the paper's *practical
  load*, J_f^T W plus or minus friction: the current has friction in it, with the sign that the motion gives it.
- joint: u = Gamma - lambda f sign(v), f from Eq. (48), lambda the share of friction that the estimate puts on the
  link side.

In the difference of two passes of one direction friction cancels, whichever side it is on, unless it depends on the
load. So what a method predicts wrongly here is its stiffness. The *lost motion* between out and back at equal load
shows the link-side friction instead: force predicts none, current all of it.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import block_diag

from bench.identify.arm import Arm
from bench.identify.estimate import JointEstimate, StiffnessEstimate
from bench.identify.friction_pairs import PairFriction, pair_friction
from bench.identify.line_passes import STATES, LinePass, LinePasses
from bench.identify.statics import Motion, SecondOrder, equilibrium, motion
from bench.robot.bodies import Array
from bench.robot.counterbalance import Counterbalance


@dataclass(frozen=True)
class LineModel:
    """What a prediction along the line is made of.

    Attributes:
        arm: The arm.
        counterbalance: Its counterbalance, if it has one.
        passes: What was measured.
        friction: State -> friction by Eq. (48), of those states that were run both ways.
    """

    arm: Arm
    counterbalance: Counterbalance | None
    passes: LinePasses
    friction: dict[str, PairFriction]


@dataclass(frozen=True)
class WindUp:
    """How the joints give on one pass, by one method.

    Attributes:
        torque: Shape (T, n) [Nm], deflecting torque u.
        motion: Where the reference point comes to be, and how that changes with torque and compliance.
        per_parameter: Shape (T, 3, p) [m per unit], derivative by the parameters of the estimate: N, and lambda if
            it has it.
        noise: Shape (T, 3) [m], standard deviation of the position from the noise of the torque.
    """

    torque: Array
    motion: Motion
    per_parameter: Array
    noise: Array


@dataclass(frozen=True)
class Prediction:
    """A displacement along the line by one method, T places.

    Attributes:
        method: Name of the method.
        displacement: Shape (T, 3) [m].
        per_parameter: Shape (T, 3, p), derivative by the p parameters of the estimate.
        covariance: Shape (p, p), of those parameters.
        noise: Shape (T, 3) [m], standard deviation from the noise of the torque, independent from place to place.
    """

    method: str
    displacement: Array
    per_parameter: Array
    covariance: Array
    noise: Array

    @property
    def standard_error(self) -> Array:
        """Shape (T, 3) [m], from the covariance of the estimate; common to all places to a large part."""
        variance = np.einsum("tap,pq,taq->ta", self.per_parameter, self.covariance, self.per_parameter)
        return np.asarray(np.sqrt(np.maximum(variance, 0.0)))


def line_model(arm: Arm, counterbalance: Counterbalance | None, passes: LinePasses) -> LineModel:
    """Return the model, with the friction of each state that was run out and back."""
    friction = {
        state: pair_friction(passes.of(state, "out"), passes.of(state, "back"), passes.current_gain)
        for state in STATES
        if {(state, "out"), (state, "back")} <= set(passes.passes)
    }
    return LineModel(arm, counterbalance, passes, friction)


def wind_up(
    model: LineModel,
    estimate: StiffnessEstimate,
    state: str,
    way: str,
    second_order: SecondOrder = SecondOrder.ALL,
    line_pass: LinePass | None = None,
) -> WindUp:
    """Return how the joints give on a pass, by the method of an estimate; joints it does not know are taken for rigid.

    Args:
        model: The model.
        estimate: The stiffness.
        state: "unloaded" or "loaded".
        way: "out" or "back".
        second_order: What is taken at the deflected angles.
        line_pass: In place of the one that was measured.

    Raises:
        InputError: The campaign has no such pass.
    """
    line_pass = line_pass or model.passes.of(state, way)
    arm, q = model.arm, line_pass.q_motor
    compliance = np.nan_to_num(estimate.compliance)
    by_share = np.zeros_like(q)
    share = np.zeros(0)
    if estimate.method == "current":
        torque, stiffness = -line_pass.current_torque, None
    else:
        constant = np.zeros_like(q)
        if isinstance(estimate, JointEstimate):
            share = estimate.link_share
            by_share = (-1 if line_pass.is_out else 1) * model.friction[state].along()
            constant = share * by_share
        place = (arm, model.counterbalance, model.passes.load_point, q, line_pass.wrench, compliance, second_order)
        torque, load = equilibrium(*place, constant=constant)
        stiffness = load.stiffness
    moved = motion(arm, model.passes.reference_point, q, torque, compliance, second_order, stiffness)
    by_lambda = (moved.per_torque * by_share[:, None, :])[..., : len(share)]
    sigma = line_pass.sigma_current_torque if estimate.method == "current" else np.zeros(q.shape[1])
    noise = np.sqrt(np.einsum("tan,n->ta", moved.per_torque**2, sigma**2))
    return WindUp(torque, moved, np.concatenate([moved.per_compliance, by_lambda], axis=2), noise)


def predicted_deflection(
    model: LineModel, estimate: StiffnessEstimate, way: str, second_order: SecondOrder = SecondOrder.ALL
) -> Prediction:
    """Return the deflection by the load, loaded less unloaded, on the way "out" or "back"; raises as `wind_up`."""
    loaded = wind_up(model, estimate, "loaded", way, second_order)
    unloaded = wind_up(model, estimate, "unloaded", way, second_order)
    return _difference(model, estimate, loaded, unloaded)


def predicted_lost_motion(model: LineModel, estimate: StiffnessEstimate, state: str) -> Prediction:
    """Return the place on the way out less that on the way back, under the same load; raises as `wind_up`."""
    return _difference(model, estimate, wind_up(model, estimate, state, "out"), wind_up(model, estimate, state, "back"))


def measured_deflection(passes: LinePasses, way: str) -> tuple[Array, Array]:
    """Return what the tracker saw of the deflection, shape (T, 3) [m], and its noise, shape (3,) [m]."""
    return _measured(passes.of("loaded", way), passes.of("unloaded", way))


def measured_lost_motion(passes: LinePasses, state: str) -> tuple[Array, Array]:
    """Return what the tracker saw of the lost motion, shape (T, 3) [m], and its noise, shape (3,) [m]."""
    return _measured(passes.of(state, "out"), passes.of(state, "back"))


def parameter_covariance(estimate: StiffnessEstimate, current_gain: Array) -> Array:
    """Return the covariance of N, and of lambda if the estimate has it, shape (p, p), as it counts along the line.

    The torque constants are the same in identification and along the line: N (1 + g)^-1 times xi I (1 + g). So their
    error, which the current method's covariance contains, cancels there and is taken off. Covariance between N and
    lambda is not part of an estimate and left out.

    Args:
        estimate: The estimate.
        current_gain: Shape (n,), prior standard deviation of the relative error of xi_j I_j.
    """
    covariance = np.nan_to_num(estimate.covariance)
    if estimate.method == "current":
        covariance = covariance - np.diag((current_gain * np.nan_to_num(estimate.compliance)) ** 2)
    if isinstance(estimate, JointEstimate):
        covariance = block_diag(covariance, np.diag(estimate.link_share_sigma**2))
    return np.asarray(covariance)


def at_commands(line_pass: LinePass) -> LinePass:
    """Return a pass as if the joints stood where they were commanded, for what is to be known before it is run."""
    return replace(line_pass, q_motor=line_pass.q_cmd)


def _difference(model: LineModel, estimate: StiffnessEstimate, first: WindUp, second: WindUp) -> Prediction:
    return Prediction(
        method=estimate.method,
        displacement=first.motion.position - second.motion.position,
        per_parameter=first.per_parameter - second.per_parameter,
        covariance=parameter_covariance(estimate, model.passes.current_gain),
        noise=np.hypot(first.noise, second.noise),
    )


def _measured(first: LinePass, second: LinePass) -> tuple[Array, Array]:
    return first.reflector - second.reflector, np.hypot(first.sigma_reflector, second.sigma_reflector)
