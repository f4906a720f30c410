"""From the motion runs of a campaign to torques at equal angles: each joint sweep there and back, bin by bin.

On the way there friction adds to the motor torque, on the way back it takes away; at equal angles half the difference is
the friction, Eq. (48), and the mean is free of it.
"""

from collections import defaultdict
from dataclasses import dataclass

import numpy as np

from bench.errors import InputError
from bench.record.campaign import Array, Campaign, Run
from bench.robot.drives import Drives

BIN = np.deg2rad(0.5)  # [rad]; within it a torque of a few kNm/rad^2 curvature departs from a line by 0.02 Nm
STEADY = 0.01  # share by which the speed may differ from the run's highest; ramps are not at full speed
SAME_SPEED = 0.02  # share by which the speeds there and back may differ
SAME_MASS = 1e-6  # [kg]
WEIGHT_ONLY = 1.0  # [N] of load that the payload's weight does not explain


@dataclass(frozen=True)
class Traverse:
    """One joint going there and back at one speed with one payload; B bins of the angle in which both ways were read.

    Attributes:
        name: Of the run on the way there.
        joint: Index of the joint that turned, from 0.
        speed: Of the joint [rad/s].
        payload: Mass at the load point [kg].
        q: Shape (B, n) [rad], motor angles, mean of both ways.
        velocity, acceleration: Shape (B,) [rad/s], [rad/s^2], of the joint on the way up; it comes down at minus the
            velocity and the same acceleration.
        torque: Shape (B, n) [Nm], xi I, mean of both ways: free of friction.
        friction: Shape (B,) [Nm], half the difference of both ways at the joint, Eq. (48).
        sigma: Shape (B,) [Nm], standard deviation of the joint's torque, and of its friction, from the current's noise.
    """

    name: str
    joint: int
    speed: float
    payload: float
    q: Array
    velocity: Array
    acceleration: Array
    torque: Array
    friction: Array
    sigma: Array

    @property
    def angle(self) -> Array:
        """Shape (B,) [rad], motor angle of the joint that turned."""
        return self.q[:, self.joint]


@dataclass(frozen=True)
class _Way:
    """One run at steady speed, by bin of the angle; bins without a sample have count 0 and nan."""

    name: str
    joint: int
    speed: float  # signed [rad/s]
    payload: float
    count: dict[int, int]
    mean: dict[int, Array]  # q (n), velocity, acceleration, torque (n)


def traverses(campaign: Campaign, drives: Drives, gravity: Array) -> tuple[Traverse, ...]:
    """Return the traverses of a campaign, each made of one run up and the next one down at its speed with its payload.

    Angles are those of the motor encoders. Speed and acceleration are taken from the commands, which have no noise and
    which the servo follows within some microradians; both fall back on the other where it was not logged. Only samples at
    steady speed count, so that neither rotor inertia nor the arm's vibration after a ramp matters much.

    Args:
        campaign: A validated campaign; its own noise of the current counts where it gives one.
        drives: Of its robot.
        gravity: Shape (3,) [m/s^2].

    Raises:
        InputError: No motion run turns a single joint at steady speed, a run has no run the other way, or the load is
            more than the weight of `load_mass_kg`; every fault is listed.
    """
    problems: list[str] = []
    waiting: defaultdict[tuple[int, float], list[_Way]] = defaultdict(list)
    found = []
    sigma = campaign.noise.get("current", drives.current_sigma)
    for run in campaign.of_kind("motion"):
        way = _way(run, drives, gravity, problems)
        if way is None:
            continue
        open_ways = waiting[way.joint, way.payload]
        match = next((w for w in open_ways if abs(w.speed + way.speed) < SAME_SPEED * abs(way.speed)), None)
        if match is None:
            open_ways.append(way)
        else:
            open_ways.remove(match)
            found.append(_together(match, way, drives, sigma))
