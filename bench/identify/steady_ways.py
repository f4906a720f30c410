"""The motion runs in which a single joint turns, cut to steady speed and averaged over bins of its angle."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.record.campaign import Array, Campaign, Run
from bench.robot.drives import Drives

BIN = np.deg2rad(0.5)  # [rad]; in it a torque that bends by 5 kNm/rad^2 leaves a straight line by 0.02 Nm
STEADY = 0.002  # share by which the speed may differ from the run's; what differs more belongs to a ramp
RUN_IN = 0.25  # [s] at steady speed before samples count: the arm, at some 5 Hz, still follows from the ramp
STILL = 1e-3  # [rad]; the other joints move less
UNEXPLAINED = 1.0  # [N] of load beyond the weight of the payload


@dataclass(frozen=True)
class SteadyWay:
    """One run at steady speed: means over each bin of the joint's angle that it passed; B bins, n drives.

    Attributes:
        run: Name.
        joint: Index of the joint that turned, from 0.
        speed: Signed [rad/s].
        payload: Mass at the load point [kg].
        bins: Shape (B,), number of the bin: its angle over `BIN`, rounded down.
        samples: Shape (B,), how many there were.
        q: Shape (B, n) [rad], motor angles.
        acceleration: Shape (B,) [rad/s^2], of the joint.
        torque: Shape (B, n) [Nm], xi I.
    """

    run: str
    joint: int
    speed: float
    payload: float
    bins: NDArray[np.int64]
    samples: NDArray[np.int64]
    q: Array
    acceleration: Array
    torque: Array


def steady_ways(campaign: Campaign, drives: Drives, gravity: Array, problems: list[str]) -> Iterator[SteadyWay]:
    """Yield the motion runs in which a single joint turns; others are passed over.

    Args:
        campaign: A validated campaign.
        drives: Of its robot.
        gravity: Shape (3,) [m/s^2].
        problems: What is wrong with a run that turns a single joint is added to it, and the run left out.
    """
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
        if way := _at_steady_speed(run, joint, float(payload[0]), smooth, q, drives):
            yield way
        else:
            problems.append(
                f"{run.name}: has less than {RUN_IN:g} s at steady speed; go further or gather speed sooner."
            )


def _at_steady_speed(run: Run, joint: int, payload: float, smooth: Array, q: Array, drives: Drives) -> SteadyWay | None:
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

    return SteadyWay(run.name, joint, speed, payload, bins, samples, mean(q), mean(acceleration), mean(torque))


def _numbers(drives: Drives) -> tuple[str, ...]:
    return tuple(str(j) for j in range(1, len(drives.torque_constant) + 1))
