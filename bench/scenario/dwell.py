"""Dwelling: one pose for a long time, read now and then. What changes there is slow: gas, temperatures, drift."""

from typing import Annotated

import numpy as np
from pydantic import Field

from bench.errors import ScenarioError
from bench.record.strict import Strict
from bench.robot.bodies import Array
from bench.robot.folder import Robot
from bench.scenario.types import MOST_REPEATS, Acceleration, Seconds, SpeedShare


class DwellPart(Strict):
    """Keys of a dwell. The robot comes from `from_deg`, quickly and not read, and stands at `q_deg` from then on."""

    from_deg: tuple[float, ...] = Field(description="where it stands before; far away, so that the gas is compressed")
    q_deg: tuple[float, ...]
    duration_s: Seconds = 600.0
    read_every_s: Seconds = Field(20.0, description="the first reading is after as much time")
    simulated_s: Seconds | None = Field(
        None, description="how much of each such interval is simulated; the robot only stands in the rest. None: all"
    )
    repeats: Annotated[int, Field(ge=1, le=MOST_REPEATS)] = Field(3, description="readings each time")
    repeat_interval_s: Seconds = 0.1
    move_speed: SpeedShare = Field(0.6, description="share of the drives' speed limit")
    acceleration_deg_per_s2: Acceleration = 60.0

    @property
    def n_times(self) -> int:
        """How often the pose is read."""
        return max(1, int(self.duration_s / self.read_every_s + 1e-9))

    def check(self, robot: Robot, limits: Array) -> None:
        """Hold the part against the robot.

        Args:
            robot: The robot it is to run on.
            limits: Shape (n, 2) [rad], ranges of the link joints.

        Raises:
            ScenarioError: Wrong number of angles, an angle outside the limits, readings that last longer than the time
                between them; all listed.
        """
        problems = []
        for name in ("from_deg", "q_deg"):
            angles = getattr(self, name)
            if len(angles) != robot.n_joints:
                problems.append(f"{name}: {len(angles)} angles, but {robot.name} has {robot.n_joints} joints.")
            problems += [
                f"{name}[{j}]: {angle:g} deg is outside joint {j + 1}'s {low:g} to {high:g} deg."
                for j, (angle, (low, high)) in enumerate(zip(angles, np.rad2deg(limits), strict=False))
                if not low <= angle <= high
            ]
        live = self.read_every_s if self.simulated_s is None else self.simulated_s
        if live > self.read_every_s:
            problems.append(f"simulated_s: {live:g} s is more than read_every_s, {self.read_every_s:g} s.")
        if self.repeats * self.repeat_interval_s > live:
            problems.append(f"repeats: {self.repeats} readings do not fit into {live:g} s.")
        if problems:
            raise ScenarioError(problems)
