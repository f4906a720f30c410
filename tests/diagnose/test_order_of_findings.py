"""In which order findings are told: by how large they surely are, whichever of their names is the true one."""

from dataclasses import replace

import pytest

from bench.diagnose.conclude import in_order
from bench.diagnose.extend.size import NORMAL_95
from bench.diagnose.named_causes import SMALL, AmbiguityGroup, NamedCause, PossibleCause


def cause(effect: str, share: float, sigmas: float = 5.0) -> NamedCause:
    return NamedCause(effect, effect, "joint 1", (), share=share, sigmas=sigmas)


def finding(*names: tuple[NamedCause, float]) -> AmbiguityGroup:
    return AmbiguityGroup(tuple(PossibleCause(one, p) for one, p in names), sum(p for _, p in names))


CURRENT, TORQUE, BY_LOAD = cause("current_offset", 0.4), cause("torque_offset", 0.04), cause("load_friction", 0.17)
OPEN, LARGE = finding((CURRENT, 0.51), (TORQUE, 0.4)), finding((BY_LOAD, 1.0))


def test_a_finding_is_as_large_as_the_smallest_of_its_likely_names() -> None:
    """A small torque stood before the larger cause: as the offset of a current it is a large share of its range."""
    assert OPEN.rank == finding((TORQUE, 0.91)).rank
    assert LARGE.rank > OPEN.rank


def test_a_name_that_is_not_likely_makes_no_finding_small() -> None:
    assert finding((CURRENT, 0.95), (TORQUE, 0.04)).rank == finding((CURRENT, 0.99)).rank
    assert finding((CURRENT, 0.89), (TORQUE, 0.11)).rank == finding((TORQUE, 1.0)).rank


def test_a_finding_is_as_large_as_the_nearer_end_of_its_interval() -> None:
    """An eccentricity of 9 to 33 thousandths of a degree stood before a payload of 134 to 167 kg."""
    assert finding((cause("a", 0.5, sigmas=2 * NORMAL_95), 1.0)).rank[0] == pytest.approx(0.25)
    vague, sure = cause("a", 0.5, sigmas=NORMAL_95 + 0.01), cause("b", 0.3, sigmas=50.0)
    assert finding((sure, 1.0)).rank > finding((vague, 1.0)).rank
    assert cause("a", 0.5, sigmas=1.0).sure_share == 0.0


def test_of_equals_the_surer_one_stands_first() -> None:
    assert finding((cause("a", 0.0, sigmas=1.5), 1.0)).rank > finding((cause("a", 0.0, sigmas=1.0), 1.0)).rank


def test_what_was_not_fitted_stands_between_large_and_small() -> None:
    nobody = replace(CURRENT, share=float("nan"), sigmas=float("nan"))
    small, large = (finding((cause("a", SMALL + by, sigmas=1e6), 1.0)).rank for by in (-0.001, 0.001))
    assert small < finding((nobody, 1.0)).rank < large
    assert finding((nobody, 0.6), (TORQUE, 0.4)).rank == (TORQUE.sure_share, 0.0)


def test_causes_of_an_explanation_stand_as_findings_do() -> None:
    for name in (CURRENT, TORQUE):
        assert in_order([name, BY_LOAD], [LARGE, OPEN]) == (BY_LOAD, name)
    beside = cause("ripple", 0.1)  # of no finding: by its own share
    assert in_order([CURRENT, beside, BY_LOAD], [LARGE, OPEN]) == (BY_LOAD, beside, CURRENT)


def test_a_cause_stands_where_it_is_the_likeliest_name() -> None:
    own = finding((TORQUE, 0.99), (CURRENT, 0.01))
    elsewhere = finding((cause("seal", 0.5), 0.98), (TORQUE, 0.02))
    assert in_order([TORQUE, BY_LOAD], [elsewhere, LARGE, own]) == (BY_LOAD, TORQUE)
