"""What nothing changed is not made again: robots of a world, and what causes change where only their priors do."""

from typing import Any

import numpy as np
import pytest

from bench.diagnose.diagnose import signatures_of
from bench.diagnose.linearise import changes
from bench.diagnose.linearise.candidates import Cause, causes_of
from bench.diagnose.linearise.signatures import Signatures
from bench.diagnose.name.candidate_model import CandidateModel
from bench.diagnose.name.models import Fitter
from bench.diagnose.plausibility import repeated
from bench.diagnose.plausibility.channels import doubts_of
from bench.diagnose.plausibility.hints import doubts_and_hints_of, hints_of
from bench.diagnose.replay.instants import run_of_each
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.diagnose.replay.world import NOMINAL, World
from bench.effects.catalogue import catalogue
from bench.effects.effect import Acting, Place
from bench.effects.recorded import recorded_in
from bench.errors import ConvergenceError
from bench.executor.serial import SERIAL
from bench.robot.patched import Structure
from bench.robot.recent import Recent
from bench.simulate.prescribed import Motion, Prescribed
from tests.diagnose.sweeps import SWEEP, made, nominal

NAMES = ("coulomb_level", "gas_loss", "payload_com", "friction_ripple", "encoder_eccentricity")


def signatures() -> tuple[Signatures, Replay]:
    campaign, effects = made(SWEEP, seed=5), {name: catalogue()[name] for name in NAMES}
    quantities = quantities_of(campaign.runs, nominal())
    replay = Replay(nominal(), segments_of(campaign, nominal(), quantities), quantities)
    return signatures_of(campaign, nominal(), effects), replay


def test_a_world_is_predicted_with_one_look_at_its_robot(monkeypatch: pytest.MonkeyPatch) -> None:
    known, replay = signatures()
    (friction,) = (one for one in known.plan if one.effect.name == "coulomb_level" and one.place.index == 1)
    asked: list[object] = []
    robot = Structure.robot
    monkeypatch.setattr(Structure, "robot", lambda self, steps: asked.append(1) or robot(self, steps))
    replay.predict(World(acting=(friction,)))
    assert len(asked) == len(replay._courses(World(acting=(friction,))))


def test_rates_of_an_error_are_made_once_by_its_value(monkeypatch: pytest.MonkeyPatch) -> None:
    known, replay = signatures()
    wrong = next(one for one in known.plan if one.effect.name == "encoder_eccentricity" and one.place.index == 1)
    friction = next(one for one in known.plan if one.effect.name == "coulomb_level")
    alone = replay.predict(World(acting=(wrong,)))
    asked: list[object] = []
    monkeypatch.setattr("bench.diagnose.replay.motion_replay.rates_along", lambda *_: asked.append(1))
    replay.predict(World(acting=(wrong, friction)))
    assert not asked
    fresh = Replay(replay.compiled, replay.segments, replay.quantities)
    monkeypatch.undo()
    assert (fresh.predict(World(acting=(wrong,))) == alone)[~(alone != alone)].all()


def test_what_sets_in_later_is_followed_from_then_on_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """A joint that slips before the last run was simulated along all runs before it as well."""
    campaign = made(SWEEP, seed=5)
    quantities = quantities_of(campaign.runs, nominal())
    replay = Replay(nominal(), segments_of(campaign, nominal(), quantities), quantities)
    effect, (*_, last) = catalogue()["joint_slip"], campaign.runs
    place = Place("joint", 1, nominal().robot.figures.drives[1].joint, last.name, last.start_s)
    slipped = World(acting=(Acting(effect, place, effect.complete({"slip": 1e-3})),))
    sound = replay.predict(NOMINAL)
    followed: list[int] = []
    follow = Prescribed.follow

    def counted(self: Prescribed, motion: Motion, *given: Any) -> Any:
        followed.append(int(motion.read.sum()))
        return follow(self, motion, *given)

    monkeypatch.setattr(Prescribed, "follow", counted)
    change = replay.predict(slipped) - sound
    since = run_of_each(replay.segments) == last.name
    assert not since.all()
    assert sum(followed) == 2 * int(since.sum())  # once as the motors move, once as gears wind up by that
    assert not np.nan_to_num(change[~since]).any()
    assert np.nan_to_num(change[since]).any()


def test_a_campaign_is_cut_and_looked_at_once_for_doubts_and_hints(monkeypatch: pytest.MonkeyPatch) -> None:
    """Both did it for themselves, which was half of `bench check`; and what they say is the same."""
    campaign = made(SWEEP, seed=5)
    doubts = doubts_of(campaign, nominal())
    alone = doubts + hints_of(campaign, nominal(), doubts)
    cut: list[int] = []
    monkeypatch.setattr(repeated, "segments_of", lambda *given: cut.append(given[-1]) or segments_of(*given))
    assert doubts_and_hints_of(campaign, nominal()) == alone
    assert cut == [repeated.BINS]


def test_causes_that_go_farther_change_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    """They were simulated once more, at sizes as many times as large: a quarter of the second look."""
    known, replay = signatures()
    before = known.sensitivities(replay.segments)
    monkeypatch.setattr(changes, "simulate_all", lambda *_: pytest.fail("simulated again"))
    farther = known.farther(4.0)
    after = farther.sensitivities(replay.segments)
    assert (after.nuisances == before.nuisances).all()
    for cause, plain in zip(farther.causes, known.causes, strict=True):
        assert cause.key == plain.key
        for wide, size in zip(cause.sizes, plain.sizes, strict=True):
            assert wide.high == 4.0 * size.high
            assert cause.typical(wide) == plain.typical(size) == size.typical
            assert cause.beside(wide) == plain.beside(size)


def cause_of(name: str) -> Cause:
    compiled, everything = nominal(), frozenset({"current", "q_link", "reflector", "motor_current"})
    effect = catalogue()[name]
    recorded = recorded_in(made(SWEEP, seed=5).runs, compiled.model.opt.gravity)
    return next(iter(causes_of([effect], compiled, everything, recorded)))


def test_a_fit_begins_at_the_nearest_one_with_other_priors(monkeypatch: pytest.MonkeyPatch) -> None:
    class Fit:
        """Stands for one."""

        def __init__(self, *causes: Cause) -> None:
            self.causes, self.start = causes, {(*cause.key, "size"): len(causes) for cause in causes}

    begun: list[CandidateModel] = []

    def fit_of(linear: object, candidate: CandidateModel, progress: object) -> None:
        begun.append(candidate)

    monkeypatch.setattr("bench.diagnose.name.models.fit_of", fit_of)
    gas, friction, payload = (cause_of(name) for name in ("gas_loss", "coulomb_level", "payload_com"))
    near, nearer = Fit(gas), Fit(gas, friction)
    one, both = (CandidateModel(causes, None, {}, None, ()) for causes in ((payload,), (gas, friction)))
    fitter = Fitter(None, None, SERIAL, earlier=(near, nearer))  # type: ignore[arg-type]
    fitter.fitted([one, both])
    assert [candidate.known for candidate in begun] == [None, nearer]
    assert begun[0].start == {}
    assert set(begun[1].start.values()) == {2}


def test_recent_forgets_what_was_asked_for_longest_ago() -> None:
    kept: Recent[str, str] = Recent(2)
    for key in ("a", "b", "a", "c"):
        assert kept.get(key, lambda key=key: key.upper()) == key.upper()
    assert kept.latest() == ["C", "A"]
    assert kept.get("b", lambda: "made again") == "made again"


def test_a_value_that_cannot_be_made_is_not_kept() -> None:
    kept: Recent[str, str] = Recent(2)

    def fails() -> str:
        raise ConvergenceError("no")

    with pytest.raises(ConvergenceError):
        kept.get("a", fails)
    assert not kept.latest()
