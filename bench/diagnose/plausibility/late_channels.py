"""Channels with another clock than the encoders: what they show follows the model's motion, but late.

To first order what a channel reads is late by d where it lacks d times its rate of change; the sign of an error of the
model does not turn with the direction of the motion, that of a delay does.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from bench.diagnose.plausibility.drive_looks import LEVEL, TOLD, Factor, inflation
from bench.diagnose.plausibility.drive_picture import LEAST, DrivePicture, payload_products
from bench.diagnose.plausibility.physical_fit import HALF
from bench.diagnose.plausibility.rates import rates_of
from bench.diagnose.replay.instants import at_each_instant
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.world import NOMINAL
from bench.record.campaign import Array

SURE = float(ndtri((1 + LEVEL) / 2))  # derived: standard errors at the ends of that interval


@dataclass(frozen=True)
class Late:
    """A channel that is late.

    Attributes:
        column: Its name.
        delay: By how much [s]; negative: it is early.
        explained: Of the variance that the model leaves.
    """

    column: str
    delay: Factor
    explained: float

    @property
    def explains_most(self) -> bool:
        """Whether it explains more than it leaves."""
        return self.explained > HALF


def as_if_in_time(replay: Replay, late: Sequence[Late], observed: Array, nominal: Array) -> Array:
    """Return readings, shape (T, c), with reflectors that are late as if they were not, to first order.

    Args:
        replay: Of segments with these readings.
        late: Which reflectors are late.
        observed: Shape (T, c).
        nominal: Shape (T, c), what the nominal model has instead.
    """
    result = observed.copy()
    rates = np.nan_to_num(rates_of(replay.segments, nominal))
    for one in late:
        index = next(q.index for q in replay.quantities if q.column == one.column)
        for c, quantity in enumerate(replay.quantities):
            if quantity.kind == "reflector" and quantity.index == index:
                result[:, c] += one.delay.value * rates[:, c]
    return result


def late_reflectors(replay: Replay) -> Iterator[Late]:
    """Yield by how much each reflector is late, all axes together; nothing where its speed goes with its place.

    At one speed along a line, or along an arc in one direction, a delay looks like an offset, or a wrong joint zero.

    Args:
        replay: Of segments with readings of reflectors.
    """
    nominal, observed, moving = _beside_nominal(replay)
    for k in sorted({q.index for q in replay.quantities if q.kind == "reflector"}):
        columns = [c for c, q in enumerate(replay.quantities) if q.kind == "reflector" and q.index == k]
        place = nominal[:, columns]
        speed = rates_of(replay.segments, place)
        missing = observed[:, columns] - place
        rows = moving & np.all(np.isfinite(missing) & np.isfinite(speed), axis=1)
        if rows.sum() < LEAST:
            continue
        missing, speed, place, segment = missing[rows], speed[rows], place[rows], _segments(replay)[rows]
        fast = float(np.sqrt(np.mean(speed**2)))
        for one in np.unique(segment):  # the frame, and what the model lacks throughout
            for part in (missing, speed, place):
                part[segment == one] -= np.mean(part[segment == one], axis=0)
        # what goes with the place is an error of the frame or of zeros of joints: there and back alike
        missing, speed = (part - place @ np.linalg.lstsq(place, part)[0] for part in (missing, speed))
        if np.sqrt(np.mean(speed**2)) > TOLD * fast:
            yield _late(replay.quantities[columns[0]].column, missing.ravel(), speed.ravel())


def late_gauges(replay: Replay) -> Iterator[Late]:
    """Yield by how much the gauge is late, with a gain and a zero of its own.

    Args:
        replay: Of segments with readings of gauges.
    """
    nominal, observed, moving = _beside_nominal(replay)
    for c, quantity in enumerate(replay.quantities):
        if quantity.kind != "gas_pressure":
            continue
        pressure = nominal[:, c]
        rate = rates_of(replay.segments, pressure[:, None])[:, 0]
        rows = moving & np.isfinite(observed[:, c]) & np.isfinite(rate)
        if rows.sum() < LEAST or not np.any(rate[rows]):
            continue
        # friction of the seal, which a gauge of the rod's force shows, turns with the motion as a delay does
        parts = np.stack([pressure, np.ones_like(pressure), np.sign(rate)], axis=1)[rows]
        parts = parts / np.maximum(np.linalg.norm(parts, axis=0), 1e-12)
        missing, own = (part - parts @ np.linalg.lstsq(parts, part)[0] for part in (observed[rows, c], rate[rows]))
        gain = float(np.median(observed[rows, c] / pressure[rows]))
        if gain > 0 and np.sqrt(np.mean(own**2)) > TOLD * float(np.sqrt(np.mean(rate[rows] ** 2))):
            yield _late(quantity.column, missing / gain, own)


def late_drives(replay: Replay, picture: DrivePicture, at_rest: Array) -> Iterator[Late]:
    """Yield by how much each drive's channel is late, beside what a payload and an inertia may make of its torque.

    Viscous friction that is read late is an inertia, and a payload whose moments the model lacks is late on one drive
    and early on another. So a payload is free with all of its moments and products, and so is the inertia that a drive
    itself turns.

    Args:
        replay: Of segments with readings of drives.
        picture: What they did.
        at_rest: Shape (T, n) [Nm], what the model needs without motion: gravity and inertia have factors of their own.
    """
    segment, products = _segments(replay), payload_products(replay)
    turns = rates_of(replay.segments, picture.velocity)
    turns = np.where(np.isfinite(turns), turns, 0.0)  # at rest nothing turns
    for j, name in enumerate(picture.names):
        rows = np.isfinite(picture.observed[:, j]) & ~picture.standing[:, j]
        if not name or rows.sum() < LEAST:
            continue
        columns = np.column_stack([picture.columns(j), at_rest[:, j], turns[:, j], products[:, j]])
        y = picture.observed[:, j]
        scale = np.maximum(np.linalg.norm(columns[rows], axis=0), 1e-12)
        fitted = columns / scale @ np.linalg.lstsq(columns[rows] / scale, y[rows])[0]
        rate = rates_of(replay.segments, fitted[:, None])[:, 0]
        # across a turn the friction jumps: no rate is told there
        turned = np.sign(picture.velocity[:, j])
        inner = np.zeros(len(y), dtype=np.bool_)
        inner[1:-1] = (
            (turned[1:-1] == turned[:-2])
            & (turned[1:-1] == turned[2:])
            & (segment[1:-1] == segment[:-2])
            & (segment[1:-1] == segment[2:])
        )
        kept = rows & inner & np.isfinite(rate)
        if kept.sum() >= LEAST:
            others = columns[kept] / scale
            own = rate[kept] - others @ np.linalg.lstsq(others, rate[kept])[0]
            rest = y[kept] - others @ np.linalg.lstsq(others, y[kept])[0]
            yield _late(name, rest, own, int(np.linalg.matrix_rank(others)))


def _beside_nominal(replay: Replay) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Return what the nominal model has (T, c), what was observed (T, c), and where anything moves (T,)."""
    trace = replay.trace(NOMINAL)
    return replay.read(NOMINAL, trace), replay.observed, np.any(trace.q_velocity != 0, axis=1)


def _late(column: str, missing: Array, rate: Array, fitted: int = 0) -> Late:
    """Return by how much a channel is late, of which so many numbers were fitted before."""
    power = float(rate @ rate)
    free = len(missing) - fitted - 1
    if power == 0 or free < 1:
        return Late(column, Factor(np.nan, np.inf), 0.0)
    delay = -float(missing @ rate) / power
    rest, before = missing + delay * rate, float(missing @ missing)
    explained = 1 - float(rest @ rest) / before if before else 0.0
    return Late(column, Factor(delay, float(np.sqrt(rest @ rest / free * inflation(rest) / power))), explained)


def _segments(replay: Replay) -> NDArray[np.intp]:
    """Return the index of the segment of each instant, shape (T,)."""
    return at_each_instant(replay.segments, np.arange(len(replay.segments)))
