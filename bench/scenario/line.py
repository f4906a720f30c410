"""The trajectory experiment of section 6: a straight line at low speed, out and back, without and with a load."""

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from bench.errors import InputError, ScenarioError, unknown_name
from bench.record.limits import SIMULATED_SECONDS
from bench.record.rules.scale import MAX_LENGTH
from bench.record.strict import Strict
from bench.robot.bodies import Array, Point, RigidBodies, read_only
from bench.robot.compiled import compile_robot
from bench.robot.folder import Robot
from bench.robot.kinematics import place, turn_onto
from bench.robot.line_path import JointPath, line_path
from bench.robot.links import rigid_bodies
from bench.scenario.rotation import CONTROL_PERIOD_S
from bench.scenario.types import Pause, Positive, ScenarioBase, Seconds

Triple = tuple[float, float, float]
Coordinate = Annotated[float, Field(ge=-MAX_LENGTH, le=MAX_LENGTH)]
Place = tuple[Coordinate, Coordinate, Coordinate]  # [m]

LEAD_IN_SHARE = 0.75  # of speed times lead-in time is the way: half the time at a mean of half the speed, half at speed
WHOLE = 1e-6  # how far from a whole number of samples the line may be


class Corrections(Strict):
    """Joint angles to add to those of the line, one table per direction; cubic between the knots."""

    share: tuple[float, ...] = Field(min_length=4, description="knots, 0 at the start of the line to 1 at its end")
    out_rad: tuple[tuple[float, ...], ...] = Field(description="one row of joint angles per knot, on the way out")
    back_rad: tuple[tuple[float, ...], ...] = Field(description="the same on the way back, still from start to end")

    @model_validator(mode="after")
    def _fits(self) -> Self:
        for name in ("out_rad", "back_rad"):
            if len(getattr(self, name)) != len(self.share):
                raise ValueError(f"{name} needs one row per knot of share, {len(self.share)}")
        if self.share[0] != 0 or self.share[-1] != 1 or np.any(np.diff(self.share) <= 0):
            raise ValueError("share must grow from 0 to 1")
        return self


class LinePart(Strict):
    """Keys of a line experiment, alone or as a part of a session.

    Points of the line are given from `origin_m`, in world axes. The tool keeps one orientation all the way: that of the
    configuration `near_deg`, turned by the smallest rotation that makes `tool_axis` (in the frame of the last link)
    point along `approach` (world axes). Without `approach` the orientation is free, for arms that cannot hold one.

    A wrench hangs at the robot's load point and is constant while the arm moves.
    """

    origin_m: Place = Field((0.0, 0.0, 0.0), description="[m], origin of the points below, world axes")
    start_m: Place
    end_m: Place
    tool_point: str | Triple = Field(description="named point, or position in the frame of the last link [m]")
    tool_axis: Triple = (0.0, 0.0, 1.0)
    approach: Triple | None = (0.0, 0.0, -1.0)
    near_deg: tuple[float, ...] = Field(description="near the start: says which branch, and how the tool is turned")
    speed_m_per_s: Positive = 0.01
    force_n: Positive
    direction: Triple = (0.0, 0.0, -1.0)
    unloaded: bool = Field(True, description="run the line without the load first")
    lead_in_s: Seconds = Field(3.0, description="at both ends: half of it from rest to speed, half at speed")
    settle_s: Pause = 2.0
    load_ramp_s: Seconds = 2.0
    sample_period_s: Annotated[float, Field(ge=CONTROL_PERIOD_S, multiple_of=CONTROL_PERIOD_S)] = 0.1
    corrections: Corrections | None = None

    @property
    def length_m(self) -> float:
        """Length of the line [m]."""
        return float(np.linalg.norm(np.subtract(self.end_m, self.start_m)))

    @property
    def n_samples(self) -> int:
        """Readings on one way along the line, both ends included."""
        return round(self.length_m / (self.speed_m_per_s * self.sample_period_s)) + 1

    def path(self, bodies: RigidBodies) -> JointPath:
        """Return the joint angles along the line and the lead-in at both ends.

        Raises:
            InputError: The line is not reached, or leaves the range of a joint.
            RobotError: The tool point is not a point of the robot.
        """
        near = np.deg2rad(self.near_deg)
        origin = np.array(self.origin_m)
        point = self._tool(bodies)
        rotation = None
        if self.approach is not None:
            there = place(bodies, point, near).rotation
            tool_axis = there @ point.rotation.T @ np.array(self.tool_axis)
            rotation = turn_onto(tool_axis, np.array(self.approach)) @ there
        overrun = LEAD_IN_SHARE * self.speed_m_per_s * self.lead_in_s
        return line_path(bodies, point, origin + self.start_m, origin + self.end_m, near, rotation, overrun)

    def check(self, robot: Robot, limits: Array) -> None:
        """Hold the scenario against the robot.

        Args:
            robot: The robot it is to run on.
            limits: Shape (n, 2) [rad], ranges of the link joints.

        Raises:
            ScenarioError: Wrong number of angles, no line, load above the rating, a tool point that is not there; all
                listed. If there is none of these: a line that is not reached, leaves a joint's range or is too fast.
        """
        n, problems = robot.n_joints, []
        if len(self.near_deg) != n:
            problems.append(f"near_deg: {len(self.near_deg)} angles, but {robot.name} has {n} joints.")
        for name in ("tool_axis", "approach", "direction"):
            if getattr(self, name) is not None and not np.any(getattr(self, name)):
                problems.append(f"{name}: is zero; give a direction, such as [0, 0, -1].")
        samples = self.length_m / (self.speed_m_per_s * self.sample_period_s)
        if not np.isfinite(samples) or round(samples) < 1 or abs(samples - round(samples)) > WHOLE * samples:
            problems.append(
                f"sample_period_s: {self.length_m:g} m at {self.speed_m_per_s:g} m/s are {samples:g} samples; make "
                "it a whole number, so that both ends of the line are read."
            )
        if self.length_m > self.speed_m_per_s * (SIMULATED_SECONDS.value - 2 * self.lead_in_s):
            problems.append(
                f"speed_m_per_s: {self.length_m:g} m and {self.lead_in_s:g} s at both ends "
                f"take more than {SIMULATED_SECONDS}; {SIMULATED_SECONDS.remedy}."
            )
        rating = robot.figures.rating.force_n
        if self.force_n > rating:
            problems.append(f"force_n: {self.force_n:g} N is above the rating of {robot.name}, {rating:g} N.")
        for name in ("out_rad", "back_rad"):
            if self.corrections and any(len(row) != n for row in getattr(self.corrections, name)):
                problems.append(f"corrections.{name}: every row needs {n} angles, as {robot.name} has joints.")
        bodies = rigid_bodies(compile_robot(robot))
        if isinstance(self.tool_point, str) and self.tool_point not in bodies.points:
            problems.append(f"tool_point: {unknown_name('point of the arm', self.tool_point, bodies.points)}")
        if problems:
            raise ScenarioError(problems)
        try:
            path = self.path(bodies)
        except InputError as error:
            raise ScenarioError(f"start_m, end_m: {problem}" for problem in error.problems) from error
        self._check_path(robot, path, limits)

    def _check_path(self, robot: Robot, path: JointPath, limits: Array) -> None:
        problems = []
        speed = np.abs(np.diff(path.q, axis=0)).max(axis=0) / np.diff(path.distance)[0] * self.speed_m_per_s
        for j, drive in enumerate(robot.figures.drives):
            if speed[j] > drive.speed_limit_rad_per_s:
                problems.append(
                    f"speed_m_per_s: joint {j + 1} would turn at {speed[j]:.3g} rad/s, its limit is "
                    f"{drive.speed_limit_rad_per_s:g} rad/s; go slower."
                )
        if self.corrections:
            largest = np.abs([*self.corrections.out_rad, *self.corrections.back_rad]).max(axis=0)
            low, high = path.q.min(axis=0) - largest, path.q.max(axis=0) + largest
            problems += [
                f"corrections: take joint {j + 1} out of its range."
                for j in np.flatnonzero((low < limits[:, 0]) | (high > limits[:, 1]))
            ]
        if problems:
            raise ScenarioError(problems)

    def _tool(self, bodies: RigidBodies) -> Point:
        if isinstance(self.tool_point, str):
            return bodies.points[self.tool_point]
        return Point(bodies.n_joints - 1, read_only(self.tool_point), read_only(np.eye(3)))


class Line(ScenarioBase, LinePart):
    """Keys of a line scenario."""

    experiment: Literal["line"]
