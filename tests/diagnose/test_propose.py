"""The next experiment: expected evidence in closed form, and twins of a small campaign that an instrument splits."""

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

from bench.diagnose.experiment_design.experiments import experiments_for
from bench.diagnose.experiment_design.preposterior import Expectation, expected_log_bayes_factor, narrowing
from bench.diagnose.experiment_design.propose import LEAST_NARROWING, MOST_PROPOSALS, name_of, propose, told_apart
from bench.diagnose.extend.fit import Fit
from bench.diagnose.extend.refit import refit
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.nominal_model import linearised_model_of
from bench.diagnose.replay.nuisances import nuisances_of
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.effects.catalogue import catalogue
from bench.effects.effect import WHOLE, Acting, Place
from bench.hide.campaign import hide_campaign
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from tests.diagnose.sweeps import SWEEP

BINS = 60
BLUR = 5e-3  # what the error of slopes (2 %) takes off


@dataclass(frozen=True)
class Twins:
    """A campaign with a loss of gas, and what explains it."""

    linear: LinearisedModel
    loss: Fit
    warmth: Fit
    bend: Fit


@pytest.fixture(scope="module")
def twins() -> Twins:
    robot, effects = load_robot("hh150"), catalogue()
    compiled = compile_robot(robot)
    acting = Acting(effects["gas_loss"], WHOLE, {"lost": 0.12})
    campaign = hide_campaign(robot, SWEEP, [acting], np.random.default_rng(5)).campaign
    quantities = quantities_of(campaign.runs, compiled)
    segments = segments_of(campaign, compiled, quantities, BINS)
    linear = linearised_model_of(Replay(compiled, segments, quantities), nuisances_of(compiled, quantities))

    def fitted(name: str) -> Fit:
        return refit(linear, (Cause(effects[name], WHOLE, effects[name].parameters, ()),), {})

    return Twins(linear, fitted("gas_loss"), fitted("gas_temperature"), fitted("polytropic_exponent"))


def expectation(mean: float, sigma: float) -> Expectation:
    return Expectation(np.array([mean]), np.array([[1.0]]), np.array([[sigma**2]]))


def test_alike_explanations_differ_by_half_the_squared_distance() -> None:
    one, two = expectation(0.0, 0.5), expectation(3.0, 0.5)
    assert expected_log_bayes_factor(one, two) == pytest.approx(0.5 * 9 / 1.25, rel=BLUR)
    assert expected_log_bayes_factor(one, one) == pytest.approx(0.0)
    assert expected_log_bayes_factor(two, one) == pytest.approx(expected_log_bayes_factor(one, two))


def test_expected_log_bayes_factor_is_that_of_many_draws(rng: np.random.Generator) -> None:
    one, two = expectation(0.0, 0.5), expectation(1.0, 2.0)

    def mean_log_ratio(true: Expectation, other: Expectation) -> float:
        y = true.mean[0] + np.sqrt(true.predictive[0, 0]) * rng.standard_normal(200_000)
        parts = [
            -0.5 * (y - e.mean[0]) ** 2 / e.predictive[0, 0] - 0.5 * np.log(e.predictive[0, 0]) for e in (true, other)
        ]
        return float(np.mean(parts[0] - parts[1]))

    drawn = [mean_log_ratio(one, two), mean_log_ratio(two, one)]
    assert abs(drawn[0] - drawn[1]) > 0.1  # else nothing says that it is the smaller one
    assert expected_log_bayes_factor(one, two) == pytest.approx(min(drawn), abs=0.02)


def test_a_measurement_narrows_by_the_sum_of_precisions() -> None:
    assert narrowing(expectation(0.0, 2.0), 0) == pytest.approx(1 / np.sqrt(1 + 4.0), rel=BLUR)
    blind = Expectation(np.zeros(1), np.zeros((1, 1)), np.eye(1))
    assert narrowing(blind, 0) == pytest.approx(1.0)


def test_a_gas_thermometer_splits_loss_and_temperature(twins: Twins) -> None:
    found = propose(twins.linear, [twins.loss, twins.warmth])
    assert 1 <= len(found) <= MOST_PROPOSALS
    best = found[0]
    assert "thermometer" in best.experiment
    assert set(best.splits) == {"loss of gas", "gas warmer or colder than nominal"}
    assert best.today < 2  # twins today
    assert best.separation > 6
    # pressure and torque see the product of amount and temperature, never one of them
    assert not [p for p in found if "pressure" in p.experiment or "sweep" in p.experiment]


def test_one_explanation_asks_for_what_narrows_it(twins: Twins) -> None:
    effect = catalogue()["payload_com"]
    hangs = refit(twins.linear, (Cause(effect, WHOLE, effect.parameters, ()),), {})
    found = propose(twins.linear, [hangs])
    assert 1 <= len(found) <= MOST_PROPOSALS
    assert all(p.splits == (effect.title, "") and p.narrows for p in found)
    gain = [p.separation for p in found]
    assert gain == sorted(gain, reverse=True)
    assert gain[-1] >= -np.log(LEAST_NARROWING)


def test_what_hardly_narrows_is_not_proposed(twins: Twins) -> None:
    """The best run would make 0.0028 of 0.0032: no engineer makes it for that."""
    assert propose(twins.linear, [twins.bend]) == ()


def fit_with(key: str, value: float) -> Fit:
    """Return a fit with one cause of one size."""
    cause = SimpleNamespace(key=key)
    unknown = SimpleNamespace(cause=cause, parameter=SimpleNamespace(null=0.0, is_shape=False))
    return SimpleNamespace(causes=(cause,), unknowns=(unknown,), values=np.array([value]))  # type: ignore[return-value]


def test_what_does_not_touch_the_causes_does_not_tell_them_apart() -> None:
    """A link encoder at joint 5 shows its stiffness, which two fits have otherwise, and nothing of joint 1."""
    jacobian = np.array([[1.0, 0.0], [0.0, 1.0]])  # of the stiffness, and of the cause in question
    ways = np.array([[10.0, 0.0], [0.0, 0.0]])
    one, two = (Expectation(mean, jacobian, 0.01 * np.eye(2)) for mean in ways)
    assert expected_log_bayes_factor(one, two) > 40
    assert told_apart(fit_with("a", 0.0), fit_with("b", 0.0), one, two) == 0.0
    assert told_apart(fit_with("a", 3.0), fit_with("b", -3.0), one, two) == pytest.approx(6.0**2 / 2)
    assert told_apart(fit_with("a", 3.0), fit_with("a", -3.0), one, two) == 0.0  # what both have is in no question


def test_it_asks_for_what_is_least_known(twins: Twins) -> None:
    (bend,), effect = twins.bend.causes, catalogue()["payload_com"]
    both = refit(twins.linear, (bend, Cause(effect, WHOLE, effect.parameters, ())), twins.bend.start)
    known = {u.parameter.name: s / u.sigma for u, s in zip(both.unknowns, both.sigma, strict=True)}
    least = max(known, key=lambda name: known[name])
    assert known["exponent"] < 0.5 * known[least]
    found = propose(twins.linear, [both])
    assert found
    assert all(p.narrows.startswith(f"{least} of {effect.title}") for p in found)


def test_what_a_stated_figure_blurs_no_run_narrows(twins: Twins) -> None:
    # a gas constant known to 1 % and a loss of gas are one number in every run
    assert propose(twins.linear, [twins.loss]) == ()


def test_nothing_found_asks_for_nothing(twins: Twins) -> None:
    assert propose(twins.linear, []) == ()
    assert propose(twins.linear, [refit(twins.linear, (), {})]) == ()


def test_experiments_stay_within_the_robot(twins: Twins) -> None:
    compiled = twins.linear.replay.compiled
    speeds = np.array([drive.speed_limit_rad_per_s for drive in compiled.robot.figures.drives])
    cold, warm = (experiments_for(twins.linear, is_thermal) for is_thermal in (False, True))
    assert len(warm) > len(cold) > 20
    for experiment in warm:
        for segment in experiment.segments:
            motion = segment.motion
            assert np.all(motion.q >= compiled.limits[:, 0])
            assert np.all(motion.q <= compiled.limits[:, 1])
            assert np.all(np.abs(motion.velocity) <= speeds)
            assert np.all(np.abs(motion.wrench[:, :3]) <= compiled.robot.figures.rating.force_n)
            assert np.all(np.diff(motion.time) > 0)
            assert np.any(np.isfinite(segment.observed))
            moved = np.abs(np.diff(motion.q, axis=0)).max(axis=0) > 0
            if not segment.is_static:
                np.testing.assert_array_equal(moved, ~segment.standing)


class Named(SimpleNamespace):
    """A cause that has a name alone."""

    def __init__(self, name: str) -> None:
        super().__init__(key=name)

    def __str__(self) -> str:
        return str(self.key)


@pytest.mark.parametrize(
    ("effect", "place", "words"),
    [
        ("joint_zero", Place("joint", 4, "joint5"), "zero of a joint (joint 5)"),
        ("link_mass", Place("body", 3, "tool"), "mass of a link (tool)"),
        ("gas_loss", WHOLE, "loss of gas"),
        ("tracker_frame", replace(WHOLE, recording="june"), "frame of the laser tracker in recording june"),
    ],
)
def test_a_cause_is_named_with_its_place(effect: str, place: Place, words: str) -> None:
    """A place stood twice in "zero of a joint of joint 5"."""
    assert str(Cause(catalogue()[effect], place, (), ())) == words


def test_explanations_are_told_apart_by_what_they_do_not_share() -> None:
    """With twenty causes in common, the two that differ were lost in forty names."""
    one, two, three = (SimpleNamespace(causes=tuple(Named(name) for name in names)) for names in ("ab", "ac", "a"))
    assert (name_of(one, two), name_of(two, one)) == ("b", "c")  # type: ignore[arg-type]
    assert (name_of(one, three), name_of(three, one)) == ("b", "none of it")  # type: ignore[arg-type]
    assert name_of(one) == "a and b"  # type: ignore[arg-type]
