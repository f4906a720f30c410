"""Constants of the diagnosis: all are found, one is changed everywhere and set back, and what moves is told."""

from dataclasses import replace

import pytest

from bench.diagnose.replay import noise, segments
from bench.study.constants import Constant, constants_of, set_to
from bench.study.outcome import Answer
from bench.study.vary import Variation, lines_of, moved
from tests.study.answers import COULOMB, LOSS, explanation


def test_constants_are_numbers_with_names_in_capitals() -> None:
    every = constants_of()
    words = [constant.words for constant in every]
    assert len(set(words)) == len(words)
    assert len(every) > 20
    assert {constant.words for constant in constants_of("replay.*")} < set(words)
    assert [c.value for c in constants_of("replay.segments.BY_CHANCE")] == [segments.BY_CHANCE]
    assert constants_of("*.UNIFORM") == (Constant("bench.diagnose.replay.noise", "UNIFORM", noise.UNIFORM),)


def test_a_constant_is_changed_where_it_is_imported_too() -> None:
    (uniform,) = constants_of("replay.noise.UNIFORM")
    before = noise.UNIFORM
    with set_to(uniform, 7.0):
        assert (noise.UNIFORM, segments.UNIFORM) == (7.0, 7.0)
    assert (before, before) == (noise.UNIFORM, segments.UNIFORM)
    with pytest.raises(ZeroDivisionError), set_to(uniform, 7.0):
        raise ZeroDivisionError
    assert (before, before) == (noise.UNIFORM, segments.UNIFORM)


@pytest.mark.parametrize(
    ("value", "factor", "expected"), [(3.0, 0.5, 1.5), (3, 2.0, 6), (1, 0.5, 1), (5, 0.5, 2), ((1.0, 4), 0.5, (0.5, 2))]
)
def test_whole_numbers_stay_whole(
    value: float | tuple[float, ...], factor: float, expected: float | tuple[float, ...]
) -> None:
    assert Constant("bench.diagnose.verdict", "NOISY", value).times(factor) == expected


def test_what_moves_is_told() -> None:
    before = Answer("cause", (explanation(LOSS, probability=0.9, value=0.1, sigma=0.01),))
    same = Answer("cause", (explanation(LOSS, probability=0.7, value=0.12, sigma=0.005),))
    found = moved("one", before, same)
    assert not found.is_other
    assert found.probability == pytest.approx(-0.2)
    assert found.shift == pytest.approx(2.0)
    assert found.width == pytest.approx(2.0)
    other = moved("two", before, Answer("unlisted cause", (explanation(COULOMB),), unlisted="joint 2"))
    assert other.is_other
    assert (other.shift, other.width) == (0.0, 1.0)
    variation = Variation(Constant("bench.diagnose.verdict", "NOISY", 3.0), 2.0)
    head, line = lines_of(variation, (found, other))
    assert head.startswith("verdict.NOISY 3.0 -> 6.0: other causes in 1 of 2")
    assert "values by 2 sigma" in head
    assert "two: gas_loss (robot) -> coulomb_level (joint 2), unlisted at joint 2" in line
    assert lines_of(variation, (moved("one", before, replace(before)),)) == ["verdict.NOISY 3.0 -> 6.0: nothing"]


def test_a_diagnosis_that_fails_is_another_answer() -> None:
    before = Answer("nothing found")
    assert moved("one", before, Answer("failed", failure="ValueError: empty")).after == "ValueError: empty"
