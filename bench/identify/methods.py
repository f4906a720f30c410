"""The methods by name. A new one is a new file and one entry here."""

from collections.abc import Mapping

from bench.identify.advice import Method, with_advice
from bench.identify.current import identify_current
from bench.identify.force import identify_force
from bench.identify.force_paper import identify_force_paper
from bench.identify.force_pose import identify_force_pose
from bench.identify.joint import identify_joint

METHODS: Mapping[str, Method] = {
    "current": with_advice(identify_current),
    "force": with_advice(identify_force),
    "force-pose": with_advice(identify_force_pose),
    "force-paper": with_advice(identify_force_paper),
    "joint": with_advice(identify_joint),
}
