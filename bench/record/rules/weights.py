"""Loads, masses and the force sensor tell of one thing: what hangs on the load point."""

from collections.abc import Iterator

import numpy as np

from bench.record.finding import Finding
from bench.record.rules.pairing import CORRELATED, FORCES, LOAD_N, MANY, NEAR, correlation
from bench.record.rules.sheet import Sheet, rows_where
from bench.record.units import STANDARD_GRAVITY

APART = 0.05  # force sensors are good to 0.5 to 3 %, weights to 0.1 %; the least error of a load tried as a defect
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


def loads_are_felt(sheet: Sheet) -> Iterator[Finding]:
    """At rest the force sensor reads the load, to a few per cent."""
    if sheet.run.kind != "static":
        return
    for axis in "xyz":
        force, load = (sheet.run.columns.get(f"{name}_{axis}_n") for name in ("force", "load"))
        if force is None or load is None or len(load) < MANY or np.ptp(load) <= LOAD_N:
            continue
        if correlation(force, load) < CORRELATED:
            continue
        about = load - load.mean()
        ratio = float(about @ (force - force.mean()) / (about @ about))
        if abs(ratio - 1) > APART and not any(abs(ratio / factor - 1) < NEAR for factor in FORCES):
            message = f"is {ratio:.3g} times load_{axis}_n"
            remedy = "one of them is wrong; bench diagnose weighs both (hung_load, channel_scale)"
            yield sheet.warning(f"force_{axis}_n", message, remedy)
