"""A learned shape: one source of values, units of a slide, and a band that holds zero everywhere is no shape."""

from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.conclude import kind_beside
from bench.diagnose.linearise.generic import Block
from bench.diagnose.name.learned_shape import LearnedCurve, LearnedShape
from bench.diagnose.verdict import Unlisted
from tests.report.diagnosis.made import GAS, ZERO, explanation

NODES = np.array([0.1, 0.2, 0.3])
TABLE = Block("joint 1", "link torque", "angle", 0, "Nm", NODES, 5.0)
POLYNOMIAL = Block("tracker", "reading", "place", -1, "m", np.empty(0), 3e-4, functions=(0, 11))
SIGMA = 2.0


@pytest.mark.parametrize(("value", "stands_out"), [([3.8, -3.9, 0.0], False), ([3.8, -4.0, 0.0], True)])
def test_a_band_that_holds_zero_everywhere_is_no_shape(value: list[float], stands_out: bool) -> None:
    half = 1.959964 * SIGMA  # 3.92
    found = np.array(value)
    shape = LearnedShape(TABLE, found, SIGMA**2 * np.eye(3))
    assert shape.stands_out is stands_out
    ends = (tuple(column.tolist()) for column in (NODES, found, found - half, found + half))
    curve = LearnedCurve("", "angle", "rad", "Nm", *ends)
    assert curve.stands_out is stands_out
    assert replace(shape, curves=(curve,)).stands_out is stands_out


def test_what_is_too_small_to_have_a_shape_names_no_verdict() -> None:
    """A verdict was called "unlisted cause" whose headline had load friction, at more than 99.9 %."""
    little = Unlisted("drive 2", "motor torque", "speed", stands_out=False)
    one, two = (explanation(causes, 1.0, 50.0) for causes in ((GAS,), (GAS, ZERO)))
    kind = "unlisted cause"
    assert kind_beside(kind, (one,), little) == "cause"
    assert kind_beside(kind, (two, one), little) == "several causes"
    assert kind_beside(kind, (), little) == kind
    assert kind_beside(kind, (one,), replace(little, stands_out=True)) == kind
    assert kind_beside("nothing found", (), None) == "nothing found"


def test_a_slide_has_newtons_and_metres() -> None:
    shape = LearnedShape(TABLE, np.ones(3), np.eye(3))
    assert (shape.unit, shape.over_unit, shape.names[0]) == ("Nm", "rad", ("at_1", "at 0.1 rad"))
    slide = replace(shape, slides=True)
    assert (slide.unit, slide.over_unit, slide.names[0]) == ("N", "m", ("at_1", "at 0.1 m"))


def test_a_polynomial_has_the_names_of_its_functions() -> None:
    shape = LearnedShape(POLYNOMIAL, np.ones(2), np.eye(2))
    assert shape.names == (("x_from_x_squared", "x from x squared"), ("z_from_z", "z from z"))
