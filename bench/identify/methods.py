"""The methods by name. A new one is a new file and one entry here."""

from collections.abc import Callable, Mapping

from bench.identify.arm import Arm
from bench.identify.current import identify_current
from bench.identify.estimate import StiffnessEstimate
from bench.identify.force import identify_force
from bench.identify.force_pose import identify_force_pose
from bench.identify.joint import identify_joint
from bench.identify.options import Options
from bench.identify.readings import StaticReadings
from bench.robot.counterbalance import Counterbalance

Method = Callable[[Arm, Counterbalance | None, StaticReadings, Options], StiffnessEstimate]

METHODS: Mapping[str, Method] = {
    "current": identify_current,
    "force": identify_force,
    "force-pose": identify_force_pose,
    "joint": identify_joint,
}
