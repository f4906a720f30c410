"""What the instruments make of the truth: noise, gain, offset, resolution. A layer outside the physics.

Systematic errors (gain, offset, frame, placement) are drawn once when the instruments are set up; noise is drawn with
every reading. The same trace read by instruments of another seed is another measurement of the same physics.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from bench.robot.compiled import CompiledRobot
from bench.robot.figures import Instruments as InstrumentFigures
from bench.simulate.plant import Trace

Array = NDArray[np.float64]

HOUR = 3600.0  # [s]
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
        placement: Shape (r, 3) [m], where a reflector sits in its nest against where it should.
        drift_direction: Shape (3,), unit vector of the tracker's drift.
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
        link_encoder = self.figures.link_encoder
        joints = [drive.joint for drive in compiled.robot.figures.drives]
        self._has_link_encoder = np.isin(joints, link_encoder.joints if link_encoder else ())
        torque_constant_error = np.array([drive.torque_constant_error for drive in compiled.robot.figures.drives])
        self.errors = _draw(self.figures, torque_constant_error, len(compiled.robot.figures.reflectors), rng)

    def move_reflector(self) -> None:
        """Carry the moving reflector round all nests but the first again: a new draw of where it sits in each.

        The first reflector, on the reference point, is one of its own and stays where it is.
        """
        if self._rng is not None and self.figures.tracker:
            placement = self.errors.placement.copy()
            placement[1:] = self.figures.tracker.placement_sigma_m * self._rng.standard_normal(placement[1:].shape)
            self.errors = replace(self.errors, placement=placement)

    def read(self, trace: Trace) -> Reading:
        """Return what the instruments show for every instant of `trace`."""
        f = self.figures
        instants, n = trace.q.shape
        missing = np.full((instants, 3), np.nan)
        force, moment = (missing, missing) if f.force is None else self._wrench(trace.wrench)
        return Reading(
            time=trace.time,
            q_motor=np.full((instants, n), np.nan) if f.encoder is None else self._encoder(trace.q),
            q_link=np.full((instants, n), np.nan) if f.link_encoder is None else self._link_encoder(trace.theta),
            current=np.full((instants, n), np.nan) if f.current is None else self._current(trace.motor_torque),
            torque=np.full((instants, n), np.nan) if f.torque is None else self._torque(trace.motor_torque),
            force=force,
            moment=moment,
            reflectors=np.full_like(trace.reflectors, np.nan) if f.tracker is None else self._tracker(trace),
            gas_pressure=missing[:, 0] if f.pressure is None else self._pressure(trace.counterbalance_force),
            gas_temperature=missing[:, 0],  # thermometers belong to the lab
        )

    def _noise(self, sigma: float, shape: tuple[int, ...]) -> Array | float:
        if self._rng is None:
            return 0.0
        if self._tails is None:
            return sigma * self._rng.standard_normal(shape)
        unit = np.sqrt((self._tails - 2) / self._tails)
        noise: Array = sigma * unit * self._rng.standard_t(self._tails, shape)
        return noise

    def _round(self, values: Array, resolution: float) -> Array:
        return values if self._rng is None or resolution == 0 else resolution * np.round(values / resolution)

    def _encoder(self, q: Array) -> Array:
        assert self.figures.encoder
        return self._round(q + self.errors.encoder_offset, self.figures.encoder.resolution_rad)

    def _current(self, torque: Array) -> Array:
        figures = self.figures.current
        assert figures
        true = torque / self._torque_constant
        seen = true * (1 + self.errors.current_gain) + self.errors.current_offset
        return self._round(seen + self._noise(figures.sigma_a, seen.shape), figures.resolution_a)

    def _link_encoder(self, theta: Array) -> Array:
        figures = self.figures.link_encoder
        assert figures
        seen = self._round(theta + self.errors.link_encoder_offset, figures.resolution_rad)
        return np.where(self._has_link_encoder, seen, np.nan)

    def _torque(self, torque: Array) -> Array:
        figures = self.figures.torque
        assert figures
        seen = torque * (1 + self.errors.torque_gain) + self.errors.torque_offset
        noise = self._noise(1.0, seen.shape) * np.array(figures.sigma_of(seen.shape[1]))
        return self._round(seen + noise, figures.resolution_nm)

    def _wrench(self, wrench: Array) -> tuple[Array, Array]:
        figures = self.figures.force
        assert figures
        seen = wrench * (1 + self.errors.force_gain)
        force, moment = seen[:, :3], seen[:, 3:]
        slanting = np.hypot(force[:, :1], force[:, 1:2]) > VERTICAL_TOLERANCE * np.abs(force[:, 2:])
        tilt = small_rotation(self.errors.force_tilt)
        force = np.where(slanting, force @ tilt.T, force)
        moment = np.where(slanting, moment @ tilt.T, moment)
        return (
            force + self._noise(figures.sigma_n, force.shape),
            moment + self._noise(figures.sigma_nm, moment.shape),
        )

    def _tracker(self, trace: Trace) -> Array:
        figures = self.figures.tracker
        assert figures
        errors = self.errors
        seen = trace.reflectors + errors.placement
        distance = np.linalg.norm(seen - np.array(figures.position_m), axis=2, keepdims=True)
        drift = figures.drift_m_per_h / HOUR * trace.time[:, None, None] * errors.drift_direction
        noise: Array | float = distance * self._noise(figures.sigma_per_distance, seen.shape)
        turned: Array = seen @ small_rotation(errors.frame_rotation).T
        return turned + errors.frame_shift + drift + noise

    def _pressure(self, force: Array) -> Array:
        figures = self.figures.pressure
        assert figures
        return self._round(force / figures.piston_area_m2, figures.resolution_pa)


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
        encoder_offset=normal(encoder.offset_sigma_rad if encoder else 0.0, (n,)),
        # not drawn where there is none, so that the noise of robots without them stays what it was
        torque_gain=normal(torque.gain_sigma, (n,)) if torque else np.zeros(n),
        torque_offset=normal(torque.offset_sigma_nm, (n,)) if torque else np.zeros(n),
        link_encoder_offset=normal(link_encoder.offset_sigma_rad, (n,)) if link_encoder else np.zeros(n),
    )
