"""What may be anew in a recording is said by what it would leave; where nothing is, nothing is said."""

import numpy as np
import pytest

from bench.diagnose.replay.posterior import Posterior, PosteriorParameter
from bench.effects.catalogue import catalogue
from bench.effects.effect import WHOLE, Acting
from bench.hide.campaign import hide_campaign
from bench.predict.predict import predict
from bench.predict.prediction import PredictedRecording, Prediction
from bench.record.campaign import Campaign
from bench.report.prediction.sentences import anew_text
from bench.report.prediction.words import words_of
from bench.report.prediction.write import json_of
from bench.robot.compiled import CompiledRobot
from tests.predict.conftest import campaign_of
from tests.predict.test_predict import only, says_nothing_anew, shifted
from tests.simulate.rotation_small import small_rotation

ZERO = 5e-4  # [rad], of a link encoder: five times its stated uncertainty
MORE = 0.15  # of a Coulomb level
SOFTER = 0.15  # of a compliance
SEEDS = range(20, 24)


@pytest.fixture(scope="module")
def set_up_anew(campaign: Campaign, nominal: CompiledRobot) -> Prediction:
    """Return what the nominal robot makes of a recording in which a link encoder was zeroed anew."""
    return predict(shifted(campaign, "q_link_2_rad", ZERO), nominal, nominal)


def with_free(campaign: Campaign, nominal: CompiledRobot, *free: str) -> PredictedRecording:
    """Return what the nominal robot leaves with something free; what else may be anew is not asked."""
    with pytest.MonkeyPatch.context() as patch:
        says_nothing_anew(patch)
        return only(campaign, nominal, nominal, *free)


def named(recording: PredictedRecording) -> list[str]:
    return [one.name for one in recording.maybe_anew]


def test_of_a_machine_as_it_was_nothing_is_said(nominal: CompiledRobot) -> None:
    """One recording of a hundred may have a false hint; of four none is expected."""
    for seed in SEEDS:
        assert named(only(campaign_of(nominal, seed), nominal, nominal)) == []


def test_a_zero_that_was_set_up_anew_is_named_alone(
    campaign: Campaign, nominal: CompiledRobot, set_up_anew: Prediction
) -> None:
    (found,) = set_up_anew.recordings
    assert named(found) == ["encoder_zero"]
    free = only(shifted(campaign, "q_link_2_rad", ZERO), nominal, nominal, "encoder_zero")
    assert named(free) == []
    # what is said is what `--free` finds
    np.testing.assert_allclose(found.maybe_anew[0].rms, [channel.rms for channel in free.channels], rtol=1e-9)


def test_another_payload_is_named_first(nominal: CompiledRobot) -> None:
    found = only(campaign_of(nominal, 2, "unstated_payload", mass=4.0, second_moment_y=0.05), nominal, nominal)
    assert named(found)[0] == "payload"


def test_friction_of_a_colder_day_is_named_and_found(nominal: CompiledRobot) -> None:
    effect = catalogue()["coulomb_level"]
    acting = [Acting(effect, place, effect.complete({"change": MORE})) for place in effect.places(nominal)]
    rng, scenario = np.random.default_rng(3), small_rotation(nominal.robot.folder)
    recorded = hide_campaign(nominal.robot, scenario, acting, rng, background=False, tails=None).campaign
    assert named(only(recorded, nominal, nominal))[0] == "friction"
    found = with_free(recorded, nominal, "friction").freed
    told = {figure.name: figure for figure in found}
    assert all("friction of" in name for name in told)
    first = told[f"motor-side Coulomb friction of {nominal.robot.figures.drives[0].joint}"]
    assert first.low < MORE < first.high
    assert first.high - first.low < MORE


@pytest.mark.parametrize("change", [SOFTER, -SOFTER / 2])
def test_a_joint_that_became_softer_or_stiffer_is_named_and_found(nominal: CompiledRobot, change: float) -> None:
    """A stranger's arm with a joint 15 % softer: nothing of a joint could be free, and the tracker was named."""
    effect = catalogue()["joint_compliance"]
    acting = [Acting(effect, effect.places(nominal)[0], effect.complete({"change": change}))]
    rng, scenario = np.random.default_rng(3), small_rotation(nominal.robot.folder)
    recorded = hide_campaign(nominal.robot, scenario, acting, rng, background=False, tails=None).campaign
    assert named(only(recorded, nominal, nominal)) == ["stiffness"]
    found = {figure.name: figure for figure in with_free(recorded, nominal, "stiffness").freed}
    assert all(name.startswith("stiffness of") for name in found)
    first = found[f"stiffness of {nominal.robot.figures.drives[0].joint}"]
    stiffer = 1 / (1 + change) - 1
    assert first.low < stiffer < first.high
    assert first.high - first.low < SOFTER / 10


@pytest.mark.parametrize("mass", [4.0, pytest.param(8.0, marks=pytest.mark.study)])
def test_friction_is_named_beside_a_payload_that_is_most_of_what_is_left(nominal: CompiledRobot, mass: float) -> None:
    """A stranger's arm with 12 % less friction on a day with another payload: the payload alone was named."""
    level, payload = (catalogue()[name] for name in ("coulomb_level", "unstated_payload"))
    acting = [Acting(level, place, level.complete({"change": 0.05})) for place in level.places(nominal)]
    acting.append(Acting(payload, WHOLE, payload.complete({"mass": mass, "second_moment_y": 0.05})))
    rng, scenario = np.random.default_rng(3), small_rotation(nominal.robot.folder)
    recorded = hide_campaign(nominal.robot, scenario, acting, rng, background=False, tails=None).campaign
    found = only(recorded, nominal, nominal)
    assert named(found) == ["payload", "friction"]
    friction = found.maybe_anew[1]
    assert friction.beside == ("payload",)
    assert "rolling, beside `--free payload` (evidence +" in anew_text(friction, found)
    both = with_free(recorded, nominal, "payload", "friction")
    np.testing.assert_allclose(friction.rms, [channel.rms for channel in both.channels], rtol=1e-3)


@pytest.mark.parametrize("lost", [0.05, 0.2])
def test_gas_that_was_lost_is_named(nominal: CompiledRobot, lost: float) -> None:
    found = only(campaign_of(nominal, 5, "gas_loss", lost=lost), nominal, nominal)
    assert set(named(found)) == {"gas_amount", "gas_temperature"}  # warmth does as well, and nothing else is left


@pytest.mark.parametrize("lost", [pytest.param(0.0, marks=pytest.mark.study), 0.05])
def test_what_the_model_itself_may_err_by_is_nothing_anew(nominal: CompiledRobot, lost: float) -> None:
    """`--free gas_temperature` was proposed of a KR300 whose gas was as before: its masses were no surer than that."""
    mass, loss = (catalogue()[name] for name in ("link_mass", "gas_loss"))
    place = mass.places(nominal)[0]
    acting = [Acting(mass, place, mass.complete({"change": 0.03}))]
    acting += [Acting(loss, WHOLE, loss.complete({"lost": lost}))] if lost else []
    rng, scenario = np.random.default_rng(4), small_rotation(nominal.robot.folder)
    recorded = hide_campaign(nominal.robot, scenario, acting, rng, background=False, tails=None).campaign
    exact = only(recorded, nominal, nominal)
    assert named(exact)[0].startswith("gas")  # of a model that is exact

    def hints(share: float) -> list[str]:
        masses = [str(one) for one in exact.linear.nuisances if str(one).startswith("mass of")]
        parameters = tuple(PosteriorParameter(name, "", share, 0.0) for name in masses)
        known = Posterior(parameters, np.eye(len(masses)))
        return [one.name for one in predict(recorded, nominal, nominal, posterior=known).recordings[0].maybe_anew]

    assert (hints(0.03) != []) is bool(lost)
    assert hints(1e-6) == named(exact)


def test_it_is_told_and_written(set_up_anew: Prediction) -> None:
    (found,) = set_up_anew.recordings
    (one,) = found.maybe_anew
    text = anew_text(one, found)
    assert text.startswith("`--free encoder_zero`, zeros of the link encoders against those of the motors (evidence +")
    assert "link angle 2 0.0" in text
    assert "motor torque" not in text  # which it does not change
    assert f"  may be anew: {text}" in list(words_of(set_up_anew))
    (written,) = json_of(set_up_anew)["recordings"][0]["maybe_anew"]
    assert written["free"] == "encoder_zero"
    assert [channel["rms"] for channel in written["channels"]] == list(one.rms)
