"""Shapes that a search tries lie so close that none is lost between two of them."""

import numpy as np

from bench.diagnose.linearise.candidates import Cause, shape_grid
from bench.effects.effect import Place
from bench.effects.gear_kinematics import TransmissionError


def test_no_number_of_cycles_is_lost_between_two_that_are_tried() -> None:
    """One of 60 was found by none of twelve, each a factor of 1.6 from the next: "nothing found", after two minutes."""
    effect = TransmissionError()
    cause = Cause(effect, Place("joint", 1, "joint2"), effect.parameters[:2], effect.parameters[2:])
    tried = np.array([shape["cycles"] for shape in shape_grid(cause)])
    swept = np.deg2rad(20)  # of a joint in one run
    for cycles in np.geomspace(1, 120, 400):
        # what sine and cosine of another number have in common with this one over the angles of a run
        assert np.max(np.abs(np.sinc((tried - cycles) * swept / (2 * np.pi)))) > 0.6
