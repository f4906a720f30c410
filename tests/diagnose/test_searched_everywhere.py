"""A search where an effect acts in every joint: friction that fell looks like masses and torque constants that grew."""

import numpy as np
import pytest

from bench.diagnose.linearise.marginal import Nuisances
from bench.diagnose.name.search import everywhere, search, searched_from_each
from bench.diagnose.name.subset_posterior import SubsetPosterior, Term

JOINTS, INSTANTS = 4, 60
NOISE, FRICTION = 0.02, 1.5
EFFECTS = ("mass", "coulomb", "scale")
TRUE = tuple(range(JOINTS - 1, 2 * JOINTS))  # the last mass and all frictions
STUCK = range(8)  # of these machines some are


def arm(seed: int) -> SubsetPosterior:
    """Return torques of a machine whose last mass grew by a half and whose friction fell by a tenth everywhere.

    Torques of joint j are the masses beyond it, each with its own motion, and friction. The scale of each torque drifts
    by 1.4 %, viscous friction by 20 %.
    """
    rng = np.random.default_rng(seed)
    t = np.linspace(0, 2 * np.pi, INSTANTS)
    of_mass = np.zeros((JOINTS, JOINTS, INSTANTS))
    for j in range(JOINTS):
        for m in range(j, JOINTS):
            for harmonic in (1, 2):
                of_mass[j, m] += rng.normal() * np.sin(harmonic * t + rng.uniform(0, 2 * np.pi))
    speed = np.sin(t * np.arange(1, JOINTS + 1)[:, None] / 2 + rng.uniform(0, 2 * np.pi, (JOINTS, 1)))
    drive = np.eye(JOINTS)[:, :, None]
    coulomb, viscous = drive * FRICTION * np.sign(speed), drive * FRICTION * speed
    scale = drive * of_mass.sum(axis=1) + coulomb + viscous
    masses = of_mass.swapaxes(0, 1)
    columns = np.concatenate([masses, coulomb, scale]).reshape(3 * JOINTS, -1).T / NOISE
    drifts = np.concatenate([0.014 * scale, 0.2 * viscous]).reshape(2 * JOINTS, -1).T / NOISE
    fell = viscous.sum(axis=0).ravel() / NOISE + columns[:, JOINTS : 2 * JOINTS].sum(axis=1)
    white = 0.5 * columns[:, JOINTS - 1] - 0.1 * fell + rng.standard_normal(len(columns))
    products = Nuisances(drifts).products(white, columns)
    terms = [
        Term((effect, place), np.array([k * JOINTS + place]), np.array([0.3]), -7.0, np.zeros(1))
        for k, effect in enumerate(EFFECTS)
        for place in range(JOINTS)
    ]
    return SubsetPosterior(products.information, products.scores, terms)


def begun(model: SubsetPosterior) -> list[tuple[int, ...]]:
    return everywhere(model, [effect for effect in EFFECTS for _ in range(JOINTS)])


@pytest.mark.parametrize("seed", STUCK)
def test_friction_that_fell_everywhere_is_found_beside_a_larger_change(seed: int) -> None:
    model = arm(seed)
    assert searched_from_each(model, ((), *begun(model)))[0].terms == TRUE


def test_a_search_from_nothing_ends_elsewhere_on_some_of_them() -> None:
    behind = [search(model)[0].log_posterior - model.log_posterior(TRUE) for model in map(arm, STUCK)]
    assert sum(rise < -10 for rise in behind) >= 2


def test_groups_begin_in_their_best_shapes_and_only_where_they_explain_something() -> None:
    columns = np.eye(3)
    white = np.array([8.0, 6.0, 0.0])
    terms = [Term("a", np.array([0]), np.array([prior]), -3.0, np.zeros(1)) for prior in (0.01, 8.0)] + [
        Term(key, np.array([k]), np.array([8.0]), -3.0, np.zeros(1)) for k, key in enumerate("bc", 1)
    ]
    products = Nuisances(np.zeros((3, 0))).products(white, columns)
    model = SubsetPosterior(products.information, products.scores, terms)
    assert everywhere(model, ["one", "one", "one", "other"]) == [(1, 2)]  # "c" alone is no group
    assert everywhere(model, [None, None, "one", "one"]) == [(2, 3)]
    assert everywhere(model, [None] * 4) == []
