"""The K_C analysis of section 4.2: not a session on the robot but a map over two of its joints."""

from typing import Literal

from pydantic import Field

from bench.errors import ScenarioError
from bench.record.strict import Strict
from bench.robot.bodies import Array
from bench.robot.folder import Robot
from bench.scenario.types import Positive


class Complementary(Strict):
    """Keys of a K_C analysis."""

    experiment: Literal["complementary"]
    robot: str = Field(description="name of a robot folder, or a path to one")
    stiffness_nm_per_rad: tuple[Positive, ...] = Field(description="assumed, Table 3")
    force_n: tuple[float, float, float] = Field(description="on the point, world axes")
    moment_nm: tuple[float, float, float]
    rest_deg: tuple[float, ...] = Field(description="joint angles, Table 4; those of the swept joints do not matter")
    swept: tuple[int, int] = Field(description="numbers of the two swept joints, from 1")
    step_deg: Positive = 2.0
    point: str = Field(description="site of the robot on which the load acts and whose deflection is predicted")
    notes: str = ""

    def check(self, robot: Robot, limits: Array) -> None:
        """Hold the scenario against the robot.

        Raises:
            ScenarioError: A wrong number of values, or a swept joint that does not exist; all listed.
        """
        n = robot.n_joints
        problems = [
            f"{key}: {len(values)} values, but {robot.name} has {n} joints."
            for key, values in (("stiffness_nm_per_rad", self.stiffness_nm_per_rad), ("rest_deg", self.rest_deg))
            if len(values) != n
        ]
        if len(set(self.swept)) < 2 or not all(1 <= joint <= n for joint in self.swept):
            problems.append(f"swept: {list(self.swept)} must name two joints between 1 and {n}.")
        if problems:
            raise ScenarioError(problems)
