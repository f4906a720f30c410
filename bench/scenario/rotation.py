"""The rotation experiment of section 5: one joint there and back at constant speed, at several speeds and payloads."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from bench.errors import ScenarioError
from bench.record.limits import SIMULATED_SECONDS
from bench.record.strict import Strict
from bench.robot.bodies import Array
from bench.robot.folder import Robot
from bench.scenario.types import (
    MOST_REPEATS,
    Acceleration,
    NonNegative,
    Pause,
    Positive,
    ScenarioBase,
    Seconds,
    SpeedShare,
)

CONTROL_PERIOD_S = 0.004  # of `bench.simulate.env`; a test holds the two together
STANDARD_GRAVITY = 9.80665  # [m/s^2]


class RotationPart(Strict):
    """Keys of a rotation experiment, alone or as a part of a session.

    The joint runs at constant speed all the way between its angle in `start_deg` and `end_deg`; it gathers speed before
    and loses it behind, over `lead_deg` on either side.
    """

    joint: Annotated[int, Field(ge=1)] = Field(description="number of the joint that turns, from 1")
    start_deg: tuple[float, ...] = Field(description="angles of all joints at the start; the others stay there")
    end_deg: float = Field(description="where the constant speed of the turning joint ends")
    speeds_deg_per_s: tuple[Positive, ...] = Field(min_length=1)
    payloads_kg: tuple[NonNegative, ...] = Field((0.0,), min_length=1, description="bolted to the load point, in turn")
    ramp_s: Seconds = Field(1.0, description="time in which the joint reaches its speed, and in which it stops")
    settle_s: Pause = Field(1.0, description="standstill before each traverse")
    repeats: Annotated[int, Field(ge=1, le=MOST_REPEATS)] = 1
    sample_period_s: Annotated[float, Field(ge=CONTROL_PERIOD_S, multiple_of=CONTROL_PERIOD_S)] = 0.02
    move_speed: SpeedShare = Field(0.3, description="share of the drives' speed limit, between traverses")
    acceleration_deg_per_s2: Acceleration = Field(30.0, description="between traverses")

    @property
    def lead_deg(self) -> float:
        """Way over which the fastest traverse gathers speed: half of what full speed would cover in that time."""
        return max(self.speeds_deg_per_s) * self.ramp_s / 2

    def check(self, robot: Robot, limits: Array) -> None:
        """Hold the scenario against the robot.

        Args:
            robot: The robot it is to run on.
            limits: Shape (n, 2) [rad], ranges of the link joints.

        Raises:
            ScenarioError: No such joint, wrong number of angles, an angle or a ramp outside the limits, a speed above
                the drive's, a payload above the rating, or no way to go; all listed.
        """
        if self.joint > robot.n_joints:
            raise ScenarioError(f"joint: there is no joint {self.joint}; {robot.name} has {robot.n_joints} joints.")
        if len(self.start_deg) != robot.n_joints:
            raise ScenarioError(
                f"start_deg: {len(self.start_deg)} angles, but {robot.name} has {robot.n_joints} joints."
            )
        degrees, swept = np.rad2deg(limits), self.joint - 1
        problems = [
            f"start_deg[{j}]: {angle:g} deg is outside joint {j + 1}'s {low:g} to {high:g} deg."
            for j, (angle, (low, high)) in enumerate(zip(self.start_deg, degrees, strict=True))
            if not low <= angle <= high
        ]
        start, (low, high) = self.start_deg[swept], degrees[swept]
        if self.end_deg == start:
            problems.append(f"end_deg: joint {self.joint} starts at {start:g} deg already; give another angle.")
        first, last = sorted((start, self.end_deg))
        if not low <= first - self.lead_deg or not last + self.lead_deg <= high:
            problems.append(
                f"end_deg: {first:g} to {last:g} deg with {self.lead_deg:g} deg on either side for the ramps leaves "
                f"joint {self.joint}'s {low:g} to {high:g} deg; shorten the way or ramp_s, or lower the speeds."
            )
        fastest = np.rad2deg(robot.figures.drives[swept].speed_limit_rad_per_s)
        problems += [
            f"speeds_deg_per_s[{i}]: {last - first:g} deg and two ramps of {self.ramp_s:g} s "
            f"take more than {SIMULATED_SECONDS}; {SIMULATED_SECONDS.remedy}."
            for i, speed in enumerate(self.speeds_deg_per_s)
            if last - first > speed * (SIMULATED_SECONDS.value - 2 * self.ramp_s)
        ]
        problems += [
            f"speeds_deg_per_s[{i}]: {speed:g} deg/s is above the limit of joint {self.joint}, {fastest:g} deg/s."
            for i, speed in enumerate(self.speeds_deg_per_s)
            if speed > fastest
        ]
        rating = robot.figures.rating.force_n
        problems += [
            f"payloads_kg[{i}]: {mass:g} kg is above the rating of {robot.name}, {rating:g} N."
            for i, mass in enumerate(self.payloads_kg)
            if mass * STANDARD_GRAVITY > rating
        ]
        if problems:
            raise ScenarioError(problems)


class Rotation(ScenarioBase, RotationPart):
    """Keys of a rotation scenario."""

    experiment: Literal["rotation"]
