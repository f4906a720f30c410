"""What the instruments of the second plant show: errors of the whole campaign, noise with every reading, steps."""

from dataclasses import dataclass

import numpy as np

from bench.robot.instruments import Instruments
from bench.second.course import Course
from bench.second.errors import Errors
from bench.second.figures import Array, Figures
from bench.second.kinematics import frames
from bench.second.plant import HOUR, State

Columns = dict[str, Array]


@dataclass(frozen=True, eq=False)
class Draws:
    """Source of noise; `quiet` instruments have none.

    Attributes:
        rng: Random numbers.
        tails: Degrees of freedom of Student's t for the noise, above 2; None for normal noise.
        quiet: No noise and no resolution.
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

    def stepped(self, values: Array, step: float) -> Array:
        """Return values in steps of a resolution; 0: infinitely fine."""
        if self.quiet or step == 0:
            return values
        steps: Array = step * np.round(values / step)
        return steps


def columns_of(
    state: State, course: Course, figures: Figures, fitted: Instruments, constants: Array, errors: Errors, draws: Draws
) -> Columns:
    """Return the columns of all K readings.

    Args:
        state: The truth along the course.
        course: Which instants are read, and what hangs on.
        figures: The arm, for what its instruments get wrong.
        fitted: Which instruments there are, and how good.
        constants: Shape (n,) [Nm/A], torque constants as the lab knows them.
        errors: What the instruments get wrong beside that.
        draws: Of noise.
    """
    rows, n, out = course.read, figures.n, figures.readout
    found: Columns = {}
    found |= _numbered("q_cmd", "rad", course.command[rows])
    if fitted.encoder:
        seen = state.q[rows] + out.zero - out.delay * course.velocity[rows] + errors.encoder_offset
        found |= _numbered("q_motor", "rad", draws.stepped(seen, fitted.encoder.resolution_rad))
    if fitted.current:
        seen = state.torque[rows] / constants * (1 + errors.current_gain) / (1 + out.torque_constant)
        seen = seen + errors.current_offset + draws.noise(fitted.current.sigma_a, (len(rows), n))
        seen = np.sign(seen) * np.maximum(np.abs(seen) - out.dead_band, 0)
        seen = out.currents.shows(seen, course.time[rows] / HOUR)
        found |= _numbered("current", "a", draws.stepped(seen, fitted.current.resolution_a))
    wrench = course.wrench[rows]
    load = wrench[:, :3] + course.payload[rows, None] * figures.gravity
    found |= _along("load", "n", load)
    if fitted.force:
        gain = (1 + figures.hung_change) * (1 + errors.force_gain) * (1 + out.force_gain)
        tilt = errors.force_tilt + out.force_tilt
        slants = np.hypot(wrench[:, :1], wrench[:, 1:2]) > 1e-6 * np.abs(wrench[:, 2:3])  # a hanging load points down
        for name, unit, part, sigma in (
            ("force", "n", slice(0, 3), fitted.force.sigma_n),
            ("moment", "nm", slice(3, 6), fitted.force.sigma_nm),
        ):
            seen = gain * wrench[:, part]
            seen = np.where(slants, seen + np.cross(tilt, seen), seen) + draws.noise(sigma, seen.shape)
            found |= _along(name, unit, seen)
    if fitted.tracker:
        axes = frames(figures, state.theta[rows]).axes
        nests = [axes[:, spot.joint] @ at for spot, at in zip(figures.reflectors, errors.placement, strict=True)]
        placed = state.reflectors[rows] + np.stack(nests, axis=1)
        found |= _reflectors(placed, course.time[rows], figures, fitted, errors, draws)
    if fitted.pressure and figures.gas:
        seen = out.gauge.shows(state.pull[rows] / figures.gas.area, course.time[rows] / HOUR)
        found["gas_pressure_pa"] = draws.stepped(seen, fitted.pressure.resolution_pa)
    return found


def _reflectors(
    places: Array, time: Array, figures: Figures, fitted: Instruments, errors: Errors, draws: Draws
) -> Columns:
    tracker, out = fitted.tracker, figures.readout
    assert tracker
    distance = np.linalg.norm(places - np.array(tracker.position_m), axis=2, keepdims=True)
    seen = places + draws.noise(tracker.sigma_per_distance, places.shape) * distance
    way = errors.drift_direction
    drift = out.creep + tracker.drift_m_per_h * way / (float(np.linalg.norm(way)) or 1.0)
    seen = (1 + out.scale) * seen + np.cross(out.turn + errors.frame_rotation, seen) + out.shift + errors.frame_shift
    seen = seen + time[:, None, None] / HOUR * (drift + np.cross(out.leaning, seen))
    found: Columns = {}
    for k in range(seen.shape[1]):
        found |= _along(f"reflector_{k + 1}", "m", seen[:, k])
    return found


def _along(quantity: str, unit: str, values: Array) -> Columns:
    return {f"{quantity}_{axis}_{unit}": values[:, i] for i, axis in enumerate("xyz")}


def _numbered(quantity: str, unit: str, values: Array) -> Columns:
    return {f"{quantity}_{j + 1}_{unit}": values[:, j] for j in range(values.shape[1])}
