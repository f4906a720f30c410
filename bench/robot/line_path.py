"""Joint angles that carry a point of the arm along a straight line: inverse kinematics by Newton's method."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from bench.errors import ConvergenceError, InputError
from bench.robot.bodies import Array, Point, RigidBodies
from bench.robot.kinematics import Placement, place_and_jacobian, rotation_vector

KNOT_SPACING = 2.5e-3  # [m]; a cubic spline of angles with curvature of about 1 rad/m^2 is then right to 1e-10 rad
TOLERANCE = 1e-11  # [m] and [rad]
MAX_ITERATIONS = 100
LONGEST_STEP = 0.3  # [rad] or [m], of any joint in one iteration, so that Newton stays on its branch
SINGULAR = 1e-7  # of the largest singular value; smaller ones are directions in which the arm cannot move
MM = 1e3  # [1/m]


@dataclass(frozen=True)
class JointPath:
    """Joint angles along a straight line, smooth in the distance.

    Attributes:
        length: From the start to the end of the line [m].
        distance: Shape (m,) [m], of the knots from the start; they may reach beyond both ends.
        q: Shape (m, n) [rad], at the knots.
    """

    length: float
    distance: Array
    q: Array

    def at(self, distance: Array) -> Array:
        """Return the joint angles at distances from the start, shape (T,) [m], as shape (T, n) [rad]."""
        return np.asarray(CubicSpline(self.distance, self.q)(distance))


def reach(bodies: RigidBodies, point: Point, target: Placement, near: Array, keep_rotation: bool = True) -> Array:
    """Return joint angles, shape (n,) [rad], that place a point of the arm, from a configuration near by.

    Gauss-Newton with the step of least length, so a joint that is not needed stays where it is.

    Args:
        bodies: The arm.
        point: Its point.
        target: Where it shall be.
        near: Shape (n,) [rad]; decides the branch (elbow up or down).
        keep_rotation: Whether the rotation of the target counts too; False asks for the position only.

    Raises:
        ConvergenceError: The arm does not get there.
    """
    q = np.array(near, dtype=np.float64)
    rows = 6 if keep_rotation else 3
    for _ in range(MAX_ITERATIONS):
        here, jacobian = place_and_jacobian(bodies, point, q)
        missing = np.concatenate([target.position - here.position, rotation_vector(target.rotation @ here.rotation.T)])
        if np.max(np.abs(missing[:rows])) < TOLERANCE:
            return q
        step = np.linalg.lstsq(jacobian[:rows], missing[:rows], rcond=SINGULAR)[0]
        q = q + step * min(1.0, LONGEST_STEP / max(float(np.max(np.abs(step))), LONGEST_STEP))
    raise ConvergenceError(
        f"the arm does not reach {_words(target.position)}: {np.linalg.norm(missing[:3]) * MM:.3g} mm and "
        f"{np.linalg.norm(missing[3:rows]):.3g} rad are left after {MAX_ITERATIONS} iterations; bring the line nearer, "
        "or start from another configuration."
    )


def line_path(
    bodies: RigidBodies,
    point: Point,
    start: Array,
    end: Array,
    near: Array,
    rotation: Array | None = None,
    overrun: float = 0.0,
) -> JointPath:
    """Return joint angles along a straight line, within the joints' limits throughout.

    Args:
        bodies: The arm.
        point: The point that runs along the line.
        start: Shape (3,) [m], world axes.
        end: Shape (3,) [m], world axes.
        near: Shape (n,) [rad], a configuration near the start; decides the branch.
        rotation: Shape (3, 3), orientation of the point, kept all the way; None leaves it free.
        overrun: How far the path reaches beyond both ends [m].

    Raises:
        InputError: The line is not reached, or leaves the range of a joint; the first place of each joint is named.
    """
    way = end - start
    length = float(np.linalg.norm(way))
    inside = max(4, round(length / KNOT_SPACING))
    beyond = int(np.ceil(overrun / length * inside)) + 1  # and one, so that the ends are not ends of the spline
    distance = length / inside * np.arange(-beyond, inside + beyond + 1)
    q = np.empty((len(distance), bodies.n_joints))
    wanted = np.eye(3) if rotation is None else rotation
    try:
        for i, way_there in enumerate(distance / length):
            target = Placement(start + way_there * way, wanted)
            q[i] = near = reach(bodies, point, target, near, keep_rotation=rotation is not None)
    except ConvergenceError as error:
        raise InputError(f"the line cannot be followed: {error}") from error
    problems = []
    for j, (low, high) in enumerate(np.asarray(bodies.limits)):
        outside = np.flatnonzero((q[:, j] < low) | (q[:, j] > high))
        if len(outside) and low < high:
            i = outside[0]
            problems.append(
                f"the line leaves joint {j + 1}'s range, {np.rad2deg(low):g} to {np.rad2deg(high):g} deg, at "
                f"{_words(start + distance[i] / length * way)}, {distance[i] * MM:.0f} mm from its start: "
                f"{np.rad2deg(q[i, j]):.1f} deg."
            )
    if problems:
        raise InputError(problems)
    return JointPath(length, np.asarray(distance), q)


def _words(position: Array) -> str:
    x, y, z = position * MM
    return f"x = {x:.0f}, y = {y:.0f}, z = {z:.0f} mm (world)"
