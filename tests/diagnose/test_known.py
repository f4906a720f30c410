"""What the lab knows besides is a reading: estimates move as Bayes' rule says, and what is known is no discovery."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.diagnose.diagnose import diagnose
from bench.diagnose.linearise.contradicted import contradicted_readings
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.nominal_model import linearised_model_of
from bench.diagnose.replay.known import carried_mass, known_quantities, with_known_payload, with_known_segments
from bench.diagnose.replay.nuisances import nuisances_of
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.diagnose.replay.world import NOMINAL, World
from bench.effects.catalogue import catalogue
from bench.effects.effect import Acting
from bench.errors import CampaignError
from bench.predict.predict import predict
from bench.record.campaign import Campaign
from bench.record.carried import with_payloads
from bench.record.known import Known
from bench.report.diagnosis.words import words_of
from bench.report.diagnosis.write import write_diagnosis
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from tests.predict.conftest import campaign_of
from tests.report.handover.made import torque_robot

BINS = 120
ROUNDING = 1e-6  # of solutions of normal equations, whose condition number is 1e7 and more
K = 1.0e5  # [Nm/rad], of joint 2 of the two-joint robot
PAYLOAD_KG = 4.0
EFFECTS = catalogue()
SOUGHT = {name: EFFECTS[name] for name in ("unstated_payload", "payload_mass", "torque_constant", "gas_loss")}


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> CompiledRobot:
    return compile_robot(load_robot(torque_robot(tmp_path_factory.mktemp("known") / "small")))


@pytest.fixture(scope="module")
def campaign(robot: CompiledRobot) -> Campaign:
    """Return sweeps in which nobody wrote down that 4 kg are bolted on."""
    made = campaign_of(robot, 1, "unstated_payload", mass=PAYLOAD_KG)
    runs = [run for run in made.runs if run.name.startswith(made.runs[0].name.split("-")[0])]
    stated = made.runs[0].columns["load_mass_kg"][0]
    light = [{name: v for name, v in run.columns.items() if not name.startswith("load_")} for run in runs]
    assert stated == 5.0
    return replace(made, runs=tuple(replace(r, columns=c) for r, c in zip(runs, light, strict=True)))


def linear_of(campaign: Campaign, robot: CompiledRobot) -> LinearisedModel:
    campaign = with_payloads(campaign)
    quantities = (*quantities_of(campaign.runs, robot), *known_quantities(campaign, robot))
    segments = with_known_segments(segments_of(campaign, robot, quantities, BINS), campaign, robot, quantities)
    nuisances = with_known_payload(nuisances_of(robot, quantities), campaign)
    return linearised_model_of(Replay(robot, segments, quantities), nuisances)


def test_a_known_stiffness_pulls_figures_as_bayes_says(campaign: Campaign, robot: CompiledRobot) -> None:
    """Bayes: x + P a (y - a x) / (s^2 + a P a), with everything that is correlated with it."""
    known = Known("stiffness_nm_per_rad", 1.02 * K, 0.005 * K, joint=2)
    linear = linear_of(replace(campaign, known=(known,)), robot)
    names = [nuisance.name for nuisance in linear.nuisances]
    at = names.index("stiffness of hinge_b")
    gain = np.zeros(len(names))
    gain[at] = K * linear.nuisances[at].sigma
    of_tables = linear.column_of != len(linear.quantities) - 1
    assert np.count_nonzero(~of_tables) == 1
    jacobian, white = linear.jacobian[of_tables], linear.white[of_tables]
    spread = np.linalg.inv(jacobian.T @ jacobian + np.eye(len(names)))
    x = spread @ jacobian.T @ white
    moved = spread @ gain / (known.sigma**2 + gain @ spread @ gain) * (0.02 * K - gain @ x)
    np.testing.assert_allclose(linear.most_probable(linear.white), x + moved, rtol=ROUNDING, atol=ROUNDING)
    assert np.abs(moved[at]) > 0.1
    assert np.count_nonzero(np.abs(moved) > 1e-3) > 1


def test_worlds_say_what_is_known(campaign: Campaign, robot: CompiledRobot) -> None:
    known = (
        Known("payload_kg", 9.0, 0.1),
        Known("stiffness_nm_per_rad", K, 1e3, joint=2),
        Known("gas_pressure_pa", 1e7, 1e5, at=(0.5, 0.1)),
        Known("gas_temperature_k", 300.0, 1.0),
    )
    linear = linear_of(replace(campaign, known=known), robot)
    rows = [i for i, segment in enumerate(linear.segments) if segment.label.startswith("known")]
    assert [linear.segments[i].run for i in rows] == [campaign.runs[-1].name] * 4
    starts = np.cumsum([0, *(len(segment) for segment in linear.segments)])[rows]
    columns = [c for c, quantity in enumerate(linear.quantities) if quantity.is_known]
    assert columns == list(range(len(linear.quantities) - 4, len(linear.quantities)))

    def said(world: World) -> list[float]:
        values = linear.replay.predict(world)
        return [float(values[row, column]) for row, column in zip(starts, columns, strict=True)]

    def acting(name: str, index: int, **values: float) -> World:
        effect = EFFECTS[name]
        return World(acting=(Acting(effect, effect.places(robot)[index], effect.complete(values)),))

    payload, stiffness, pressure, temperature = said(NOMINAL)
    assert (payload, stiffness, temperature) == (9.0, K, 293.15)
    heavier = said(acting("unstated_payload", 0, mass=2.0))
    np.testing.assert_allclose(heavier, [11.0, K, pressure, 293.15], rtol=1e-4)  # links give, so the cylinder moves
    np.testing.assert_allclose(said(acting("payload_mass", 0, change=0.1))[0], 9.9)
    np.testing.assert_allclose(said(acting("joint_compliance", 1, change=0.25))[1], 0.8 * K)
    np.testing.assert_allclose(said(acting("gas_loss", 0, lost=0.1))[2], 0.9 * pressure, rtol=1e-4)
    warm = said(acting("gas_temperature", 0, offset=10.0))
    np.testing.assert_allclose(warm[2:], [pressure * (1 + 10 / 293.15), 303.15], rtol=1e-4)
    zero = next(nuisance for nuisance in linear.nuisances if nuisance.name == "zero of link encoder 2")
    assert said(World({zero: 1.0})) == said(NOMINAL)
    assert carried_mass(linear.replay.robot(acting("unstated_payload", 0, mass=2.0))) == 2.0
    for c, row in zip(columns, starts, strict=True):
        measured = linear.residual[:, c]
        assert np.flatnonzero(np.isfinite(measured)).tolist() == [row]


def test_a_known_payload_is_no_finding(campaign: Campaign, robot: CompiledRobot, tmp_path: Path) -> None:
    """9 kg hang on the arm and no run says so: found, unless the lab weighed them."""
    total = PAYLOAD_KG + 5.0
    found = diagnose(campaign, robot, SOUGHT, most_bins=BINS, proposes=False)
    taken = {cause.effect: cause for cause in found.verdict.explanations[0].causes}
    assert "unstated_payload" in taken
    weighed = replace(campaign, known=(Known("payload_kg", total, 0.05),))
    after = diagnose(weighed, robot, SOUGHT, most_bins=BINS)
    causes = {cause.effect for explanation in after.verdict.explanations for cause in explanation.causes}
    assert not causes & {"unstated_payload", "payload_mass"}
    assert after.verdict.kind == "nothing found"
    write_diagnosis(after, tmp_path, weighed)
    assert "payload as known" in (tmp_path / "report.html").read_text()


def test_two_readings_of_a_payload_weigh_by_their_errors(campaign: Campaign, robot: CompiledRobot) -> None:
    """What hangs on the arm is the first reading; both are rows about it, and pull as Bayes' rule says."""
    one, other = Known("payload_kg", 9.6, 0.2), Known("payload_kg", 9.0, 0.02)
    linear = linear_of(replace(campaign, known=(one, other)), robot)
    at = [nuisance.scales_payload for nuisance in linear.nuisances].index(True)
    size = 9.6 * linear.nuisances[at].sigma
    known = linear.column_of == len(linear.quantities) - 1
    np.testing.assert_allclose(linear.jacobian[known][:, at], [size / 0.2, size / 0.02])
    np.testing.assert_allclose(linear.white[known], [0.0, -0.6 / 0.02], atol=1e-9)
    jacobian, white, rows = linear.jacobian[~known], linear.white[~known], linear.jacobian[known]
    spread = np.linalg.inv(jacobian.T @ jacobian + np.eye(len(linear.nuisances)))
    x = spread @ jacobian.T @ white
    pull = np.linalg.solve(np.eye(2) + rows @ spread @ rows.T, linear.white[known] - rows @ x)
    np.testing.assert_allclose(
        linear.most_probable(linear.white), x + spread @ rows.T @ pull, rtol=ROUNDING, atol=ROUNDING
    )


@pytest.mark.parametrize("stated", [1.0, 2.0])
def test_a_reading_that_all_others_contradict_is_told(
    campaign: Campaign, robot: CompiledRobot, stated: float, tmp_path: Path
) -> None:
    """A payload that was written down twice as heavy was believed; of a stiffness two causes were named at 100 %."""
    known = Known("payload_kg", stated * (5.0 + PAYLOAD_KG), 0.1)
    weighed = replace(campaign, known=(known,))
    found = diagnose(weighed, robot, {"gas_loss": EFFECTS["gas_loss"]}, most_bins=BINS)
    told = found.verdict.contradicted
    assert len(told) == (stated != 1.0)
    for one in told:
        assert (one.channel, one.value, one.sigma) == ("known_payload_kg", known.value, known.sigma)
        assert abs(one.by_others - known.value / stated) < 5 * one.by_others_sigma
        assert one.apart > 5.0
        assert any("standard errors apart" in line for line in words_of(found.verdict))
        write_diagnosis(found, tmp_path, weighed)
        assert "standard errors apart" in (tmp_path / "report.html").read_text()


def test_what_no_figure_moves_is_held_against_what_was_found(campaign: Campaign, robot: CompiledRobot) -> None:
    """The gas is as warm as the model has it; a reading that no figure can follow was told of nowhere."""
    known = Known("gas_temperature_k", 393.0, 1.0)
    linear = linear_of(replace(campaign, known=(known,)), robot)
    (one,) = contradicted_readings(linear, linear.residual)
    assert (one.value, one.by_others_sigma, one.apart > 50.0) == (393.0, 0.0, True)
    assert not list(contradicted_readings(linear, 0.0 * linear.residual))


def test_prediction_takes_what_is_known(campaign: Campaign, robot: CompiledRobot) -> None:
    weighed = replace(campaign, known=(Known("payload_kg", 9.0, 0.05),))
    before, after = (predict(one, robot, robot).recordings[0] for one in (campaign, weighed))
    torque = {"tau_motor_1_nm"}
    old, new = (next(c for c in one.channels if c.channel in torque) for one in (before, after))
    assert new.rms < 0.1 * old.rms
    assert after.channels[-1].channel == "known_payload_kg"
    assert abs(after.channels[-1].rms) < 1e-9


@pytest.mark.parametrize(
    ("known", "said"),
    [
        (Known("stiffness_nm_per_rad", K, 1.0, joint=3), r"known\[0\].joint: small has 2 joints, not 3"),
        (Known("gas_pressure_pa", 1e7, 1e5, at=(0.0,)), r"known\[0\].at: needs a position for each of the 2 joints"),
    ],
)
def test_what_does_not_fit_the_robot_is_named(
    campaign: Campaign, robot: CompiledRobot, known: Known, said: str
) -> None:
    with pytest.raises(CampaignError, match=said):
        diagnose(replace(campaign, known=(known,)), robot, SOUGHT)


def test_gas_of_a_robot_without_a_cylinder_cannot_be_known() -> None:
    emps = compile_robot(load_robot("emps"))
    with pytest.raises(CampaignError, match="emps has no counterbalance"):
        known_quantities(Campaign("emps", (), known=(Known("gas_temperature_k", 300.0, 1.0),)), emps)
