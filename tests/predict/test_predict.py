"""A model against a campaign: what it leaves is what a replay leaves, and nothing is fitted but what is free."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.diagnose.cross_validation.predicted_error import PredictedError
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.world import NOMINAL
from bench.errors import InputError
from bench.predict.another_payload import AnotherPayload
from bench.predict.fit_anew import freed_beside_the_day
from bench.predict.free import FREE, checked
from bench.predict.freed import known_of
from bench.predict.predict import predict
from bench.predict.prediction import PredictedRecording
from bench.record.campaign import Campaign
from bench.record.joined import joined
from bench.record.known import Known
from bench.report.handover.robot_folder import hand_over
from bench.report.prediction.sentences import untold_sentence
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.fitted import Fitted, FittedReadings
from bench.robot.folder import load_robot
from tests.predict.conftest import campaign_of
from tests.report.handover.made import CASES, fit_of

AGREES = 1e-6  # of a channel's largest reading; as a handed-over folder agrees with its fit
ZERO = 7e-5  # [rad], of a link encoder; two thirds of its stated uncertainty
FAR_ZERO = 5e-4  # [rad], five times that
PAYLOAD_KG = 4.0


def says_nothing_anew(patch: pytest.MonkeyPatch) -> None:
    """Leave out what may be anew: most of the time of a prediction, and `test_worth_freeing.py` asks for it."""
    patch.setattr("bench.predict.predict.worth_freeing", lambda *given: ())


@pytest.fixture(autouse=True)
def nothing_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    says_nothing_anew(monkeypatch)


def only(campaign: Campaign, model: CompiledRobot, nominal: CompiledRobot, *free: str) -> PredictedRecording:
    (found,) = predict(campaign, model, nominal, free=free).recordings
    return found


def shifted(campaign: Campaign, column: str, by: float) -> Campaign:
    runs = [replace(run, columns={**run.columns, column: run.columns[column] + by}) for run in campaign.runs]
    return replace(campaign, runs=tuple(runs))


def test_a_folder_predicts_what_its_fit_did(
    campaign: Campaign,
    nominal: CompiledRobot,
    plain: PredictedRecording,
    tmp_path: Path,
    rng: np.random.Generator,
) -> None:
    linear = plain.linear
    fit = fit_of(linear, CASES["friction"], rng)
    hand_over(linear, fit, tmp_path / "robot", tmp_path / "nominal.xml")
    found = only(campaign, compile_robot(load_robot(tmp_path / "robot")), nominal)
    repeated = Replay(nominal, found.linear.segments, found.linear.quantities)
    expected, stated = repeated.predict(fit.world(linear)), repeated.predict(NOMINAL)
    scale = np.max(np.abs(expected), axis=0)
    there = np.isfinite(found.error)
    assert np.max((np.abs(found.measured - found.error - expected) / scale)[there]) < AGREES
    assert np.max((np.abs(found.measured - found.nominal_error - stated) / scale)[there]) < AGREES
    assert np.max((np.abs(expected - stated) / scale)[there]) > 1e3 * AGREES


def test_what_is_fitted_anew_is_held_against_the_narrower_promise(campaign: Campaign, nominal: CompiledRobot) -> None:
    """Only where it acts: 1.95 bar of 2 % of gas were as promised, and more than that with a force sensor free."""
    promised = PredictedError("tau_motor_1_nm", "Nm", "motion", 8, 1.0, 0.5, 2.0, 0.7, 1.5)
    promises = [promised, replace(promised, channel="reflector_1_x_m", unit="m")]
    (found,) = predict(campaign, nominal, nominal, promises, ("torque_offset",)).recordings
    ends = {one.channel: (one.low, one.high) for one in found.channels if one.kind == "motion"}
    assert ends["tau_motor_1_nm"] == (0.7, 1.5)
    assert ends["reflector_1_x_m"] == (0.5, 2.0)


def test_errors_are_plain_root_mean_squares_beside_the_promise(campaign: Campaign, nominal: CompiledRobot) -> None:
    promised = PredictedError("tau_motor_1_nm", "Nm", "motion", 8, 1.0, 0.5, 2.0, 0.7, 1.5)
    (found,) = predict(campaign, nominal, nominal, [promised, replace(promised, kind="static")]).recordings
    assert promised.channel in [channel.channel for channel in found.channels]
    for channel in found.channels:
        column = [quantity.column for quantity in found.linear.quantities].index(channel.channel)
        left = found.error[np.isfinite(found.error[:, column]), column]
        np.testing.assert_allclose(channel.rms, np.sqrt(np.mean(left**2)))
        assert (channel.kind, channel.readings, channel.nominal) == ("motion", len(left), channel.rms)
        is_promised = channel.channel == promised.channel
        assert (channel.low, channel.high) == (0.5, 2.0) if is_promised else channel.answer == "not promised"


def test_a_recording_is_cut_as_the_nominal_robot_rings(
    campaign: Campaign, nominal: CompiledRobot, plain: PredictedRecording
) -> None:
    """By the model's own figures bins came out longer, and errors below all that was promised."""
    soft = nominal.model.__copy__()
    soft.tendon_stiffness[nominal.at.element] /= 30.0
    model = replace(nominal, model=soft)
    found = only(campaign, model, nominal).linear.segments
    expected = plain.linear.segments
    own = only(campaign, model, model).linear.segments
    assert [len(one) for one in found] == [len(one) for one in expected] != [len(one) for one in own]


def test_a_right_model_is_left_with_no_more_than_the_floor(plain: PredictedRecording) -> None:
    """Where a joint stands, what its friction may hold is in the floor too; the joint that moves is left with noise."""
    channels = {one.channel: one for one in plain.channels}
    for channel in channels.values():
        assert channel.rms < 1.2 * channel.floor, channel
    assert channels["tau_motor_1_nm"].rms > 0.8 * channels["tau_motor_1_nm"].floor


def test_stretches_hold_the_worst_of_each_channel(campaign: Campaign, nominal: CompiledRobot) -> None:
    """A torque that is off for a while in one run is the worst stretch, of that run and at that time."""
    spoilt = campaign.runs[1]
    time = spoilt.columns["time_s"]
    late = time > 0.8 * time[-1]
    torque = np.where(late, spoilt.columns["tau_motor_1_nm"] + 500.0, spoilt.columns["tau_motor_1_nm"])
    runs = (campaign.runs[0], replace(spoilt, columns={**spoilt.columns, "tau_motor_1_nm": torque}), *campaign.runs[2:])
    worst = only(replace(campaign, runs=runs), nominal, nominal).stretches[0]
    assert (worst.channel, worst.run) == ("tau_motor_1_nm", spoilt.name)
    assert spoilt.start_s > time[-1]  # the clock of the recording would tell another time
    assert 0.6 * time[-1] < worst.start_s < worst.end_s <= time[-1]
    assert worst.rms > 10 * worst.floor


def test_what_is_known_besides_is_no_stretch(campaign: Campaign, nominal: CompiledRobot) -> None:
    """It is an instant of the last run without a time of its own, and ended the worst stretch before it began."""
    weighed = replace(campaign, known=(Known("stiffness_nm_per_rad", 2 * float(nominal.stiffness[1]), 1.0, joint=2),))
    for stretch in only(weighed, nominal, nominal).stretches:
        assert not stretch.channel.startswith("known")
        assert stretch.start_s <= stretch.end_s
        assert stretch.run == stretch.label


def test_free_takes_exactly_the_zero(campaign: Campaign, nominal: CompiledRobot) -> None:
    """Bayes: of what an encoder was shifted by, all is found but the part that the prior keeps; nothing else moves."""
    recorded = shifted(campaign, "q_link_2_rad", ZERO)
    before, after = (only(one, nominal, nominal, "encoder_zero") for one in (campaign, recorded))
    (old,), (new,) = before.freed, after.freed
    assert (new.name, new.unit, new.sigma, new.model) == ("zero of link encoder 2", "rad", 1e-4, 0.0)
    anew = freed_beside_the_day(only(recorded, nominal, nominal).linear, ("encoder_zero",))
    # of one standard deviation of the prior, where the fit ends; beside the zero what drifts anyway
    shows = anew.fit.design(anew.linear).jacobian
    assert str(anew.linear.nuisances[0]) == new.name
    kept_back = np.linalg.inv(np.eye(shows.shape[1]) + shows.T @ shows)[0, 0]
    spread, expected = new.sigma * kept_back**0.5, ZERO * (1 - kept_back)
    assert spread <= (new.high - new.low) / (2 * 1.959964) * (1 + 1e-6)  # which counts how runs disagree, too
    assert (
        abs(new.found - old.found - expected) < 2e-4 * spread
    )  # what it leaves counts as noise, another time a little more
    assert new.low < ZERO + old.found < new.high
    columns = [quantity.column for quantity in after.linear.quantities]
    others = [c for c, column in enumerate(columns) if column != "q_link_2_rad"]
    np.testing.assert_array_equal(after.error[:, others], before.error[:, others])
    seen = columns.index("q_link_2_rad")
    kept = after.error[:, seen] - before.error[:, seen]
    np.testing.assert_allclose(kept[np.isfinite(kept)], ZERO - (new.found - old.found), atol=1e-12)


def test_without_free_a_zero_stays_in_the_error(
    campaign: Campaign, nominal: CompiledRobot, plain: PredictedRecording
) -> None:
    before, after = plain, only(shifted(campaign, "q_link_2_rad", ZERO), nominal, nominal)
    moved = after.error - before.error
    columns = [quantity.column for quantity in after.linear.quantities]
    np.testing.assert_allclose(moved[np.isfinite(moved[:, -1]), columns.index("q_link_2_rad")], ZERO, atol=1e-12)
    assert after.freed == ()


@pytest.mark.parametrize("carried", [0.0, 7.0])
def test_another_payload_is_found_in_both_directions(nominal: CompiledRobot, tmp_path: Path, carried: float) -> None:
    """The model carries nothing, or more than the recording does."""
    model = nominal
    if carried:
        linear = only(campaign_of(nominal, 3), nominal, nominal).linear
        fit = fit_of(linear, CASES["unstated payload"], np.random.default_rng(0))
        values = np.array([carried, 0.025, 0.025, 0.025, 0.0, 0.0, 0.0])
        fit = replace(fit, values=values, nuisances=np.zeros_like(fit.nuisances))
        hand_over(linear, fit, tmp_path / "robot", tmp_path / "nominal.xml")
        model = compile_robot(load_robot(tmp_path / "robot"))
    recorded = campaign_of(nominal, 2, "unstated_payload", mass=PAYLOAD_KG, second_moment_y=0.05)
    found = only(recorded, model, nominal, "payload")
    mass = next(figure for figure in found.freed if figure.name.endswith(": mass"))
    assert mass.low < PAYLOAD_KG - carried < mass.high
    assert mass.high - mass.low < 1.0
    np.testing.assert_allclose(mass.model, carried, atol=1e-6)
    np.testing.assert_allclose(mass.total, carried + mass.found)
    torques = [c for c, quantity in enumerate(found.linear.quantities) if quantity.is_drive]
    fixed = only(recorded, model, nominal)
    assert np.nanstd(found.error[:, torques]) < 0.5 * np.nanstd(fixed.error[:, torques])


def test_an_offset_of_the_day_is_no_payload(campaign: Campaign, nominal: CompiledRobot) -> None:
    """A torque sensor whose zero is 2 Nm another one, as far as zeros drift, would hold up 0.2 kg."""
    found = only(shifted(campaign, "tau_motor_1_nm", -2.0), nominal, nominal, "payload")
    mass = next(figure for figure in found.freed if figure.name.endswith(": mass"))
    assert mass.low < 0.0 < mass.high < 0.1  # that of a model without drifts is 0.17 to 0.26 kg
    torque = next(c for c, quantity in enumerate(found.linear.quantities) if quantity.column == "tau_motor_1_nm")
    assert np.nanmean(found.error[:, torque]) < -1.5  # what is not free stays in the error


def test_errors_are_those_with_what_is_free_alone(campaign: Campaign, nominal: CompiledRobot) -> None:
    recorded = shifted(campaign, "tau_motor_1_nm", -2.0)
    found = only(recorded, nominal, nominal, "payload", "encoder_zero")
    assert {str(one) for one, value in found.world.deviations.items() if value} == {"zero of link encoder 2"}
    simulated = Replay(nominal, found.linear.segments, found.linear.quantities).predict(found.world)
    there = np.isfinite(found.error)
    np.testing.assert_allclose((found.linear.observed - simulated)[there], found.error[there])


def test_what_the_model_has_is_told_beside_the_difference(nominal: CompiledRobot) -> None:
    """A diagnosis handed over a zero and an offset; of gains, which multiply, there is no total."""
    first, second = (drive.joint for drive in nominal.robot.figures.drives)
    readings = FittedReadings(link_encoder_zero_rad={second: 3e-4}, tracker_shift_m=(0.0, 2e-3, 0.0))
    figures = nominal.robot.figures.model_copy(update={"fitted": Fitted(readings=readings)})
    known = known_of(replace(nominal, robot=replace(nominal.robot, figures=figures)))
    assert known["zero of link encoder 2"] == 3e-4
    assert known["tracker frame, shift y"] == 2e-3
    assert known[f"torque offset of {first}"] == 0.0
    assert "gain of the force sensor" not in known


@pytest.mark.parametrize(("hidden", "value", "lost"), [("lost", 0.1, 0.1), ("offset", 20.0, -20.0 / 293.15)])
def test_gas_may_be_less_or_more(nominal: CompiledRobot, hidden: str, value: float, lost: float) -> None:
    """Warm gas pulls as more gas does."""
    name = {"lost": "gas_loss", "offset": "gas_temperature"}[hidden]
    recorded = campaign_of(nominal, 5, name, **{hidden: value})
    (gas,) = only(recorded, nominal, nominal, "gas_amount").freed
    np.testing.assert_allclose(gas.found, lost, rtol=0.02)  # the engine that made it takes other steps


def test_nothing_about_a_recording_depends_on_the_others(campaign: Campaign, nominal: CompiledRobot) -> None:
    other = shifted(campaign_of(nominal, 4), "q_link_2_rad", ZERO)
    both = predict(joined({"one": campaign, "two": other}), nominal, nominal, free=("encoder_zero",))
    assert [recording.name for recording in both.recordings] == ["one", "two"]
    for recording, own in zip(both.recordings, (campaign, other), strict=True):
        alone = only(own, nominal, nominal, "encoder_zero")
        np.testing.assert_array_equal(recording.error, alone.error)
        assert recording.channels == alone.channels


def test_what_is_free_and_not_told_is_named(
    campaign: Campaign, nominal: CompiledRobot, plain: PredictedRecording
) -> None:
    """Two hinges turn a payload: it was silent on what that leaves open, as if it had stayed."""
    found = only(campaign, nominal, nominal, "payload")
    told, untold = ({name.partition(": ")[2] for name in names} for names in (_names(found), found.untold))
    assert untold
    assert not told & untold
    assert told | untold == {p.name.replace("_", " ") for p in AnotherPayload.parameters}
    assert untold_sentence(found).startswith("Not told by this recording: change of the payload: ")
    assert untold_sentence(plain) == ""


def _names(found: PredictedRecording) -> list[str]:
    return [figure.name for figure in found.freed]


def test_unknown_names_list_the_known_ones() -> None:
    with pytest.raises(InputError, match=r"--free encoder: unknown name 'encoder'.*Known: .*encoder_zero, ") as raised:
        checked(["encoder", "payload", "wings"])
    assert len(raised.value.problems) == 2
    assert checked(["payload", "payload"]) == ("payload",)


def test_what_nothing_shows_cannot_be_free(campaign: Campaign, nominal: CompiledRobot) -> None:
    dark = [{name: v for name, v in run.columns.items() if not name.startswith("q_link")} for run in campaign.runs]
    runs = tuple(replace(run, columns=columns) for run, columns in zip(campaign.runs, dark, strict=True))
    with pytest.raises(InputError, match="--free encoder_zero: nothing to fit"):
        predict(replace(campaign, runs=runs), nominal, nominal, free=("encoder_zero",))


def test_a_payload_that_the_robot_states_to_be_known_is_not_free(
    campaign: Campaign, nominal: CompiledRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`uncertainty.payload_kg: 0`, of a lab that weighs all that it hangs on, ended in a ZeroDivisionError."""
    monkeypatch.undo()
    figures = nominal.robot.figures
    known = figures.model_copy(update={"uncertainty": figures.uncertainty.model_copy(update={"payload_kg": 0.0})})
    stated = compile_robot(replace(nominal.robot, figures=known))
    moved = shifted(campaign, "q_link_2_rad", FAR_ZERO)
    assert [one.name for one in only(moved, stated, stated).maybe_anew] == ["encoder_zero"]
    with pytest.raises(InputError, match=r"--free payload: `uncertainty\.payload_kg: 0` in figures\.yaml") as raised:
        predict(campaign, stated, stated, free=("payload",))
    assert len(raised.value.problems) == 1


def test_what_is_free_is_documented() -> None:
    page = (Path(__file__).parents[2] / "bench/predict/README.md").read_text()
    for name, one in FREE.items():
        assert f"| `{name}` | {one.words} |" in page
