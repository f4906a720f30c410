"""Two recordings of one machine with another friction: said before a joint diagnosis."""

from bench.diagnose.baseline.changed_friction import changed_friction
from bench.record.joined import joined
from bench.report.diagnosis.baseline import changed_lines
from tests.diagnose.sweeps import SWEEPS, made, nominal


def test_friction_that_changed_between_recordings_is_told_with_both_levels() -> None:
    """A level 30 % higher on the second day ended in 166 Nm (13.8 and 17.8 are right), at 100 %."""
    before = made(SWEEPS, 1, machine=3)
    days = joined({"may": before, "june": made(SWEEPS, 5, {"coulomb_level": 0.4}, machine=3)})
    (found,) = changed_friction(days, nominal())
    assert found.name == "Coulomb friction (joint2)"
    assert 1.3 < found.found["june"] / found.found["may"] < 1.5
    (line,) = changed_lines([found])
    assert "Nm in may and" in line
    assert "bench compare" in line


def test_friction_that_stayed_is_not() -> None:
    days = joined({"may": made(SWEEPS, 1, machine=3), "june": made(SWEEPS, 2, machine=3)})
    assert not list(changed_friction(days, nominal()))


def test_one_recording_has_nothing_to_differ_from() -> None:
    assert not list(changed_friction(made(SWEEPS, 1), nominal()))
