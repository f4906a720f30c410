"""What the instruments of the second plant show: systematic errors drawn once, noise with every reading, steps."""

from dataclasses import dataclass

import numpy as np

from bench.robot.figures import Instruments
from bench.second.course import Course
from bench.second.figures import Array, Figures
from bench.second.plant import HOUR, State

Columns = dict[str, Array]


@dataclass(frozen=True, eq=False)
class Draws:
    """Source of all errors of reading; `quiet` instruments have none.

    Attributes:
        rng: Random numbers.
        tails: Degrees of freedom of Student's t for the noise, above 2; None for normal noise.
        quiet: No noise, no error, no resolution.
    """

    rng: np.random.Generator
    tails: float | None = None
    quiet: bool = False

    def noise(self, sigma: float, shape: tuple[int, ...]) -> Array:
        """Draw noise of one standard deviation."""
        if self.quiet:
            return np.zeros(shape)
        if self.tails is None:
            return sigma * self.rng.standard_normal(shape)
        heavy: Array = sigma * np.sqrt((self.tails - 2) / self.tails) * self.rng.standard_t(self.tails, shape)
        return heavy

    def error(self, sigma: float, shape: tuple[int, ...]) -> Array:
        """Draw errors that stay over the campaign; they are normal."""
        return np.zeros(shape) if self.quiet else sigma * self.rng.standard_normal(shape)

    def stepped(self, values: Array, step: float) -> Array:
        """Return values in steps of a resolution; 0: infinitely fine."""
        if self.quiet or step == 0:
            return values
        steps: Array = step * np.round(values / step)
        return steps


def columns_of(
    state: State, course: Course, figures: Figures, fitted: Instruments, constants: Array, errors: Array, draws: Draws
) -> Columns:
    """Return the columns of all K readings.

    Args:
        state: The truth along the course.
        course: Which instants are read, and what hangs on.
        figures: The arm, for what its instruments get wrong.
        fitted: Which instruments there are, and how good.
        constants: Shape (n,) [Nm/A], torque constants as the lab knows them.
        errors: Shape (n,), their relative standard deviations.
        draws: Of noise and errors.
    """
    rows, n, out = course.read, figures.n, figures.readout
    shape = (len(rows), n)
    found: Columns = {}
    found |= _numbered("q_cmd", "rad", course.command[rows])
    if fitted.encoder:
        seen = state.q[rows] + out.zero - out.delay * course.velocity[rows]
        seen = seen + draws.error(fitted.encoder.offset_sigma_rad, (n,))
        found |= _numbered("q_motor", "rad", draws.stepped(seen, fitted.encoder.resolution_rad))
    if fitted.current:
        gain = np.array([float(draws.error(float(np.hypot(fitted.current.gain_sigma, s)), ())) for s in errors])
        seen = state.torque[rows] / constants * (1 + gain) / (1 + out.torque_constant)
        seen = seen + draws.error(fitted.current.offset_sigma_a, (n,)) + draws.noise(fitted.current.sigma_a, shape)
        seen = np.sign(seen) * np.maximum(np.abs(seen) - out.dead_band, 0) + out.offset
        found |= _numbered("current", "a", draws.stepped(seen, fitted.current.resolution_a))
    wrench = course.wrench[rows]
    load = wrench[:, :3] + course.payload[rows, None] * figures.gravity
    found |= _along("load", "n", load)
    if fitted.force:
        gain = 1 + draws.error(fitted.force.gain_sigma, ())
        tilt = draws.error(fitted.force.direction_sigma_rad, (3,))
        slants = np.hypot(wrench[:, :1], wrench[:, 1:2]) > 1e-6 * np.abs(wrench[:, 2:3])  # a hanging load points down
        for name, unit, part, sigma in (
            ("force", "n", slice(0, 3), fitted.force.sigma_n),
            ("moment", "nm", slice(3, 6), fitted.force.sigma_nm),
        ):
            seen = gain * wrench[:, part]
            seen = np.where(slants, seen + np.cross(tilt, seen), seen) + draws.noise(sigma, seen.shape)
            found |= _along(name, unit, seen)
    if fitted.tracker:
        found |= _reflectors(state.reflectors[rows], course.time[rows], figures, fitted, draws)
    if fitted.pressure and figures.gas:
        found["gas_pressure_pa"] = draws.stepped(state.pull[rows] / figures.gas.area, fitted.pressure.resolution_pa)
    return found


def _reflectors(places: Array, time: Array, figures: Figures, fitted: Instruments, draws: Draws) -> Columns:
    tracker = fitted.tracker
    assert tracker
    seen = places + draws.error(tracker.placement_sigma_m, places.shape[1:])
    distance = np.linalg.norm(seen - np.array(tracker.position_m), axis=2, keepdims=True)
    seen = seen + draws.noise(tracker.sigma_per_distance, seen.shape) * distance
    way = draws.error(1.0, (3,))
    drift = tracker.drift_m_per_h * way / (float(np.linalg.norm(way)) or 1.0)
    turn = figures.readout.turn + draws.error(tracker.frame_sigma_rad, (3,))
    shift = figures.readout.shift + draws.error(tracker.frame_sigma_m, (3,))
    seen = seen + np.cross(turn, seen) + shift + time[:, None, None] / HOUR * drift
    found: Columns = {}
    for k in range(seen.shape[1]):
        found |= _along(f"reflector_{k + 1}", "m", seen[:, k])
    return found


def _along(quantity: str, unit: str, values: Array) -> Columns:
    return {f"{quantity}_{axis}_{unit}": values[:, i] for i, axis in enumerate("xyz")}


def _numbered(quantity: str, unit: str, values: Array) -> Columns:
    return {f"{quantity}_{j + 1}_{unit}": values[:, j] for j in range(values.shape[1])}
