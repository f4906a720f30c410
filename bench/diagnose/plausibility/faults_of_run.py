"""What may be wrong with one run of a campaign, as columns of a linear model: each is one number, or three of a place.

A channel may be displaced, y = prediction + f; scaled, y = (1 + f) prediction; or late, y = prediction - f rate. An
angle may be f more than where the joint was, and a load 1 + f times what was written down.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.plausibility.listed_causes import ListedCauses
from bench.diagnose.replay.quantities import Quantity
from bench.effects.gas import GasLoss
from bench.effects.geometry import JointZero
from bench.effects.recording_channel import ChannelDelay
from bench.effects.recording_log import HungLoad
from bench.effects.sensing_bench import ForceGain, TrackerFrame, TrackerScale
from bench.effects.sensing_drive import CurrentOffset, TorqueConstant
from bench.record.campaign import Array

LOADS = "loads"  # the subject of faults of what was written down; else the kind of a quantity, or "angles"
ANGLES = "angles"
FELT = ("force", "moment")
# derived: sizes, by subject and how, up to which the catalogue knows a cause that is no fault of a file
LISTED: Mapping[tuple[str, str], float] = {
    (LOADS, "scaled"): HungLoad.parameters[0].low,
    (ANGLES, "displaced"): JointZero.parameters[0].high,
    ("q_link", "displaced"): JointZero.parameters[0].high,
    ("reflector", "displaced"): TrackerFrame.parameters[0].high,
    ("reflector", "scaled"): TrackerScale.parameters[0].high,
    ("force", "scaled"): ForceGain.parameters[0].high,
    ("moment", "scaled"): ForceGain.parameters[0].high,
    ("gas_pressure", "scaled"): GasLoss.parameters[0].low,
    ("current", "scaled"): TorqueConstant.parameters[0].high,
    ("tau_motor", "scaled"): TorqueConstant.parameters[0].high,
    ("current", "displaced"): CurrentOffset.parameters[0].high,
}
SOONEST = ChannelDelay.parameters[0].low  # derived: [s], of a delay of any channel


@dataclass(frozen=True, eq=False)
class Fault:
    """One thing that may be wrong with a run; t instants of the run, c quantities.

    Attributes:
        run: Its name.
        subject: What it is about: kind of the quantities and index of the drive or reflector, `ANGLES`, or `LOADS`.
        column: Of the campaign, or what several columns of an instrument begin with.
        how: "displaced", "scaled" or "late".
        unit: Of the number.
        columns: Shape (t, c, p), what one unit of each number changes.
    """

    run: str
    subject: tuple[str, int]
    column: str
    how: str
    unit: str
    columns: Array

    def matters(self, values: Array) -> bool:
        """Whether its numbers, shape (p,), are larger than what the catalogue knows a cause of."""
        least = SOONEST if self.how == "late" else LISTED.get((self.subject[0], self.how), 0.0)
        return float(np.linalg.norm(values)) > least


def faults_of(
    run: str,
    own: NDArray[np.bool_],
    quantities: Sequence[Quantity],
    predicted: Array,
    rates: Array,
    causes: ListedCauses,
    angles: Mapping[int, str],
) -> Iterator[Fault]:
    """Yield what may be wrong with a run; of equals the plainest first.

    Args:
        run: Its name.
        own: Shape (T,), its instants.
        quantities: Shape (c,).
        predicted: Shape (T, c), what the others make of it.
        rates: Shape (T, c), how fast that changes; nan where nobody can say.
        causes: What changes readings.
        angles: Index of a drive -> column of its angle.
    """
    for column, changes in causes.loads.items():
        if run in changes and np.any(changes[run][own]):
            yield Fault(run, (LOADS, 0), column, "scaled", "", changes[run][own][:, :, None])
            felt = np.array([quantity.kind in FELT for quantity in quantities])
            if np.any(changes[run][own][:, felt]):  # a force sensor that says the same may have been copied from it
                unfelt = np.where(felt, 0.0, changes[run][own])[:, :, None]
                yield Fault(run, (LOADS, 0), f"{column} and force", "scaled", "", unfelt)
    seen = np.isfinite(causes.residual[own])
    changing = np.nan_to_num(rates[own])
    for j, zero in causes.zeros.items():
        if j in angles and np.any(zero[own]):
            yield Fault(run, (ANGLES, 0), angles[j], "displaced", unit_of(angles[j]), zero[own][:, :, None])
    for subject, members in subjects_of(quantities).items():
        there = [c for c in members if np.any(seen[:, c])]
        if not there:
            continue
        only = np.zeros(seen.shape, dtype=np.bool_)
        only[:, there] = seen[:, there]
        name, unit = quantities[there[0]].column, quantities[there[0]].unit
        alone = [only & (np.arange(len(quantities)) == c) for c in there]
        for c, rows in zip(there, alone, strict=True):
            yield Fault(run, subject, quantities[c].column, "displaced", unit, 1.0 * rows[:, :, None])
        whole = name.rsplit("_", 2)[0] if len(there) > 1 else name
        yield Fault(run, subject, whole, "late", "s", -(only * changing)[:, :, None])
        for c, rows in zip(there, alone, strict=True):
            yield Fault(run, subject, quantities[c].column, "scaled", "", (rows * predicted[own])[:, :, None])
        if len(there) > 1:
            yield Fault(run, subject, whole, "scaled", "", (only * predicted[own])[:, :, None])
            each = np.stack([1.0 * rows for rows in alone], axis=2)
            yield Fault(run, subject, whole, "displaced", unit, each)


def subjects_of(quantities: Sequence[Quantity]) -> dict[tuple[str, int], list[int]]:
    """Return the quantities that one instrument shows: kind and index -> places among the quantities."""
    found: dict[tuple[str, int], list[int]] = {}
    for c, quantity in enumerate(quantities):
        found.setdefault((quantity.kind, quantity.index), []).append(c)
    return found


def unit_of(column: str) -> str:
    """Return the unit that the name of a column ends with."""
    return column.rsplit("_", 1)[-1]
