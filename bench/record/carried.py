"""What runs carry: a payload that the lab knows besides, written into runs that state none."""

from dataclasses import replace

import numpy as np

from bench.record.campaign import Array, Campaign, Run
from bench.record.known import PAYLOAD
from bench.record.units import STANDARD_GRAVITY


def with_payloads(campaign: Campaign) -> Campaign:
    """Return a campaign in which a payload that the lab knows besides is what runs carry that state none.

    Of several readings of one payload the first is taken for that; all count as readings.
    """
    known = {one.recording: one.value for one in reversed(campaign.known) if one.quantity == PAYLOAD}
    if not known:
        return campaign
    runs = tuple(_carrying(run, known.get(run.recording, known.get(""))) for run in campaign.runs)
    return replace(campaign, runs=runs)


def load_with_weight(run: Run) -> Array:
    """Return the wrench on the load point with the weight of what is carried, shape (n_rows, 6) [N, Nm], world axes.

    A table that states a load has that weight in it; one that states a mass alone has not.
    """
    wrench = np.array(run.load_wrench())
    if "load_mass_kg" in run.columns and not states_load(run):
        wrench[:, 2] -= STANDARD_GRAVITY * run.columns["load_mass_kg"]
    return wrench


def states_load(run: Run) -> bool:
    """Whether a table states the force or moment on the load point."""
    return any(name.startswith("load_") and name.endswith(("_n", "_nm")) for name in run.columns)


def _carrying(run: Run, mass: float | None) -> Run:
    """Return a run with a mass at its load point; its weight stands in the load, as the format has it."""
    if not mass or "load_mass_kg" in run.columns:
        return run
    columns = {**run.columns, "load_mass_kg": np.full(len(run), mass)}
    if states_load(run):
        columns["load_z_n"] = run.columns.get("load_z_n", np.zeros(len(run))) - STANDARD_GRAVITY * mass
    return replace(run, columns=columns)
