"""The posterior over subsets against dense algebra, quadrature and enumeration."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from scipy.integrate import trapezoid
from scipy.stats import multivariate_normal, norm

from bench.diagnose.linearise.marginal import Nuisances
from bench.diagnose.name import search as search_module
from bench.diagnose.name.search import WINDOW, Subset, alternatives_of, exchanges, search
from bench.diagnose.name.subset_posterior import SubsetPosterior, Term

M, P = 40, 3
ODDS = -3.0
EXACT = 1e-6  # of logarithms; the algebra adds 1e-9 to diagonals


def model_of(
    columns: np.ndarray, white: np.ndarray, jacobian: np.ndarray, signs: tuple[float, ...], prior: float = 1.5
) -> SubsetPosterior:
    products = Nuisances(jacobian).products(white, columns)
    terms = [
        Term(f"cause {i}", np.array([i]), np.array([prior]), ODDS, np.array([sign])) for i, sign in enumerate(signs)
    ]
    return SubsetPosterior(products.information, products.scores, terms)


@pytest.fixture
def data() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(5)
    return rng.standard_normal((M, 4)), rng.standard_normal(M), 0.3 * rng.standard_normal((M, P))


def test_posterior_is_the_ratio_of_normal_densities_with_prior_odds(
    data: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> None:
    columns, white, jacobian = data
    model = model_of(columns, white, jacobian, (0.0,) * 4)
    null = np.eye(M) + jacobian @ jacobian.T
    for which in [(1,), (0, 2), (0, 1, 3)]:
        own = 1.5 * columns[:, list(which)]
        expected = multivariate_normal(cov=null + own @ own.T).logpdf(white) - multivariate_normal(cov=null).logpdf(
            white
        )
        assert model.log_posterior(which) == pytest.approx(expected + len(which) * ODDS, abs=EXACT)


def test_a_size_of_one_sign_has_a_half_normal_prior(data: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
    columns, white, jacobian = data
    free, bound = (
        model_of(columns, white, jacobian, (0.0,) * 4),
        model_of(columns, white, jacobian, (0.0, -1.0, 0.0, 0.0)),
    )
    inverse = np.linalg.inv(np.eye(M) + jacobian @ jacobian.T)

    (a, ab), (_, b) = columns[:, :2].T @ inverse @ columns[:, :2]
    r, s = columns[:, :2].T @ inverse @ white
    x, y = np.linspace(-8, 8, 1601)[:, None], np.linspace(-8, 0, 801)
    fall = r * x + s * y - 0.5 * (a * x**2 + 2 * ab * x * y + b * y**2)
    density = np.exp(fall) * norm(0, 1.5).pdf(x) * 2 * norm(0, 1.5).pdf(y)
    evidence = trapezoid(trapezoid(density, y), x[:, 0])
    assert bound.log_posterior((0, 1)) == pytest.approx(np.log(evidence) + 2 * ODDS, abs=1e-4)
    assert bound.log_posterior((0, 2)) == free.log_posterior((0, 2))


def test_what_an_addition_promises_is_what_it_brings(data: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
    columns, white, jacobian = data
    model = model_of(columns, white, jacobian, (0.0, 0.0, 1.0, -1.0))
    for which in [(), (0,), (0, 1)]:
        rise = model.additions(which)
        for i in range(4):
            if i in which:
                assert rise[i] == -np.inf
            else:
                both = tuple(sorted((*which, i)))
                assert rise[i] == pytest.approx(model.log_posterior(both) - model.log_posterior(which), abs=EXACT)


def test_additions_of_any_number_of_columns_are_what_they_bring_listed_or_not(
    data: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> None:
    columns = np.concatenate([data[0], data[0][::-1] ** 2], axis=1)
    products = Nuisances(data[2]).products(data[1], columns)
    blocks = ((0,), (1, 2), (3, 4, 5), (7, 6), (2,), (1, 5, 6))
    terms = [
        Term(i, np.array(own), np.linspace(1, 2, len(own)), ODDS, np.eye(len(own))[0] * (i == 3), i % 2 == 0)
        for i, own in enumerate(blocks)
    ]
    model = SubsetPosterior(products.information, products.scores, terms)
    for which in [(), (2,), (4, 5)]:
        every, listed, others = (model.additions(which, listed=listed) for listed in (None, True, False))
        for i in sorted({*range(6)} - {*which}):
            brought = model.log_posterior((*which, i)) - model.log_posterior(which)
            asked, other = (listed, others) if i % 2 == 0 else (others, listed)
            assert [every[i], asked[i], other[i]] == [pytest.approx(brought, abs=EXACT)] * 2 + [-np.inf]


def test_search_finds_what_enumeration_finds() -> None:
    rng = np.random.default_rng(7)
    columns = rng.standard_normal((M, 9))
    columns[:, 5] = columns[:, 0] + columns[:, 1] + 0.2 * columns[:, 5]
    for _ in range(5):
        hidden = columns[:, :9] @ (rng.random(9) < 0.4)
        model = model_of(columns, hidden + rng.standard_normal(M), np.zeros((M, 1)), (0.0,) * 9)
        every = {s: model.log_posterior(s) for k in range(10) for s in combinations(range(9), k)}
        found = search(model)
        best = max(every.values())
        assert found[0].log_posterior == pytest.approx(best)
        near = {s for s, value in every.items() if value > best - WINDOW / 2}
        assert near <= {subset.terms for subset in found}


def test_two_causes_behind_one_that_looks_like_both_are_found() -> None:
    """Adding cause after cause takes the column that resembles the sum first, and never parts with it."""
    rng = np.random.default_rng(3)
    one, two = np.linalg.qr(rng.standard_normal((M, 2)))[0].T
    columns = np.stack([one, two, (one + two) / np.sqrt(2) + 0.02 * rng.standard_normal(M)], axis=1)
    white = 12 * one + 8 * two + 0.1 * rng.standard_normal(M)
    model = model_of(columns, white, np.zeros((M, 1)), (0.0,) * 3, prior=10.0)
    assert int(np.argmax(model.additions(()))) == 2
    assert search(model)[0].terms == (0, 1)


def test_one_cause_that_looks_like_two_is_weighed_against_both() -> None:
    """All drives were late, two showed it, and each of those two was named late by itself."""
    rng = np.random.default_rng(5)
    drives = np.linalg.qr(rng.standard_normal((M, 5)))[0]
    columns = np.column_stack([drives, drives.sum(axis=1)])
    white = drives @ np.array([2.0, 5.0, 5.0, 2.0, 2.0])
    model = model_of(columns, white, np.zeros((M, 1)), (0.0,) * 6, prior=5.0)
    two = Subset((1, 2), model.log_posterior((1, 2)))
    one = next(other for other in exchanges(model, two, most=2) if other.terms == (5,))
    assert one.log_posterior == pytest.approx(model.log_posterior((5,)))
    assert one.log_posterior > two.log_posterior
    assert all(other.terms != (5,) for other in (*exchanges(model, two), *exchanges(model, two, always=(1,), most=2)))


def test_shapes_of_one_cause_exclude_each_other_and_count_together(
    data: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> None:
    columns, white, jacobian = data
    plain = model_of(columns, white + 3 * columns[:, 0], jacobian, (0.0,) * 4)
    keys = ("a", "a", "b", "c")
    terms = [
        Term(key, term.columns, term.prior, ODDS, term.sign, key != "c")
        for key, term in zip(keys, plain.terms, strict=True)
    ]
    model = SubsetPosterior(plain.information, plain.scores, terms)
    subsets = search(model)
    assert not any({0, 1} <= set(s.terms) or 3 in s.terms for s in subsets)
    assert all(3 in s.terms for s in search(model, always=(3,)))
    first = alternatives_of(model, subsets)[0]
    same = [s.log_posterior for s in subsets if {keys[i] for i in s.terms} == first.keys]
    assert first.log_posterior == pytest.approx(np.logaddexp.reduce(same))
    assert first.best.log_posterior == max(same)


def test_what_has_no_place_without_a_finding_does_not_stand_in_its_place() -> None:
    """More of a friction acts as the friction does; a robot that has none cannot have more of it."""
    column = np.random.default_rng(3).standard_normal((M, 1))
    products = Nuisances(np.zeros((M, 1))).products(column[:, 0], np.concatenate([column, column], axis=1))
    friction = Term("friction", np.array([0]), np.ones(1), ODDS, np.zeros(1))
    more = replace(friction, key="more", columns=np.array([1]), needs=frozenset({"friction"}))
    model = SubsetPosterior(products.information, products.scores, [friction, more])
    assert model.log_posterior((0,)) > 0 > model.additions((0,))[1] > model.additions(())[1] == -np.inf
    visited = search(model, [(0,)])
    weighed = {one.terms for one in (*visited, *exchanges(model, visited[0])) if np.isfinite(one.log_posterior)}
    assert weighed == {(), (0,), (0, 1)}


def test_no_subset_has_a_size_beyond_what_is_plausible() -> None:
    """A comparison named a centre of mass that had moved by 317 mm, at 100 %, beside a payload that was swapped."""
    rng = np.random.default_rng(3)
    columns = rng.standard_normal((M, 2))
    white = 8.0 * columns[:, 0] + 1.0 * columns[:, 1] + 0.1 * rng.standard_normal(M)
    free = model_of(columns, white, np.zeros((M, 1)), (0.0, 0.0), prior=3.0)
    bound = SubsetPosterior(
        free.information, free.scores, [replace(free.terms[0], most=np.array([5.0])), free.terms[1]]
    )
    assert search(free)[0].terms == (0, 1)
    assert abs(np.linalg.solve(*free.equations((0, 1)))[0]) > 5
    found = search(bound)
    assert all(0 not in subset.terms for subset in (*found, *exchanges(bound, found[0])))
    assert bound.log_posterior((0, 1)) == -np.inf


def test_what_cannot_be_replaced_is_left_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of twenty findings most have no other name: it is looked for once, and what has one is found all the same."""
    rng = np.random.default_rng(7)
    columns = rng.standard_normal((M, 12))
    columns[:, 11] = columns[:, 10] + 0.005 * rng.standard_normal(M)  # the eleventh may as well be the twelfth
    white = columns[:, :11] @ np.full(11, 40.0) + rng.standard_normal(M)
    model = model_of(columns, white, np.zeros((M, P)), (0.0,) * 12, 50.0)
    start, asked = tuple(range(11)), list[tuple[int, ...]]()
    additions = SubsetPosterior.additions
    monkeypatch.setattr(
        SubsetPosterior,
        "additions",
        lambda self, which, listed: asked.append(tuple(which)) or additions(self, which, listed=listed),
    )
    found = {one.terms: one.log_posterior for one in search(model, [start])}
    few = len(asked)
    assert (*range(10), 11) in found
    asked.clear()
    monkeypatch.setattr(search_module, "IRREPLACEABLE", np.inf)
    every = {one.terms: one.log_posterior for one in search(model, [start])}
    assert few < len(asked) / 2
    near = {terms for terms, value in every.items() if value > max(every.values()) - WINDOW}
    assert near <= found.keys()
