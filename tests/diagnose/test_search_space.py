"""A campaign linearised about a model with findings, and models fitted without what they do not need."""

from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.diagnose import Diagnosis, diagnose
from bench.diagnose.extend.fit import BEYOND, fit_without, unknowns_of
from bench.diagnose.extend.refit import refit
from bench.diagnose.linearise.candidates import causes_of
from bench.diagnose.linearise.generic import blocks_of
from bench.diagnose.linearise.marginal import Nuisances
from bench.diagnose.linearise.screening import tried_of
from bench.diagnose.name.models import CandidateModel, Fitter
from bench.diagnose.name.search_space import SearchSpace, search_space
from bench.effects.catalogue import catalogue
from bench.executor.serial import SERIAL
from tests.diagnose.sweeps import SWEEPS, made, nominal

CHOICE = ("coulomb_level", "viscous_level", "gas_loss")


@pytest.fixture(scope="module")
def found() -> Diagnosis:
    effects = catalogue()
    campaign = made(SWEEPS, 6, {"viscous_level": -0.8, "gas_loss": 0.15})
    return diagnose(campaign, nominal(), {name: effects[name] for name in CHOICE}, proposes=False)


@pytest.fixture(scope="module")
def about(found: Diagnosis) -> SearchSpace:
    linear = found.naming.linear
    return search_space(linear, tried_of(blocks_of(linear)), found.verdict.threshold, found.naming.models[0])


def test_taking_a_cause_away_is_exact(found: Diagnosis, about: SearchSpace) -> None:
    """Of the columns of a cause, times its sizes, is left what a simulation without it changes."""
    linear, fit = found.naming.linear, found.naming.models[0].fit
    for cause, tangent in zip(fit.causes, about.tangents, strict=True):
        sizes = [v - u.parameter.null for u, v in zip(fit.unknowns, fit.values, strict=True) if u.cause is cause]
        removed = linear.whiten(fit_without(linear, fit, cause).residual - fit.residual)
        np.testing.assert_allclose(tangent @ sizes, removed, atol=1e-6 * np.max(np.abs(removed)))


def test_what_a_model_does_not_need_is_left_out_of_it(found: Diagnosis) -> None:
    linear = found.naming.linear
    effects = catalogue()
    every = causes_of([effects["viscous_level"], effects["gas_loss"]], nominal(), frozenset())
    gas, idle = (
        next(one for one in every if one.key == key) for key in (("gas_loss", "robot"), ("viscous_level", "joint 5"))
    )
    start = {("gas_loss", "robot", "lost"): 0.1, ("viscous_level", "joint 5", "change"): 0.3}
    fitter = Fitter(linear, refit(linear, (), {}), SERIAL)
    (model,) = fitter.fitted([CandidateModel((gas, idle), None, start, None, (-5.0, -7.0))])
    assert model.keys == {gas.key}
    assert model.log_posterior == pytest.approx(model.log_evidence - 5.0)


def test_a_fit_that_wants_more_than_is_plausible_is_none(found: Diagnosis) -> None:
    fit = found.naming.models[0].fit
    assert fit.is_plausible
    high = np.array([unknown.parameter.high for unknown in unknowns_of(fit.causes)])
    assert not replace(fit, values=np.array([BEYOND * high[0], *fit.values[1:]])).is_plausible


def test_what_is_beside_listed_causes_is_orthogonal_to_them(rng: np.random.Generator) -> None:
    jacobian, known, columns = rng.standard_normal((30, 4)), rng.standard_normal((30, 2)), rng.standard_normal((30, 3))
    left = columns - known @ Nuisances(jacobian).regression(known, columns)
    inverse = np.linalg.inv(np.eye(30) + jacobian @ jacobian.T)
    np.testing.assert_allclose(known.T @ inverse @ left, 0.0, atol=1e-6)


def test_findings_are_found_again_without_a_part_of_the_runs(found: Diagnosis) -> None:
    assert [finding.repeats for finding in found.naming.findings] == [1.0, 1.0]
