"""The side from which poses were reached, against what friction makes of it: motors that came upwards pull harder."""

from collections import defaultdict
from collections.abc import Hashable, Iterator, Sequence
from math import comb

import numpy as np

from bench.record.finding import Finding
from bench.record.rules.sheet import Sheet

CHANCE = 0.001  # declared: that drives of which friction shows nothing are warned of
FELT = "drives that came upwards (+1) pull less than after they came downwards (-1)"
SAME = 0.01  # rounding: [rad], [m]; poses that are alike to this are one pose, reached twice
EFFORTS = ("current", "tau_motor")


def approach_is_felt(sheets: Sequence[Sheet]) -> Iterator[Finding]:
    """Drives that came to a pose upwards do not pull less there, unloaded, than those that came downwards.

    Coulomb friction opposes the motion that has just ended. Where it shows nothing, either sign is as likely: signs of
    all drives in all pairs of visits are counted (sign test). A servo that overshoots each time turns them as well. Of
    one pose the share of lower ones is no larger than that of all other poses, but for chance (Fisher's exact test).
    """
    poses: dict[Hashable, dict[float, list[dict[str, float]]]] = defaultdict(lambda: defaultdict(list))
    of_pose: dict[Hashable, dict[str, Sheet]] = defaultdict(dict)
    for sheet in sheets:
        for pose, side, efforts in _visits(sheet):
            poses[sheet.run.recording, pose][side].append(efforts)
            of_pose[sheet.run.recording, pose][sheet.run.name] = sheet
    risen = {pose: [*_differences(sides[1.0], sides[-1.0])] for pose, sides in poses.items()}
    count = {pose: (sum(one < 0 for one in every), sum(one != 0 for one in every)) for pose, every in risen.items()}
    count = {pose: one for pose, one in count.items() if one[1]}
    lower, pairs = (sum(one[i] for one in count.values()) for i in (0, 1))
    if pairs and sum(comb(pairs, k) for k in range(lower, pairs + 1)) < CHANCE * 2**pairs:
        message = f"{FELT}, in {lower} of {pairs} comparisons without load; friction makes them pull more"
        remedy = "sides exchanged? +1 is written where joint positions rose; or servos that overshoot"
        yield next(iter(of_pose[next(iter(count))].values())).warning("approach", message, remedy)
        return
    chance = {pose: _of_so_many(own, of, lower, pairs) for pose, (own, of) in count.items()}
    worst = min(chance, key=lambda pose: chance[pose], default=None)
    if worst is not None and len(chance) * chance[worst] < CHANCE:
        own, of = count[worst]
        first, *others = of_pose[worst].values()
        where = f" here and in {', '.join(other.file for other in others)}" if others else ""
        message = (
            f"{FELT}, in {own} of {of} comparisons without load{where}, and in {lower - own} of {pairs - of} elsewhere"
        )
        yield first.warning("approach", message, "sides or tables of two visits exchanged? +1: joint positions rose")


def _of_so_many(own: int, of: int, lower: int, pairs: int) -> float:
    """Return the chance that of some comparisons so many or more are lower, where of all pairs so many are."""
    ways = sum(comb(of, k) * comb(pairs - of, lower - k) for k in range(own, min(of, lower) + 1))
    return ways / comb(pairs, lower)


def _differences(upwards: Sequence[dict[str, float]], downwards: Sequence[dict[str, float]]) -> Iterator[float]:
    """Yield by how much more each drive pulls after coming upwards, in the mean of visits to one pose."""
    for name in {name for efforts in upwards for name in efforts} & {name for efforts in downwards for name in efforts}:
        up, down = ([one[name] for one in every if name in one] for every in (upwards, downwards))
        yield float(np.mean(up) - np.mean(down))


def _visits(sheet: Sheet) -> Iterator[tuple[Hashable, float, dict[str, float]]]:
    """Yield pose, side, and effort by channel before any load, of each visit of a static run."""
    columns = sheet.run.columns
    names = [name for name in ("pose", "approach", "load_step") if name in columns]
    angles = [values for _, values in sheet.columns("q_cmd")] or [values for _, values in sheet.columns("q_motor")]
    efforts = {column.name: values for column, values in sheet.columns(*EFFORTS)}
    if sheet.run.kind != "static" or len(names) < 3 or not angles or not efforts or not len(sheet.run):
        return
    pose, side, step = (columns[name] for name in names)
    if not all(np.isfinite(values).all() for values in (pose, side, step, *angles, *efforts.values())):
        return  # other rules say where
    visit = np.cumsum(np.concatenate([[True], (np.diff(pose) != 0) | (np.diff(side) != 0) | (np.diff(step) < 0)]))
    for rows in np.split(np.arange(len(visit)), np.flatnonzero(np.diff(visit)) + 1):
        first = rows[step[rows] == step[rows[0]]]
        at = tuple(round(float(np.median(values[first])) / SAME) for values in angles)
        yield at, float(side[first[0]]), {name: float(np.mean(values[first])) for name, values in efforts.items()}
