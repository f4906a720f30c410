"""What the instruments make of the truth: noise, gain, offset, resolution. A layer outside the physics.

Systematic errors (gain, offset, frame, placement) are drawn once when the instruments are set up, about those that the
robot's figures hold as fitted; noise is drawn with every reading. The same trace read by instruments of another seed is
another measurement of the same physics.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from bench.record.units import HOUR
from bench.robot.compiled import CompiledRobot
from bench.robot.instruments import Instruments as InstrumentFigures
from bench.robot.turned_sites import TurnedSites
from bench.simulate.fitted_errors import fitted_errors
from bench.simulate.trace import Trace

Array = NDArray[np.float64]

VERTICAL_TOLERANCE = 1e-6  # a load is hanging when its sideways part is below this share; its direction is then known


@dataclass(frozen=True)
class Reading:
    """Instrument readings at T instants; a quantity whose instrument is missing is nan.

    Attributes:
        time: Shape (T,) [s].
        q_motor: Shape (T, n) [rad].
        q_link: Shape (T, n) [rad], nan for joints without a secondary encoder.
        current: Shape (T, n) [A].
        torque: Shape (T, n) [Nm], motor torque that the drives report, reflected to the joint.
        force: Shape (T, 3) [N], world axes.
        moment: Shape (T, 3) [Nm], world axes, about the load point.
        reflectors: Shape (T, r, 3) [m], tracker readings in the base frame.
        gas_pressure: Shape (T,) [Pa], above ambient.
        gas_temperature: Shape (T,) [K], in the counterbalance.
    """

    time: Array
    q_motor: Array
    q_link: Array
    current: Array
    torque: Array
    force: Array
    moment: Array
    reflectors: Array
    gas_pressure: Array
    gas_temperature: Array

    def __getitem__(self, rows: slice | Sequence[int]) -> Self:
        return type(self)(**{f.name: getattr(self, f.name)[rows] for f in fields(self)})

    @classmethod
    def concatenate(cls, parts: Sequence["Reading"]) -> "Reading":
        """Join readings end to end."""
        return cls(**{f.name: np.concatenate([getattr(part, f.name) for part in parts]) for f in fields(cls)})


@dataclass(frozen=True)
class SystematicErrors:
    """One draw of what stays wrong over a campaign; all zero for perfect instruments.

    Attributes:
        current_gain: Shape (n,), relative; error of the reading and of the torque constant together.
        current_offset: Shape (n,) [A].
        force_gain: Relative, one sensor, all axes.
        force_tilt: Shape (3,) [rad], rotation vector of the measured against the true direction of a slanting load.
        frame_shift: Shape (3,) [m], tracker frame against base frame.
        frame_rotation: Shape (3,) [rad], rotation vector of the same.
        placement: Shape (r, 3) [m], where a reflector sits in its nest against where it should, in the axes of the
            body that carries it.
        drift_direction: Shape (3,), unit vector of the tracker's drift.
        frame_drift: Shape (3,) [m/h], drift of the tracker beside that.
        encoder_offset: Shape (n,) [rad].
        torque_gain: Shape (n,), relative.
        torque_offset: Shape (n,) [Nm].
        link_encoder_offset: Shape (n,) [rad].
    """

    current_gain: Array
    current_offset: Array
    force_gain: float
    force_tilt: Array
    frame_shift: Array
    frame_rotation: Array
    placement: Array
    drift_direction: Array
    frame_drift: Array
    encoder_offset: Array
    torque_gain: Array
    torque_offset: Array
    link_encoder_offset: Array


class Instruments:
    """The instruments around one robot.

    Args:
        compiled: The robot; its figures say which instruments there are and how good they are.
        rng: Source of systematic errors and noise; None makes perfect instruments (no noise, no error, no resolution).
        tails: Degrees of freedom, above 2, of Student's t from which noise is drawn, with the standard deviation of the
            figures. None: normal noise.
    """

    def __init__(self, compiled: CompiledRobot, rng: np.random.Generator | None, tails: float | None = None) -> None:
        self.figures: InstrumentFigures = compiled.robot.figures.instruments
        self._rng = rng
        self._tails = tails
        self._torque_constant = compiled.torque_constant
        self._sites = TurnedSites.reflectors_of(compiled)
        link_encoder = self.figures.link_encoder
        joints = [drive.joint for drive in compiled.robot.figures.drives]
        self._has_link_encoder = np.isin(joints, link_encoder.joints if link_encoder else ())
        torque_constant_error = np.array([drive.torque_constant_error for drive in compiled.robot.figures.drives])
        self.errors = _draw(self.figures, torque_constant_error, len(compiled.robot.figures.reflectors), rng)
        self._fitted_nests: Array = np.zeros_like(self.errors.placement)
        if rng is not None:
            fitted = fitted_errors(compiled.robot.figures)
            self.errors = replace(self.errors, **{name: getattr(self.errors, name) + x for name, x in fitted.items()})
            self._fitted_nests = np.asarray(fitted["placement"])

    @property
    def is_perfect(self) -> bool:
        """Whether there is no noise, no error and no resolution."""
        return self._rng is None

    def move_reflector(self) -> None:
        """Carry the moving reflector round all nests but the first again: a new draw of where it sits in each.

        The first reflector, on the reference point, is one of its own and stays where it is.
        """
        if self._rng is not None and self.figures.tracker:
            placement = self.errors.placement.copy()
            drawn = self._rng.standard_normal(placement[1:].shape)
            placement[1:] = self._fitted_nests[1:] + self.figures.tracker.placement_sigma_m * drawn
            self.errors = replace(self.errors, placement=placement)

    def read(self, trace: Trace) -> Reading:
        """Return what the instruments show for every instant of `trace`."""
        seen = self.systematic(trace)
        for name, sigma in self.spreads().items():
            noise = sigma * self.draw(seen[name].shape)
            if name == "reflectors":
                noise = np.linalg.norm(self.away(trace.reflectors), axis=2, keepdims=True) * noise
            seen[name] = seen[name] + noise
        for name, resolution in self.resolutions().items():
            seen[name] = resolution * np.round(seen[name] / resolution)
        instants, n = trace.q.shape
        shapes = {"force": (instants, 3), "moment": (instants, 3), "reflectors": trace.reflectors.shape}
        shapes |= {"gas_pressure": (instants,), "gas_temperature": (instants,)}  # thermometers belong to the lab
        names = (f.name for f in fields(Reading) if f.name != "time")
        missing = {name: np.full(shapes.get(name, (instants, n)), np.nan) for name in names if name not in seen}
        return Reading(time=trace.time, **seen, **missing)

    def systematic(self, trace: Trace) -> dict[str, Array]:
        """Return what the instruments would show without noise and infinitely fine, by fields of `Reading`.

        Those that are missing have no entry.
        """
        seen = self.linear(trace)
        if self.figures.tracker:
            seen["reflectors"] = seen["reflectors"] + self.nests(trace.theta)
        return seen

    def nests(self, theta: Array) -> Array:
        """Return what sitting off in nests adds to the tracker's readings, shape (T, r, 3) [m]; theta: shape (T, n)."""
        placed = self._sites.moved(theta, self.errors.placement)
        return np.asarray(placed @ small_rotation(self.errors.frame_rotation).T, dtype=np.float64)

    def nests_at(self, theta: Array, turn: Array) -> Array:
        """Return the same of one instant, shape (r, 3), as fast as an environment asks it.

        Args:
            theta: Shape (n,), of the joints.
            turn: Shape (3, 3), of the frame.
        """
        return np.asarray(self._sites.at(theta, self.errors.placement) @ turn.T, dtype=np.float64)

    def linear(self, trace: Trace, slants: bool | None = None) -> dict[str, Array]:
        """Return what `systematic` does but for the nests, which but for `slants` is a linear function of `trace`.

        Args:
            trace: T instants.
            slants: Whether loads slant; None: as they do.
        """
        f, errors = self.figures, self.errors
        seen: dict[str, Array] = {}
        if f.encoder:
            seen["q_motor"] = trace.q + errors.encoder_offset
        if f.link_encoder:
            seen["q_link"] = np.where(self._has_link_encoder, trace.theta + errors.link_encoder_offset, np.nan)
        if f.current:
            true = trace.motor_torque / self._torque_constant
            seen["current"] = true * (1 + errors.current_gain) + errors.current_offset
        if f.torque:
            seen["torque"] = trace.motor_torque * (1 + errors.torque_gain) + errors.torque_offset
        if f.force:
            wrench = trace.wrench * (1 + errors.force_gain)
            tilt = small_rotation(errors.force_tilt)
            slanting = is_slanting(trace.wrench) if slants is None else slants
            seen["force"] = np.where(slanting, wrench[:, :3] @ tilt.T, wrench[:, :3])
            seen["moment"] = np.where(slanting, wrench[:, 3:] @ tilt.T, wrench[:, 3:])
        if f.tracker:
            turned = trace.reflectors @ small_rotation(errors.frame_rotation).T
            rate = f.tracker.drift_m_per_h * errors.drift_direction + errors.frame_drift
            drift = trace.time[:, None, None] / HOUR * rate
            seen["reflectors"] = turned + errors.frame_shift + drift
        if f.pressure:
            seen["gas_pressure"] = trace.gas_force / f.pressure.piston_area_m2
        return seen

    def spreads(self) -> dict[str, Array | float]:
        """Return the standard deviations of the noise in the order in which it is drawn; none for perfect instruments.

        Names are those of `systematic`; for "reflectors" it is relative to the distance from the tracker.
        """
        f = self.figures
        if self._rng is None:
            return {}
        known: dict[str, Array | float] = {}
        known |= {"force": f.force.sigma_n, "moment": f.force.sigma_nm} if f.force else {}
        known |= {"current": f.current.sigma_a} if f.current else {}
        known |= {"torque": np.array(f.torque.sigma_of(len(self._torque_constant)))} if f.torque else {}
        return known | ({"reflectors": f.tracker.sigma_per_distance} if f.tracker else {})

    def resolutions(self) -> dict[str, float]:
        """Return the smallest steps of instruments that have one; none for perfect instruments."""
        f = self.figures
        if self._rng is None:
            return {}
        known = {
            "q_motor": f.encoder.resolution_rad if f.encoder else 0.0,
            "q_link": f.link_encoder.resolution_rad if f.link_encoder else 0.0,
            "current": f.current.resolution_a if f.current else 0.0,
            "torque": f.torque.resolution_nm if f.torque else 0.0,
            "gas_pressure": f.pressure.resolution_pa if f.pressure else 0.0,
        }
        return {name: resolution for name, resolution in known.items() if resolution}

    def draw(self, shape: tuple[int, ...] | int) -> Array:
        """Draw noise with a standard deviation of one; perfect instruments have none to draw."""
        assert self._rng is not None
        if self._tails is None:
            return self._rng.standard_normal(shape)
        noise: Array = np.sqrt((self._tails - 2) / self._tails) * self._rng.standard_t(self._tails, shape)
        return noise

    def away(self, reflectors: Array) -> Array:
        """Return where reflectors, shape (T, r, 3) [m], are as seen from the tracker, in world axes."""
        assert self.figures.tracker
        seen: Array = reflectors + self.errors.placement - np.array(self.figures.tracker.position_m)
        return seen


def is_slanting(wrench: Array) -> NDArray[np.bool_]:
    """Return whether loads, shape (T, 6) [N, Nm] or (T, 3) [N], pull aside, shape (T, 1)."""
    aside: NDArray[np.bool_] = np.hypot(wrench[:, :1], wrench[:, 1:2]) > VERTICAL_TOLERANCE * np.abs(wrench[:, 2:3])
    return aside


def small_rotation(vector: Array) -> Array:
    """Return the matrix of a small rotation, shape (3, 3), to first order in the rotation vector, shape (3,) [rad]."""
    x, y, z = vector
    return np.array([[1.0, -z, y], [z, 1.0, -x], [-y, x, 1.0]])


def _draw(
    f: InstrumentFigures, torque_constant_error: Array, r: int, rng: np.random.Generator | None
) -> SystematicErrors:
    n = len(torque_constant_error)

    def normal(sigma: float | Array, shape: tuple[int, ...]) -> Array:
        return np.zeros(shape) if rng is None else sigma * rng.standard_normal(shape)

    current, force, tracker, encoder = f.current, f.force, f.tracker, f.encoder
    torque, link_encoder = f.torque, f.link_encoder
    direction = normal(1.0, (3,))
    size = float(np.linalg.norm(direction))
    return SystematicErrors(
        current_gain=normal(np.hypot(current.gain_sigma, torque_constant_error) if current else 0.0, (n,)),
        current_offset=normal(current.offset_sigma_a if current else 0.0, (n,)),
        force_gain=float(normal(force.gain_sigma if force else 0.0, (1,))[0]),
        force_tilt=normal(force.direction_sigma_rad if force else 0.0, (3,)),
        frame_shift=normal(tracker.frame_sigma_m if tracker else 0.0, (3,)),
        frame_rotation=normal(tracker.frame_sigma_rad if tracker else 0.0, (3,)),
        placement=normal(tracker.placement_sigma_m if tracker else 0.0, (r, 3)),
        drift_direction=direction / size if size else direction,
        frame_drift=np.zeros(3),
        encoder_offset=normal(encoder.offset_sigma_rad if encoder else 0.0, (n,)),
        # not drawn where there is none, so that the noise of robots without them stays what it was
        torque_gain=normal(torque.gain_sigma, (n,)) if torque else np.zeros(n),
        torque_offset=normal(np.array(torque.offset_sigma_of(n)), (n,)) if torque else np.zeros(n),
        link_encoder_offset=normal(link_encoder.offset_sigma_rad, (n,)) if link_encoder else np.zeros(n),
    )
