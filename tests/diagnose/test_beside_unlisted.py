"""What listed causes are worth beside something unlisted."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.special import expit, logsumexp
from scipy.stats import multivariate_normal, norm

from bench.diagnose.extend.fit import unknowns_of
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.first_order import FirstOrder
from bench.diagnose.linearise.generic import blocks_at, hats
from bench.diagnose.linearise.screening import widths_of
from bench.diagnose.linearise.threshold import LEAST
from bench.diagnose.name.beside_unlisted import free_beside, group_beside, log_odds, log_odds_as_runs_say
from bench.diagnose.name.groups import IN_SET, AmbiguityGroup, Member
from bench.diagnose.name.subset_posterior import SubsetPosterior, Term
from bench.diagnose.replay.world import NOMINAL
from bench.effects.catalogue import catalogue
from bench.effects.effect import WHOLE, Acting
from bench.record.campaign import Array
from tests.diagnose.noise_free import linearised, noise_free
from tests.diagnose.small_models import Shift, X, fit_alone
from tests.diagnose.sweeps import nominal

ODDS = -6.0
WIDTHS = (0.3, 1.0, 3.0)
LEFT_OUT = np.exp(-IN_SET)  # of a sum: each of its terms that is further behind
SAMPLES = 400
NOISE = 0.05
FIRST_ORDER = 5e-3  # of its length; to which closed forms are right (bench/diagnose/linearise/README.md)

speed = np.random.default_rng(1).permutation(np.linspace(0.05, 1.0, SAMPLES))  # at any angle
angle = np.concatenate([np.linspace(-1, 1, SAMPLES // 2), np.linspace(1, -1, SAMPLES // 2)])
direction = np.repeat([1.0, -1.0], SAMPLES // 2)
OVER_SPEED = hats(speed, np.linspace(0.05, 1.0, 4)) * direction[:, None]
OVER_ANGLE = hats(angle, np.linspace(-1, 1, 33))
OVER_BOTH = hats(angle, np.linspace(-1, 1, 9)) * direction[:, None]
KINDS = {"speed": OVER_SPEED, "angle": OVER_ANGLE, "angle and direction": OVER_BOTH}
CAUSES = {"viscous": speed * direction, "coulomb": direction}


def model_of(torque: Array, causes: Sequence[str], kinds: Sequence[str] = tuple(KINDS)) -> SubsetPosterior:
    """Return what may be at work in a torque that was measured at one joint."""
    columns = np.column_stack([*(KINDS[kind] for kind in kinds), *(CAUSES[cause] for cause in causes)]) / NOISE
    shapes, start = [], 0
    for kind in kinds:
        own = np.arange(start, start + KINDS[kind].shape[1])
        shapes += [Term(kind, own, np.full(len(own), width), 0.0, np.zeros(len(own))) for width in WIDTHS]
        start += len(own)
    listed = [Term(cause, np.array([start + i]), np.ones(1), ODDS, np.zeros(1)) for i, cause in enumerate(causes)]
    white = torque / NOISE
    return SubsetPosterior(columns.T @ columns, columns.T @ white, free_beside(shapes, listed, -ODDS))


def noisy(torque: Array, rng: np.random.Generator) -> Array:
    return torque + NOISE * rng.standard_normal(SAMPLES)


def test_odds_are_those_of_all_variances_enumerated(rng: np.random.Generator) -> None:
    """Density of the data with and without the cause, each averaged over the variances of two shapes."""
    kinds = ("speed", "angle and direction")
    torque = noisy(0.03 * speed * direction + 0.02 * OVER_SPEED[:, 1], rng)
    own, noise = CAUSES["viscous"], NOISE**2 * np.eye(SAMPLES)
    density: list[list[float]] = [[], []]
    ways = ((0.0, 0.0), *((width, ODDS - LEAST - float(np.log(len(WIDTHS)))) for width in WIDTHS))
    for parts in product(ways, repeat=len(kinds)):
        covariance = noise + sum(
            width**2 * KINDS[kind] @ KINDS[kind].T for kind, (width, _) in zip(kinds, parts, strict=True)
        )
        share = sum(share for _, share in parts)
        for found, extra in zip(density, (0.0, 1.0), strict=True):
            full = covariance + extra * np.outer(own, own)
            found.append(float(multivariate_normal(cov=full).logpdf(torque)) + share)
    expected = ODDS + logsumexp(density[1]) - logsumexp(density[0])
    found_odds = log_odds(model_of(torque, ("viscous",), kinds))["viscous"]
    assert found_odds == pytest.approx(expected, abs=LEFT_OUT)


@pytest.mark.parametrize("size", [0.5, 2.0, 30.0])
def test_viscous_friction_is_not_named_beside_a_drag_with_the_square_of_the_speed(
    size: float, rng: np.random.Generator
) -> None:
    """Quadratic drag came out as viscous friction at 100 %, and a shape for the rest.

    The largest is ten times what the widest shape expects, and viscous friction stood for what it did not reach.
    """
    model = model_of(noisy(size * speed**2 * direction, rng), ("viscous",))
    alone = SubsetPosterior(model.information, model.scores, model.terms[-1:])
    assert expit(alone.log_posterior((0,))) > 0.99
    assert expit(log_odds(model)["viscous"]) < 0.5


def test_coulomb_friction_keeps_its_name_beside_a_dent(rng: np.random.Generator) -> None:
    u = (angle - 0.3) / 0.15
    dent = 0.5 * u * np.exp((1 - u**2) / 2)
    with np.errstate(under="ignore"):
        odds = log_odds(model_of(noisy(dent + 0.3 * direction, rng), ("coulomb", "viscous")))
    assert expit(odds["coulomb"]) > 0.97
    assert expit(odds["viscous"]) < 0.1


def test_names_of_a_finding_share_what_the_discrepancy_leaves_it() -> None:
    members = tuple(Member(SimpleNamespace(key=key), share) for key, share in (("a", 0.6), ("b", 0.3)))  # type: ignore[arg-type]
    group = AmbiguityGroup(members, 0.9)
    held = group_beside(group, {"b": float(np.log(0.45 / 0.55)), "c": 9.0})
    assert held.probability == pytest.approx(0.45)
    assert [member.probability for member in held.members] == pytest.approx([0.3, 0.15])
    assert held.may_be_unlisted
    kept = group_beside(group, {"a": 9.0})
    assert (kept.probability, kept.may_be_unlisted) == (0.9, False)


def test_evidence_by_standard_errors_of_runs_is_that_of_a_reading_so_exact() -> None:
    """One reading x with a standard error e of a size with the prior P: N(x; 0, e^2 + P^2) / N(x; 0, e^2).

    P has several widths, which share the odds.
    """
    cause = Cause(Shift(), WHOLE, (X,), ())
    (unknown,) = unknowns_of((cause,))
    reading, error = 3e-3, 1e-3
    weight = unknown.sigma**2 / (unknown.sigma**2 + error**2)
    fit = fit_alone(cause, [weight * reading], np.array([[weight * error**2]]))
    priors = unknown.sigma * np.array(widths_of(cause))
    evidence = np.log(np.mean(norm(0, np.hypot(error, priors)).pdf(reading))) - norm(0, error).logpdf(reading)
    assert log_odds_as_runs_say(fit, cause, 5.0) == pytest.approx(evidence - 5.0)
    # where runs disagree as much as that, nothing is left
    wide = replace(fit, covariance=np.array([[(2 * reading) ** 2]]))
    assert expit(log_odds_as_runs_say(wide, cause, 5.0)) < 0.01


def test_a_torque_at_every_angle_holds_a_constant_one() -> None:
    """A cable that snaps was a constant torque, at 0.98, and a shape for the rest.

    The constant one acted on a joint that stood while others moved, and no shape did.
    """
    effect, linear = catalogue()["torque_offset"], linearised(noise_free("session-short"))
    constant = FirstOrder(linear.replay, NOMINAL).change(Acting(effect, effect.places(nominal())[0], {"torque": 100.0}))
    assert constant is not None
    white = linear.whiten(constant[:, :, None])[:, 0]
    torques = (block for block in blocks_at(linear, 0, (17,)) if block.kind == "link torque")
    (block,) = (block for block in torques if block.depends_on == "angle")
    left = white - block.columns @ np.linalg.lstsq(block.columns, white)[0]
    print(f"{np.linalg.norm(left) / np.linalg.norm(white):.2g} of a constant torque is left")
    assert np.linalg.norm(left) < FIRST_ORDER * np.linalg.norm(white)
