"""From a campaign to what a replay repeats: motor motion and loads in, with what was measured at the same instants.

A static run is read visit by visit: the pose is approached from its side, then load follows load; repeats become one
mean with its standard error. A motion is cut into bins of constant direction, short against everything that changes.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtri

from bench.diagnose.replay.motion_segments import stretches_of
from bench.diagnose.replay.noise import UNIFORM, Noise
from bench.diagnose.replay.quantities import Quantity
from bench.diagnose.replay.segment_input import AverageExcess, Path, SegmentInput, centre_weights
from bench.diagnose.replay.static_segments import visits_of
from bench.effects.conditions import REFERENCE_K, Conditions
from bench.record.campaign import Array, Campaign, Run
from bench.robot.compiled import CompiledRobot
from bench.simulate.prescribed import Motion

BY_CHANCE = 1e-4  # declared: probability up to which the scatter of repeats is taken for their instrument's
MOST_BINS = 700  # effort: of one run; a replay of so many takes some milliseconds
# effort: Bins times channels of all runs together, for memory: a diagnosis of the HH-150 with all causes takes 33 kB
# for each (1.1 GB with 34,000, 2.3 GB with two such recordings). Ten recordings of a KR300 have 9,000. Only beyond does
# the resolution of a run depend on the others, and what rings may look slow: bins as long as a period of the lowest
# mode made a floor out of level of it (1.3 mrad, 67 nats, in two sound recordings without noise).
MOST_READINGS = 100_000

Index = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Segment:
    """A stretch of one run that is replayed as a whole; T instants that are read, c quantities, n drives.

    Attributes:
        run: Name of the run.
        label: Run, and pose and approach of a static visit.
        is_static: Whether every instant is a rest.
        motion: What the motors did by their encoders, with the instants before that shape friction; `motion.read`
            marks the T instants.
        conditions: Temperatures and payload.
        observed: Shape (T, c); nan where not measured.
        sigma: Shape (T, c), standard error by the instruments' noise, or by the scatter of repeats where an arm swayed.
        standing: Shape (n,) bool, drives that did not move.
        acceleration_error: Shape (T, n), standard deviation of the motors' accelerations, as differentiated.
        drive_error: Shape (2, T, n), the same of links and of rotors as torques of drives have them; None: the same.
        rings: Shape (T,) bool, instants so soon after a jerk that the arm may still ring.
        path: Every sample of the motors; None at rest, and for a motion that nobody measured.
        recording: Name of the recording that the run belongs to.
        average_excess: What the drives' averaged torques have more than those of the averaged motion, by the nominal
            model; None: nothing.
        counted_once: Shape (T, c), by what the variance of readings was raised that were rounded to the same number, so
            that together they count as one; None: by nothing.
        is_known: Whether nobody recorded it: it holds what is known besides, by the lab or an earlier diagnosis.
    """

    run: str
    label: str
    is_static: bool
    motion: Motion
    conditions: Conditions
    observed: Array
    sigma: Array
    standing: NDArray[np.bool_]
    acceleration_error: Array
    rings: NDArray[np.bool_]
    path: Path | None = None
    recording: str = ""
    drive_error: Array | None = None
    counted_once: Array | None = None
    average_excess: AverageExcess | None = None
    is_known: bool = False

    def __len__(self) -> int:
        return len(self.observed)

    def earlier(self, seconds: float) -> "Segment":
        """Return the segment with the motion of some time before, read at the same instants; a rest stays as it is.

        What averaged torques have more is that of its own motion, and stays behind.
        """
        if self.is_static:
            return self
        motion = self.motion
        angles = -seconds * motion.velocity + seconds**2 / 2 * motion.acceleration
        speeds, accelerations = -seconds * motion.acceleration, np.zeros_like(motion.acceleration)
        if self.path is not None:
            moved = self.path.motion_earlier(seconds)
            for known, change in zip((angles, speeds, accelerations), moved, strict=True):
                known[motion.read] = np.where(self.standing, 0.0, change)
        changed = replace(
            motion,
            q=motion.q + angles,
            velocity=motion.velocity + speeds,
            acceleration=motion.acceleration + accelerations,
        )
        return replace(self, motion=changed, average_excess=None)

    def rates_of(self, error: Callable[[Array, Array], Array | None]) -> tuple[Array, Array]:
        """Return what an error of the encoders adds to the speeds and accelerations of the motion, shape (T, n) each.

        Args:
            error: Of angles and speeds, shape (rows, n) each, the error of the angles; None: there is none.
        """
        speeds, accelerations = (np.zeros_like(self.motion.q) for _ in range(2))
        if self.path is not None and not self.is_static:
            wrong = error(self.path.angles, self.path.speeds)
            if wrong is not None:
                drives = np.flatnonzero(np.any(wrong != wrong[0], axis=0) & ~self.standing)  # a constant has no rate
                here = np.ix_(np.flatnonzero(self.motion.read), drives)
                _, speeds[here], accelerations[here] = self.path.motion_of(wrong[:, drives])
        return speeds, accelerations


def segments_of(
    campaign: Campaign, compiled: CompiledRobot, quantities: tuple[Quantity, ...], most_bins: int = MOST_BINS
) -> tuple[Segment, ...]:
    """Return everything in a campaign that can be replayed, in its order.

    Args:
        campaign: A checked campaign.
        compiled: Its robot.
        quantities: What to compare.
        most_bins: How many bins the motion of one run may have.
    """
    noise = Noise(campaign, compiled.robot.figures)
    lasts = {run.name: float(np.ptp(run.columns["time_s"])) for run in campaign.of_kind("motion") if len(run) > 1}
    least = sum(lasts.values()) * len(quantities) / MOST_READINGS
    found: list[Segment] = []
    for run in campaign.runs:
        width = max(lasts.get(run.name, 0.0) / most_bins, least)
        moving = run.kind != "static"
        felt = _torque_noise(run, compiled, quantities, noise) if moving else None
        for segment_input in stretches_of(run, compiled, width, felt) if moving else visits_of(run, compiled):
            observed, sigma = _means(run, segment_input, quantities, noise)
            motion = segment_input.motion
            if not np.any(np.isfinite(observed)):
                continue
            speed = np.max(np.abs(motion.velocity[motion.read]), axis=0)
            found.append(
                Segment(
                    run.name,
                    segment_input.label,
                    run.kind == "static",
                    motion,
                    conditions_of(run, segment_input.rows, compiled.n_joints),
                    observed,
                    sigma,
                    speed == 0.0,
                    segment_input.acceleration_error,
                    segment_input.rings,
                    segment_input.path,
                    run.recording,
                    segment_input.drive_error,
                    average_excess=segment_input.average_excess,
                )
            )
    runs = {run.name: run for run in campaign.runs}
    return _rounded_alike(found, runs, quantities, noise) if found else ()


def _rounded_alike(
    found: list[Segment], runs: Mapping[str, Run], quantities: tuple[Quantity, ...], noise: Noise
) -> tuple[Segment, ...]:
    """Return the segments with readings that were rounded to the same number counted as one.

    A gauge shows the same digit all day while its joint stands; a thousand such readings know no more than one. In a
    bin of motion that runs through k digits rounding averages out, but for a part of the first and the last: 1/k of it.
    """
    sigma = [segment.sigma.copy() for segment in found]
    once = [np.zeros_like(segment.sigma) for segment in found]
    for c, quantity in enumerate(quantities):
        step = noise.rounding(quantity)
        if step == 0.0:
            continue
        seen = np.concatenate([segment.observed[:, c] for segment in found])
        known = np.sort(seen[np.isfinite(seen)])
        half = step / UNIFORM / 2
        for segment, own, more in zip(found, sigma, once, strict=True):
            values = segment.observed[:, c]
            if not np.any(np.isfinite(values)):
                continue  # a run may lack a channel that others have
            alike = np.searchsorted(known, values + half) - np.searchsorted(known, values - half)
            digits = np.ones(len(segment))
            if segment.path and not segment.is_static:
                shown = runs[segment.run].columns[quantity.column]
                digits = np.array([max(1.0, np.ptp(shown[group]) / (2 * half)) for group in segment.path.groups])
            own[:, c] = np.hypot(own[:, c], step * np.sqrt(np.maximum(alike, 1)) / digits)
            more[:, c] = (step / digits) ** 2 * (np.maximum(alike, 1) - 1)
    both = zip(found, sigma, once, strict=True)
    return tuple(replace(segment, sigma=own, counted_once=more) for segment, own, more in both)


def conditions_of(run: Run, rows: Index, n: int) -> Conditions:
    """Return the mean temperatures over some rows; what nobody measured is at its reference, gears as the air."""

    def mean(column: str, otherwise: float = REFERENCE_K) -> float:
        return float(np.mean(run.columns[column][rows])) if column in run.columns else otherwise

    air = mean("ambient_temperature_k")
    return Conditions(
        gear_k=np.array([mean(f"gear_temperature_{i + 1}_k", air) for i in range(n)]),
        winding_k=np.array([mean(f"motor_temperature_{i + 1}_k") for i in range(n)]),
        gas_k=mean("gas_temperature_k"),
        ambient_k=air,
        payload_kg=float(np.mean(run.columns["load_mass_kg"][rows])) if "load_mass_kg" in run.columns else 0.0,
        time_s=run.start_s + (float(np.mean(run.columns["time_s"][rows])) if "time_s" in run.columns else 0.0),
    )


def _means(
    run: Run, segment_input: SegmentInput, quantities: tuple[Quantity, ...], noise: Noise
) -> tuple[Array, Array]:
    """Return mean and standard error of every instant, shape (T, c) each.

    Readings that feel a joint which starts or turns round are left out: friction is between its levels there.
    """
    is_static = run.kind == "static"
    groups = segment_input.groups
    shape = (len(groups), len(quantities))
    mean, sigma = np.full(shape, np.nan), np.full(shape, np.nan)
    weights = [np.full(len(group), 1 / len(group)) if is_static else centre_weights(len(group)) for group in groups]
    plain = tuple(zip(groups, weights, strict=True))
    of_torque = segment_input.path.of_torque if segment_input.path else plain
    any_turning = np.any(segment_input.turning, axis=1)
    present = [c for c, quantity in enumerate(quantities) if quantity.column in run.columns]
    if not present:
        return mean, sigma
    readings = np.stack([run.columns[quantities[c].column] for c in present], axis=1)
    mean[:, present] = [w @ readings[group] for w, group in zip(weights, groups, strict=True)]
    scatter = np.zeros(len(present)) if is_static else noise.of_samples(readings)
    if not is_static:
        scatter = np.maximum(scatter, noise.of_groups(readings, groups))
    for c, values, least in zip(present, readings.T, scatter, strict=True):
        quantity = quantities[c]
        one = noise.beside(quantity, mean[:, c], run, float(least))
        own = of_torque if quantity.is_drive else plain
        mean[:, c] = [w @ values[rows] for rows, w in own]
        # a torque that shares samples with its neighbours is known no better than without them
        alone = [v if len(w) > len(v) else w for (_, w), v in zip(own, weights, strict=True)]
        error = one * np.array([np.linalg.norm(w) for w in alone])
        if is_static:
            error = np.maximum(error, _swayed(values, groups, np.hypot(one, noise.rounding(quantity))))
        sigma[:, c] = np.hypot(error, noise.lasting(quantity))
        turning = segment_input.turning[:, quantity.index] if quantity.is_of_drive else any_turning
        mean[turning, c] = np.nan
    return mean, sigma


def _torque_noise(run: Run, compiled: CompiledRobot, quantities: tuple[Quantity, ...], noise: Noise) -> Array:
    """Return the standard deviation of a sample of what each drive reports, shape (n,) [Nm] or [N]; nan: not read."""
    found = np.full(compiled.n_joints, np.nan)
    for quantity in quantities:
        if quantity.is_drive and quantity.column in run.columns:
            values = run.columns[quantity.column][:, None]
            drive = compiled.robot.figures.drives[quantity.index]
            to_torque = drive.torque_constant_nm_per_a if quantity.kind == "current" else 1.0
            one = noise.beside(quantity, values[:1, 0], run, float(noise.of_samples(values)[0]))
            found[quantity.index] = np.fmin(found[quantity.index], to_torque * one[0])
    return found


def _swayed(values: Array, groups: tuple[Index, ...], one: Array) -> Array:
    """Return the scatter of repeats where they scatter more than chance lets their instrument, else 0; one per group.

    An arm that was read before it had settled sways; neighbours err alike then, so their mean is no better than one.
    """
    found = np.zeros(len(groups))
    sizes = np.array([len(group) for group in groups])
    for n in set(sizes.tolist()) - {1}:
        alike = np.flatnonzero(sizes == n)
        variance = values[np.stack([groups[i] for i in alike])].var(axis=1, ddof=1)
        found[alike] = np.where(variance > one[alike] ** 2 * _most_by_chance(n), np.sqrt(variance), 0.0)
    return found


@lru_cache
def _most_by_chance(n: int) -> float:
    """Return up to what the variance of n readings comes by chance, as a share of the true one."""
    return float(chdtri(n - 1, BY_CHANCE)) / (n - 1)
