"""A machine whose readings, all of them after, show nothing but a change: nothing to be integrated out, no cell."""

from collections.abc import Sequence
from types import SimpleNamespace
from typing import cast

import numpy as np
from scipy.sparse import csr_array, eye_array

from bench.compare.background import Background
from bench.compare.shared import SharedWhitening
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.marginal import Nuisances
from bench.diagnose.linearise.screening import Entry
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot


def seen_once(entries: Sequence[Entry], columns: Array, white: Array, robot: CompiledRobot) -> Background:
    """Return all recordings of such a machine.

    Args:
        entries: What may change.
        columns: Shape (m, q), what they change.
        white: Shape (m,), the readings.
        robot: That changes are linear about.
    """
    m = len(white)
    linear = SimpleNamespace(replay=SimpleNamespace(compiled=robot))
    none = csr_array((0, m))
    recordings = (SimpleNamespace(is_after=False), SimpleNamespace(is_after=True))
    whitening = SharedWhitening(cast(LinearisedModel, linear), csr_array(eye_array(m)), none, np.empty(0), ())
    background = SimpleNamespace(
        entries=tuple(entries),
        columns=columns,
        white=white,
        nuisances=Nuisances(np.zeros((m, 1))),
        whitening=whitening,
        joint=SimpleNamespace(linear=linear, recordings=recordings, of_row=np.ones(m, dtype=np.intp)),
        acting=lambda which, weights: columns[:, which],
    )
    return cast(Background, background)
