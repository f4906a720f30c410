"""What effects that act as torques change to first order, without a simulation of their own.

An effect says which torques it adds along what the robot did (`Effect.torques`). With the motors' motion prescribed, a
torque f on link j lets that link give by f / k_j, moves the reflectors by their Jacobian, and is taken off the motor; a
torque on the motor is paid by the motor alone, whatever its link sits on. What a link that gives does to the weight
that other joints carry is left out. How exact that is, effect by effect, is measured by
`tests/diagnose/test_first_order.py`.
"""

from dataclasses import replace

import numpy as np

from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.world import World
from bench.effects.effect import Acting, Effect
from bench.effects.levels import acts_in
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot


def acts_as_torque(effect: Effect) -> bool:
    """Whether an effect may say which torques it adds."""
    return type(effect).torques is not Effect.torques


class FirstOrder:
    """A model, along the motion of a campaign.

    Args:
        replay: The campaign.
        around: The model.

    Raises:
        ConvergenceError, RobotError: The model cannot be simulated.
    """

    def __init__(self, replay: Replay, around: World) -> None:
        self._replay, self._around = replay, around
        self._trace = replay.trace(around)
        self._reading = replay.read(around, self._trace)
        self._courses = replay.followed(around)
        self._is_plain = all(_is_plain(followed.compiled, replay.compiled) for _, followed in self._courses)

    def change(self, acting: Acting) -> Array | None:
        """Return what the torques of an effect change in every reading, shape (T, c); None: it has to be simulated."""
        if not acts_as_torque(acting.effect):
            return None
        j, trace = acting.place.index, self._trace
        paid, given = np.empty(len(trace)), np.empty(len(trace))
        for course, followed in self._courses:
            if not acts_in(acting.place, course.recording):
                paid[course.rows] = given[course.rows] = 0.0
                continue
            torques = acting.effect.torques(acting.place, acting.values, followed)
            if torques is None or (np.any(torques.link) and not self._is_plain):
                return None
            paid[course.rows] = torques.motor + torques.link
            given[course.rows] = torques.link / followed.compiled.stiffness[j]
        torque, theta = trace.motor_torque.copy(), trace.theta.copy()
        torque[:, j] -= paid
        theta[:, j] += given
        reflectors = trace.reflectors + self._replay.jacobians[:, :, :, j] * given[:, None, None]
        moved = replace(trace, motor_torque=torque, theta=theta, reflectors=reflectors)
        change: Array = self._replay.read(self._around, moved) - self._reading
        return change


def _is_plain(compiled: CompiledRobot, nominal: CompiledRobot) -> bool:
    """Whether the links of a robot sit on its linear elastic elements alone, which is all that is known here."""
    return compiled.model.nv == nominal.model.nv and compiled.has_plain_elements
