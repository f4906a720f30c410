"""A campaign by some of its channels."""

from dataclasses import replace

import numpy as np

from bench.diagnose.replay.quantities import Quantity
from bench.diagnose.replay.segments import Segment


def with_channels(
    segments: tuple[Segment, ...], every: tuple[Quantity, ...], kept: tuple[Quantity, ...]
) -> tuple[Segment, ...]:
    """Return the segments that have readings of some of the quantities, with those alone."""
    columns = [every.index(quantity) for quantity in kept]
    parts = (
        replace(
            segment,
            observed=segment.observed[:, columns],
            sigma=segment.sigma[:, columns],
            counted_once=None if segment.counted_once is None else segment.counted_once[:, columns],
        )
        for segment in segments
    )
    return tuple(part for part in parts if np.any(np.isfinite(part.observed)))
