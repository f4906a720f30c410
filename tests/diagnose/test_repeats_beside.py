"""How much of the friction at rest repeats is told beside what acts: a step between two visits is no friction."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.diagnose import diagnose
from bench.diagnose.linearise.candidates import Candidate, Cause
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.other_noise import with_repeats
from bench.diagnose.linearise.repeated_rests import SHARES, repeating_share, repeating_visits
from bench.diagnose.linearise.screening import Tried, tried_of
from bench.diagnose.name.neighbourhood import Neighbourhood
from bench.diagnose.replay.instants import at_each_instant
from bench.effects.catalogue import catalogue
from bench.effects.effect import WHOLE, Acting
from bench.hide.campaign import hide_campaign
from bench.hide.recorded import recorded_of
from bench.record.campaign import Array
from bench.record.joined import joined
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.scenario.files import read_scenario
from tests.diagnose.small_models import Shift, X, Z, linear_of
from tests.diagnose.sweeps import LOADS, made, nominal
from tests.diagnose.test_repeated_rests import friction_of

STEP = 3e-4  # [m]
CAUSE = Cause(Shift(), WHOLE, (X, Z), ())


@pytest.fixture(scope="module")
def linear() -> LinearisedModel:
    """Two recordings of the same visits."""
    return linear_of(joined({name: made(LOADS, seed=5 + i, machine=5) for i, name in enumerate(("may", "june"))}))


def shift_of(linear: LinearisedModel) -> Array:
    """Return what a step of the tracker before June changes, shape (T, c, 2), along x and z."""
    june = at_each_instant(linear.segments, [int(one.recording == "june") for one in linear.segments])
    axes = [
        [name.kind == "reflector" and name.column.endswith(f"_{axis}_m") for axis in "xz"] for name in linear.quantities
    ]
    return june[:, None, None] * np.array(axes, dtype=float)


def with_readings(linear: LinearisedModel, share: float, step: float, seed: int) -> LinearisedModel:
    """Return the campaign with noise, with friction of which a share repeats, and with a step."""
    rng = np.random.default_rng(seed)
    left = [segment.sigma * rng.standard_normal(segment.sigma.shape) for segment in linear.segments]
    for visits in repeating_visits(linear.segments):
        common = rng.standard_normal(friction_of(linear, visits[0]).shape[1])
        for i in visits:
            columns = friction_of(linear, i)
            own = rng.standard_normal(columns.shape[1])
            left[i] += (columns @ (np.sqrt(share) * common + np.sqrt(1 - share) * own)).reshape(left[i].shape)
    residual = np.concatenate(left) + step * shift_of(linear) @ [1.0, -0.7]
    found = _share_of(linear, residual)
    return with_repeats(replace(linear, residual=residual, white=linear.whiten(residual)), found)


def _share_of(linear: LinearisedModel, residual: Array) -> float:
    known = linear.replay.compiled, linear.segments, linear.responses, linear.quantities, linear.scatter
    return repeating_share(*known, linear.split(residual))


def weighed(linear: LinearisedModel, monkeypatch: pytest.MonkeyPatch, tries: Sequence[Cause]) -> float:
    """Return the share that is believed where these causes may act."""
    around = Neighbourhood(nominal(), {}, frozenset(), 0.01)
    around._repeats = linear.scatter.repeats

    def everything(about: LinearisedModel) -> Tried:
        plausible = np.array([one.high for one in CAUSE.sizes]) / np.sqrt(3)
        columns = about.whiten(shift_of(about))
        return tried_of([Candidate(cause, {}, np.ones(2), plausible, columns) for cause in tries])

    monkeypatch.setattr(around, "everything", everything)
    return around._repeating(linear, lambda about: about.whiten(about.residual)).scatter.repeats


def test_a_step_between_two_visits_does_not_hide_in_friction(
    linear: LinearisedModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A tracker that was pushed after the first run was not found: friction was taken to repeat by half."""
    moved = with_readings(linear, SHARES[-1], STEP, seed=3)
    assert moved.scatter.repeats < 0.9
    assert weighed(moved, monkeypatch, [CAUSE]) > 0.97


@pytest.mark.parametrize("share", [0.0, 0.5, 0.8])
def test_friction_that_does_not_repeat_is_no_step(
    linear: LinearisedModel, share: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    for seed in range(4):
        still = with_readings(linear, share, 0.0, seed)
        assert weighed(still, monkeypatch, [CAUSE]) == pytest.approx(still.scatter.repeats, abs=0.05)


@pytest.mark.study
def test_a_tracker_that_is_pushed_after_the_first_run_is_found() -> None:
    """By three detection limits (seed 1067): it was "nothing found"."""
    robot, session = load_robot("hh150"), read_scenario("session-study")
    compiled, effect = compile_robot(robot), catalogue()["tracker_step"]
    place = effect.places_in(compiled, recorded_of(robot, session))[0]
    moved = {"tx": 1.8e-4, "ty": 8.5e-5, "tz": -2.7e-4, "rx": 5.5e-5, "ry": -2.2e-5, "rz": 6.7e-5}
    hidden = hide_campaign(robot, session, (Acting(effect, place, moved),), np.random.default_rng(8))
    found = diagnose(hidden.campaign, compiled, catalogue(), proposes=False)
    first = found.verdict.findings[0].names[0]
    print(f"{first.cause.title} ({first.cause.place}): {first.probability:.3f}")
    assert found.linear.scatter.repeats > 0.97
    assert (first.cause.effect, first.cause.place) == ("tracker_step", str(place))
