"""What a person wrote down of a session, with errors in the loads."""

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from bench.effects.effect import Acting
from bench.effects.recorded import LogError
from bench.record.campaign import Run
from bench.simulate.trace import Array


def written(runs: Sequence[Run], acting: Iterable[Acting], gravity: Array) -> tuple[Run, ...]:
    """Return the runs of a session as somebody wrote them down, with the errors in the log that effects make.

    Args:
        runs: With loads as they were hung on and bolted on by plan.
        acting: Effects; what they say of a run is the truth over what is written.
        gravity: Shape (3,) [m/s^2].
    """
    acting = tuple(acting)
    found = []
    for run in runs:
        for one in acting:
            error = one.effect.log_error(one.place, one.values, run.name)
            run = run if error is None else _miswritten(run, error, gravity)
        found.append(run)
    return tuple(found)


def _miswritten(run: Run, error: LogError, gravity: Array) -> Run:
    columns = dict(run.columns)
    bolted = columns.get("load_mass_kg", np.zeros(len(run)))
    hung = {name: columns[name] for name in columns if name.startswith("load_") and name != "load_mass_kg"}
    for axis, pull in zip("xyz", gravity, strict=True):
        name = f"load_{axis}_n"
        if name in hung:
            columns[name] = (hung[name] - bolted * pull) / error.hung + bolted / error.bolted * pull
    if "load_mass_kg" in columns:
        columns["load_mass_kg"] = bolted / error.bolted
    return replace(run, columns=columns)
