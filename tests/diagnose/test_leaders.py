"""Which models are simulated."""

from types import SimpleNamespace
from typing import Any

import numpy as np

from bench.diagnose.name.leaders import grown, leaders_of, other_names, rivals_of, scattering, without
from bench.diagnose.name.search import Alternative, Subset
from bench.diagnose.name.subset_posterior import SubsetPosterior, Term


def linearised() -> Any:
    """Friction and softening at joint 1, friction at joint 2, and play at joint 1, which nothing has found."""
    names = ("friction 1", "softening 1", "friction 2", "play 1")
    causes = [SimpleNamespace(key=name, effect=SimpleNamespace(scatters=name.startswith("play"))) for name in names]
    return SimpleNamespace(
        what=[SimpleNamespace(drive=int(name[-1])) for name in names],
        model=SimpleNamespace(terms=causes),
        cause=causes.__getitem__,
        candidate_of=lambda which: frozenset(names[i] for i in which),
    )


def never(terms: object, i: int, play: int) -> bool:
    return False


def test_a_play_is_tried_beside_and_in_the_place_of_whatever_is_at_its_joint() -> None:
    leader = Alternative(frozenset({"friction 1", "softening 1", "friction 2"}), Subset((0, 1, 2), 0.0), 0.0)
    found = scattering(linearised(), leader, set(), never)
    assert {
        there: set(candidate) - there  # type: ignore[call-overload]
        for there, candidate in found.items()
    } == {
        frozenset({"friction 1", "softening 1", "play 1"}): {"friction 2"},
        frozenset({"friction 1", "play 1"}): {"friction 2"},
        frozenset({"softening 1", "play 1"}): {"friction 2"},
    }


def test_a_play_that_fell_behind_is_not_tried_again_for_what_is_found_elsewhere() -> None:
    leader = Alternative(frozenset({"friction 1", "friction 2"}), Subset((0, 2), 0.0), 0.0)
    behind = scattering(linearised(), leader, set(), never).keys()
    alone = Alternative(frozenset({"friction 1"}), Subset((0,), 0.0), 0.0)
    assert scattering(linearised(), alone, behind, never) == {}
    assert scattering(linearised(), Alternative(frozenset({"softening 1"}), Subset((1,), 0.0), 0.0), behind, never)


def test_a_play_is_not_tried_in_the_place_of_what_motion_needs() -> None:
    leader = Alternative(frozenset({"friction 1", "softening 1"}), Subset((0, 1), 0.0), 0.0)
    found = scattering(linearised(), leader, set(), lambda terms, i, play: i == 0)
    assert set(found) == {frozenset({"friction 1", "softening 1", "play 1"}), frozenset({"friction 1", "play 1"})}


def test_what_has_all_of_a_model_and_more_is_simulated_as_well(rng: np.random.Generator) -> None:
    """Models without a part of it promised more, and fell short: what was missing beside it was never tried."""
    columns, noise = rng.standard_normal((80, 3)), rng.standard_normal(80)
    white = columns @ [6.0, 4.0, 5.0] + noise
    terms = [Term(name, np.array([i]), np.full(1, 5.0), -7.0, np.zeros(1)) for i, name in enumerate("abc")]
    model = SubsetPosterior(columns.T @ columns, columns.T @ white, terms)
    about: Any = SimpleNamespace(model=model, present=(0, 1), about=SimpleNamespace(keys=frozenset("ab")))
    without = Alternative(frozenset("bc"), Subset((1, 2), 900.0), 900.0)
    assert grown(about, [without]) == (0, 1, 2)
    assert grown(about, [without, Alternative(frozenset("abc"), Subset((0, 1, 2), 800.0), 800.0)]) == ()


def test_what_is_listed_is_tried_in_the_place_of_a_shape(rng: np.random.Generator) -> None:
    """Coulomb friction of an axis was never tried, for a torque over its speed had come first and was held on to."""
    columns, noise = rng.standard_normal((80, 3)), rng.standard_normal(80)
    columns[:, 2] = columns[:, 1] + 0.1 * columns[:, 2]
    white = columns[:, :2] @ [6.0, 4.0] + noise
    terms = [Term(name, np.array([i]), np.full(1, 5.0), -7.0, np.zeros(1)) for i, name in enumerate("ab")]
    terms.append(Term("shape", np.array([2]), np.full(1, 5.0), -7.0, np.zeros(1), is_listed=False))
    model = SubsetPosterior(columns.T @ columns, columns.T @ white, terms)
    about = SimpleNamespace(model=model)
    assert without(about, (0, 2), (2,), with_listed=True) == ((0,), (0, 1))
    assert without(about, (0, 2), (2,), with_listed=False) == ((0,),), "a search that is not the last goes on anyway"


def test_what_is_listed_and_explains_little_of_a_shape_is_not_tried(rng: np.random.Generator) -> None:
    """Nine causes that promised a quarter of it were fitted for a minute, in every round (a detent, seed 1021)."""
    columns, noise = rng.standard_normal((80, 3)), rng.standard_normal(80)
    columns[:, 1] += 0.5 * columns[:, 2]
    white = columns[:, [0, 2]] @ [6.0, 8.0] + noise
    terms = [Term(name, np.array([i]), np.full(1, 5.0), -7.0, np.zeros(1)) for i, name in enumerate("ab")]
    terms.append(Term("shape", np.array([2]), np.full(1, 5.0), -7.0, np.zeros(1), is_listed=False))
    model = SubsetPosterior(columns.T @ columns, columns.T @ white, terms)
    explained = model.log_posterior((0, 1)) - model.log_posterior((0,))
    assert 4.6 < explained < 0.5 * (model.log_posterior((0, 2)) - model.log_posterior((0,)))
    assert without(SimpleNamespace(model=model), (0, 2), (2,), with_listed=True) == ((0,),)


def test_a_finding_with_many_names_leaves_room_for_those_of_another() -> None:
    """From which of six runs on gas was lost took all places; that the gas might be colder was never simulated."""

    def alternative(names: str, value: float) -> Alternative:
        return Alternative(frozenset(names.split()), Subset((), value), value)

    found = [alternative(f"loss step{i}", 50.0 - i / 10) for i in range(6)]
    found += [alternative("cold step0", 43.0), alternative("cold step1", 42.9), alternative("cold", 42.0)]
    many = leaders_of(found, 4)
    assert many == found[:4]
    simulated = {one.keys for one in many}
    assert rivals_of(found, found[0].keys, simulated, simulated) == [found[6]]
    with_another = simulated | {found[7].keys}
    assert rivals_of(found, found[0].keys, with_another, with_another) == [found[6]]
    with_cold = simulated | {found[6].keys}
    assert rivals_of(found, found[0].keys, with_cold, with_cold) == []


def test_the_best_of_simulated_models_has_rivals_whatever_promised_more() -> None:
    """Three findings of three joints: leaders had two of them each, and other names of the third were never tried."""
    names = ["cold+stiff", "warm+stiff", "cold+stiff+rough", "warm+stiff+rough", "cold+rough"]
    found = [Alternative(frozenset(name.split("+")), Subset((), -i), -i) for i, name in enumerate(names)]
    simulated = {found[i].keys for i in (0, 1, 2)}
    assert rivals_of(found, found[2].keys, simulated, simulated) == [found[3]]


def test_a_name_that_fell_short_is_no_reason_to_try_no_other() -> None:
    """One finding got one other name in all: where that was ruled out, its equal was never simulated."""
    names = ["payload+direction", "payload+scale", "payload+constant"]
    found = [Alternative(frozenset(name.split("+")), Subset((), -i), -i) for i, name in enumerate(names)]
    simulated = {found[0].keys, found[1].keys}
    assert rivals_of(found, found[0].keys, {found[0].keys}, simulated) == [found[2]]
    assert rivals_of(found, found[0].keys, simulated, simulated) == [], "one that is as good will do"


def test_a_model_that_no_search_visited_has_other_names(rng: np.random.Generator) -> None:
    """The best of simulated models had no rivals where another one had promised more: it was looked up among those."""
    columns, noise = rng.standard_normal((80, 3)), rng.standard_normal(80)
    columns[:, 2] = columns[:, 1] + 1e-3 * columns[:, 2]
    white = columns[:, :2] @ [6.0, 4.0] + noise
    terms = [Term(name, np.array([i]), np.full(1, 5.0), -7.0, np.zeros(1)) for i, name in enumerate("abc")]
    about: Any = SimpleNamespace(model=SubsetPosterior(columns.T @ columns, columns.T @ white, terms), shape=())
    best = frozenset("ab")
    visited = {(0,): Subset((0,), 900.0)}
    assert other_names(about, visited, best, {best}, {best}) == [(0, 2)]
    assert {(0, 1), (0, 2)} <= visited.keys()
