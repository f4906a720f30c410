"""Labels of readings at rest: which pose, from which side, under which load, which repeat."""

from collections import Counter
from collections.abc import Iterator

import numpy as np

from bench.record.finding import Finding
from bench.record.rules.sheet import TRAVEL, Sheet, rows_where

STATE = ("pose", "approach", "load_step")
LABELS = (*STATE, "repeat")

SAME_LOAD = 0.05  # declared: of the largest load of a run, by which what was written down of one state may scatter
LOAD_N = 1.0  # [N]; a load smaller than this is a scale that was not quite zero


def are_counts(sheet: Sheet) -> Iterator[Finding]:
    """Labels are 0, 1, 2, ...; the approach is +1 or -1."""
    for name in LABELS:
        values = sheet.get(name)
        if values is None:
            continue
        is_approach = name == "approach"
        fits = np.abs(values) == 1 if is_approach else (values >= 0) & (values == np.round(values))
        if rows := rows_where(~fits):
            allowed = "+1 or -1" if is_approach else "0, 1, 2, ..."
            yield sheet.error(name, f"{values[rows[0] - 1]:g} is no label", f"write {allowed}", rows)


def tell_readings_apart(sheet: Sheet) -> Iterator[Finding]:
    """Each reading at rest has labels of its own, and samples of a movement are not repeats of each other."""
    if sheet.run.kind == "motion":
        repeat = sheet.get("repeat")
        if repeat is not None and len(repeat) and np.ptp(repeat) > 0:
            yield sheet.warning("repeat", "differs between samples of one movement", "is the run static?")
        return
    if "approach" not in sheet.names:
        yield sheet.warning("approach", "is missing", "add it; friction at rest depends on how the pose was reached")
    elif set(LABELS) <= set(sheet.run.columns):
        readings = _labels(sheet, LABELS)
        counts = Counter(readings)
        if twice := [row for row, reading in enumerate(readings, 1) if counts[reading] > 1]:
            yield sheet.warning("repeat", "several readings have the same labels", "count the repeats", twice)


def complete_states(sheet: Sheet) -> Iterator[Finding]:
    """In a static run, each visit to a pose has readings without load, and each state as many repeats as the others."""
    states = _labels(sheet, STATE)
    if sheet.run.kind != "static" or not states:
        return
    repeats = Counter(states)
    usual = Counter(repeats.values()).most_common(1)[0][0]
    if few := [row for row, state in enumerate(states, 1) if repeats[state] < usual]:
        message = f"has fewer repeats than the usual {usual}"
        yield sheet.warning("load_step", message, "look for lost readings or wrong labels", few)
    unloaded = {state[:-1] for state in states if state[-1] == 0}
    if without := [row for row, state in enumerate(states, 1) if state[:-1] not in unloaded]:
        message = "the visit to this pose has no reading without load"
        yield sheet.warning("load_step", message, "label the unloaded readings 0", without)


def agree_with_pose(sheet: Sheet) -> Iterator[Finding]:
    """In a static run, one pose is one set of joint angles, and load step 0 is not one of the loaded ones."""
    pose, step = sheet.get("pose"), sheet.get("load_step")
    if sheet.run.kind != "static" or pose is None:
        return
    _, first, which = np.unique(pose, return_index=True, return_inverse=True)
    for column, values in sheet.columns("q_cmd", "q_motor"):
        tolerance = TRAVEL[column.unit]
        if rows := rows_where(np.abs(values - values[first[which]]) > tolerance):
            message = f"changes by more than {tolerance:g} {column.unit} within one pose"
            yield sheet.warning(column.name, message, "number poses by joint angles; is the run a motion?", rows)
    force = np.linalg.norm(sheet.run.load_wrench()[:, :3], axis=1)
    if step is not None and (rows := rows_where((step == 0) & (force > force.min(initial=np.inf) + LOAD_N))):
        yield sheet.warning("load_step", "is 0 under load", "0 is for unloaded readings", rows)


def hang_one_load(sheet: Sheet) -> Iterator[Finding]:
    """In a static run, all repeats of a state have the same load."""
    states = _labels(sheet, STATE)
    if sheet.run.kind != "static" or not states:
        return
    which = np.unique(states, axis=0, return_inverse=True)[1].ravel()
    for column, values in sheet.columns("load"):
        if column.unit != "n" or not np.isfinite(values).all():
            continue
        usual = np.array([np.median(values[which == state]) for state in range(which.max() + 1)])[which]
        off = np.abs(values - usual)
        if rows := rows_where(off > LOAD_N + SAME_LOAD * float(np.max(np.abs(usual), initial=0.0))):
            message = (
                f"is {values[rows[0] - 1]:.6g}, and {usual[rows[0] - 1]:.6g} in other repeats of the same load step"
            )
            yield sheet.warning(column.name, message, "correct the load, or count load steps", rows)


def _labels(sheet: Sheet, names: tuple[str, ...]) -> list[tuple[float, ...]]:
    """Return the labels of each row; a column that is not there counts as the same everywhere. Empty without state."""
    if sheet.get("pose") is None or sheet.get("load_step") is None:
        return []
    blank = np.zeros(len(sheet.run))
    columns = [sheet.run.columns.get(name, blank).tolist() for name in names]
    return list(zip(*columns, strict=True))
