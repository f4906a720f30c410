"""Quasi-static equilibrium: the links' rest position for given motor angles, by fixed point instead of time stepping.

The elastic elements are far stiffer than everything else that depends on the link angles (gravity, counterbalance, the
moving load: some parts in a thousand), so theta <- theta + residual / stiffness contracts by that factor each time. Where a
friction element begins to slip, the stiffness falls from that of both in parallel to that of the elastic element alone;
each joint therefore takes the secant of its last step, kept between the two.
"""

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.errors import ConvergenceError
from bench.robot.compiled import CompiledRobot

Array = NDArray[np.float64]

TOLERANCE = 1e-9  # [Nm] on every link; the elastic elements carry 1e2 to 1e4 Nm
MAX_ITERATIONS = 200
STEP_RESOLUTION = 1e-13  # [rad]
REST = 1e-12  # [rad], how close motor angles and servo torques must fit together after a reset


class Equilibrium:
    """Rest positions of one robot along a path of motor angles and wrenches; friction elements remember the path.

    Args:
        compiled: The robot.
        data: State to work on; it is left at the equilibrium with zero velocities. None makes a fresh one, with all
            friction elements unstressed.
    """

    def __init__(self, compiled: CompiledRobot, data: mujoco.MjData | None = None) -> None:
        self._compiled = compiled
        self.data = mujoco.MjData(compiled.model) if data is None else data
        self._slipping = compiled.stiffness
        self._sticking = compiled.stiffness + compiled.link_presliding

    def solve(self, q: Array, wrench: Array) -> Array:
        """Return the link angles at rest, shape (n,) [rad], and leave `data` there.

        Args:
            q: Shape (n,) [rad], motor angles, held exactly.
            wrench: Shape (6,) [N, Nm], on the load point in world axes.

        Raises:
            ConvergenceError: The residual did not fall below `TOLERANCE`.
        """
        model, data, at = self._compiled.model, self.data, self._compiled.at
        data.qvel[:] = 0
        data.qpos[at.q] = q
        data.xfrc_applied[at.load_body] = wrench
        slope = self._sticking
        residual = self._residual()
        for _ in range(MAX_ITERATIONS):
            if np.max(np.abs(residual)) < TOLERANCE:
                self._remember()
                return data.qpos[at.theta].copy()
            step = residual / slope
            data.qpos[at.theta] += step
            before, residual = residual, self._residual()
            moved = np.abs(step) > STEP_RESOLUTION  # below it the difference of residuals is rounding
            secant = np.divide(before - residual, step, out=slope.copy(), where=moved)
            slope = np.clip(secant, self._slipping, self._sticking)
        raise ConvergenceError(
            f"no equilibrium within {MAX_ITERATIONS} iterations: {np.max(np.abs(residual)):.3g} Nm are left, "
            f"{TOLERANCE:g} Nm were asked for; is the load far above the rating?"
        )

    def motor_torque(self) -> Array:
        """Return what the motors put out at the last equilibrium, shape (n,) [Nm]: spring torque less motor friction."""
        data, at = self.data, self._compiled.at
        spring = self._compiled.model.tendon_stiffness[at.element] * data.ten_length[at.element]
        return spring - data.actuator_force[at.motor_friction]

    def _residual(self) -> Array:
        """Return the torque that is left on each link, shape (n,) [Nm]."""
        model, data, at = self._compiled.model, self.data, self._compiled.at
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_tendon(model, data)
        mujoco.mj_transmission(model, data)
        mujoco.mj_fwdVelocity(model, data)
        mujoco.mj_fwdActuation(model, data)
        forces = data.qfrc_passive + data.qfrc_actuator - data.qfrc_bias
        push = data.xfrc_applied[at.load_body]
        mujoco.mj_applyFT(model, data, push[:3], push[3:], data.xipos[at.load_body], at.load_body, forces)
        return forces[at.theta_dof]

    def _remember(self) -> None:
        """Let the plugins take over the state of this instant: an integration step in which nothing moves."""
        model, data = self._compiled.model, self.data
        time, act = data.time, data.act.copy()
        mujoco.mj_fwdPosition(model, data)
        data.qacc[:] = 0
        mujoco.mj_Euler(model, data)
        data.time, data.act[:] = time, act


def settle(compiled: CompiledRobot, data: mujoco.MjData, command: Array) -> None:
    """Put a freshly reset robot at rest, unloaded, under servos commanded to `command`, shape (n,) [rad].

    A servo with integral action holds its command, and its integral carries what hangs on it; a proportional one gives
    until its position error carries it.
    """
    model, at = compiled.model, compiled.at
    has_integral = model.actuator_actnum[at.servo] > 0
    proportional_gain = -model.actuator_biasprm[at.servo, 1]
    equilibrium = Equilibrium(compiled, data)
    data.qpos[at.theta] = command
    q = command.copy()
    while True:
        data.plugin_state[:] = 0  # friction elements unstressed, wherever this ends
        equilibrium.solve(q, np.zeros(6))
        torque = equilibrium.motor_torque()
        given = np.where(has_integral, command, command - torque / proportional_gain)
        if np.max(np.abs(given - q)) < REST:
            break
        q = given
    integrating = at.servo[has_integral]
    data.act[model.actuator_actadr[integrating]] = torque[has_integral] / model.actuator_gainprm[integrating, 0]
    data.ctrl[at.servo_ctrl] = command
    mujoco.mj_forward(model, data)
