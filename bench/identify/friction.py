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
from bench.identify.readings import StaticReadings

Array = NDArray[np.float64]

LOAD_DEPENDENT = 0.05  # prior sigma of friction per transmitted torque; gears show 0.01 to 0.06 (DESIGN, drive friction)
NEGLIGIBLE = 0.02  # share of a joint's largest change of torque that surely does not slide it


@dataclass(frozen=True)
class FrictionChange:
    """Friction that came to act against the load, both sides together, in m states.

    Attributes:
        force: Shape (m, n) [Nm], dGamma.
        current: Shape (m, n) [Nm], dT.
        gain: Shape (n,), d.
        gain_sigma: Shape (n,), its standard deviation.
        scale: Shape (n,) [Nm], S: root mean square of s beyond its noise in the states that slid.
        sliding: Shape (m, n), from -1 to 1: -1 or 1 where the load has surely made the joint slide down or up, so that friction
            stands at its level on both sides; between them where it may still stick somewhere.
    """

    force: Array
    current: Array
    gain: Array
    gain_sigma: Array
    scale: Array
    sliding: Array

    @property
    def total(self) -> Array:
        """Shape (m, n) [Nm], s."""
        return self.force - (1 + self.gain) * self.current

    @property
    def may_stick(self) -> NDArray[np.bool_]:
        """Shape (m, n); friction need not be at its level, and its two sides need not have the same history."""
        return np.abs(self.sliding) < 1


def friction_change(readings: StaticReadings, gamma: Array, sigma_force: Array) -> FrictionChange:
    """Compare currents with the load.

    Args:
        readings: States with currents and load.
        gamma: Shape (m, n) [Nm], Gamma = J_f^T W - G - M of every state.
        sigma_force: Shape (m, n) [Nm], standard deviation of its change from the noise of the force sensor.
    """
    first = readings.first_of_series
    torque = -readings.current_torque
    force, current = gamma - gamma[first], torque - torque[first]
    sigma_current = readings.sigma_current_torque * np.sqrt(2 / readings.n_repeats[:, None])
    variance = sigma_force**2 + sigma_current**2
    slid = np.abs(play(readings.series, force, NEGLIGIBLE * np.abs(force).max(axis=0))) == 1

    def scale(total: Array) -> Array:
        excess = np.sum(np.where(slid, total**2 - variance, 0.0), axis=0) / np.maximum(slid.sum(axis=0), 1)
        return np.sqrt(np.maximum(excess, 0.0))

    sliding = play(readings.series, force, scale(force - current))
    prior = np.maximum(np.hypot(readings.systematic.torque_gain, readings.systematic.force_gain), SURE)
    gain, gain_sigma = current_gain(readings.series, force, current, sliding, variance.max(axis=0), prior)
    return FrictionChange(force, current, gain, gain_sigma, scale(force - (1 + gain) * current), sliding)


def play(series: NDArray[np.int64], drive: Array, level: Array) -> Array:
    """Return the state of a play element (rigid, then sliding), from -1 to 1, shape (m, n); each series starts at 0.

    Args:
        series: Shape (m,) int; rows of a series stand in the order of time.
        drive: Shape (m, n), what drives it.
        level: Shape (n,), half its width in units of the drive.
    """
    state = np.zeros_like(drive)
    width = np.maximum(level, 1e-9 * np.abs(drive).max(initial=1.0))
    for s in np.unique(series):
        rows = np.flatnonzero(series == s)
        for before, now in zip(rows[:-1], rows[1:], strict=True):
            step = np.clip((drive[now] - drive[before]) / width, -2.0, 2.0)
            state[now] = np.clip(state[before] + step, -1.0, 1.0)
    return state


def current_gain(
    series: NDArray[np.int64], force: Array, current: Array, sliding: Array, variance: Array, prior: Array
) -> tuple[Array, Array]:
    """Return gain d of each joint and its standard deviation, both shape (n,).

    Fits dGamma - dT = d dT + (F + mu |dGamma|) direction + offset of the series in the states that slide: there Coulomb
    friction F is constant up to its direction, and the slope belongs to the gain or to load-dependent friction mu, which a
    reversal of the load tells apart. Without a reversal the priors of d and mu share the slope between them. The noise of
    the fit is estimated, and not taken below that of the instruments.

    Args:
        series: Shape (m,) int.
        force: Shape (m, n) [Nm], dGamma.
        current: Shape (m, n) [Nm], dT.
        sliding: Shape (m, n), as in `FrictionChange`.
        variance: Shape (n,) [Nm^2], of dGamma - dT from instrument noise.
        prior: Shape (n,), standard deviation of d as known beforehand.
    """
    gain, gain_sigma = np.zeros_like(prior), prior.copy()
    member = series == np.unique(series)[:, None]
    for j in range(len(prior)):
        slides = np.abs(sliding[:, j]) == 1
        way, load, motor = sliding[slides, j], force[slides, j], current[slides, j]
        rows = np.stack([motor, way, way * np.abs(load), load - motor], axis=1)
        inside = member[:, slides].astype(np.float64)
        count = inside.sum(axis=1)
        rows = rows - inside.T @ ((inside @ rows) / np.maximum(count, 1)[:, None])
        freedom = len(rows) - int(np.sum(count > 0)) - 3
        if freedom < 1:
            continue
        columns, response = rows[:, :3], rows[:, 3]
        precision = np.diag(np.array([prior[j], np.inf, LOAD_DEPENDENT]) ** -2.0)
        noise = variance[j]
        for _ in range(3):
            covariance = np.linalg.pinv(columns.T @ columns / noise + precision, hermitian=True)
            fit = covariance @ columns.T @ response / noise
            residual = response - columns @ fit
            noise = max(float(residual @ residual) / freedom, variance[j])
        gain[j], gain_sigma[j] = fit[0], np.sqrt(covariance[0, 0])
    return gain, gain_sigma
