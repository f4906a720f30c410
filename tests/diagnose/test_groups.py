"""What could stand in the place of each finding."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bench.diagnose.name.groups import Keys, groups_of

CAUSES: dict[Any, Any] = {
    key: SimpleNamespace(key=key) for key in ("gas", "heat", "offset", "friction", "slope", "far")
}


def groups(*best: str, **odds: float) -> list[dict[str, float]]:
    """Return the groups of a model; odds by subset, keys joined with an underscore."""
    posterior: dict[Keys, float] = {frozenset(keys.split("_")): value for keys, value in odds.items()}
    found = groups_of(best, posterior, CAUSES)
    return [{str(member.cause.key): member.probability for member in group.members} for group in found]


def test_each_finding_has_its_own_names() -> None:
    """Two findings with two names each are two sets of two, not one of four."""
    gas, offset = groups("gas", "offset", gas_offset=10.0, heat_offset=9.0, gas_friction=10.0, heat_friction=9.0)
    share = 1 / (1 + np.exp(-1.0))
    assert gas == pytest.approx({"gas": share, "heat": 1 - share})
    assert offset == pytest.approx({"offset": 0.5, "friction": 0.5})


def test_what_the_search_did_not_visit_does_not_count() -> None:
    """Names of one finding are weighed with all other findings as they are, so that products need not be visited."""
    gas, offset = groups("gas", "offset", gas_offset=10.0, heat_offset=10.0, gas_friction=10.0)
    assert gas == pytest.approx({"gas": 0.5, "heat": 0.5})
    assert offset == pytest.approx({"offset": 0.5, "friction": 0.5})


def test_a_cause_that_stands_for_two_belongs_to_the_one_that_explains_most() -> None:
    gas, offset = groups("gas", "offset", gas_offset=10.0, heat=10.0)
    assert set(gas) == {"gas", "heat"}
    assert offset == pytest.approx({"offset": 0.5})


def test_what_is_far_behind_is_told_apart() -> None:
    (gas,) = groups("gas", gas=10.0, far=3.0, heat=8.0)
    assert set(gas) == {"gas", "heat"}


def test_a_finding_that_may_not_be_is_less_than_certain() -> None:
    posterior: dict[Keys, float] = {frozenset({"gas", "slope"}): 10.0, frozenset({"gas"}): 10.0}
    gas, slope = groups_of(("gas", "slope"), posterior, CAUSES)
    assert gas.probability == pytest.approx(1.0)
    assert slope.probability == pytest.approx(0.5)


def test_names_have_shares_far_behind_another_model_too() -> None:
    """A verdict on a recorded motion had no probabilities: odds of e^800 are no number."""
    posterior: dict[Keys, float] = {frozenset({"gas"}): 10.0, frozenset({"heat"}): 10.0, frozenset({"far"}): 900.0}
    (gas,) = groups_of(("gas",), posterior, CAUSES)
    assert gas.probability == pytest.approx(1.0)  # "far" could stand in its place
    (gas,) = groups_of(("gas",), {frozenset({"gas"}): 10.0, frozenset(): 900.0}, CAUSES)
    assert [member.probability for member in gas.members] == [0.0]


def test_a_pair_of_two_of_its_names_counts_once() -> None:
    (gas,) = groups_of(
        ("gas",), {frozenset({"gas"}): 10.0, frozenset({"gas", "heat"}): 9.0, frozenset({"heat"}): 9.5}, CAUSES
    )
    assert gas.probability == pytest.approx(1.0)


def test_a_set_holds_99_percent_and_no_more() -> None:
    (gas,) = groups("gas", gas=10.0, heat=10.0, slope=10.0 - np.log(0.99 * 50), offset=4.5)
    assert set(gas) == {"gas", "heat", "slope"}


def test_names_are_weighed_beside_any_name_of_the_others() -> None:
    """An offset of a current was given 0.4 % where a torque like it had 99 %; with a payload they were found equal.

    What is not simulated is held to the least of those that promised more, so it says nothing of a ratio.
    """
    odds = {"gas_offset": 10.0, "heat_offset": 9.8, "heat_slope": 9.75, "gas_slope": 4.0, "heat_friction": 9.0}
    posterior: dict[Keys, float] = {frozenset(keys.split("_")): value for keys, value in odds.items()}
    simulated = posterior.keys() - {frozenset({"gas", "slope"})}
    _, offset = groups_of(("gas", "offset"), posterior, CAUSES, simulated)
    names = {str(member.cause.key): member.probability / offset.probability for member in offset.members}
    weights = {"offset": 1.0, "slope": np.exp(-0.05), "friction": np.exp(-0.8)}
    assert names == pytest.approx({name: weight / sum(weights.values()) for name, weight in weights.items()})


def test_what_is_superfluous_beside_another_name_stands_for_nothing() -> None:
    """Twenty causes that act in no way had 5 % each: beside a second name of a finding they took its place in turn."""
    posterior: dict[Keys, float] = {
        frozenset({"gas", "offset"}): 10.0,
        frozenset({"heat", "offset"}): 8.0,
        frozenset({"gas", "heat", "offset"}): 6.0,
        frozenset({"heat", "offset", "slope"}): 5.0,
        frozenset({"gas", "heat"}): 5.0,
        frozenset({"heat", "slope"}): 4.5,
    }
    gas, offset = groups_of(("gas", "offset"), posterior, CAUSES)
    assert gas.keys == {"gas", "heat"}
    assert offset.keys == {"offset"}


def test_what_is_no_better_than_nothing_is_no_name() -> None:
    """A scale of a torque at even odds had 95 other names, of 0.3 % each: whatever else might act besides nothing."""
    posterior: dict[Keys, float] = {
        frozenset({"gas", "offset"}): 10.0,
        frozenset({"gas"}): 9.9,
        frozenset({"gas", "friction"}): 9.95,  # it is likelier that it acts than that nothing does
        frozenset({"gas", "slope"}): 5.0,
        frozenset({"gas", "far"}): 9.0,
    }
    _, offset = groups_of(("gas", "offset"), posterior, CAUSES)
    assert offset.keys == {"offset", "friction"}
    weights = {key: float(np.exp(value)) for key, value in posterior.items()}
    of_both = sum(weight for key, weight in weights.items() if key & offset.keys)
    assert offset.probability == pytest.approx(of_both / sum(weights.values()))


def test_one_cause_in_the_place_of_all_findings_is_one_finding() -> None:
    """A diagnosis that ended before it fitted a payload of 1.2 kg named it seven times, for all that imitates it."""
    (far,) = groups("gas", "offset", gas_offset=0.0, far_offset=50.0, far_gas=50.0, far=60.0)
    assert set(far) == {"far"}
