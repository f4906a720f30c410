"""The model that is handed over: an error of the recording that most searches do not find again is no part of it."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bench.diagnose.diagnose import Diagnosis, diagnose
from bench.diagnose.explain import extension_of
from bench.diagnose.extend.fit import Fit
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
