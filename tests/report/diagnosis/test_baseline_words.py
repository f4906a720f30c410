"""What is said of least squares before anything is diagnosed."""

from dataclasses import replace

import pytest

from bench.diagnose.baseline.first_look import FirstLook, first_look
from bench.report.diagnosis.baseline import REPEATS, baseline_lines, first_lines
from tests.diagnose.sweeps import SWEEPS, made, nominal
from tests.report.diagnosis.made import MISSING, NOT_MISSING


@pytest.mark.parametrize("times", [0.5, 2.0])
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
