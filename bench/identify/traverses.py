"""From the motion runs of a campaign to torques at equal angles: one joint there and back, bin by bin.

One way the friction adds to the motor torque, the other way it takes away: at equal angles half the difference is the
friction, Eq. (48), and the mean is free of it.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.errors import InputError
from bench.record.campaign import Array, Campaign, Run
from bench.robot.drives import Drives

BIN = np.deg2rad(0.5)  # [rad]; in it a torque that bends by 5 kNm/rad^2 leaves a straight line by 0.02 Nm
STEADY = 0.002  # share by which the speed may differ from the run's; what differs more belongs to a ramp
RUN_IN = 0.25  # [s] at steady speed before samples count: the arm, at some 5 Hz, still follows from the ramp
STILL = 1e-3  # [rad]; the other joints move less
SAME_SPEED = 0.02  # share by which the speeds of the two ways may differ
UNEXPLAINED = 1.0  # [N] of load beyond the weight of the payload


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
        friction: Shape (B,) [Nm], half the difference of both ways at the joint, Eq. (48).
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


@dataclass(frozen=True)
class _Way:
    """One run at steady speed: means over each bin of the angle, and how many samples they are of."""

    run: str
    joint: int
    speed: float  # signed
    payload: float
    bins: NDArray[np.int64]
    samples: NDArray[np.int64]
    q: Array
    acceleration: Array
    torque: Array


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
    open_ways: list[_Way] = []
    found = []
    for way in _ways(campaign, drives, gravity, problems):
        partner = next((other for other in open_ways if _are_opposite(way, other)), None)
        if partner is None:
            open_ways.append(way)
        else:
            open_ways.remove(partner)
            up, down = sorted((way, partner), key=lambda w: -w.speed)
            found.append(_both(up, down, drives, sigma))
    problems += [f"{way.run}: has no run the other way at its speed with its payload; add one." for way in open_ways]
    if not problems and not found:
        problems.append("the campaign has no motion run in which a single joint turns; record one there and back.")
    if problems:
        raise InputError(problems)
    return tuple(found)


def _ways(campaign: Campaign, drives: Drives, gravity: Array, problems: list[str]) -> Iterator[_Way]:
    for run in campaign.of_kind("motion"):
        command, encoder = (run.stack(name, "rad", _numbers(drives)) for name in ("q_cmd", "q_motor"))
        q = np.where(np.isfinite(encoder), encoder, command)
        moves = np.ptp(q, axis=0) > STILL
        if np.count_nonzero(moves) != 1:
            continue
        joint = int(np.flatnonzero(moves)[0])
        payload = run.columns.get("load_mass_kg", np.zeros(len(run)))
        surplus = run.load_wrench()
        surplus[:, :3] -= payload[:, None] * gravity
        if np.ptp(payload) > 0 or np.abs(surplus).max() > UNEXPLAINED:
            problems.append(
                f"{run.name}: the load is not the weight of load_mass_kg; a load that moves along needs its mass."
            )
            continue
        smooth = np.where(np.isfinite(command), command, encoder)
        if way := _steady_way(run, joint, float(payload[0]), smooth, q, drives):
            yield way
        else:
            problems.append(
                f"{run.name}: has less than {RUN_IN:g} s at steady speed; go further or gather speed sooner."
            )


def _steady_way(run: Run, joint: int, payload: float, smooth: Array, q: Array, drives: Drives) -> _Way | None:
    time = run.columns["time_s"]
    velocity = np.gradient(smooth[:, joint], time)
    acceleration = np.gradient(velocity, time)
    speed = float(np.median(velocity))
    steady = np.abs(velocity - speed) < STEADY * abs(speed)
    steady &= time > time[np.argmax(steady)] + RUN_IN
    if np.count_nonzero(steady) < 2:
        return None
    torque = drives.torque_constant * run.stack("current", "a", _numbers(drives))
    bins, place, samples = np.unique(
        np.floor(q[steady, joint] / BIN).astype(np.int64), return_inverse=True, return_counts=True
    )

    def mean(values: Array) -> Array:
        sums = np.zeros((len(bins), *values.shape[1:]))
        np.add.at(sums, place, values[steady])
        return (sums.T / samples).T

    return _Way(run.name, joint, speed, payload, bins, samples, mean(q), mean(acceleration), mean(torque))


def _are_opposite(a: _Way, b: _Way) -> bool:
    same = a.joint == b.joint and a.payload == b.payload
    return same and abs(a.speed + b.speed) < SAME_SPEED * abs(a.speed)


def _both(up: _Way, down: _Way, drives: Drives, sigma: float) -> Traverse:
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


def _numbers(drives: Drives) -> tuple[str, ...]:
    return tuple(str(j) for j in range(1, len(drives.torque_constant) + 1))
