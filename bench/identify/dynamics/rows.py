"""The equations of one drive, of all stretches, with the columns that depend on the parameters themselves."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from bench.identify.arm import Arm
from bench.identify.dynamics.band import Band, low_pass
from bench.identify.dynamics.curves import Curves
from bench.identify.dynamics.equations import DRIVE_COLUMNS, GAS_SHAPE, Equations
from bench.identify.dynamics.parameters import Layout
from bench.identify.dynamics.regressor import N_INERTIAL, payload_columns
from bench.record.campaign import Array
from bench.robot.nominal_dynamics import NominalDynamics

LEAN = slice(-3, -1)  # exact: columns of either lean, before that of the gain


@dataclass(frozen=True)
class DriveRows:
    """Equations of one drive in which it moves; R of them, for q of the parameters.

    Attributes:
        drive: Its index.
        index: Shape (q,), which parameters they hold; the last is the gain of the drive's torque.
        constant: Shape (R, q), factors of the parameters; those of the gain are zero.
        gas: Which columns are errors of the gas law's shape, per unit of gas amount; empty without gas.
        leaning: Shape (R, 2, m + 1), what the first m of the parameters, and the known mass, weigh across gravity, per
            unit of how far it leans; (R, 0, m + 1) where it does not.
        known: Shape (R,) [Nm], torque for the known load.
        torque: Filtered torque of each stretch, as curves that the rows read [Nm].
        segment: Shape (R,), number of the uninterrupted piece of motion that a row belongs to.
        stretch: Shape (R,), index of its stretch.
        instant: Shape (R,), index of its thinned instant in the stretch.
    """

    drive: int
    index: NDArray[np.int64]
    constant: Array
    gas: slice
    leaning: Array
    known: Array
    torque: Curves
    segment: NDArray[np.int64]
    stretch: NDArray[np.int64]
    instant: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.constant)

    def response(self, delay: float) -> Array:
        """Return the torque that the parameters explain, shape (R,) [Nm], read `delay` [s] later than the angles."""
        return self.torque.at(delay) - self.known

    def model(self, parameters: Array) -> Array:
        """Return the torque that parameters, shape (p,), predict, gain included and known load not, shape (R,)."""
        own = parameters[self.index].copy()
        gain, own[-1] = own[-1], 0.0
        return np.asarray((1 + gain) * (self._at(parameters) @ own))

    def factors(self, parameters: Array) -> Array:
        """Return the factors of the parameters about given ones, shape (R, q).

        An error of the gas law's shape counts by the gas there is, the gain by the whole torque, and masses by gravity
        as it leans.
        """
        found = self._at(parameters)
        own = parameters[self.index].copy()
        own[-1] = 0.0
        found[:, -1] = found @ own
        if self._leans:
            found[:, : self._heavy] += self._across(own)
        return found

    def twice(self, parameters: Array) -> Array:
        """Return what factors about parameters times these exceed the model by, shape (R,) [Nm].

        What weighs across a gravity that leans goes with the lean and with masses, so both have it.
        """
        own = parameters[self.index]
        return self._across(own) @ own[: self._heavy] if self._leans else np.zeros(len(self))

    @property
    def _leans(self) -> bool:
        return bool(self.leaning.shape[1])

    @property
    def _heavy(self) -> int:
        """How many of the first parameters weigh anything."""
        return int(self.leaning.shape[2]) - 1

    def _across(self, own: Array) -> Array:
        """Return what the parameters of links and payloads weigh more because gravity leans, shape (R, m)."""
        return np.asarray(np.einsum("rlm,l->rm", self.leaning[:, :, :-1], own[LEAN]))

    def _at(self, parameters: Array) -> Array:
        found = self.constant.copy()
        if self.gas.stop > self.gas.start:
            found[:, self.gas] *= parameters[self.index[self.gas.start - 1]]
        if self._leans:
            found[:, LEAN] = self.leaning @ np.append(parameters[self.index[: self._heavy]], 1.0)
        return found


def drive_rows(
    equations: Sequence[Equations], drive: int, layout: Layout, band: Band, arm: Arm, nominal: NominalDynamics
) -> DriveRows:
    """Return the equations of one drive in which it moves."""
    body, payload = payload_columns(arm, nominal.load_point)
    own = slice(
        layout.drives.start + len(DRIVE_COLUMNS) * drive, layout.drives.start + len(DRIVE_COLUMNS) * (drive + 1)
    )
    has_gas = layout.has_gas and nominal.counterbalance is not None and nominal.counterbalance.joint == drive
    every = np.arange(layout.size)
    loads = np.concatenate([np.empty(0, dtype=np.int64), *(every[one] for one in layout.payloads)])
    parts = [every[layout.links], loads, every[own], *([every[layout.gas]] if has_gas else [])]
    index = np.concatenate([*parts, every[layout.softness], every[layout.lean], [layout.gain.start + drive]])
    shape = sum(map(len, parts)) - len(GAS_SHAPE)
    used = [np.flatnonzero(part.moves[:, drive]) for part in equations]
    tables, leaning, segments, n_segments = [], [], [], 0
    for part, rows in zip(equations, used, strict=True):
        links = part.links[rows, drive]
        across = part.leaning[rows, drive]
        carried = np.zeros((len(rows), len(loads)))
        carried_across = np.zeros((*across.shape[:2], len(loads)))
        if layout.has_payload:
            inside = np.isin(loads, every[layout.payload_in(part.samples.recording)])
            of_body = slice(N_INERTIAL * body, N_INERTIAL * (body + 1))
            carried[:, inside] = links[:, of_body] @ payload
            carried_across[:, :, inside] = across[:, :, of_body] @ payload
        leaning.append(np.concatenate([across[:, :, :-1], carried_across, across[:, :, -1:]], axis=2))
        gas = part.gas[rows] if has_gas else np.zeros((len(rows), 0))
        lean_and_gain = np.zeros((len(rows), 2 + 1))
        own_factors = part.drives[rows, drive], gas, part.winding[rows, drive]
        tables.append(np.hstack([links, carried, *own_factors, lean_and_gain]))
        breaks = np.concatenate([[0], np.cumsum(np.diff(rows) > 1)])[: len(rows)]
        segments.append(breaks + n_segments)
        n_segments += int(breaks[-1]) + 1 if len(rows) else 0
    return DriveRows(
        drive=drive,
        index=index,
        constant=np.vstack(tables),
        gas=slice(shape, shape + len(GAS_SHAPE)) if has_gas else slice(0, 0),
        leaning=np.concatenate(leaning),
        known=np.concatenate([part.known[rows, drive] for part, rows in zip(equations, used, strict=True)]),
        torque=Curves.of(
            [_curve(part, drive, band) for part in equations],
            [part.time[rows] for part, rows in zip(equations, used, strict=True)],
        ),
        segment=np.concatenate(segments).astype(np.int64),
        stretch=np.repeat(np.arange(len(used)), [len(rows) for rows in used]),
        instant=np.concatenate(used),
    )


def _curve(part: Equations, drive: int, band: Band) -> CubicSpline:
    torque = part.samples.torque[:, drive]
    filtered = low_pass(np.where(np.isfinite(torque), torque, 0.0), part.samples.rate, band.cutoff_hz)
    return CubicSpline(part.samples.time, filtered)


def rows_of(
    stretches: Sequence[Equations], layout: Layout, band: Band, arm: Arm, nominal: NominalDynamics
) -> tuple[DriveRows, ...]:
    """Return the equations of each drive, from stretches of thinned ones."""
    return tuple(drive_rows(stretches, j, layout, band, arm, nominal) for j in range(layout.n))
