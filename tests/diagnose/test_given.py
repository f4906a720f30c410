"""A posterior is a prior: two diagnoses in a row know what one of both campaigns would know."""

from pathlib import Path

import numpy as np
import pytest

from bench.diagnose.cross_validation.posterior import posterior_of
from bench.diagnose.diagnose import diagnose
from bench.diagnose.extend.refit import refit
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.linearised_model import LinearisedModel, linearised_model_of
from bench.diagnose.replay.given import EARLIER, OF_RECORDING, Posterior, given_by, with_earlier
from bench.diagnose.replay.nuisances import nuisances_of
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.effects.effect import WHOLE, Acting
from bench.errors import RobotError
from bench.hide.campaign import hide_campaign
from bench.predict.free import FREE
from bench.record.campaign import Campaign
from bench.report.handover.posterior_file import POSTERIOR, read_posterior, write_posterior
from bench.report.handover.robot_folder import hand_over
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from tests.report.handover.made import EFFECTS, torque_robot
from tests.simulate.rotation_small import small_rotation

BINS = 120
LOST = 0.05
FIRST_ORDER = 0.05  # standard deviations, of what is linearised about the nominal robot and about the one found


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> CompiledRobot:
    return compile_robot(load_robot(torque_robot(tmp_path_factory.mktemp("given") / "small")))


def made(robot: CompiledRobot, seed: int, lost: float = 0.0) -> Campaign:
    """Return sweeps of one and the same machine, with other noise."""
    effect = EFFECTS["gas_loss"]
    acting = [Acting(effect, effect.places(robot)[0], {"lost": lost})] if lost else []
    rng = np.random.default_rng(seed)
    return hide_campaign(robot.robot, small_rotation(robot.robot.folder), acting, rng, background=False).campaign


def linear_of(campaign: Campaign, robot: CompiledRobot, given: Posterior | None = None) -> LinearisedModel:
    quantities = quantities_of(campaign.runs, robot)
    nuisances = nuisances_of(robot, quantities)
    if given:
        nuisances, quantities = given_by(given, nuisances, robot).nuisances, (*quantities, EARLIER)
    segments = with_earlier(segments_of(campaign, robot, quantities, BINS), quantities, nuisances)
    return linearised_model_of(Replay(robot, segments, quantities), nuisances)


def test_two_campaigns_in_a_row_are_both_at_once(robot: CompiledRobot, tmp_path: Path) -> None:
    """Figures as fitted to one campaign, then to the other with what was known, against both together."""
    first, second = linear_of(made(robot, 1), robot), linear_of(made(robot, 2), robot)
    fit = refit(first, (), {})
    hand_over(first, fit, tmp_path / "robot", tmp_path / "nominal.xml")
    handed = compile_robot(load_robot(tmp_path / "robot"))
    later = linear_of(made(robot, 2), handed, posterior_of(first, fit))
    found = refit(later, (), {})
    names = [nuisance.name for nuisance in first.nuisances]
    assert [nuisance.name for nuisance in second.nuisances] == names
    shared = [i for i, nuisance in enumerate(later.nuisances[: len(names)]) if nuisance.said_before]
    assert not any(names[i].startswith(OF_RECORDING) for i in shared)
    assert len(shared) > 10
    own = [i for i in range(len(names)) if i not in shared]
    p, q = len(names), len(own)
    jacobian = np.zeros((len(first.white) + len(second.white), p + q))
    jacobian[: len(first.white), :p] = first.jacobian
    jacobian[len(first.white) :, shared] = second.jacobian[:, shared]
    jacobian[len(first.white) :, p:] = second.jacobian[:, own]
    information = jacobian.T @ jacobian + np.eye(p + q)
    together = np.linalg.solve(information, jacobian.T @ np.concatenate([first.white, second.white]))
    spread = np.sqrt(np.diag(np.linalg.inv(information)))
    for i in shared:
        nuisance, old, new = first.nuisances[i], fit.nuisances[i], found.nuisances[i]
        x, y = old * nuisance.sigma, new * nuisance.sigma
        both = ((1 + x) * (1 + y) - 1 if nuisance.unit == "" else x + y) / nuisance.sigma
        assert abs(both - together[i]) < FIRST_ORDER, nuisance.name
    after = np.linalg.inv(later.jacobian.T @ later.jacobian + np.eye(later.jacobian.shape[1]))
    for i in shared:
        assert abs(np.sqrt(after[i, i]) / spread[i] - 1) < FIRST_ORDER, names[i]


def test_a_finding_is_background_the_next_time(robot: CompiledRobot, tmp_path: Path) -> None:
    """What was found is in the model; it is known as well as it was found, no better and no worse."""
    linear = linear_of(made(robot, 1, LOST), robot)
    effect = EFFECTS["gas_loss"]
    cause = Cause(effect, WHOLE, effect.parameters, ())
    fit = refit(linear, (cause,), {})
    hand_over(linear, fit, tmp_path / "robot", tmp_path / "nominal.xml")
    write_posterior(tmp_path / "robot", posterior_of(linear, fit))
    handed = compile_robot(load_robot(tmp_path / "robot"))
    given = given_by(read_posterior(tmp_path / "robot"), nuisances_of(handed, linear.quantities), handed)
    (name,) = given.findings
    assert name == "loss of gas: lost, as found before"
    assert given.held == ()
    rows = np.array([nuisance.said_before or np.zeros(1) for nuisance in given.nuisances if nuisance.said_before]).T
    sigma = np.array([nuisance.sigma for nuisance in given.nuisances if nuisance.said_before])
    covariance = np.linalg.inv(np.eye(len(sigma)) + (rows * sigma).T @ (rows * sigma)) * np.outer(sigma, sigma)
    np.testing.assert_allclose(np.sqrt(covariance[-1, -1]), fit.sigma[0], rtol=1e-6)


def test_what_was_found_before_is_not_found_again(robot: CompiledRobot, tmp_path: Path) -> None:
    sought = {name: EFFECTS[name] for name in ("gas_loss", "coulomb_friction", "torque_constant")}
    before = diagnose(made(robot, 1, LOST), robot, sought, most_bins=BINS, proposes=False)
    (cause,) = before.verdict.explanations[0].causes
    assert cause.effect == "gas_loss"
    fit = before.extension
    assert fit
    hand_over(before.linear, fit, tmp_path / "robot", tmp_path / "nominal.xml")
    handed, posterior = compile_robot(load_robot(tmp_path / "robot")), posterior_of(before.linear, fit)
    same = diagnose(made(robot, 2, LOST), handed, sought, most_bins=BINS, given=posterior)
    assert same.verdict.kind == "nothing found"
    more = diagnose(made(robot, 2, LOST + 0.02), handed, sought, most_bins=BINS, proposes=False, given=posterior)
    (again,) = more.verdict.explanations[0].causes
    assert again.effect == "gas_loss"
    lost = again.parameters[0]
    assert lost.low < 1 - (1 - LOST - 0.02) / (1 - LOST) < lost.high


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (None, "does not exist"),
        ("{", POSTERIOR),
        ('{"format": 1, "parameters": [], "covariance": [[1.0]]}', "needs 0 rows"),
        ('{"format": 1, "parameters": [{"name": "a"}], "covariance": []}', "sigma"),
    ],
)
def test_a_posterior_that_cannot_be_read_is_named(tmp_path: Path, text: str | None, said: str) -> None:
    if text is not None:
        (tmp_path / POSTERIOR).write_text(text)
    with pytest.raises(RobotError, match=said):
        read_posterior(tmp_path)


def test_what_may_be_anew_in_a_recording_is_not_given() -> None:
    for one in FREE.values():
        for name in one.figures:
            assert name.startswith(OF_RECORDING)
