"""Loads, masses and the force sensor tell of one thing: what hangs on the load point."""

from collections.abc import Iterator, Sequence

import numpy as np

from bench.record.carried import load_with_weight
from bench.record.finding import Finding
from bench.record.rules.pairing import CORRELATED, FORCES, MANY, NEAR
from bench.record.rules.sheet import LOAD_N, Sheet, rows_where
from bench.record.rules.stuck import AT_EXTREME
from bench.record.units import STANDARD_GRAVITY

APART = 0.05  # force sensors are good to 0.5 to 3 %, weights to 0.1 %; the least error of a load tried as a defect
EXACT = 0.01  # rounding: of a factor; 9.8 and 9.81 are 0.1 % apart
UNSTATED_N = 10 * LOAD_N  # beyond what a cable or a hand on the sensor makes; assumed
ZERO_N = 5 * LOAD_N  # an adapter of 5 kg that was not tared, far beyond what a zero wanders by; assumed
FEW = 3  # rows, of which the median is no single outlier
# beyond how far a load hangs beside the load point, and what a sensor reads by itself; assumed
LEVER_M, LEVER_NM = 0.05, 20.0
ACROSS, LIKE = 0.3, (0.5, 2.0)  # cosine of 73 degrees, and sizes of one thing: the sensor reads along other axes
HEAVY_N = 10.0  # [N]; below, rounding of either may be what differs


def masses_hang(sheet: Sheet) -> Iterator[Finding]:
    """Each mass that moves with the load point pulls at least with its weight."""
    mass, load = (sheet.run.columns.get(name) for name in ("load_mass_kg", "load_z_n"))
    if mass is None or load is None:
        return
    weight = mass * STANDARD_GRAVITY
    if rows := rows_where((weight > HEAVY_N) & (-load < (1 - APART) * weight)):
        row = rows[0] - 1
        message = f"{mass[row]:g} kg weigh {weight[row]:.4g} N, but load_z_n is {load[row]:.4g} N"
        yield sheet.doubt(
            "load_mass_kg", message, "the weight of the mass stands in load_z_n; correct one of them", rows
        )


def weights_are_masses(sheets: Sequence[Sheet]) -> Iterator[Finding]:
    """No load is the same multiple of the weight of each mass; beside one mass alone something else may pull."""
    both = [sheet for sheet in sheets if {"load_mass_kg", "load_z_n"} <= set(sheet.run.columns)]
    if not both:
        return
    mass, load = (np.concatenate([sheet.run.columns[name] for sheet in both]) for name in ("load_mass_kg", "load_z_n"))
    weight = STANDARD_GRAVITY * mass
    heavy = (weight > HEAVY_N) & np.isfinite(load)
    if len(set(mass[heavy].tolist())) < 2:
        return
    factor = -load[heavy] / weight[heavy]
    if np.ptp(factor) < EXACT * abs(factor[0]) and factor[0] - 1 > APART:
        message = f"is {factor[0]:.3g} times the weight of load_mass_kg with each mass"
        yield both[0].doubt("load_z_n", message, "the weight of the mass stands in load_z_n; correct one of them")


def loads_are_felt(sheet: Sheet) -> Iterator[Finding]:
    """At rest the force sensor reads the load, to a few per cent of its size; its direction is not looked at."""
    columns = sheet.run.columns
    axes = [axis for axis in "xyz" if f"force_{axis}_n" in columns]
    if sheet.run.kind != "static" or not axes or len(sheet.run) < MANY:
        return
    force = np.stack([columns[f"force_{axis}_n"] for axis in axes])
    load = load_with_weight(sheet.run)[:, ["xyz".index(axis) for axis in axes]].T
    if np.max(np.ptp(load, axis=1)) <= LOAD_N:
        felt_n = float(np.max(np.ptp(force, axis=1)))
        if felt_n > UNSTATED_N:
            axis = axes[int(np.argmax(np.ptp(force, axis=1)))]
            message = f"changes by {felt_n:.4g} N while no load is stated to change"
            yield sheet.warning(f"force_{axis}_n", message, f"write what hung into load_{axis}_n")
        return
    felt, hung = (values - values.mean(axis=1, keepdims=True) for values in (force, load))
    along = float(np.sum(hung * felt))
    sizes = [float(np.sqrt(np.sum(values**2))) for values in (hung, felt)]
    if (
        abs(along) < ACROSS * sizes[0] * sizes[1]
        and LIKE[0] < sizes[1] / sizes[0] < LIKE[1]
        and len(axes) == len("xyz")
    ):
        axis = axes[int(np.argmax(np.ptp(force, axis=1)))]
        message = f"feels what load_{axes[int(np.argmax(np.ptp(load, axis=1)))]}_n says"
        yield sheet.doubt(f"force_{axis}_n", message, "look at the axes of the sensor; forces are along world axes")
        return
    ratio = along / float(np.sum(hung**2))
    most = LOAD_N + APART * float(np.max(np.ptp(load, axis=1)))
    if along <= CORRELATED * sizes[0] * sizes[1] or np.any(np.linalg.norm(felt - ratio * hung, axis=0) > most):
        off = force - load
        off = np.linalg.norm(off - np.median(off, axis=1, keepdims=True), axis=0)
        loaded = force[np.ptp(force, axis=1) > LOAD_N]
        is_cut = any(np.sum(values == end) >= AT_EXTREME for values in loaded for end in (values.min(), values.max()))
        if along > 0 and not is_cut and (rows := rows_where(off > most)):
            axis = axes[int(np.argmax(np.ptp(force, axis=1)))]
            message = f"contradicts the loads by up to {np.max(off):.3g} N"
            yield sheet.warning(f"force_{axis}_n", message, "steps of load exchanged, or a wrong zero of it?", rows)
        return
    if abs(ratio - 1) > APART and not any(abs(ratio / factor - 1) < NEAR for factor in FORCES):
        axis = axes[int(np.argmax(np.ptp(load, axis=1)))]
        remedy = "one of them is wrong; bench diagnose weighs both (hung_load, channel_scale)"
        yield sheet.warning(f"force_{axis}_n", f"is {ratio:.3g} times load_{axis}_n", remedy)


def zero_is_set(sheet: Sheet) -> Iterator[Finding]:
    """With nothing on it a force sensor reads nothing."""
    axes = [axis for axis in "xyz" if f"force_{axis}_n" in sheet.run.columns]
    if sheet.run.kind != "static" or not axes:
        return
    bare = np.linalg.norm(load_with_weight(sheet.run)[:, :3], axis=1) < LOAD_N
    if np.all(bare) or np.count_nonzero(bare) < FEW:  # nobody stated any load: what is felt may be one
        return
    felt = {axis: float(np.median(sheet.run.columns[f"force_{axis}_n"][bare])) for axis in axes}
    axis = max(felt, key=lambda axis: abs(felt[axis]))
    if abs(felt[axis]) > ZERO_N:
        message = f"reads {felt[axis]:.4g} N while no load is stated"
        remedy = "set its zero with the adapter on and nothing else, or write what hung into the loads"
        yield sheet.warning(f"force_{axis}_n", message, remedy, rows_where(bare))


def moments_are_about_the_load_point(sheet: Sheet) -> Iterator[Finding]:
    """From load to load in one pose, moments about the point on which a load pulls do not change."""
    forces, moments = ([f"{name}_{axis}_{unit}" for axis in "xyz"] for name, unit in (("force", "n"), ("moment", "nm")))
    columns = sheet.run.columns
    if sheet.run.kind != "static" or "pose" not in columns or not {*forces, *moments} <= set(columns):
        return
    force = np.stack([columns[name] for name in forces], axis=1)
    moment = np.stack([columns[name] for name in moments], axis=1) - load_with_weight(sheet.run)[:, 3:]
    for pose in np.unique(columns["pose"]):
        here = columns["pose"] == pose
        force[here] -= force[here].mean(axis=0)
        moment[here] -= moment[here].mean(axis=0)
    size = np.abs(moment).max(axis=0)
    lever = float(np.linalg.norm(moment)) / max(float(np.linalg.norm(force)), LOAD_N)
    if lever > LEVER_M and size.max() > LEVER_NM:
        message = f"changes with the load as if it pulled {lever:.2g} m beside the point about which moments are given"
        remedy = "give moments about the load point, or state the moment of the load (load_mx_nm and so on)"
        yield sheet.warning(moments[int(np.argmax(size))], message, remedy)
