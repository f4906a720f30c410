"""Torques averaged along a motion have the gravity and the pull of the average, not of the middle."""

from dataclasses import replace

import numpy as np

from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import Segment, segments_of
from bench.diagnose.replay.world import NOMINAL
from bench.identify.arm import Arm
from bench.record.campaign import Array
from bench.robot.links import rigid_bodies
from tests.diagnose.sweeps import SWEEP, made, nominal

FAST = SWEEP.model_copy(
    update={"speeds_deg_per_s": (40.0,), "ramp_s": 0.7, "sample_period_s": 0.02, "payloads_kg": (0.0, 100.0)}
)
JOINT = 1


def excess_of(segment: Segment) -> Array:
    """Return what averaged torques have more, with what is bolted on, shape (T, n) [Nm]."""
    assert segment.averaged_rest
    return segment.averaged_rest.arm + segment.conditions.payload_kg * segment.averaged_rest.per_kg


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
        used = segments if averaged else tuple(replace(segment, averaged_rest=None) for segment in segments)
        left = (observed - Replay(compiled, used, every).predict(NOMINAL)[:, column]) * compiled.torque_constant[JOINT]
        there = np.isfinite(left)
        columns = np.stack([excess, *beside], axis=1)[there]
        return float(np.linalg.lstsq(columns, left[there])[0][0])

    print(f"of the excess, up to {np.max(np.abs(excess)):.1f} Nm, missed {missed(averaged=False):.2f}", end=", ")
    print(f"averaged {missed(averaged=True):.2f}")
    assert abs(missed(averaged=False) - 1) < 0.3
    assert abs(missed(averaged=True)) < 0.3


def test_it_is_the_average_of_what_holds_the_arm_at_every_sample() -> None:
    """Interpolation between some samples costs less than a thousandth of the largest excess."""
    campaign, compiled = made(FAST, seed=2), nominal()
    arm = Arm(rigid_bodies(compiled))
    for segment in segments_of(campaign, compiled, quantities_of(campaign.runs, compiled)):
        assert segment.path
        mass, middle = segment.conditions.payload_kg, segment.motion.q[segment.motion.read]
        lifts = [arm.jacobian(q, compiled.robot.figures.load_point)[..., 2, :] for q in (segment.path.angles, middle)]
        every, there = (
            arm.gravity(q) + mass * 9.81 * lift for q, lift in zip((segment.path.angles, middle), lifts, strict=True)
        )
        assert compiled.counterbalance
        every[:, JOINT] += compiled.counterbalance.torque(segment.path.angles[:, JOINT])
        there[:, JOINT] += compiled.counterbalance.torque(middle[:, JOINT])
        expected = np.stack([weights @ every[rows] for rows, weights in segment.path.of_torque]) - there
        largest = np.max(np.abs(expected))
        np.testing.assert_allclose(excess_of(segment), expected, atol=1e-3 * largest)
