"""The model that is handed over: an error of the recording that most searches do not find again is no part of it."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bench.diagnose import extension
from bench.diagnose.cross_validation.held_out import CONFIRMS, HeldOut, held_out
from bench.diagnose.diagnose import Diagnosis, diagnose
from bench.diagnose.extend.fit import Fit
from bench.diagnose.extend.refit import refit
from bench.diagnose.extension import extension_of
from bench.diagnose.linearise.generic import Block, blocks_of
from bench.diagnose.name.candidate_model import with_shape
from bench.diagnose.name.models import Model
from bench.diagnose.name.naming import Naming
from bench.diagnose.verdict import CONFIRMED
from bench.effects.catalogue import catalogue
from bench.hide.campaign import hide_campaign
from bench.hide.recorded import recorded_of
from bench.hide.request import effects_of
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from tests.simulate.session_small import small_session

CHOICE = ("channel_delay", "channel_scale", "coulomb_level", "joint_compliance", "gas_loss")
HIDDEN = ("channel_delay@tracker=0.2", "coulomb_level@1=0.6")


@pytest.fixture(scope="module")
def diagnosis(small_robot: Path) -> Diagnosis:
    compiled = compile_robot(load_robot(small_robot))
    session, effects = small_session(compiled.robot.folder), catalogue()
    acting = effects_of(HIDDEN, compiled, effects, None, recorded_of(compiled.robot, session))
    hidden = hide_campaign(compiled.robot, session, acting, np.random.default_rng(3), background=False)
    choice = {name: effects[name] for name in CHOICE}
    return diagnose(hidden.campaign, compiled, choice, most_bins=12, proposes=False)


def names(found: Fit | None) -> set[str]:
    assert found
    return {cause.effect.name for cause in found.causes}


@pytest.mark.parametrize("repeats", [CONFIRMED - 0.1, CONFIRMED])
def test_what_is_of_the_recording_has_to_be_confirmed(diagnosis: Diagnosis, repeats: float) -> None:
    """A scale of a torque at even odds was fitted beside friction, and the folder lacked it: 93 Nm in place of 2."""
    naming = diagnosis.naming
    seen = replace(naming, findings=tuple(replace(one, repeats=repeats) for one in naming.findings))
    kept, whole = extension_of(seen, None), extension_of(replace(naming, findings=()), None)
    assert "channel_delay" in names(whole)
    assert ("channel_delay" in names(kept)) == (repeats >= CONFIRMED)
    assert "coulomb_level" in names(kept)  # of the machine


def test_of_several_recordings_one_that_has_it_is_enough(diagnosis: Diagnosis) -> None:
    """A search without the only recording in which a channel is late cannot find that again."""
    naming = diagnosis.naming
    findings = tuple(replace(one, repeats=0.0) for one in naming.findings)
    several: Any = SimpleNamespace(segments=[SimpleNamespace(recording=name) for name in ("may", "june")])
    assert "channel_delay" in names(extension_of(replace(naming, findings=findings, linear=several), None))


def called_unlisted(naming: Naming, shape: Block, *effects: str) -> Naming:
    """Return a naming whose best model has a free shape in the place of some causes, and the old one behind."""
    (model, linear) = (naming.models[0], naming.linear)
    others = tuple(cause for cause in model.causes if cause.effect.name not in effects)
    fit = refit(with_shape(linear, shape), others, model.fit.start)
    return replace(naming, models=(Model(fit, shape, log_posterior=model.log_posterior + 1), model))


def speed_of_joint_1(naming: Naming) -> Block:
    return next(
        one for one in blocks_of(naming.linear) if (one.drive, one.kind, one.depends_on) == (0, "link torque", "speed")
    )


def test_listed_causes_stand_in_for_a_shape_that_no_model_has(diagnosis: Diagnosis) -> None:
    """Of a real arm, friction of joint 1 was a torque over the speed, and the robot that was handed over had none."""
    naming = diagnosis.naming
    unlisted = called_unlisted(naming, speed_of_joint_1(naming), "coulomb_level")
    assert {cause.effect.name for cause in unlisted.models[0].causes} == {"channel_delay"}
    handed = extension_of(unlisted, None)
    assert names(handed) == {"channel_delay", "coulomb_level"}
    assert handed
    assert handed.residual == pytest.approx(naming.models[0].fit.residual, nan_ok=True)


@pytest.mark.parametrize(("times", "stands_in"), [(0.5, True), (2.0, False)])
def test_what_predicts_a_channel_worse_does_not_stand_in(
    diagnosis: Diagnosis, monkeypatch: pytest.MonkeyPatch, times: float, stands_in: bool
) -> None:
    """Beside 7600 nats of all others, a wrist of a real arm lost 0.15, which is not worth a mention."""
    naming = diagnosis.naming
    unlisted = called_unlisted(naming, speed_of_joint_1(naming), "coulomb_level")

    def with_a_worse_channel(*args: Any) -> HeldOut:
        gain = held_out(*args)
        last = gain.channels[-1]
        squares = 1 + 2 * times * CONFIRMS * (last.floor / last.before) ** 2 / last.readings
        return replace(gain, channels=(*gain.channels[:-1], replace(last, low=-0.4, high=1 - squares**0.5)))

    monkeypatch.setattr(extension, "held_out", with_a_worse_channel)
    assert ("coulomb_level" in names(extension_of(unlisted, None))) is stands_in


@pytest.mark.parametrize("gone", [("channel_delay",), ("channel_delay", "coulomb_level")])
def test_an_error_of_the_recording_does_not_stand_in(
    diagnosis: Diagnosis, gone: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A robot has no place for it. Friction beside it does: the model of a real arm had a scale of a channel, too."""
    naming = diagnosis.naming
    monkeypatch.setattr(HeldOut, "predicts_better", lambda *_: True)
    unlisted = called_unlisted(naming, speed_of_joint_1(naming), *gone)
    assert names(extension_of(unlisted, None)) == {"coulomb_level"}
