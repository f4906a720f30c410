"""A payload that nobody stated has a centre of mass: first moments, linear whatever the mass, and what people read."""

import numpy as np
import pytest

from bench.diagnose.conclude import quotients_of
from bench.diagnose.linearise.candidates import Cause, causes_of
from bench.diagnose.linearise.signatures import Signatures
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.diagnose.replay.world import World
from bench.effects.catalogue import catalogue
from bench.effects.conditions import Conditions
from bench.effects.payloads import UNSTATED
from bench.robot.compiled import read_spec
from bench.robot.plugins import added_body
from bench.study.limits import Way
from tests.diagnose.recordings_small import BINS, compiled, recording
from tests.diagnose.small_models import fit_alone

MOMENTS = ("moment_x", "moment_y", "moment_z")
BY_MASS = 0.02  # of what is to be seen: links sag under a heavier payload, and s^2/m is inertia
VISIBLE = 0.02  # [A]
DRAWS = 200_000


@pytest.fixture(scope="module")
def cause() -> Cause:
    (found,) = causes_of([catalogue()["unstated_payload"]], compiled(), frozenset())
    return found


def test_signatures_of_first_moments_do_not_depend_on_the_mass(cause: Cause) -> None:
    """Without a mass there is no body that could have a first moment; its derivative is one and the same with any."""
    campaign = recording(1)
    quantities = quantities_of(campaign.runs, compiled())
    segments = segments_of(campaign, compiled(), quantities, BINS)
    replay, steps = Replay(compiled(), segments, quantities), {size.name: size.typical for size in cause.sizes}
    signatures = Signatures(compiled(), quantities, (), [cause]).sensitivities(segments).causes
    light = {"mass": 0.3 * cause.sizes[0].high}
    ground = replay.predict(World(acting=(cause.acting(light),)))
    swept = next(c for c, quantity in enumerate(quantities) if quantity.is_drive and quantity.index == 1)
    seen = 0
    for size, signature in zip(cause.sizes, signatures, strict=True):
        if size.name in MOMENTS:
            then = replay.predict(World(acting=(cause.acting({**light, size.name: steps[size.name]}),)))
            change = (then - ground)[:, swept]
            assert signature is not None
            np.testing.assert_allclose(signature[:, swept], change, atol=BY_MASS * VISIBLE)
            seen += bool(np.max(np.abs(change)) > VISIBLE)
    assert seen == 2  # the third one is across the plane in which joint 2 swings


def test_the_centre_has_the_interval_of_a_quotient(cause: Cause) -> None:
    mean = np.array([40.0, 0.5, 0.3, 0.2, 4.0, 0.0, -2.0])
    sigma = np.array([1.0, 0.1, 0.1, 0.1, 0.2, 0.1, 0.3])
    correlation = np.eye(7)
    correlation[0, 4] = correlation[4, 0] = 0.8
    covariance = correlation * np.outer(sigma, sigma)
    found = {one.name: one for one in quotients_of(cause, fit_alone(cause, mean.tolist(), covariance))}
    drawn = np.random.default_rng(1).multivariate_normal(mean, covariance, DRAWS)
    for axis, column in zip("xyz", (4, 5, 6), strict=True):
        centre = drawn[:, column] / drawn[:, 0]
        assert found[axis].value == pytest.approx(mean[column] / 40.0)
        assert found[axis].high - found[axis].low == pytest.approx(2 * 1.96 * np.std(centre), rel=0.01)
        assert found[axis].unit == "m"


def test_nothing_is_said_of_the_centre_of_a_mass_that_may_be_none(cause: Cause) -> None:
    assert list(quotients_of(cause, fit_alone(cause, [1.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0], np.eye(7)))) == []


def test_a_light_payload_is_drawn_with_small_first_moments(cause: Cause) -> None:
    lever = cause.sizes[4].high / cause.sizes[0].high
    for seed in range(50):
        values = Way.draw(cause.effect, cause.place, compiled(), np.random.default_rng(seed)).at(0.1, compiled()).values
        assert all(abs(values[name]) <= lever * values["mass"] * (1 + 1e-12) for name in MOMENTS)


def test_what_is_bolted_on_beside_a_payload_whose_centre_was_fitted_is_about_the_load_point(cause: Cause) -> None:
    """A comparison fits the centre of the payload it begins with: 1 kg more came out 6 mm beside its place."""
    spec = read_spec(compiled().robot)
    for change in (
        {"mass": 1.5, "moment_x": 0.03, "second_moment_y": 0.004},
        {"mass": 1.0, "moment_x": 0.02, "moment_z": 0.1},
    ):
        edit = cause.effect.edit(cause.place, cause.acting(change).values, Conditions.reference(compiled().n_joints))
        assert edit is not None
        edit(spec, compiled().robot)
        carried = added_body(spec, UNSTATED)
        assert carried is not None
        if "moment_z" not in change:
            carried.ipos = np.array([0.0064, -0.0002, 0.0103])
            fitted = 1.5 * (np.array(carried.pos) + np.array(carried.ipos))
    at = np.array(spec.body(compiled().robot.figures.load_body).ipos)
    moment = 2.5 * (np.array(carried.pos) + np.array(carried.ipos) - at)
    np.testing.assert_allclose(moment - (fitted - 1.5 * at), [0.02, 0.0, 0.1], atol=1e-12)
