"""The robot under its servo, advanced in time: commands and wrench in, true quantities out. No instruments here."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.actuators.state import TEMPERATURE_RISE, state_of
from bench.robot.compiled import CompiledRobot, SpecEdit, compile_spec, read_spec
from bench.robot.folder import Robot
from bench.simulate.trace import Array, Trace, add_trace_sensors, n_readings, trace_of_readings
from bench.simulate.track import Seen, Tracker

_STATE = mujoco.mjtState.mjSTATE_FULLPHYSICS


@dataclass(frozen=True)
class Left:
    """What a sitting leaves behind for the next one, which may have another plant.

    Attributes:
        time_s: When it ended [s].
        q: Shape (n,) [rad], where the motors were sent last.
        gas_rise: T / T0 - 1 of the gas of the cylinder.
    """

    time_s: float
    q: Array
    gas_rise: float


class Plant:
    """One simulated robot. Commands are interpolated within a control period, as a drive's fine interpolator does.

    Args:
        robot: The robot folder.
        edits: Changes of the model, applied in order before it is compiled.
        timestep: Integration step [s]; None takes the MJCF's.
        spec: Of the robot, which is copied; None reads the MJCF.
    """

    def __init__(
        self,
        robot: Robot,
        edits: Iterable[SpecEdit] = (),
        timestep: float | None = None,
        spec: mujoco.MjSpec | None = None,
    ) -> None:
        own = read_spec(robot) if spec is None else spec.copy()
        self.compiled: CompiledRobot = compile_spec(own, robot, (*edits, add_trace_sensors), timestep)
        self.model: mujoco.MjModel = self.compiled.model
        self.data = mujoco.MjData(self.model)
        self.tracker = Tracker(self.compiled, self.data)
        self._n_state = mujoco.mj_stateSize(self.model, _STATE)
        self._sensors = slice(self.model.nsensordata - n_readings(robot), self.model.nsensordata)
        # The integrator takes the velocity at the end of a step for the servo's damping, the sensor that at its start:
        # under 1 rad/s^2 they differ by an ampere. What acted is what counts.
        self._servo_damping = -self.model.actuator_biasprm[self.compiled.at.servo, 2]
        self._timestep = float(self.model.opt.timestep)
        self._command = np.zeros(robot.n_joints)
        self._wrench = np.zeros(6)
        self.reset(np.zeros(robot.n_joints))

    @property
    def timestep(self) -> float:
        """Integration step [s]."""
        return self._timestep

    def reset(self, q: Array, gas_rise: float = 0.0) -> None:
        """Put the robot at rest with all motors at `q` [rad], unloaded, friction elements unstressed.

        The gas of its cylinder has T / T0 - 1 = `gas_rise`, where it warms up at all.

        The links hang on their elastic elements in static equilibrium, and the integral action of the servo already
        carries the load, so nothing moves after a reset.
        """
        from bench.simulate.equilibrium import settle  # the two need each other

        mujoco.mj_resetData(self.model, self.data)
        if gas_rise:
            state_of(self.model, self.data, self.compiled.at.counterbalance)[TEMPERATURE_RISE] = gas_rise
        self._command = np.array(q, dtype=np.float64)
        self._wrench = np.zeros(6)
        settle(self.compiled, self.data, self._command)

    def advance(self, commands: Array, wrenches: Array, period: float) -> Trace:
        """Follow commands for one control period each, and return every integration step.

        Args:
            commands: Shape (P, n) [rad], motor angle asked for at the end of each period; linear in between.
            wrenches: Shape (P, 6) [N, Nm], on the load point in world axes at the end of each period; linear between.
            period: [s], a multiple of the timestep.

        Returns:
            Trace of P * period / timestep instants; the last is one timestep before the end of the last period.
        """
        substeps = round(period / self.timestep)
        starts = np.concatenate([self._command[None], commands[:-1]])
        path = np.stack([(commands - starts) / period, starts])
        return self.track(path, wrenches, substeps, np.arange(len(commands) * substeps), commands[-1])

    def track(
        self, path: Array, wrenches: Array, substeps: int, rows: NDArray[np.int64], end: Array, ahead: float = 0.0
    ) -> Trace:
        """Follow a path that is given as polynomials, and return some of the integration steps.

        Args:
            path: Shape (k, P, n) [rad], motor angles in each of P periods: coefficients for powers of the time since
                its beginning [s], from the highest power down, as `scipy.interpolate.PPoly` keeps them.
            wrenches: Shape (P, 6) [N, Nm], on the load point at the end of each period; linear between.
            substeps: Integration steps in a period.
            rows: Shape (K,), which steps to return, growing.
            end: Shape (n,) [rad], the command at the end.
            ahead: By how much later the velocity set point is taken than that of the position [s].
        """
        pushes = np.concatenate([self._wrench[None], wrenches])
        seen = self.tracker.run(path, pushes, substeps, rows, ahead)
        self._command, self._wrench = np.array(end), np.array(wrenches[-1])
        return self._seen(seen)

    def step(self, command: Array, wrench: Array, period: float) -> Array:
        """Follow one command for a control period, as `advance` does, and return the record of its last step.

        Args:
            command: Shape (n,) [rad], motor angle asked for at the end of the period; linear in between.
            wrench: Shape (6,) [N, Nm], on the load point at the end of the period; linear in between.
            period: [s], a multiple of the timestep.

        Returns:
            As `Tracker.run_one`; `trace_of` says what it means.

        Raises:
            ValueError: Command or wrench have another shape.
        """
        if command.shape != self._command.shape or wrench.shape != (6,):
            raise ValueError(f"a command {command.shape} and a wrench {wrench.shape} do not fit the robot")
        substeps = round(period / self._timestep)
        record = self.tracker.run_one(self._command, command, (self._wrench, wrench), period, substeps)
        self._command[:], self._wrench[:] = command, wrench
        return record

    def trace_of(self, records: Array) -> Trace:
        """Return what K records of `step` say, shape (K, width)."""
        return self._seen(Seen.of(records.copy(), self.model.nsensordata))

    def _seen(self, seen: Seen) -> Trace:
        trace = trace_of_readings(self.compiled, seen.time, seen.sensors[:, self._sensors], seen.wrench)
        gained = seen.velocities[:, self.compiled.at.q_dof] - trace.q_velocity
        return replace(trace, motor_torque=trace.motor_torque - self._servo_damping * gained)

    def left(self, now: float) -> "Left":
        """Return what it leaves behind at the end of a sitting.

        Args:
            now: [s], on the clock of the session.
        """
        balance, rise = self.compiled.counterbalance, 0.0
        if balance and balance.heat_capacity_ratio > 1:
            rise = float(state_of(self.model, self.data, self.compiled.at.counterbalance)[TEMPERATURE_RISE])
        return Left(now, self._command.copy(), rise)

    def arrive(self, q: Array, now: float, before: "Left | None") -> None:
        """Put the robot at rest where a sitting begins: it went there right after the last one, and waited.

        Args:
            q: Shape (n,) [rad], of the motors.
            now: [s], on the clock of the session.
            before: What the last sitting left, of this plant or of one with another payload; None: it is the first.
        """
        balance, rise = self.compiled.counterbalance, 0.0
        if before and balance and balance.heat_capacity_ratio > 1:
            angles = np.array([before.q, q, q])[:, balance.joint]
            rise = float(balance.temperature_rise(angles, [0.0, now - before.time_s], before.gas_rise)[-1])
        self.reset(q, rise)

    def wait(self, seconds: float) -> None:
        """Let time pass in which the robot only stands: its gas relaxes at the volume it has, nothing else moves."""
        balance = self.compiled.counterbalance
        if balance and np.isfinite(balance.relaxation_time):
            gas = state_of(self.model, self.data, self.compiled.at.counterbalance)
            gas[TEMPERATURE_RISE] *= np.exp(-seconds / balance.relaxation_time)

    def take_over(self, other: "Plant") -> None:
        """Go on from the present state of another plant, whose model has the same parts with other numbers.

        Raises:
            ValueError: The state of the other model has another size.
        """
        if other._n_state != self._n_state:
            raise ValueError(f"a state of {other._n_state} numbers does not fit a model with {self._n_state}")
        state = np.empty(self._n_state)
        mujoco.mj_getState(other.model, other.data, state, _STATE)
        mujoco.mj_setState(self.model, self.data, state, _STATE)
        self._command, self._wrench = other._command.copy(), other._wrench.copy()

    def look(self) -> Trace:
        """Return the present instant, shape (1, ...), without moving."""
        mujoco.mj_forward(self.model, self.data)
        readings = self.data.sensordata[None, self._sensors].copy()
        return trace_of_readings(self.compiled, np.array([self.data.time]), readings, self._wrench[None])
