"""Which friction and which protocol would give Fig. 17: z largely better by currents than by forces, x no different.

The line from rest to rest: rate-independent friction slides along it, so that each place is an equilibrium of its own.
What compensation leaves of the deformation follows in closed form from the stiffness that the loading experiment gave
under each protocol: J (theta - q - N_m u_m), with u_m the torque that method m counts on.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.identify.arm import Arm
from bench.identify.line_passes import AXES
from bench.identify.statics import SecondOrder, link_torque
from bench.report.paper.methods.study import AS_THE_PAPER, ConditionResult
from bench.robot.bodies import Array
from bench.robot.compiled import compile_robot
from bench.robot.edits import shared_friction
from bench.robot.folder import load_robot
from bench.robot.links import rigid_bodies
from bench.scenario.line import Line
from bench.simulate.line import line_sittings
from bench.simulate.policy import Step
from bench.simulate.quasistatic import RestLog, turning_points

PLACES = 31  # along the line
ANGLE_RESOLUTION = 9  # decimals of a commanded angle [rad]; rounding of the path would count as turning round
LARGELY = 0.5  # z, current over force, at or below which it is "largely reduced": assumed, the paper gives no number
SAME = 0.1  # by which x may differ from 1 and be "no significant difference": assumed likewise
SHARED_ERRORS_MM = (0.0, 0.1, 0.2, 0.5, 1.0, 2.0)  # of frame and kinematics, the same with either compensation
ANALYSES = {"weighted": ("force", "current"), "plain": tuple(reversed(AS_THE_PAPER))}
TORQUES = ("its own torque", "the current's torque for both")


@dataclass(frozen=True)
class Left:
    """What compensation leaves, rms over both ways [mm].

    Attributes:
        condition: Friction and protocol in words.
        force: Axis -> by the force method.
        current: Axis -> by the current method.
    """

    condition: str
    force: dict[str, float]
    current: dict[str, float]

    def ratio(self, axis: str, shared: float = 0.0) -> float:
        """Return current over force with a further error of `shared` [mm] in both, nan where neither leaves any."""
        force, current = np.hypot(self.force[axis], shared), np.hypot(self.current[axis], shared)
        return float(current / force) if force > 0 else np.nan

    @property
    def hiding(self) -> float:
        """The error in x [mm] that both runs must share for x to be the same within `SAME`."""
        small, large = sorted((self.force["x"] ** 2, self.current["x"] ** 2))
        needed = ((1 - SAME) ** 2 * large - small) / (1 - (1 - SAME) ** 2)
        return float(np.sqrt(max(needed, 0.0)))


@dataclass(frozen=True)
class _Pass:
    """The loaded line out and back with one friction, T places: J, theta - q, u of the load and u of the currents."""

    jacobian: Array
    wound: Array
    by_load: Array
    by_current: Array
    stiffness: Array


def left_over(scenario: Line, results: Sequence[ConditionResult]) -> list[Left]:
    """Return what compensation would leave, for each condition, weighting of the fit, and torque that is counted on.

    Args:
        scenario: The line; its friction is that of each condition, and its servo holds.
        results: Of the loading experiment, with the analyses of `ANALYSES`.
    """
    robot = load_robot(scenario.robot)
    every = (scenario.n_samples - 1) / (PLACES - 1) * scenario.sample_period_s
    sparse = scenario.model_copy(update={"sample_period_s": every, "unloaded": False})
    (sitting,) = line_sittings(sparse, robot)
    steps = turning_points([replace(step, q_cmd=step.q_cmd.round(ANGLE_RESOLUTION)) for step in sitting.steps])
    passes: dict[tuple[float, float], _Pass] = {}
    found = []
    for result in results:
        condition = result.condition
        friction = condition.friction, condition.link_share
        if friction not in passes:
            passes[friction] = _pass(scenario, steps, sitting.start, friction)
        line = passes[friction]
        for weights, (force, current) in ANALYSES.items():
            for torque in TORQUES:
                by_force = line.by_load if torque == TORQUES[0] else line.by_current
                found.append(
                    Left(
                        f"{condition.friction:g} times the friction, {100 * condition.link_share:.0f} % of it on the "
                        f"link side, {condition.protocol.name}, {weights}, {torque}",
                        _rms(line, by_force / (line.stiffness * (1 + result.bias(force)))),
                        _rms(line, line.by_current / (line.stiffness * (1 + result.bias(current)))),
                    )
                )
    return found


def fig17_sentences(found: Sequence[Left], here: Mapping[str, float]) -> list[str]:
    """Return which of the conditions give the paper's picture, in sentences.

    Args:
        found: What was tried.
        here: Axis -> current over force as the simulated line had it, with all errors of its instruments.
    """

    def fits(left: Left, x: float, z: float) -> bool:
        return left.ratio("z", z) <= LARGELY and abs(left.ratio("x", x) - 1) <= SAME

    alike = {error: [left for left in found if fits(left, error, error)] for error in SHARED_ERRORS_MM}
    given = [f"{left.condition} with {error:g} mm" for error, lefts in alike.items() for left in lefts]
    near = [
        (left.ratio("z", error), error, left)
        for error in SHARED_ERRORS_MM
        for left in found
        if abs(left.ratio("x", error) - 1) <= SAME
    ]
    ratio, error, nearest = min(near, key=lambda each: each[0])
    hidden = [left for left in found if left.ratio("z") <= LARGELY]
    sentences = [
        f"Fig. 17: the paper has z largely reduced by currents against forces (taken as current over force at most "
        f"{LARGELY:g}) and x no different (within {100 * SAME:.0f} %); here they are {here['z']:.2f} in z and "
        f"{here['x']:.2f} in x.",
        f"Tried on the line from rest to rest: {len(found)} combinations of amount and side of friction, protocol, "
        "weights, and torque that the force method counts on, each with an error of "
        f"{SHARED_ERRORS_MM[0]:g} to {SHARED_ERRORS_MM[-1]:g} mm that both runs share in x and z (frame, kinematics). "
        f"{len(given)} give the paper's picture" + (f": {'; '.join(given)}." if given else "."),
        f"Nearest with x the same: z at {ratio:.2f}, with {nearest.condition}, and {error:g} mm shared.",
    ]
    if hidden:
        least = min(hidden, key=lambda left: left.hiding)
        sentences.append(
            f"With an error in x alone it can be had: {len(hidden)} combinations have z at most {LARGELY:g}, and the "
            f"least error in x that hides its difference is {least.hiding:.2f} mm ({least.condition}; without it x is "
            f"at {least.ratio('x'):.2f}, z at {least.ratio('z'):.2f})."
        )
    return sentences


def _pass(scenario: Line, steps: Sequence[Step], start: Array, friction: tuple[float, float]) -> _Pass:
    compiled = compile_robot(load_robot(scenario.robot), [shared_friction(*friction)])
    log = RestLog(compiled, steps, start)
    arm, figures = Arm(rigid_bodies(compiled)), compiled.robot.figures
    q = log.instants.q
    wrench = np.array([step.wrench for step in log.log.steps])
    load = link_torque(arm, compiled.counterbalance, figures.load_point, q, q, wrench, SecondOrder.NONE)
    return _Pass(
        jacobian=arm.jacobian(q, figures.reflectors[0])[:, :3],
        wound=log.instants.theta - q,
        by_load=load.total,
        by_current=-log.instants.motor_torque,
        stiffness=compiled.stiffness,
    )


def _rms(line: _Pass, corrected: Array) -> dict[str, float]:
    error = np.einsum("tan,tn->ta", line.jacobian, line.wound - np.nan_to_num(corrected))
    return {axis: 1e3 * float(np.sqrt(np.mean(error[:, a] ** 2))) for a, axis in enumerate(AXES)}
