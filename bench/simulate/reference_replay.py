"""The replay of `prescribed.py` in NumPy, instant by instant: to read, and what the C version is held against."""

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.actuators.state import TEMPERATURE_RISE, state_of
from bench.errors import ConvergenceError
from bench.robot.compiled import CompiledRobot
from bench.simulate.equilibrium import evaluate_forces
from bench.simulate.prescribed import (
    MAX_ITERATIONS,
    PATIENCE,
    STEP_RESOLUTION,
    TOLERANCE,
    Motion,
    Prescribed,
)
from bench.simulate.trace import Array, Trace, gas_force

EXPLICIT = int(mujoco.mjtDisableBit.mjDSBL_EULERDAMP)  # damping may fall with speed; nothing moves


class Reference:
    """One robot, moved along one motion that begins once.

    Args:
        compiled: The robot.
    """

    def __init__(self, compiled: CompiledRobot) -> None:
        self.compiled = compiled
        self._data = mujoco.MjData(compiled.model)
        same = Prescribed(compiled)  # its unknowns and slopes; the search is what stands here once more
        self._dofs, self._positions, self._slopes = same.dofs, same.positions, same.slopes
        self._wrench: Array | None = None
        self._bias = np.zeros(compiled.model.nv)

    @property
    def n_unknowns(self) -> int:
        """Links and passive hinges whose balance is sought."""
        return len(self._dofs)

    def follow(
        self, motion: Motion, guess: Array | None = None, links: tuple[Array, Array] | None = None
    ) -> tuple[Trace, Array, Array]:
        """Return what `Prescribed.follow` returns.

        Raises:
            ConvergenceError: No balance at some instant.
        """
        links = links or (motion.velocity, motion.acceleration)
        model, data, at = self.compiled.model, self._data, self.compiled.at
        mujoco.mj_resetData(model, data)
        if motion.gas_rise is not None and at.counterbalance >= 0:
            state_of(model, data, at.counterbalance)[TEMPERATURE_RISE] = motion.gas_rise[0]
        n = self.compiled.n_joints
        found, load = np.empty((len(motion), 2, len(self._dofs))), np.empty((len(motion), n))
        rows = np.flatnonzero(motion.read)
        kept = {name: np.empty((len(rows), n)) for name in ("theta", "torque", "motor", "link")}
        points = np.empty((len(rows), len(at.reflectors) + 1, 3))
        sites = np.append(at.reflectors, at.load_point)
        cylinder = np.full((len(rows), 2), np.nan)
        unknown = np.zeros(len(self._dofs))
        unknown[:n] = motion.q[0]
        row = 0
        own_step = model.opt.timestep
        accelerated, pushed = np.any(links[1], axis=1).tolist(), np.any(motion.wrench, axis=1).tolist()
        for i in range(len(motion)):
            # gas relaxes over what the plugin takes for one step
            model.opt.timestep = own_step if i == 0 else max(motion.time[i] - motion.time[i - 1], own_step)
            slope = None
            if guess is not None:
                unknown, slope = guess[i]
                if i:  # what the guess missed an instant ago it is likely to miss again
                    unknown = unknown + (found[i - 1, 0] - guess[i - 1, 0])
            elif i:
                unknown = found[i - 1, 0].copy()
                unknown[:n] += motion.q[i] - motion.q[i - 1]
            data.qpos[at.q] = motion.q[i]
            data.qvel[at.q_dof], data.qvel[at.theta_dof] = motion.velocity[i], links[0][i]
            data.qacc[at.q_dof], data.qacc[at.theta_dof] = motion.acceleration[i], links[1][i]
            self._wrench = motion.wrench[i] if pushed[i] else None
            found[i] = self._balance(np.array(unknown), slope, accelerated[i], motion.time[i])
            load[i] = self._load(accelerated[i])
            if motion.read[i]:
                kept["theta"][row] = data.qpos[at.theta]
                kept["torque"][row] = self._motor_torque(motion.acceleration[i])
                kept["motor"][row] = data.actuator_force[at.motor_friction]
                kept["link"][row] = data.actuator_force[at.link_friction]
                points[row] = data.site_xpos[sites]
                if at.counterbalance >= 0:
                    cylinder[row] = -data.actuator_force[at.counterbalance], data.ten_length[at.counterbalance_tendon]
                row += 1
            self._remember()
        model.opt.timestep = own_step
        trace = Trace(
            time=motion.time[rows],
            q=motion.q[rows],
            q_velocity=motion.velocity[rows],
            theta=kept["theta"],
            theta_velocity=links[0][rows],
            motor_torque=kept["torque"],
            motor_friction=kept["motor"],
            link_friction=kept["link"],
            reflectors=points[:, :-1],
            load_point=points[:, -1],
            wrench=motion.wrench[rows],
            counterbalance_force=cylinder[:, 0],
            gas_force=gas_force(self.compiled, cylinder[:, 0], cylinder[:, 1]),
            counterbalance_length=cylinder[:, 1],
        )
        return trace, found, load

    def _balance(self, unknown: Array, slope: Array | None, accelerates: bool, time: float) -> tuple[Array, Array]:
        data = self._data
        if slope is None:
            slope = self._slopes.sliding if data.qvel.any() else self._slopes.sticking
        data.qpos[self._positions] = unknown
        residual, limit = self._residual(accelerates)
        before = step = residual
        bracket, before_last = None, np.inf
        for iteration in range(MAX_ITERATIONS):
            if residual @ residual < limit:
                return unknown, slope
            if iteration:
                moved = np.abs(step) > STEP_RESOLUTION
                made = np.where(moved, step, 1.0)
                # where nothing is transmitted, steps double until they meet the other flank
                doubled = np.where(np.abs(residual) > np.abs(before) / 2, np.abs(residual / made) / 2, np.inf)
                least = np.minimum(self._slopes.softest, doubled)
                secant = (before - residual) / made
                slope = np.where(moved, np.minimum(np.maximum(secant, least), self._slopes.stiffest), slope)
            step = residual / slope
            if iteration >= PATIENCE:
                if bracket is None:
                    bracket = np.stack([np.full_like(unknown, -np.inf), np.full_like(unknown, np.inf)])
                worst = np.arange(len(residual)) == np.argmax(np.abs(residual))
                halves = np.zeros_like(worst)
                if iteration % 2:
                    most = float(np.max(np.abs(residual)))
                    halves = worst & (most > before_last / 2)
                    before_last = most
                step = _bracketed(bracket, unknown, residual / self._slopes.stiffest, step, halves)
            unknown = unknown + step
            data.qpos[self._positions] = unknown
            before = residual
            residual, limit = self._residual(accelerates)
        raise ConvergenceError(
            f"no balance at {time:.3f} s within {MAX_ITERATIONS} iterations: {np.max(np.abs(residual)):.3g} Nm left."
        )

    def _residual(self, accelerates: bool) -> tuple[Array, float]:
        """Return the torque left on every unknown, shape (u,) [Nm], and the square of what may be left [Nm^2]."""
        model, data, at = self.compiled.model, self._data, self.compiled.at
        evaluate_forces(model, data)
        if accelerates:
            mujoco.mj_rne(model, data, 1, self._bias)  # without armature, which only the rotors have
            bias = self._bias
        else:
            bias = data.qfrc_bias
        passive = data.qfrc_passive
        forces = passive + data.qfrc_actuator - bias
        if self._wrench is not None:
            mujoco.mj_applyFT(
                model, data, self._wrench[:3], self._wrench[3:], data.xipos[at.load_body], at.load_body, forces
            )
        sprung = passive[self._dofs]
        return forces[self._dofs], TOLERANCE**2 * (1.0 + float(sprung @ sprung))

    def _load(self, accelerates: bool) -> Array:
        """Return what elements have to carry but for friction and what else acts on a joint, shape (n,) [Nm]."""
        model, data, at = self.compiled.model, self._data, self.compiled.at
        forces, _ = self._residual(accelerates)
        carried = np.zeros(model.nv)
        if at.counterbalance >= 0:
            moment = np.zeros((len(data.moment_rownnz), model.nv))
            mujoco.mju_sparse2dense(
                moment, data.actuator_moment, data.moment_rownnz, data.moment_rowadr, data.moment_colind
            )
            carried = moment[at.counterbalance] * data.actuator_force[at.counterbalance]
        others = data.qfrc_passive + data.qfrc_actuator - carried
        n = self.compiled.n_joints
        return np.array(others[at.theta_dof] - forces[:n])

    def _motor_torque(self, acceleration: Array) -> Array:
        """Return what the motors put out, shape (n,) [Nm]: inertia, viscous and Coulomb friction, and the element."""
        model, data, at = self.compiled.model, self._data, self.compiled.at
        others = data.qfrc_actuator[at.q_dof] - data.actuator_force[at.servo]
        return np.array(model.dof_armature[at.q_dof] * acceleration - data.qfrc_passive[at.q_dof] - others)

    def _remember(self) -> None:
        """Let the plugins take over the state of this instant: an integration step in which nothing moves."""
        model, data = self.compiled.model, self._data
        time, act = data.time, data.act.copy()
        data.qvel[:] = 0
        data.qacc[:] = 0
        flags = model.opt.disableflags
        model.opt.disableflags = flags | EXPLICIT
        mujoco.mj_Euler(model, data)
        model.opt.disableflags = flags
        data.time, data.act[:] = time, act


def _bracketed(bracket: Array, at: Array, near: Array, step: Array, halves: NDArray[np.bool_]) -> Array:
    """Return a step that stays between the places where the torque left was positive and where it was negative.

    Secants can run in circles where friction slips on both sides, and creep where play meets a flank. The torque on
    each unknown falls as that unknown rises, but for a little that the others add; the bracket is therefore opened
    again where no balance can lie in it any more.

    Args:
        bracket: Shape (2, u), changed.
        at: Shape (u,), where the unknowns are.
        near: Shape (u,), the torque left over the largest stiffness: no balance is nearer than that.
        step: Shape (u,), of the secants.
        halves: Shape (u,), unknowns that go to the middle of their brackets instead.
    """
    low, high = bracket
    low[near > 0] = at[near > 0]
    high[near < 0] = at[near < 0]
    closed = high - low < np.abs(near)
    low[closed & (near < 0)] = -np.inf
    high[closed & (near > 0)] = np.inf
    aim = at + step
    known = np.isfinite(low) & np.isfinite(high)
    middle = np.where(known, (np.where(known, low, 0.0) + np.where(known, high, 0.0)) / 2, aim)
    outside = known & (halves | (aim <= low) | (aim >= high))
    limited: Array = np.where(outside, middle, aim) - at
    return limited
