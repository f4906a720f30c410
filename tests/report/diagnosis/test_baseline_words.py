"""What is said of least squares before anything is diagnosed."""

from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.baseline.first_look import FirstLook, first_look
from bench.identify.dynamics.warming import Warming
from bench.report.diagnosis.baseline import REPEATS, baseline_lines, first_lines
from bench.report.diagnosis.page import Pictures, page_of
from tests.diagnose.sweeps import SWEEPS, made, nominal
from tests.report.diagnosis.made import MISSING, NOT_MISSING, facts_for


@pytest.mark.parametrize("times", [pytest.param(0.5, marks=pytest.mark.study), 2.0])
def test_errors_beyond_the_torque_itself_are_explained(times: float) -> None:
    """A session that moves each joint in runs of its own printed 46098 Nm without a word."""
    found = first_look(made(SWEEPS, 3), nominal()).found
    assert found
    squares = {**found.held_out.squares, "rival": found.held_out.squares["measured"] * times**2}
    changed = replace(found, held_out=replace(found.held_out, squares=squares))
    words = " ".join(first_lines(FirstLook(changed)))
    assert ("errs by more than the torque itself on drive" in words) == (times > 1)


def test_errors_of_a_repetition_are_said_to_be_that() -> None:
    """Five runs of one excitation were held out one by one, and nothing said that no other motion was."""
    assert REPEATS in list(baseline_lines(NOT_MISSING))
    assert REPEATS not in list(baseline_lines(MISSING))


def test_friction_that_fell_is_said_on_terminal_and_page() -> None:
    """The scatter of drives that warmed up was left to a reader as something that nothing explains."""
    fell = Warming(("joint1", "joint2"), ("a", "b"), np.array([[0.04, -0.021], [np.nan, np.nan]]), np.array([0.7, 0.1]))
    assert MISSING.baseline is not None
    verdict = replace(MISSING, baseline=replace(MISSING.baseline, warming=fell))
    (said,) = [line for line in baseline_lines(verdict) if "warm up" in line]
    assert "From 'a' to 'b' it falls by joint1 6.1%." in said
    assert "it falls by joint1 6.1%" in page_of(verdict, facts_for(verdict), Pictures(worst=()), {}, "")
    assert not any("warm up" in line for line in baseline_lines(MISSING))
