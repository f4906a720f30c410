"""Loads that are too small for what drives paid: in another unit, though no force sensor says so.

Within a visit to a pose only the load changes. Friction takes part of it or adds to it at each step, up to twice its
level; a load in kilonewtons is a thousand times too small.
"""

from collections.abc import Iterator

import numpy as np

from bench.diagnose.plausibility.drive_picture import DrivePicture
from bench.diagnose.plausibility.mistaken import doubt
from bench.diagnose.plausibility.mistaken_inputs import Recording, without_loads
from bench.record.campaign import Array
from bench.record.finding import Finding
from bench.record.units import STANDARD_GRAVITY

TOO_SMALL = 3.0  # times; a load that is written down wrong (hung_load) is up to twice too small
ALIKE = 0.9  # correlation of what drives paid and what the loads ask for, over all drives and states
NEAR = 0.5  # of a factor's logarithm, by which friction may blur a unit
UNITS = {1e3: "kilonewtons? multiply by 1000", STANDARD_GRAVITY: "kilograms? multiply by 9.80665"}


def loads_too_small(picture: DrivePicture, recording: Recording) -> Iterator[Finding]:
    """Yield a doubt where currents ask for loads that are several times as large.

    Args:
        picture: What drives did.
        recording: The same, to be replayed without its loads.
    """
    bare = without_loads(recording)
    if bare is None:
        return
    paid, asked = [], []
    first = 0
    for segment in recording.segments:
        rows = slice(first, first + len(segment))
        first += len(segment)
        if segment.is_static and len(segment) > 1:
            of_load = (picture.model - bare.model)[rows] / picture.slack
            seen = picture.observed[rows] / picture.slack
            paid.append(seen[1:] - seen[0])
            asked.append(of_load[1:] - of_load[0])
    if not paid:
        return
    y, x = np.concatenate(paid).ravel(), np.concatenate(asked).ravel()
    known = np.isfinite(y)
    factor = _slope(y[known], x[known])
    if factor > TOO_SMALL:
        guess = next(
            (words for unit, words in UNITS.items() if abs(np.log(factor / unit)) < NEAR), "look at their unit"
        )
        yield doubt("load_z_n", f"drives paid for loads about {factor:.2g} times as large", guess)


def _slope(y: Array, x: Array) -> float:
    """Return y over x by least squares, 0 where they do not go together."""
    power = float(np.sqrt((x @ x) * (y @ y)))
    return float(x @ y) / float(x @ x) if power > 0 and float(x @ y) > ALIKE * power else 0.0
