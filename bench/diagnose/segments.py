"""From a campaign to what a replay repeats: motor motion and loads in, with what was measured at the same instants.

A static run is read visit by visit: the pose is approached from its side, then load follows load; repeats become one
mean with its standard error. A motion is cut into bins of constant direction, short against everything that changes.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d
from scipy.signal import savgol_filter

from bench.diagnose.noise import UNIFORM, Noise
from bench.diagnose.quantities import Quantity
from bench.effects.effect import REFERENCE_K, Conditions
from bench.record.campaign import Array, Campaign, Run
from bench.robot.compiled import CompiledRobot
from bench.simulate.prescribed import Motion

MOST_BINS = 1400  # over all motion of a campaign: what a minute of diagnosis can replay some hundred times
APPROACH = np.deg2rad(2.0)  # [rad]; friction is sliding long before
SHORTEST_WINDOW = 0.06  # [s], over which motion is differentiated
TURNING = 0.08  # of a joint's top speed in a run; below it, it starts, stops or turns round
SAMPLES_OF_PARABOLA = 4  # fewer samples have no curvature to speak of
STEADY = 0.15  # of a joint's largest acceleration in a run, below which it moves steadily
ENOUGH_STEADY = 0.4  # of a run
FOLLOWS = 0.1  # of its top speed; a drive that is nearer than that to its command follows it
UNRESOLVED = 0.5  # of the difference between accelerations over one window and over two, that may be error
RINGS = 0.2  # [s], for which a jerk is felt before and after
STANDS = 1e-4  # [rad/s] or [m/s]; below it a joint counts as standing


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
        sigma: Shape (T, c), standard error from the instruments' noise alone.
        pure_error: Shape (T, c), variance of the mean as the scatter of the repeats gives it, nan where there is none.
        standing: Shape (n,) bool, drives that did not move.
        acceleration_error: Shape (T, n), standard deviation of the motors' accelerations, as differentiated.
    """

    run: str
    label: str
    is_static: bool
    motion: Motion
    conditions: Conditions
    observed: Array
    sigma: Array
    pure_error: Array
    standing: Array
    acceleration_error: Array

    def __len__(self) -> int:
        return len(self.observed)


def segments_of(
    campaign: Campaign, compiled: CompiledRobot, quantities: tuple[Quantity, ...], most_bins: int = MOST_BINS
) -> tuple[Segment, ...]:
    """Return everything in a campaign that can be replayed, in its order.

    Args:
        campaign: A checked campaign.
        compiled: Its robot.
        quantities: What to compare.
        most_bins: How many bins all motion together may have.
    """
    noise = Noise(campaign, compiled.robot.figures)
    moving = sum(float(np.ptp(run.columns["time_s"])) for run in campaign.of_kind("motion") if len(run) > 1)
    width = moving / most_bins
    found: list[Segment] = []
    for run in campaign.runs:
        pieces = _visits(run, compiled) if run.kind == "static" else _stretches(run, compiled, width)
        for label, rows, motion, edges, error in pieces:
            observed, sigma, pure = _means(run, rows, edges, quantities, noise, run.kind == "static")
            if not np.any(np.isfinite(observed)):
                continue
            speed = np.max(np.abs(motion.velocity[motion.read]), axis=0)
            found.append(
                Segment(
                    run.name,
                    label,
                    run.kind == "static",
                    motion,
                    conditions_of(run, rows, compiled.n_joints),
                    observed,
                    sigma,
                    pure,
                    speed < STANDS,
                    error,
                )
            )
    return _rounded_alike(found, quantities, noise)


def _rounded_alike(found: list[Segment], quantities: tuple[Quantity, ...], noise: Noise) -> tuple[Segment, ...]:
    """Return the segments with readings that were rounded to the same number counted as one.

    A gauge shows the same digit all day while its joint stands; a thousand such readings know no more than one.
    """
    sigma = [segment.sigma.copy() for segment in found]
    for c, quantity in enumerate(quantities):
        step = noise.rounding(quantity)
        if step == 0.0:
            continue
        seen = np.concatenate([segment.observed[:, c] for segment in found])
        known = np.sort(seen[np.isfinite(seen)])
        half = step / UNIFORM / 2
        for segment, own in zip(found, sigma, strict=True):
            values = segment.observed[:, c]
            alike = np.searchsorted(known, values + half) - np.searchsorted(known, values - half)
            own[:, c] = np.hypot(own[:, c], step * np.sqrt(np.maximum(alike, 1)))
    return tuple(replace(segment, sigma=own) for segment, own in zip(found, sigma, strict=True))


def conditions_of(run: Run, rows: Index, n: int) -> Conditions:
    """Return the mean temperatures over some rows; those that nobody measured are at their reference."""

    def mean(column: str) -> float:
        return float(np.mean(run.columns[column][rows])) if column in run.columns else REFERENCE_K

    return Conditions(
        gear_k=np.array([mean(f"gear_temperature_{i + 1}_k") for i in range(n)]),
        winding_k=np.array([mean(f"motor_temperature_{i + 1}_k") for i in range(n)]),
        gas_k=mean("gas_temperature_k"),
        ambient_k=mean("ambient_temperature_k"),
        payload_kg=float(np.mean(run.columns["load_mass_kg"][rows])) if "load_mass_kg" in run.columns else 0.0,
    )


# label, rows of the run, motion, first row of each group within `rows`, error of the accelerations
Piece = tuple[str, Index, Motion, Index, Array]


def _angles(run: Run, compiled: CompiledRobot) -> Array:
    """Return motor angles by encoder, where there is none by command, shape (rows, n)."""
    n = compiled.n_joints
    keys = tuple(str(i + 1) for i in range(n))
    measured, commanded = (
        np.where(np.isnan(rad), run.stack(quantity, "m", keys), rad)
        for quantity, rad in ((q, run.stack(q, "rad", keys)) for q in ("q_motor", "q_cmd"))
    )
    angles: Array = np.where(np.isnan(measured), commanded, measured)
    return angles


def _wrench(run: Run, compiled: CompiledRobot) -> Array:
    """Return the wrench on the load point without the weight of what is bolted to it, shape (rows, 6)."""
    wrench = np.array(run.load_wrench())
    if not any(name.startswith("load_") and name.endswith(("_n", "_nm")) for name in run.columns):
        keys = ("x", "y", "z")
        sensed = np.concatenate([run.stack("force", "n", keys), run.stack("moment", "nm", keys)], axis=1)
        felt: Array = np.nan_to_num(sensed)
        return felt
    if "load_mass_kg" in run.columns:
        wrench[:, :3] -= run.columns["load_mass_kg"][:, None] * compiled.model.opt.gravity
    wrench[np.abs(wrench) < 1e-6] = 0.0
    return wrench


def _visits(run: Run, compiled: CompiledRobot) -> Iterator[Piece]:
    angles, wrenches = _angles(run, compiled), _wrench(run, compiled)
    count = np.zeros(len(run))
    pose, step = run.columns["pose"], run.columns["load_step"]
    approach = run.columns.get("approach", count)
    begins = np.flatnonzero(
        np.concatenate([[True], (np.diff(pose) != 0) | (np.diff(approach) != 0) | (np.diff(step) < 0)])
    )
    for first, last in zip(begins, np.append(begins[1:], len(run)), strict=True):
        rows = np.arange(first, last)
        edges = np.flatnonzero(np.concatenate([[True], np.diff(step[rows]) != 0]))
        groups = np.split(rows, edges[1:])
        q = np.stack([angles[group].mean(axis=0) for group in groups])
        wrench = np.stack([wrenches[group].mean(axis=0) for group in groups])
        clock = run.columns.get("time_s", np.arange(len(run), dtype=np.float64))
        time = run.start_s + np.array([clock[group].mean() for group in groups])
        side = approach[first]
        before = q[:1] - side * APPROACH if side else q[:1]
        zeros = np.zeros((len(q) + 1, q.shape[1]))
        motion = Motion(
            time=np.concatenate([time[:1] - 1.0, time]),
            q=np.concatenate([before, q]),
            velocity=zeros,
            acceleration=zeros,
            wrench=np.concatenate([np.zeros((1, 6)), wrench]),
            read=np.concatenate([[False], np.ones(len(q), dtype=bool)]),
        )
        words = {1.0: " from below", -1.0: " from above"}.get(float(side), "")
        yield f"{run.name}, pose {pose[first]:g}{words}", rows, motion, edges, zeros[1:]


def _stretches(run: Run, compiled: CompiledRobot, width: float) -> Iterator[Piece]:
    if len(run) < 5:
        return
    time = run.columns["time_s"]
    dt = float(np.median(np.diff(time)))
    angles, wrenches = _angles(run, compiled), _wrench(run, compiled)
    window = int(np.clip(2 * round(SHORTEST_WINDOW / dt / 2) + 1, 5, 2 * ((len(run) - 1) // 2) - 1))
    velocity, acceleration = (
        savgol_filter(angles, window, 3, deriv=order, delta=dt, axis=0, mode="interp") for order in (1, 2)
    )
    error = _acceleration_error(angles, acceleration, window, dt)
    samples = max(1, round(width / dt))
    edges = np.arange(0, len(run), samples)
    if len(edges) > 1 and len(run) - edges[-1] < samples:
        edges = edges[:-1]
    groups = np.split(np.arange(len(run)), edges[1:])
    # where a joint starts or turns round, friction is between its levels: such groups say little and mislead
    top = np.max(np.abs(velocity), axis=0)
    moves = top > STANDS
    kept = [group for group in groups if not np.any(moves & (np.min(np.abs(velocity[group]), axis=0) < TURNING * top))]
    if not kept:
        return
    rows = np.concatenate(kept)
    starts = np.cumsum([0, *[len(group) for group in kept[:-1]]])

    def mean(values: Array) -> Array:
        centred: Array = np.stack([centre_weights(len(group)) @ values[group] for group in kept])
        return centred

    q, v, a = mean(angles), mean(velocity), mean(acceleration)
    still = ~moves
    v[:, still] = a[:, still] = 0.0
    q[:, still] = q[:, still].mean(axis=0)
    first = v[0]
    motion = Motion(
        time=run.start_s + np.concatenate([[time[kept[0][0]] - 1.0], mean(time)]),
        q=np.concatenate([q[:1] - np.sign(first) * APPROACH, q]),
        velocity=np.concatenate([v[:1], v]),
        acceleration=np.concatenate([np.zeros_like(a[:1]), a]),
        wrench=np.concatenate([mean(wrenches)[:1], mean(wrenches)]),
        read=np.concatenate([[False], np.ones(len(kept), dtype=bool)]),
    )
    worst = np.stack([error[group].max(axis=0) for group in kept])
    worst[:, still] = 0.0
    yield run.name, rows, motion, starts, worst


def _acceleration_error(angles: Array, acceleration: Array, window: int, dt: float) -> Array:
    """Return how far an acceleration may be off where it changes fast, shape (rows, n): what half the resolution adds.

    Where motion jerks, links ring for a while after it; the error is therefore kept up over a few windows.
    """
    longer = min(2 * window + 1, 2 * ((len(angles) - 1) // 2) - 1)
    if longer <= window:
        return np.zeros_like(angles)
    coarse = savgol_filter(angles, longer, 3, deriv=2, delta=dt, axis=0, mode="interp")
    reach = max(longer, 2 * round(RINGS / dt / 2) + 1)
    error: Array = UNRESOLVED * maximum_filter1d(np.abs(acceleration - coarse), reach, axis=0)
    return error


def centre_weights(n: int) -> Array:
    """Return weights of n equidistant samples that give a parabola's value at their middle, shape (n,).

    A plain mean would cut the corners: a reflector on an arc of 2 m moves 0.4 mm inwards over a bin of four degrees.
    """
    if n < SAMPLES_OF_PARABOLA:
        return np.full(n, 1 / n)
    basis = np.vander(np.linspace(-1, 1, n), 3, increasing=True)
    weights: Array = np.linalg.pinv(basis)[0]
    return weights


def _asked_velocity(run: Run, compiled: CompiledRobot, measured: Array, window: int, dt: float) -> Array:
    """Return the commanded velocity where commands were logged and followed, for it has no noise; else the measured."""
    keys = tuple(str(i + 1) for i in range(compiled.n_joints))
    asked = np.where(
        np.isnan(run.stack("q_cmd", "m", keys)), run.stack("q_cmd", "rad", keys), run.stack("q_cmd", "m", keys)
    )
    if not np.all(np.isfinite(asked)):
        return measured
    velocity = savgol_filter(asked, window, 3, deriv=1, delta=dt, axis=0, mode="interp")
    follows = np.max(np.abs(velocity - measured), axis=0) < FOLLOWS * np.max(np.abs(measured), axis=0) + STANDS
    chosen: Array = np.where(follows, velocity, measured)
    return chosen


def _means(
    run: Run, rows: Index, edges: Index, quantities: tuple[Quantity, ...], noise: Noise, is_static: bool
) -> tuple[Array, Array, Array]:
    """Return mean, standard error and pure error of every group of rows, shape (T, c) each."""
    groups = np.split(rows, edges[1:])
    shape = (len(groups), len(quantities))
    mean, sigma, pure = np.full(shape, np.nan), np.full(shape, np.nan), np.full(shape, np.nan)
    sizes = np.array([len(group) for group in groups])
    for c, quantity in enumerate(quantities):
        if quantity.column not in run.columns:
            continue
        values = run.columns[quantity.column]
        weights = [np.full(n, 1 / n) if is_static else centre_weights(n) for n in sizes]
        mean[:, c] = [w @ values[group] for w, group in zip(weights, groups, strict=True)]
        one = noise.of(quantity, mean[:, c], run)
        if not is_static:
            one = np.maximum(one, noise.of_samples(values))
        sigma[:, c] = one * [np.linalg.norm(w) for w in weights]
        if is_static:
            many = sizes > 1
            pure[many, c] = [values[group].var(ddof=1) / len(group) for group in groups if len(group) > 1]
    return mean, sigma, pure
