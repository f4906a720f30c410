"""An arm that was found as if its gears were rigid and lost nothing: what torque its links need along a motion."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.identify.arm import Arm
from bench.identify.dynamics.balancer import balancer_columns
from bench.identify.dynamics.band import Band
from bench.identify.dynamics.equations import BALANCER, known_torque
from bench.identify.dynamics.leaning import leant
from bench.identify.dynamics.parameters import Layout
from bench.identify.dynamics.regressor import N_INERTIAL, links_with, payload_columns
from bench.identify.dynamics.samples import MotionSamples
from bench.record.campaign import Array
from bench.robot.nominal_dynamics import NominalDynamics

# effort: samples of the torque to one period of the highest frequency that positions keep; splines lie between them
OVERSAMPLED = 5


@dataclass(frozen=True)
class Passed:
    """What gears pass on to the links of a stretch; K instants of n drives.

    Attributes:
        time: Shape (K,) [s].
        state: Position, velocity and acceleration, shape (K, n) each.
        rigid: Shape (K, n) [Nm], torque of links, payload and gas.
        known: Shape (K, n) [Nm], torque that the known load needs.
    """

    time: Array
    state: tuple[Array, Array, Array]
    rigid: Array
    known: Array


@dataclass(frozen=True)
class FoundArm:
    """Links as found.

    Attributes:
        arm: With the payload that nobody stated and is there now.
        arms: The same with the payload of each recording that has one of its own.
        nominal: The robot, for its counterbalance, known loads and stiffness.
        gas: Share of the gas that is in the counterbalance.
        balancers: Shape (n, 6) [Nm], factors of `balancer_columns`.
    """

    arm: Arm
    arms: Mapping[str, Arm]
    nominal: NominalDynamics
    gas: float
    balancers: Array

    def carrying(self, recording: str) -> Arm:
        """Return the arm with the payload of a recording."""
        return self.arms.get(recording, self.arm)

    def passed(self, samples: MotionSamples, band: Band) -> Passed:
        """Return what gears pass on in a stretch, at instants close enough for a spline between them."""
        every = max(1, int(samples.rate / (OVERSAMPLED * band.position_cutoff_hz)))
        rows: NDArray[np.int64] = np.unique(np.append(np.arange(0, len(samples), every), len(samples) - 1))
        position, velocity, acceleration = (values[rows] for values in band.smooth(samples))
        state = position, velocity, acceleration
        rigid = self.torque(self.carrying(samples.recording), *state)
        return Passed(samples.time[rows], state, rigid, known_torque(self.arm, self.nominal, samples, state, rows))

    def torque(self, arm: Arm, position: Array, velocity: Array, acceleration: Array) -> Array:
        """Return the torque on the links, known loads apart, shape (T, n)."""
        states = zip(position, velocity, acceleration, strict=True)
        torque = np.stack([arm.inverse_dynamics(*state) for state in states])
        if full := self.nominal.counterbalance:
            torque[:, full.joint] += self.gas * full.torque(position[:, full.joint])
        waves = balancer_columns(position, arm.bodies.is_hinge)
        return np.asarray(torque + np.einsum("tnk,nk->tn", waves, self.balancers))


def found_arm(nominal: NominalDynamics, arm: Arm, layout: Layout, parameters: Array) -> FoundArm:
    """Return an arm with parameters that were found.

    Args:
        nominal: The robot.
        arm: Its links as stated.
        layout: Of the parameters.
        parameters: Shape (p,), of bodies that can exist.
    """
    body, payload = payload_columns(arm, nominal.load_point)
    bodies = leant(arm.bodies, parameters[layout.lean])

    def carrying(one: slice) -> Arm:
        links = parameters[layout.links].reshape(layout.n, N_INERTIAL).copy()
        if layout.has_payload:
            links[body] += payload @ parameters[one]
        return Arm(links_with(bodies, links))

    arms = {recording: carrying(layout.payload_in(recording)) for recording in layout.carried}
    gas = float(parameters[layout.gas][0]) if layout.has_gas else 0.0
    balancers = np.stack([parameters[layout.of_drives(name)] for name in BALANCER], axis=1)
    return FoundArm(carrying(layout.payload), arms, nominal, gas, balancers)
