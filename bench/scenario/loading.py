"""The loading experiment of section 5: poses, loads up and down, approach from both directions, ten repeats."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from bench.errors import ScenarioError
from bench.record.strict import Strict
from bench.robot.bodies import Array
from bench.robot.folder import Robot
from bench.scenario.types import MOST_REPEATS, Acceleration, Pause, Positive, ScenarioBase, Seconds, SpeedShare

ApproachDirection = Literal[-1, 1]


class LoadedPose(Strict):
    """One configuration with its loads; the robot is read unloaded, then at each force in turn, as listed."""

    q_deg: tuple[float, ...]
    force_n: tuple[Positive, ...] = Field(min_length=1)
    direction: tuple[float, float, float] = (0.0, 0.0, -1.0)
    sides: tuple[ApproachDirection, ...] = Field(
        (), description="for each joint, the side that it comes from where `approach` is 1; empty: all from below"
    )

    def side(self, approach: int) -> Array:
        """Return where each joint comes from, 1: from below, -1: from above, shape (n,), as `approach` has it."""
        return approach * np.array(self.sides or [1] * len(self.q_deg), dtype=np.float64)


class LoadingPart(Strict):
    """Keys of a loading experiment, alone or as a part of a session."""

    poses: tuple[LoadedPose, ...] = Field(min_length=1)
    approach: tuple[ApproachDirection, ...] = Field((1, -1), min_length=1)
    approach_deg: Positive = 3.0
    unload: bool = Field(True, description="take the loads off again in steps and read at each")
    repeats: Annotated[int, Field(ge=1, le=MOST_REPEATS)] = 10
    repeat_interval_s: Seconds = 0.1
    move_speed: SpeedShare = Field(0.3, description="share of the drives' speed limit, between poses")
    acceleration_deg_per_s2: Acceleration = 30.0
    approach_speed_deg_per_s: Seconds = 2.0
    load_ramp_s: Seconds = 1.0
    settle_s: Pause = 2.0
    orientation: bool = Field(False, description="carry a reflector round the other nests at every load, for Eq. (23)")

    def check(self, robot: Robot, limits: Array) -> None:
        """Hold the scenario against the robot.

        Args:
            robot: The robot it is to run on.
            limits: Shape (n, 2) [rad], ranges of the link joints.

        Raises:
            ScenarioError: Wrong number of angles, pose or approach outside the limits, load above the rating; all are
                listed.
        """
        problems = []
        degrees = np.rad2deg(limits)
        rating = robot.figures.rating.force_n
        for i, pose in enumerate(self.poses):
            place = f"poses[{i}]"
            if len(pose.q_deg) != robot.n_joints:
                count = len(pose.q_deg)
                problems.append(f"{place}.q_deg: {count} angles, but {robot.name} has {robot.n_joints} joints.")
            if len(pose.sides) not in (0, robot.n_joints):
                problems.append(
                    f"{place}.sides: {len(pose.sides)} sides, but {robot.name} has {robot.n_joints} joints."
                )
                continue
            starts = pose.q_deg - self.approach_deg * np.stack([pose.side(sign) for sign in self.approach])
            for j, (angle, (low, high)) in enumerate(zip(pose.q_deg, degrees, strict=False)):
                reach = self.approach_deg
                if not low <= angle <= high:
                    reached = f"joint {j + 1}'s {low:g} to {high:g} deg"
                    problems.append(f"{place}.q_deg[{j}]: {angle} deg is outside {reached}.")
                elif any(not low <= start <= high for start in starts[:, j]):
                    problems.append(
                        f"{place}.q_deg[{j}]: the approach over {reach} deg to {angle} deg leaves joint {j + 1}'s "
                        f"{low:g} to {high:g} deg; move the pose inwards or shorten approach_deg."
                    )
            if not np.any(pose.direction):
                problems.append(f"{place}.direction: is zero; give where the load pulls, such as [0, 0, -1].")
            problems += [
                f"{place}.force_n[{k}]: {force:g} N is above the rating of {robot.name}, {rating:g} N."
                for k, force in enumerate(pose.force_n)
                if force > rating
            ]
        if problems:
            raise ScenarioError(problems)


class Loading(ScenarioBase, LoadingPart):
    """Keys of a loading scenario."""

    experiment: Literal["loading"]
