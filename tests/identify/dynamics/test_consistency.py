"""Bodies that can exist: pseudo-inertia, and the most probable point among them."""

import numpy as np

from bench.identify.arm import Arm
from bench.identify.dynamics.consistency import bodies_of, inertial_parameters, nearest, pseudo_inertia
from bench.identify.dynamics.equations import OPTIONAL
from bench.identify.dynamics.parameters import Layout
from bench.identify.dynamics.prior import prior_of
from bench.identify.dynamics.regressor import standard_parameters
from bench.identify.dynamics.widths import Widths
from tests.identify.dynamics.rigid_world import N, arm, robot


def test_pseudo_inertia_there_and_back(rng: np.random.Generator) -> None:
    for link in standard_parameters(arm()).reshape(N, 10):
        np.testing.assert_allclose(inertial_parameters(pseudo_inertia(link)), link, rtol=1e-12, atol=1e-12)
        assert np.linalg.eigvalsh(pseudo_inertia(link))[0] > 0


def test_a_rod_longer_than_its_inertia_allows_cannot_exist() -> None:
    point = pseudo_inertia(np.array([2.0, 2.0, 0, 0, 0, 0, 2.0, 0, 0, 2.0]))  # 2 kg at x = 1 m, and nothing else
    np.testing.assert_allclose(np.linalg.eigvalsh(point)[:3], 0, atol=1e-12)
    assert np.linalg.eigvalsh(pseudo_inertia(np.array([2.0, 2.0, 0, 0, 0, 0, 1.9, 0, 0, 1.9])))[0] < 0


def test_nearest_is_feasible_and_no_feasible_point_is_more_probable(rng: np.random.Generator) -> None:
    nominal, layout = robot(arm(), payload=20.0), Layout(N, True, False)
    prior = prior_of(layout, nominal, Arm(nominal.bodies), np.full(N, 100.0), np.full(N, 1.0))
    factor = prior.factor(Widths(4, 0, (0,) * N, (0,) * len(OPTIONAL) * N))
    sigma = np.sqrt(np.sum(factor**2, axis=1))
    bodies = bodies_of(layout, nominal.bodies.names, prior.mean, sigma, nominal.payload, 0.7)
    rows = rng.standard_normal((200, layout.size))
    gram = rows.T @ rows
    wanted = prior.mean + factor @ rng.standard_normal(layout.size)
    wanted[layout.payload.start] = -3.0
    assert "payload" in bodies.broken(wanted)
    found = nearest(bodies, wanted, prior.mean, factor, gram)
    assert bodies.broken(found) == ()
    inverse = np.linalg.pinv(factor)
    precision = np.eye(layout.size) + factor.T @ gram @ factor

    def improbability(parameters: np.ndarray) -> float:
        z = inverse @ (parameters - wanted)
        return float(z @ precision @ z) / 2

    best = improbability(found)
    for _ in range(300):  # the set is convex: if any point of it were better, so would be one nearby towards it
        other = prior.mean + factor @ rng.standard_normal(layout.size)
        if not bodies.broken(other):
            assert improbability(found + 1e-3 * (other - found)) > best - 1e-3


def test_what_can_exist_is_left_as_it_is() -> None:
    nominal, layout = robot(arm()), Layout(N, False, False)
    prior = prior_of(layout, nominal, Arm(nominal.bodies), np.full(N, 100.0), np.full(N, 1.0))
    sigma = np.ones(layout.size)
    bodies = bodies_of(layout, nominal.bodies.names, prior.mean, sigma, 0.0, 0.7)
    parameters = bodies.start
    assert nearest(bodies, parameters, prior.mean, np.eye(layout.size), np.eye(layout.size)) is parameters
