"""The plant under torques of one's own: its servos hold it until the first of them, and no longer from then on."""

from copy import copy
from dataclasses import replace
from functools import cached_property

import mujoco
import numpy as np

from bench.simulate.plant import Plant
from bench.simulate.trace import Array
from bench.simulate.track import Tracker

# [Nm/rad], all that is left of a servo: it is told angles so large that it puts out the torque asked for. How far the
# motor really turned takes a millionth of a Nm from that for each rad.
GAIN = 1e-6


class TorquePlant(Plant):
    """One simulated robot whose motors put out the torques that they are told.

    Args:
        robot, edits, timestep, spec: As of a `Plant`.
    """

    @cached_property
    def _free(self) -> Tracker:
        """Steps along a copy of the model whose servos put out what they are told."""
        model, at = copy(self.model), self.compiled.at
        model.actuator_biasprm[at.servo, 1:3] = -GAIN, 0.0
        model.actuator_dyntype[at.servo] = mujoco.mjtDyn.mjDYN_NONE  # no integral
        model.actuator_actnum[at.servo], model.actuator_actadr[at.servo] = 0, -1
        model.actuator_ctrllimited[at.servo_ctrl] = False
        return Tracker(replace(self.compiled, model=model), self.data)

    def step(self, command: Array, wrench: Array, period: float) -> Array:
        """Put out torques for a control period and return the record of its last step, as `Plant.step`.

        Args:
            command: Shape (n,) [Nm], torque of each motor at the joint during the whole period.
            wrench: Shape (6,) [N, Nm], on the load point at the end of the period; linear in between.
            period: [s], a multiple of the timestep.

        Raises:
            ValueError: Command or wrench have another shape.
        """
        nothing = np.zeros(self.compiled.n_joints)
        if command.shape != nothing.shape or wrench.shape != (6,):
            raise ValueError(f"torques {command.shape} and a wrench {wrench.shape} do not fit the robot")
        self._servo_damping = nothing
        substeps, angles = round(period / self._timestep), command / GAIN
        record = self._free.run_one(angles, angles, (self._wrench, wrench), period, substeps)
        self._wrench[:] = wrench
        return record
