"""Signatures without a simulation: what effects that act as torques change to first order.

An effect says which torques it adds along what the robot did (`Effect.torques`); how readings answer to torques on
motors and links is known in closed form (`torque_response.py`). What a link that gives does to the weight that other
joints carry is left out. How exact that is, effect by effect, is measured by `tests/diagnose/test_first_order.py`.
"""

import numpy as np

from bench.diagnose.picture.torque_response import torque_response
from bench.diagnose.replay.replay import Replay, World
from bench.effects.effect import Acting
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot


class FirstOrder:
    """A model, along the motion of a campaign.

    Args:
        replay: The campaign.
        around: The model.

    Raises:
        ConvergenceError, RobotError: The model cannot be simulated.
    """

    def __init__(self, replay: Replay, around: World) -> None:
        self._shape = replay.shape
        courses = replay.followed(around)
        self._courses = [
            (course.rows, followed, torque_response(followed.compiled, followed.trace, replay.quantities))
            for course, followed in courses
            if _is_plain(followed.compiled, replay.compiled)
        ]
        self._is_complete = len(self._courses) == len(courses)

    def change(self, acting: Acting) -> Array | None:
        """Return what an effect changes in every reading, shape (T, c); None: it has to be simulated."""
        if not self._is_complete:
            return None
        change, j = np.empty(self._shape), acting.place.index
        for rows, followed, response in self._courses:
            torques = acting.effect.torques(acting.place, acting.values, followed)
            if torques is None:
                return None
            motor, link = np.atleast_1d(torques.motor)[:, None], np.atleast_1d(torques.link)[:, None]
            change[rows] = response.motor[:, :, j] * motor + response.link[:, :, j] * link
        return change


def _is_plain(compiled: CompiledRobot, nominal: CompiledRobot) -> bool:
    """Whether the links of a robot sit on its linear elastic elements alone, which is all that a response knows of."""
    return compiled.model.nv == nominal.model.nv and compiled.has_plain_elements
