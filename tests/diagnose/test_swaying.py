"""Rests that were read before the arm had settled."""

import numpy as np
import pytest

from bench.diagnose.diagnose import Diagnosis, diagnose
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.segments import Segment, segments_of
from bench.effects.catalogue import catalogue
from bench.record.campaign import Array, Campaign
from tests.diagnose.sweeps import LOADS, changed, made, nominal

CHOICE = ("hysteresis", "joint_compliance", "backlash", "tracker_frame")
SWAY = np.array([-0.9e-3, -0.8e-3, 0.0])  # [m], of three repeats
CHANNEL = "reflector_1_y_m"


@pytest.fixture(scope="module")
def still() -> Campaign:
    return made(LOADS, seed=5)


@pytest.fixture(scope="module")
def swaying(still: Campaign) -> Campaign:
    def sway(columns: dict[str, Array]) -> None:
        if columns["pose"][0] == 2 and columns["approach"][0] == -1:
            columns[CHANNEL][:3] += SWAY  # the repeats without load

    return changed(still, sway)


def diagnosed(campaign: Campaign) -> Diagnosis:
    effects = catalogue()
    return diagnose(campaign, nominal(), {name: effects[name] for name in CHOICE}, proposes=False)


def segments(campaign: Campaign) -> tuple[tuple[Segment, ...], int]:
    quantities = quantities_of(campaign.runs, nominal())
    column = next(i for i, quantity in enumerate(quantities) if quantity.column == CHANNEL)
    return segments_of(campaign, nominal(), quantities), column


def test_a_rest_that_swayed_counts_by_its_scatter(still: Campaign, swaying: Campaign) -> None:
    (before, column), (after, _) = segments(still), segments(swaying)
    one, two = (np.concatenate([segment.sigma for segment in found]) for found in (before, after))
    rows, columns = np.nonzero(np.isfinite(one) & ~np.isclose(one, two))
    assert columns.tolist() == [column]
    assert two[rows[0], column] == pytest.approx(SWAY.std(ddof=1), rel=0.1)


def test_it_makes_nobody_find_anything(swaying: Campaign) -> None:
    assert diagnosed(swaying).verdict.kind == "nothing found"
