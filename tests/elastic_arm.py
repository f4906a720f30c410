"""An arm on soft gears that another program integrates in time: what its motors pay along a motion of theirs."""

import numpy as np
from scipy.integrate import solve_ivp

from bench.identify.arm import Arm
from bench.record.campaign import Array, Run
from bench.robot.compiled import CompiledRobot
from bench.robot.links import rigid_bodies

FOLLOWS, SAMPLE = 2.0, 0.01  # [s] until what rang has faded, and from reading to reading
FREQUENCY = 2 * np.pi * np.array([0.2, 0.24, 0.28, 0.32, 0.36, 0.4])  # [rad/s], with 2.3 times each beside it
MIDDLE, SIZE = np.array([0.0, 0.3, -0.4, 0.0, 0.7, 0.0]), np.array([0.6, 0.3, 0.4, 0.6, 0.45, 0.75])  # [rad]


def motors(time: Array | float) -> tuple[Array, Array, Array]:
    """Return angles, speeds and accelerations of the motors at some times, shape (..., 6)."""
    moment = np.asarray(time)[..., None]
    found = [MIDDLE, 0.0, 0.0]
    for share, ratio in ((1.0, 1.0), (0.4, 2.3)):
        rate = ratio * FREQUENCY
        phase, size = rate * moment + ratio * np.arange(6), share * SIZE
        found[0] = found[0] + size * np.sin(phase)
        found[1] = found[1] + size * rate * np.cos(phase)
        found[2] = found[2] - size * rate**2 * np.sin(phase)
    return found[0], found[1], found[2]


def elastic(compiled: CompiledRobot, seconds: float) -> Run:
    """Return the motors' torques of an arm whose links swing on damped springs without friction, once they follow."""
    arm, k, damping = Arm(rigid_bodies(compiled)), compiled.stiffness, compiled.damping
    rotors = compiled.model.dof_armature[compiled.at.q_dof]

    def pull(time: float, state: Array) -> Array:
        q, speed, _ = motors(time)
        return np.array(k * (q - state[:6]) + damping * (speed - state[6:]))

    def change(time: float, state: Array) -> Array:
        left = pull(time, state) - arm.inverse_dynamics(state[:6], state[6:], np.zeros(6))
        return np.concatenate([state[6:], np.linalg.solve(arm.mass_matrix(state[:6]), left)])

    q, speed, acceleration = motors(0.0)
    begin = np.concatenate([q - arm.inverse_dynamics(q, speed, acceleration) / k, speed])
    time = np.arange(FOLLOWS, FOLLOWS + seconds, SAMPLE)
    states = solve_ivp(change, (0.0, time[-1]), begin, "DOP853", time, rtol=1e-9, atol=1e-11).y.T
    torques = np.array([rotors * motors(at)[2] + pull(at, state) for at, state in zip(time, states, strict=True)])
    columns = {"time_s": time - FOLLOWS}
    columns |= {f"q_motor_{j + 1}_rad": motors(time)[0][:, j] for j in range(6)}
    columns |= {f"tau_motor_{j + 1}_nm": torques[:, j] for j in range(6)}
    return Run("fourier", "motion", 0.0, columns)
