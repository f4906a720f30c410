"""Campaigns of one channel, put together by hand, and their exact fits: for tests of held-out runs."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np

from bench.diagnose.extend.fit import Fit, Unknown
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.noise_covariance import Scatter, Whitening
from bench.diagnose.replay.nuisances import Nuisance
from bench.diagnose.replay.quantities import Quantity
from bench.diagnose.replay.segments import Segment
from bench.effects.catalogue import catalogue
from bench.effects.conditions import Conditions
from bench.effects.effect import WHOLE
from bench.simulate.prescribed import Motion

SIGMA = 0.2  # [A]
LENGTH = 12  # instants of a run
EFFECT = catalogue()["gas_loss"]
CAUSE = Cause(EFFECT, WHOLE, EFFECT.parameters, ())
UNKNOWN = Unknown(CAUSE, EFFECT.parameters[0])


def design_with(
    residual: np.ndarray, sensitivities: np.ndarray, runs: int, modes: np.ndarray | None = None
) -> LinearisedModel:
    """Return a campaign of one channel, noise SIGMA; residual of shape (T,), changes of shape (T, p)."""
    n = len(residual) // runs
    zeros = np.zeros((n, 1))
    motion = Motion(np.arange(n, dtype=float), zeros, zeros, zeros, np.zeros((n, 6)), np.ones(n, dtype=bool))
    segments, whitenings = [], []
    for i in range(runs):
        observed, sigma = residual[i * n : (i + 1) * n, None], np.full((n, 1), SIGMA)
        standing = np.zeros(1, dtype=bool)
        at = Conditions.reference(1)
        segments.append(
            Segment(
                f"run{i}", f"run{i}", False, motion, at, observed, sigma, standing, 0 * sigma, observed[:, 0] < -np.inf
            )
        )
        factors = np.full((n, 1, 1), 1 / SIGMA)
        common = np.zeros((n, 0)) if modes is None else modes / SIGMA
        found, size, _ = np.linalg.svd(common, full_matrices=False)
        whitenings.append(Whitening(np.ones(n, dtype=bool), factors, found, 1 - 1 / np.sqrt(1 + size**2)))
    observed = np.concatenate([segment.observed for segment in segments])
    quantities = (Quantity("current_1_a", "current", "A"),)
    replay = SimpleNamespace(segments=tuple(segments), quantities=quantities, observed=observed)
    empty = np.empty(0)
    draft = LinearisedModel(
        replay=replay,  # type: ignore[arg-type]
        nuisances=tuple(Nuisance(f"n{i}", "", 1.0) for i in range(sensitivities.shape[1])),
        responses=(),
        whitenings=tuple(whitenings),
        repeated=(),
        scatter=Scatter(np.zeros(1), np.zeros((2, 1)), 0.0),
        weighed=tuple(segments),
        inflation=np.ones((2, 1)),
        unexplained=np.ones((2, 1)),
        sensitivities=sensitivities[:, None, :],
        residual=residual[:, None],
        jacobian=empty,
        white=empty,
        run_of=np.repeat(np.arange(runs), n),
        runs=tuple(f"run{i}" for i in range(runs)),
        column_of=np.zeros(len(residual), dtype=int),
    )
    return replace(draft, jacobian=draft.whiten(draft.sensitivities), white=draft.whiten(draft.residual))


def fit_of(linear: LinearisedModel, column: np.ndarray | None = None) -> Fit:
    """Return the exact fit of nuisances and, if there is a column of shape (T,), of one unknown."""
    jacobian = np.zeros((*linear.residual.shape, 0)) if column is None else column[:, None, None]
    unknowns = () if column is None else (UNKNOWN,)
    tangent = np.concatenate([linear.jacobian, linear.whiten(jacobian)], axis=1)
    p = linear.jacobian.shape[1]
    prior = np.concatenate([np.ones(p), [1 / u.sigma**2 for u in unknowns]])
    curvature = tangent.T @ tangent + np.diag(prior)
    found = np.linalg.solve(curvature, tangent.T @ linear.white)
    left = linear.residual - linear.sensitivities @ found[:p] - jacobian @ found[p:]
    causes = (CAUSE,) if unknowns else ()
    covariance = np.linalg.inv(curvature)[p:, p:]
    return Fit(causes, unknowns, found[p:], covariance, found[:p], 0.0, 0.0, left, jacobian, np.zeros(1))


def noise(rng: np.random.Generator, runs: int) -> np.ndarray:
    return SIGMA * rng.standard_normal(runs * LENGTH)


def sensitivities(rng: np.random.Generator, runs: int, p: int = 3) -> np.ndarray:
    return 0.3 * rng.standard_normal((runs * LENGTH, p))


def in_recordings(linear: LinearisedModel, whose: tuple[str | None, ...]) -> LinearisedModel:
    """Return a campaign of which each run is a recording, with nuisances that belong to all or to one."""
    segments = tuple(replace(segment, recording=segment.run) for segment in linear.segments)
    observed = np.concatenate([segment.observed for segment in segments])
    replay = SimpleNamespace(segments=segments, quantities=linear.quantities, observed=observed)
    nuisances = tuple(Nuisance(f"n{i}", "", 1.0, recording=name) for i, name in enumerate(whose))
    return replace(linear, replay=replay, nuisances=nuisances)  # type: ignore[arg-type]
