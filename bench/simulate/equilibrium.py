"""Quasi-static equilibrium: where the robot rests for given commands, by fixed point instead of time stepping.

Each joint has a link, on its elastic element, and a motor, on its servo. A servo with integral action rests at its
command, so its motor angle is known; a proportional one gives. The elastic elements are far stiffer than everything
else that depends on the link angles (gravity, counterbalance, the moving load: some parts in a thousand), so solving
joint by joint contracts by that factor each time. Where a friction element begins to slip, its stiffness falls to zero:
each unknown therefore takes the secant of its last step, kept between slipping and sticking.

Where the model has more (play, a bent spring, something beside the elastic elements, coupled drives, passive hinges),
the same balances are solved for all unknowns together, by Newton's method (`newton.py`).
"""

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.errors import ConvergenceError
from bench.robot.compiled import CompiledRobot
from bench.simulate.newton import find_balance

Array = NDArray[np.float64]

TOLERANCE = 1e-8  # [Nm] on every link and motor; elements carry 1e2 to 1e4 Nm, and a servo's kp rounds at 1e-9 Nm
MAX_ITERATIONS = 200
STEP_RESOLUTION = 1e-13  # [rad]


class Equilibrium:
    """Rest positions of one robot along a path of commands and wrenches; friction elements remember the path.

    Friction elements are rate independent: between two poses or loads the path may be as long as it likes, as long as
        every angle and load changes in one direction only.

    Args:
        compiled: The robot.
        data: State to work on; it is left at the equilibrium with zero velocities. None makes a fresh one at the
            model's zero, with all friction elements unstressed.
    """

    def __init__(self, compiled: CompiledRobot, data: mujoco.MjData | None = None) -> None:
        self.compiled = compiled
        self.data = mujoco.MjData(compiled.model) if data is None else data
        model, at, k = compiled.model, compiled.at, compiled.stiffness
        self._command = np.array(self.data.qpos[at.q])
        self._passive = passive_dofs(compiled)
        self._is_plain = len(self._passive) == 0 and compiled.has_plain_elements
        self._gives = model.actuator_actnum[at.servo] == 0
        servo = np.where(self._gives, -model.actuator_biasprm[at.servo, 1], 0.0)
        self._slipping = np.stack([k, k + servo])
        self._sticking = self._slipping + np.stack([compiled.link_presliding, compiled.motor_presliding])

    def solve(self, command: Array, wrench: Array) -> Array:
        """Return the link angles at rest, shape (n,) [rad], and leave `data` there.

        Args:
            command: Shape (n,) [rad], what the servos are commanded to.
            wrench: Shape (6,) [N, Nm], on the load point in world axes.

        Raises:
            ConvergenceError: The residual did not fall below `TOLERANCE`.
        """
        data, at, k = self.data, self.compiled.at, self.compiled.stiffness
        data.qvel[:] = 0
        data.ctrl[at.servo_ctrl] = command
        data.ctrl[at.servo_ctrl + 1] = 0
        way = command - self._command
        self._command = np.array(command)
        data.qpos[at.theta] += way
        data.qpos[at.q] = np.where(self._gives, data.qpos[at.q] + way, command)
        data.xfrc_applied[at.load_body] = wrench
        if not self._is_plain:
            self._solve_together()
            self._remember()
            return np.array(data.qpos[at.theta])
        slope = self._sticking
        residual = self._residual()
        for _ in range(MAX_ITERATIONS):
            if np.max(np.abs(residual)) < TOLERANCE:
                self._remember()
                return np.array(data.qpos[at.theta])
            step = self._step(slope, residual)
            data.qpos[at.theta] += step[0]
            data.qpos[at.q] += step[1]
            before, residual = residual, self._residual()
            change = before - residual + k * step[::-1]  # less what the element passes on from the other side
            moved = np.abs(step) > STEP_RESOLUTION  # below it the difference of residuals is rounding
            slope = np.clip(np.divide(change, step, out=slope.copy(), where=moved), self._slipping, self._sticking)
        raise ConvergenceError(
            f"no equilibrium within {MAX_ITERATIONS} iterations: {np.max(np.abs(residual)):.3g} Nm are left, "
            f"{TOLERANCE:g} Nm were asked for; is the load far above the rating?"
        )

    def motor_torque(self) -> Array:
        """Return what the motors put out at the last equilibrium, shape (n,) [Nm]: the balance of each rotor."""
        data, at = self.data, self.compiled.at
        others = data.qfrc_actuator[at.q_dof] - data.actuator_force[at.servo]
        return np.array(data.qfrc_bias[at.q_dof] - data.qfrc_passive[at.q_dof] - others)

    def _solve_together(self) -> None:
        """Balance links, giving motors and passive hinges by Newton's method."""
        model, data, at = self.compiled.model, self.data, self.compiled.at
        dofs = np.concatenate([at.theta_dof, at.q_dof[self._gives], self._passive])
        positions = model.jnt_qposadr[model.dof_jntid[dofs]]

        def residual(x: Array) -> Array:
            data.qpos[positions] = x
            return np.array(self._forces()[dofs])

        hinges = model.jnt_stiffness[model.dof_jntid[self._passive]]
        stiffness = np.concatenate([self._slipping[0], self._slipping[1][self._gives], hinges])
        residual(find_balance(residual, np.array(data.qpos[positions]), stiffness, TOLERANCE))

    def _step(self, slope: Array, residual: Array) -> Array:
        """Solve each joint's two balances, shape (2, n): link first, then motor; a motor that holds does not move."""
        k = self.compiled.stiffness
        determinant = slope[0] * slope[1] - k * k
        link = np.where(self._gives, (slope[1] * residual[0] + k * residual[1]) / determinant, residual[0] / slope[0])
        motor = np.where(self._gives, (slope[0] * residual[1] + k * residual[0]) / determinant, 0.0)
        return np.stack([link, motor])

    def _residual(self) -> Array:
        """Return the torque that is left on each link and each giving motor, shape (2, n) [Nm]."""
        forces, at = self._forces(), self.compiled.at
        return np.stack([forces[at.theta_dof], np.where(self._gives, forces[at.q_dof], 0.0)])

    def _forces(self) -> Array:
        """Return the torque that is left on every degree of freedom, shape (nv,) [Nm]."""
        model, data, at = self.compiled.model, self.data, self.compiled.at
        evaluate_forces(model, data)
        forces: Array = data.qfrc_passive + data.qfrc_actuator - data.qfrc_bias
        push = data.xfrc_applied[at.load_body]
        mujoco.mj_applyFT(model, data, push[:3], push[3:], data.xipos[at.load_body], at.load_body, forces)
        return forces

    def _remember(self) -> None:
        """Let the plugins take over the state of this instant: an integration step in which nothing moves."""
        model, data = self.compiled.model, self.data
        time, act = data.time, data.act.copy()
        mujoco.mj_fwdPosition(model, data)
        data.qacc[:] = 0
        mujoco.mj_Euler(model, data)
        data.time, data.act[:] = time, act


def passive_dofs(compiled: CompiledRobot) -> NDArray[np.int64]:
    """Return the degrees of freedom that are neither link nor rotor, shape (p,)."""
    driven = {*compiled.at.theta_dof.tolist(), *compiled.at.q_dof.tolist()}
    return np.array([dof for dof in range(compiled.model.nv) if dof not in driven], dtype=np.int64)


def settle(compiled: CompiledRobot, data: mujoco.MjData, command: Array) -> None:
    """Put a freshly reset robot at rest, unloaded, under servos commanded to `command`, shape (n,) [rad].

    Friction elements are unstressed. The integral action of the servos, where they have it, carries what hangs on them.
    """
    model, at = compiled.model, compiled.at
    data.qpos[at.theta] = data.qpos[at.q] = command
    equilibrium = Equilibrium(compiled, data)
    equilibrium.solve(command, np.zeros(6))
    integrating = model.actuator_actnum[at.servo] > 0
    servo = at.servo[integrating]
    data.act[model.actuator_actadr[servo]] = equilibrium.motor_torque()[integrating] / model.actuator_gainprm[servo, 0]
    mujoco.mj_forward(model, data)


def evaluate_forces(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """Compute all forces of a state at rest or in motion, but nothing that follows from them."""
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_tendon(model, data)
    mujoco.mj_transmission(model, data)
    mujoco.mj_fwdVelocity(model, data)
    mujoco.mj_fwdActuation(model, data)
