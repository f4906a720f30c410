"""From the motion runs of a campaign to torques at equal angles: one joint there and back, bin by bin.

One way the friction adds to the motor torque, the other way it takes away: at equal angles half the difference is the
friction, Eq. (48), and the mean is free of it.
"""

from dataclasses import dataclass

import numpy as np

from bench.errors import InputError
from bench.identify.steady_ways import SteadyWay, steady_ways
from bench.record.campaign import Array, Campaign
from bench.robot.drives import Drives

SAME_SPEED = 0.02  # share by which the speeds of the two ways may differ
FEWEST = 10  # bins that both ways share


@dataclass(frozen=True)
class Traverse:
    """One joint going both ways at one speed with one payload; B bins of its angle in which both ways were read.

    Attributes:
        name: Of the run that goes up.
        joint: Index of the joint that turned, from 0.
        speed: [rad/s].
        payload: Mass at the load point [kg].
        q: Shape (B, n) [rad], motor angles, mean of both ways.
        acceleration: Shape (B,) [rad/s^2], of the joint, mean of both ways.
        torque: Shape (B, n) [Nm], xi I, mean of both ways: free of friction.
        friction: Shape (B,) [Nm], half the difference of both ways at the joint, Eq. (48), at equal motor angles; where
            friction acts behind the elastic element the link angles differ by its twist, worth some 0.1 % of it.
        sigma: Shape (B,) [Nm], standard deviation of the joint's torque, and of its friction, from the current's noise.
    """

    name: str
    joint: int
    speed: float
    payload: float
    q: Array
    acceleration: Array
    torque: Array
    friction: Array
    sigma: Array

    @property
    def angle(self) -> Array:
        """Shape (B,) [rad], motor angle of the joint that turned."""
        return self.q[:, self.joint]


def traverses(campaign: Campaign, drives: Drives, gravity: Array) -> tuple[Traverse, ...]:
    """Return the traverses of a campaign: each a run up and a run down, of the same joint, speed and payload.

    Angles are those of the motor encoders. Speed and acceleration come from the commands, which are free of noise and
    which a servo follows within some microradians. Where either was not logged, the other stands in. Only samples at
    steady speed count: there neither rotor inertia nor the vibration that a ramp excites has a say.

    Args:
        campaign: A validated campaign; its own noise of the current counts where it gives one.
        drives: Of its robot.
        gravity: Shape (3,) [m/s^2].

    Raises:
        InputError: No run turns a single joint, a run has no partner the other way, or a load is not the weight of a
            payload; every fault is listed.
    """
    problems: list[str] = []
    sigma = campaign.noise.get("current", drives.current_sigma)
    open_ways: list[SteadyWay] = []
    found = []
    for way in steady_ways(campaign, drives, gravity, problems):
        partner = next((other for other in open_ways if _are_opposite(way, other)), None)
        if partner is None:
            open_ways.append(way)
        else:
            open_ways.remove(partner)
            up, down = sorted((way, partner), key=lambda w: -w.speed)
            found.append(_both(up, down, drives, sigma))
    problems += [
        f"{way.run}: has no run the other way, alike in speed, payload and range; add one." for way in open_ways
    ]
    if not problems and not found:
        problems.append("the campaign has no motion run in which a single joint turns; record one there and back.")
    if problems:
        raise InputError(problems)
    return tuple(found)


def _are_opposite(a: SteadyWay, b: SteadyWay) -> bool:
    same = a.joint == b.joint and a.payload == b.payload
    shared = np.intersect1d(a.bins, b.bins).size
    return same and abs(a.speed + b.speed) < SAME_SPEED * abs(a.speed) and shared >= FEWEST


def _both(up: SteadyWay, down: SteadyWay, drives: Drives, sigma: float) -> Traverse:
    _, i, k = np.intersect1d(up.bins, down.bins, return_indices=True)
    torque = (up.torque[i] + down.torque[k]) / 2
    apart = (up.q[i, up.joint] - down.q[k, up.joint]) / 2  # half of what the mean angles of both ways differ by
    slope = np.gradient(torque[:, up.joint], (up.q[i, up.joint] + down.q[k, up.joint]) / 2)
    noise = drives.torque_constant[up.joint] * sigma / 2 * np.sqrt(1 / up.samples[i] + 1 / down.samples[k])
    return Traverse(
        name=up.run,
        joint=up.joint,
        speed=(up.speed - down.speed) / 2,
        payload=up.payload,
        q=(up.q[i] + down.q[k]) / 2,
        acceleration=(up.acceleration[i] + down.acceleration[k]) / 2,
        torque=torque,
        friction=(up.torque[i, up.joint] - down.torque[k, up.joint]) / 2 - slope * apart,
        sigma=noise,
    )
