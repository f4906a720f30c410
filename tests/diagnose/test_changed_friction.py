"""Two recordings of one machine with another friction: said before a joint diagnosis."""

import numpy as np
import pytest

from bench.diagnose.baseline.changed_friction import changed_friction
from bench.effects.drifts import COULOMB, DAY_K
from bench.record.joined import joined
from bench.report.diagnosis.baseline import changed_lines
from tests.diagnose.sweeps import SWEEPS, made, nominal


def test_friction_that_changed_between_recordings_is_told_with_both_levels() -> None:
    """A level 30 % higher on the second day ended in 166 Nm (13.8 and 17.8 are right), at 100 %."""
    before = made(SWEEPS, 1, machine=3)
    days = joined({"may": before, "june": made(SWEEPS, 2, {"coulomb_level": 0.4}, machine=3)})
    (found,) = changed_friction(days, nominal())
    assert found.name == "Coulomb friction (joint2)"
    days_apart = np.sqrt(2) * COULOMB * DAY_K  # hidden machines have another level every day as it is
    assert found.found["june"] / found.found["may"] == pytest.approx(1.4, rel=2 * days_apart)
    (line,) = changed_lines([found])
    assert "Nm in may and" in line
    assert "bench compare" in line


def test_friction_that_stayed_is_not() -> None:
    days = joined({"may": made(SWEEPS, 1, machine=3), "june": made(SWEEPS, 2, machine=3)})
    assert not list(changed_friction(days, nominal()))


def test_one_recording_has_nothing_to_differ_from() -> None:
    assert not list(changed_friction(made(SWEEPS, 1), nominal()))
