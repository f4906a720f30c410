"""Torques averaged along a motion have more than those of the averaged motion: gravity, pull and inertia change."""

from dataclasses import replace

import numpy as np

from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import Segment, segments_of
from bench.diagnose.replay.uneven_derivative import derivative_over
from bench.diagnose.replay.world import NOMINAL
from bench.identify.arm import Arm
from bench.identify.dynamics.regressor import standard_parameters
from bench.record.campaign import Array
from bench.robot.compiled import compile_robot
from bench.robot.links import rigid_bodies
from bench.simulate.payload import bolt_on
from tests.diagnose.sweeps import SWEEP, made, nominal

FAST = SWEEP.model_copy(
    update={"speeds_deg_per_s": (40.0,), "ramp_s": 0.7, "sample_period_s": 0.02, "payloads_kg": (0.0, 100.0)}
)
JOINT = 1


def arm_of(segment: Segment) -> Arm:
    """Return the nominal links with what is bolted on."""
    mass = segment.conditions.payload_kg
    return Arm(rigid_bodies(compile_robot(nominal().robot, [bolt_on(mass)] if mass else [])))


def excess_of(segment: Segment) -> Array:
    """Return what averaged torques have more, with what is bolted on, shape (T, n) [Nm]."""
    assert segment.average_excess
    return segment.average_excess.torque(standard_parameters(arm_of(segment).bodies))


def test_ramps_leave_less_of_the_simulation_in_time() -> None:
    """Beside what figures that are a little off make of joint 2, a replay of the middles misses what averages have."""
    campaign, compiled = made(FAST, seed=2), nominal()
    every = quantities_of(campaign.runs, compiled)
    segments = segments_of(campaign, compiled, every)
    column = [quantity.column for quantity in every].index("current_2_a")
    observed = np.concatenate([segment.observed[:, column] for segment in segments])
    excess = np.concatenate([excess_of(segment)[:, JOINT] for segment in segments])
    q, v, a = (
        np.concatenate([getattr(segment.motion, name)[segment.motion.read][:, JOINT] for segment in segments])
        for name in ("q", "velocity", "acceleration")
    )
    mass = np.concatenate([np.full(len(segment), segment.conditions.payload_kg) for segment in segments])
    beside = [np.ones(len(q)), np.sign(v), v, a, np.sin(q), np.cos(q), np.sin(2 * q), np.cos(2 * q)]
    beside += [mass * a, mass * np.sin(q), mass * np.cos(q)]

    def missed(*, averaged: bool) -> float:
        """Return how much of the excess is missed, beside all else."""
        used = segments if averaged else tuple(replace(segment, average_excess=None) for segment in segments)
        left = (observed - Replay(compiled, used, every).predict(NOMINAL)[:, column]) * compiled.torque_constant[JOINT]
        there = np.isfinite(left)
        columns = np.stack([excess, *beside], axis=1)[there]
        return float(np.linalg.lstsq(columns, left[there])[0][0])

    print(f"of the excess, up to {np.max(np.abs(excess)):.1f} Nm, missed {missed(averaged=False):.2f}", end=", ")
    print(f"averaged {missed(averaged=True):.2f}")
    assert abs(missed(averaged=False) - 1) < 0.3
    assert abs(missed(averaged=True)) < 0.3


def test_it_is_the_average_of_what_moves_the_arm_at_every_sample() -> None:
    """Interpolation between some samples costs less than a thousandth of the largest excess."""
    campaign, compiled = made(FAST, seed=2), nominal()
    for segment in segments_of(campaign, compiled, quantities_of(campaign.runs, compiled)):
        path, motion = segment.path, segment.motion
        assert path
        arm = arm_of(segment)
        rates = [derivative_over(path.angles, path.time, path.window, order) for order in (1, 2)]
        states = [path.angles, *rates]
        averaged = [path.averaged(rate, path.groups) for rate in rates]
        for values, still in ((states[0], motion.q[0]), (states[1], 0.0), (states[2], 0.0), (averaged[1], 0.0)):
            values[:, segment.standing] = np.broadcast_to(still, 6)[segment.standing]
        there = [motion.q[motion.read], motion.velocity[motion.read], averaged[1]]
        balance = compiled.counterbalance
        assert balance
        every, middle = (
            np.array([arm.inverse_dynamics(*row) for row in zip(*x, strict=True)]) for x in (states, there)
        )
        for torque, (q, *_) in ((every, states), (middle, there)):
            torque[:, JOINT] += balance.torque(q[:, JOINT])
        expected = np.stack([weights @ every[rows] for rows, weights in path.of_torque]) - middle
        np.testing.assert_allclose(excess_of(segment), expected, atol=1e-3 * np.max(np.abs(expected)))
