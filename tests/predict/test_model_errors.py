"""What a diagnosis did not know of its model is in the intervals of what is fitted anew."""

import numpy as np
import pytest

from bench.diagnose.cross_validation.figures import FittedFigure
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.replay.posterior import Posterior, PosteriorParameter
from bench.predict.fit_anew import Anew, freed_beside_the_day
from bench.predict.model_errors import model_errors
from bench.predict.predict import predict
from bench.robot.compiled import CompiledRobot
from tests.predict.conftest import campaign_of

NORMAL_95 = 1.959964


@pytest.fixture(scope="module")
def stated(nominal: CompiledRobot) -> LinearisedModel:
    """Return a recording with 3 kg of payload, by a model that carries nothing."""
    recorded = campaign_of(nominal, 2, "unstated_payload", mass=3.0, second_moment_y=0.05)
    return predict(recorded, nominal, nominal).recordings[0].linear


@pytest.fixture(scope="module")
def anew(stated: LinearisedModel) -> Anew:
    return freed_beside_the_day(stated, ("payload",))


def payload(sigma: float) -> PosteriorParameter:
    name = "payload that is not stated: mass, as found before"
    return PosteriorParameter(name, "kg", sigma, 1.0, "unstated_payload", "robot", "mass")


def sigma_of(figure: FittedFigure) -> float:
    return (figure.high - figure.low) / (2 * NORMAL_95)


def mass(anew: Anew, stated: LinearisedModel, *known: PosteriorParameter, covariance: object) -> tuple[float, float]:
    """Return the standard errors of the difference of masses, and of both together."""
    errors = model_errors(stated, Posterior(known, np.array(covariance)))
    one, other = next((one, other) for one, other in anew.figures(errors) if one.name.endswith(": mass"))
    assert other is not None
    assert one.found == other.found
    return sigma_of(one), sigma_of(other)


def test_the_models_own_payload_is_in_the_difference_and_not_in_the_total(anew: Anew, stated: LinearisedModel) -> None:
    exact, none = next(rows for rows in anew.figures() if rows[0].name.endswith(": mass"))
    assert none is None
    difference, total = mass(anew, stated, payload(2.0), covariance=[[0.04]])  # 0.2 of 2 kg
    np.testing.assert_allclose(difference, np.hypot(sigma_of(exact), 0.4), rtol=1e-6)
    np.testing.assert_allclose(total, sigma_of(exact), rtol=1e-6)


def test_what_bends_model_and_fit_alike_cancels_in_the_difference(anew: Anew, stated: LinearisedModel) -> None:
    """A link that was taken for lighter than it is makes both payloads heavier: only their difference is known."""
    exact = sigma_of(next(one for one, _ in anew.figures() if one.name.endswith(": mass")))
    link = PosteriorParameter(next(str(one) for one in stated.nuisances if one.of_mass), "", 0.1, 0.0)
    alone, total = mass(anew, stated, link, covariance=[[1.0]])
    np.testing.assert_allclose(alone, total)
    bent = float(np.sqrt(alone**2 - exact**2))
    assert bent > 0.5 * exact
    rho, either = 0.9999, list[float]()
    for sign in (-1, 1):
        known = link, payload(bent)
        covariance = [[1.0, sign * rho], [sign * rho, 1.0]]
        difference, total = mass(anew, stated, *known, covariance=covariance)
        np.testing.assert_allclose(total, alone, rtol=1e-6)
        either.append(difference)
    np.testing.assert_allclose(
        sorted(either), np.sqrt(exact**2 + 2 * bent**2 * np.array([1 - rho, 1 + rho])), rtol=1e-6
    )
