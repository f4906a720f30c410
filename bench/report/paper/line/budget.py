"""The error of a pass against the commanded line, and what it is made of; the parts add up to it exactly.

Opens no truth's file: it is given the simulation's own angles (`bench.report.paper.line.sessions`).
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from bench.identify.arm import Arm
from bench.identify.compensation import Compensation
from bench.identify.line_passes import AXES, LinePass
from bench.report.paper.line.sessions import LineSession, TruePass
from bench.robot.bodies import Array
from bench.robot.instruments import Tracker


@dataclass(frozen=True)
class TrajectoryError:
    """Tracker less commanded line, T places.

    Attributes:
        error: Shape (T, 3) [m].
        parts: Name -> shape (T, 3) [m]; they add up to the error. All have "following" (motor against command, with the
            sampling's delay), "frame" (the tracker's frame, placement and drift) and "noise" (of the tracker). An
            uncompensated pass has "deformation" (of the elastic elements); a compensated one has of it "stiffness"
            (what the error of the stiffness leaves over), "torque" (what the error of u leaves: friction on the side
            that the method does not look at, errors of currents) and "rest" (second order, smoothing).
    """

    error: Array
    parts: Mapping[str, Array]

    @property
    def true(self) -> Array:
        """Shape (T, 3) [m], the error without what the tracker adds to it."""
        return self.error - self.parts["frame"] - self.parts["noise"]

    def rms(self, axis: str, part: str | None = None) -> float:
        """Return the root mean square along one axis [m], of the error or of one part."""
        values = self.error if part is None else self.parts[part]
        return float(np.sqrt(np.mean(values[:, AXES.index(axis)] ** 2)))


def trajectory_error(
    arm: Arm, session: LineSession, nominal: LinePass, way: str, compensation: Compensation | None = None
) -> TrajectoryError:
    """Return the error of the loaded pass of a session, and its parts.

    Args:
        arm: The arm.
        session: What was run.
        nominal: A pass out whose commands are those of the line, without corrections.
        way: "out" or "back".
        compensation: What its commands were corrected by, if they were.
    """
    measured, true = session.passes.of("loaded", way), session.truth["loaded", way]
    point = session.passes.reference_point
    line, jacobian = arm.position_and_jacobian(nominal.q_cmd, point)
    at_command, at_motor, at_link = (arm.pose(q, point)[0] for q in (measured.q_cmd, true.q_motor, true.q_link))
    frame, noise = _smooth_and_rest(measured.reflector - true.reflector)
    parts = {"following": at_motor - at_command, "frame": frame, "noise": noise}
    elastic = at_link - at_motor + at_command - line
    if compensation is None:
        parts["deformation"] = elastic
    else:
        parts |= _left_over(elastic, jacobian[:, :3], compensation, way, session.stiffness, true)
    parts["following"] = parts["following"] + true.reflector - at_link  # zero: the reflector sits where the links say
    return TrajectoryError(measured.reflector - line, parts)


def tracker_sigma(tracker: Tracker | None, position: Array, noise: Array) -> Array:
    """Return the standard deviation of a tracker's position in the base frame as a lab knows it beforehand, (T, 3) [m].

    Args:
        tracker: Its figures; None for one without errors but noise.
        position: Shape (T, 3) [m].
        noise: Shape (3,) [m], of one reading.
    """
    if tracker is None:
        return np.broadcast_to(noise, position.shape)
    across = np.sum(position**2, axis=1, keepdims=True) - position**2
    fixed = tracker.frame_sigma_m**2 + tracker.placement_sigma_m**2
    return np.asarray(np.sqrt(fixed + tracker.frame_sigma_rad**2 * across + noise**2))


def _left_over(
    elastic: Array, jacobian: Array, compensation: Compensation, way: str, stiffness: Array, true: TruePass
) -> dict[str, Array]:
    """Split what is left of N u - N_est u_est: J (N - N_est) u_est, J N (u - u_est), and the rest; each (T, 3) [m]."""
    counted_on = compensation.ways[way].torque
    by_stiffness = (1 / stiffness - compensation.compliance) * counted_on
    by_torque = true.q_link - true.q_motor - counted_on / stiffness
    parts = {
        "stiffness": np.einsum("tan,tn->ta", jacobian, by_stiffness),
        "torque": np.einsum("tan,tn->ta", jacobian, by_torque),
    }
    return parts | {"rest": elastic - parts["stiffness"] - parts["torque"]}


def _smooth_and_rest(values: Array) -> tuple[Array, Array]:
    """Return the best straight lines through columns, shape (T, 3), and what is left of them."""
    along = np.linspace(-1, 1, len(values))
    basis = np.stack([np.ones_like(along), along], axis=1)
    smooth = basis @ np.linalg.lstsq(basis, values, rcond=None)[0]
    return smooth, values - smooth
