"""What currents and load say together about friction, before any deflection is looked at.

Between the first state of a series and a later one, the load changes the joint torque by dGamma and the motor by
dT = -xi dI. What is missing,

    s = dGamma - (1 + d) dT = -(df_link + df_motor),

is the friction that came to act against the load, on both sides of the elastic element together; d is the gain of the
load's torque over the current's. s is read off state by state. How it is shared between the two sides, only the
deflection can say (`bench.identify.joint`).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.identify.gls import SURE
from bench.identify.play import Play, play
from bench.identify.readings import StaticReadings
from bench.robot.bodies import Array

LOAD_DEPENDENT = (
    0.05  # prior sigma of friction per transmitted torque; gears show 0.01 to 0.06 (design of this project)
)
NEGLIGIBLE = 0.02  # share of a joint's largest change of torque that surely does not make it slide


@dataclass(frozen=True)
class FrictionChange:
    """Friction that came to act against the load, both sides together, in m states.

    Attributes:
        force: Shape (m, n) [Nm], dGamma.
        current: Shape (m, n) [Nm], dT.
        gain: Shape (n,), d.
        gain_sigma: Shape (n,), its standard deviation, if the direction of the load is right.
        gain_by_direction: Shape (n, 3) [1/rad], change of d per turn of the measured load about x, y and z.
        scale: Shape (n,) [Nm], S: root mean square of s beyond its noise in the states that slid.
        may_stick: Shape (m, n) bool; the load has changed too little since it last turned to make sure that friction
            stands at its level on both sides.
    """

    force: Array
    current: Array
    gain: Array
    gain_sigma: Array
    gain_by_direction: Array
    scale: Array
    may_stick: NDArray[np.bool_]

    @property
    def total(self) -> Array:
        """Shape (m, n) [Nm], s."""
        return self.force - (1 + self.gain) * self.current


def friction_change(readings: StaticReadings, gamma: Array, sigma_force: Array, by_direction: Array) -> FrictionChange:
    """Compare currents with the load.

    Args:
        readings: States with currents and load.
        gamma: Shape (m, n) [Nm], Gamma = J_f^T W - G - M of every state.
        sigma_force: Shape (m, n) [Nm], standard deviation of its change from the noise of the force sensor.
        by_direction: Shape (m, n, 3) [Nm/rad], change of Gamma per turn of the measured load about x, y and z.
    """
    first = readings.first_of_series
    torque = -readings.current_torque
    force, current = gamma - gamma[first], torque - torque[first]
    sigma_current = readings.sigma_current_torque * np.sqrt(2 / readings.n_repeats[:, None])
    variance = sigma_force**2 + sigma_current**2
    slid = play(readings, force, NEGLIGIBLE * np.abs(force).max(axis=0)).slides
    slid[first] = False

    def scale(total: Array) -> Array:
        excess = np.sum(np.where(slid, total**2 - variance, 0.0), axis=0) / np.maximum(slid.sum(axis=0), 1)
        return np.array(np.sqrt(np.maximum(excess, 0.0)))

    sliding = play(readings, force, scale(force - current))
    prior = np.maximum(np.hypot(readings.systematic.torque_gain, readings.systematic.force_gain), SURE)
    turned = by_direction - by_direction[first]
    found = current_gain(readings.series, force, current, sliding, variance.max(axis=0), prior, turned)
    total_scale = scale(force - (1 + found[0]) * current)
    return FrictionChange(force, current, *found, total_scale, ~sliding.slides)


def current_gain(
    series: NDArray[np.int64],
    force: Array,
    current: Array,
    sliding: Play,
    variance: Array,
    prior: Array,
    by_direction: Array,
) -> tuple[Array, Array, Array]:
    """Return gain d of each joint and its standard deviation, shape (n,), and its change per turn of the load, (n, 3).

    Fits dGamma - dT = d dT + (F + mu |dGamma|) direction + offset of the series in the states that slide: there Coulomb
    friction F is constant up to its direction, and the slope belongs to the gain or to load-dependent friction mu,
    which a reversal of the load tells apart. Without a reversal the priors of d and mu share the slope between them.
    The noise of the fit is estimated, and not taken below that of the instruments.

    Args:
        series: Shape (m,) int.
        force: Shape (m, n) [Nm], dGamma.
        current: Shape (m, n) [Nm], dT.
        sliding: Where friction stands at its level on both sides, and in which direction.
        variance: Shape (n,) [Nm^2], of dGamma - dT from instrument noise.
        prior: Shape (n,), standard deviation of d as known beforehand.
        by_direction: Shape (m, n, 3) [Nm/rad], change of dGamma per turn of the measured load about x, y and z.
    """
    gain, gain_sigma, gain_by_direction = np.zeros_like(prior), prior.copy(), np.zeros((len(prior), 3))
    member = series == np.unique(series)[:, None]
    for j in range(len(prior)):
        slides = sliding.slides[:, j]
        way, load, motor = sliding.direction[slides, j], force[slides, j], current[slides, j]
        rows = np.column_stack([motor, way, way * np.abs(load), load - motor, by_direction[slides, j]])
        inside = member[:, slides].astype(np.float64)
        count = inside.sum(axis=1)
        rows = rows - inside.T @ ((inside @ rows) / np.maximum(count, 1)[:, None])
        freedom = len(rows) - int(np.sum(count > 0)) - 3
        if freedom < 1:
            continue
        columns, response, turned = rows[:, :3], rows[:, 3], rows[:, 4:]
        precision = np.diag(np.array([prior[j], np.inf, LOAD_DEPENDENT]) ** -2.0)
        noise = variance[j]
        for _ in range(3):
            covariance = np.linalg.pinv(columns.T @ columns / noise + precision, hermitian=True)
            solver = covariance @ columns.T / noise
            fit = solver @ response
            residual = response - columns @ fit
            noise = max(float(residual @ residual) / freedom, variance[j])
        gain[j], gain_sigma[j] = fit[0], np.sqrt(covariance[0, 0])
        gain_by_direction[j] = solver[0] @ turned
    return gain, gain_sigma, gain_by_direction
