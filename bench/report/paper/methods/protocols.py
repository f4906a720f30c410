"""How a loading experiment may be done: from which side poses are approached, in which order loads come and go.

The paper states no approach. Its Table 5 lists rising loads, and one slanting load for each of the last two poses.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from bench.identify.arm import Arm
from bench.scenario.loading import ApproachDirection, LoadedPose, Loading, LoadingPart

VERTICAL = (0.0, 0.0, -1.0)


@dataclass(frozen=True)
class Protocol:
    """One way of doing the experiment.

    Attributes:
        name: Key in the results.
        title: What people read.
        approach: 1: joints come from below, their angles rise; -1: from above.
        by_load: Each joint has its own side: 1 then stands for the side from which the load will push it on, so that
            it moves before the reading as it does under the load.
        loads: "rising": put on step by step; "falling": the heaviest first, then step by step off; "both": on and off.
        one_slanting: Poses with a slanting load are read under the largest alone.
    """

    name: str
    title: str
    approach: tuple[ApproachDirection, ...]
    by_load: bool = False
    loads: Literal["rising", "falling", "both"] = "rising"
    one_slanting: bool = False

    def of(self, scenario: Loading, arm: Arm, load_point: str) -> Loading:
        """Return a loading scenario done this way.

        Args:
            scenario: Poses and rising loads.
            arm: The arm.
            load_point: Where its loads act.
        """
        poses = tuple(self._pose(pose, arm, load_point) for pose in scenario.poses)
        changes = {"poses": poses, "approach": self.approach, "unload": self.loads == "both"}
        return scenario.model_copy(update=changes)

    def _pose(self, pose: LoadedPose, arm: Arm, load_point: str) -> LoadedPose:
        forces: Sequence[float] = pose.force_n
        if self.one_slanting and not hangs(pose):
            forces = forces[-1:]
        if self.loads == "falling":
            forces = forces[::-1]
        sides = sides_of_load(pose, arm, load_point) if self.by_load else ()
        return pose.model_copy(update={"force_n": tuple(forces), "sides": sides})


PROTOCOLS = (
    Protocol("below", "all joints from below, loads only put on", (1,)),
    Protocol("above", "all joints from above, loads only put on", (-1,)),
    Protocol("both", "from both sides in turn, loads only put on", (1, -1)),
    Protocol("both-unloading", "from both sides in turn, loads put on and taken off", (1, -1), loads="both"),
    Protocol("below-unloading", "all joints from below, loads put on and taken off", (1,), loads="both"),
    Protocol("below-falling", "all joints from below, heaviest load first, then taken off", (1,), loads="falling"),
    Protocol("table-5", "all joints from below, the loads that Table 5 lists", (1,), one_slanting=True),
    Protocol("table-5-above", "all joints from above, the loads that Table 5 lists", (-1,), one_slanting=True),
    Protocol("with-load", "each joint moving as the load will push it, loads only put on", (1,), by_load=True),
    Protocol("against-load", "each joint moving against the load, loads only put on", (-1,), by_load=True),
)
AS_PLANNED = PROTOCOLS[3]  # of scenarios/loading.yaml


def in_words(scenario: LoadingPart) -> str:
    """Return the protocol of a loading scenario, as far as it says it for all joints alike."""
    sides: dict[tuple[int, ...], str] = {(1,): "all joints from below", (-1,): "all joints from above"}
    loads = "put on and taken off" if scenario.unload else "only put on"
    return f"{sides.get(scenario.approach, 'from both sides in turn')}, loads {loads}"


def hangs(pose: LoadedPose) -> bool:
    """Return whether the load of a pose hangs."""
    return bool(np.allclose(np.array(pose.direction) / np.linalg.norm(pose.direction), VERTICAL))


def sides_of_load(pose: LoadedPose, arm: Arm, load_point: str) -> tuple[ApproachDirection, ...]:
    """Return for each joint the side from which the load of a pose pushes it on: 1 where its torque raises the angle.

    Joints that the load does not push get 1.
    """
    jacobian = arm.jacobian(np.deg2rad(pose.q_deg)[None], load_point)[0, :3]
    return tuple(1 if torque >= 0 else -1 for torque in jacobian.T @ np.array(pose.direction))
