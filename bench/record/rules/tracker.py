"""Laser tracker: the beam holds, and follows the arm."""

from collections.abc import Iterator

import numpy as np

from bench.record.finding import Finding
from bench.record.rules.sheet import Sheet

FEW = 5  # readings that may agree to the last digit


def sees_reflectors(sheet: Sheet) -> Iterator[Finding]:
    """No reflector is in the origin (beam lost), or in one place while the arm moves (tracker does not follow)."""
    joints = [column.name for column, _ in sheet.columns("q_cmd", "q_motor")]
    for index in dict.fromkeys(column.index for column, _ in sheet.columns("reflector")):
        point = {column.name: values for column, values in sheet.columns("reflector") if column.index == index}
        name, coordinates = next(iter(point)), np.stack(list(point.values()))
        lost = np.flatnonzero(np.all(coordinates == 0, axis=0)) + 1
        if len(point) == 3 and len(lost):
            yield sheet.error(name, f"reflector {index} stands in the origin", "beam lost? remove rows", lost.tolist())
        elif len(sheet.run) > FEW and np.ptp(coordinates, axis=1).max() == 0 and any(map(sheet.moves, joints)):
            message = f"reflector {index} is the same in every row while the arm moves"
            yield sheet.doubt(name, message, "look whether the tracker follows it")
