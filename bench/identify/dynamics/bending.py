"""How much less, or more, torque a drive needs because gears wind up and links stand elsewhere than their motors.

A gear of stiffness k winds up by t/k under the torque t on its link, so links move as q - t/k. To first order in how
much softer gears are than stated, x = k stated / k,

    tau(q - x t/k) = tau(q) + sum_j x_j [tau(q - e_j t_j/k_j) - tau(q)]

with the torques of a rigid arm that was found first, its counterbalance included. It holds far below the lowest mode,
where the filter's band lies (`band.py`). What a known load pulls is taken where the motors are.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from bench.identify.arm import Arm
from bench.identify.dynamics.band import Band
from bench.identify.dynamics.equations import Equations, known_torque
from bench.identify.dynamics.parameters import Layout
from bench.identify.dynamics.regressor import N_INERTIAL, links_with, payload_columns
from bench.record.campaign import Array
from bench.robot.nominal_dynamics import NominalDynamics

# effort: samples of the winding to one period of the highest frequency that positions keep; splines lie between them
OVERSAMPLED = 5


@dataclass(frozen=True)
class Bending:
    """An arm that was found as if its gears were rigid.

    Attributes:
        arm: Its links, with the payload that nobody stated and is there now.
        arms: The same with the payload of each recording that has one of its own.
        nominal: The robot, for its counterbalance, known loads and stiffness.
        gas: Share of the gas that is in the counterbalance.
        winds: Shape (n,), gears that wind up; the others are rigid.
    """

    arm: Arm
    arms: Mapping[str, Arm]
    nominal: NominalDynamics
    gas: float
    winds: NDArray[np.bool_]

    def columns(self, equations: Equations, band: Band) -> Array:
        """Return what each gear's winding as stated adds to the torque of each drive, shape (T, n, n), thinned.

        Args:
            equations: Of a stretch.
            band: The filter that they passed.
        """
        samples, n = equations.samples, self.nominal.n_joints
        every = max(1, int(samples.rate / (OVERSAMPLED * band.position_cutoff_hz)))
        rows = np.unique(np.append(np.arange(0, len(samples), every), len(samples) - 1))
        position, velocity, acceleration = (values[rows] for values in band.smooth(samples))
        time, state = samples.time[rows], (position, velocity, acceleration)
        arm = self.arms.get(samples.recording, self.arm)
        rigid = self._torque(arm, *state)
        known = known_torque(arm, self.nominal, samples, state, rows)
        wound = CubicSpline(time, (rigid + known) / self.nominal.stiffness)
        found = np.zeros((len(rows), n, n))
        for j in np.flatnonzero(self.winds):
            of_j = np.arange(n) == j
            found[:, :, j] = self._torque(arm, *(x - of_j * wound(time, k) for k, x in enumerate(state))) - rigid
        return band.filtered(CubicSpline(time, found)(samples.time), samples)

    def _torque(self, arm: Arm, position: Array, velocity: Array, acceleration: Array) -> Array:
        """Return the torque on the links, shape (T, n)."""
        states = zip(position, velocity, acceleration, strict=True)
        torque = np.stack([arm.inverse_dynamics(*state) for state in states])
        if full := self.nominal.counterbalance:
            torque[:, full.joint] += self.gas * full.torque(position[:, full.joint])
        return torque


def bending_of(nominal: NominalDynamics, arm: Arm, layout: Layout, parameters: Array) -> Bending:
    """Return the bending of an arm that was found rigid.

    Args:
        nominal: The robot.
        arm: Its links as stated.
        layout: Of the parameters.
        parameters: Shape (p,), of bodies that can exist.
    """
    body, payload = payload_columns(arm, nominal.load_point)

    def carrying(one: slice) -> Arm:
        links = parameters[layout.links].reshape(layout.n, N_INERTIAL).copy()
        if layout.has_payload:
            links[body] += payload @ parameters[one]
        return Arm(links_with(arm.bodies, links))

    arms = {recording: carrying(layout.payload_in(recording)) for recording in layout.carried}
    gas = float(parameters[layout.gas][0]) if layout.has_gas else 0.0
    return Bending(carrying(layout.payload), arms, nominal, gas, np.isfinite(nominal.stiffness))


def bent(equations: Equations, bending: Bending, band: Band) -> Equations:
    """Return equations with the winding of the gears."""
    return replace(equations, winding=bending.columns(equations, band))
