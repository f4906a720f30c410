"""A study of a few small campaigns, from end to end."""

import json
import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from bench.diagnose.replay.world import World
from bench.effects.catalogue import catalogue
from bench.effects.effect import Acting, Effect
from bench.errors import ConvergenceError, InputError
from bench.executor.contract import Executor
from bench.executor.processes import Processes
from bench.executor.serial import SERIAL
from bench.record.campaign import Campaign
from bench.report.study.write import PAGE, RESULTS, write_study
from bench.study import make as make_module
from bench.study import study
from bench.study.labs import Lab, Setup, prepare
from bench.study.limits import Way, detection_limit
from bench.study.outcome import Outcome
from bench.study.plan import Counts, Trial
from bench.study.rows import ROWS
from bench.study.scores import scores_of
from bench.study.study import NULL_STREAM, Settings, run_study, run_trial
from bench.study.worlds import WORLDS
from bench.study.worlds import World as WorldName

SESSION = """
experiment: session
robot: hh150
break_s: 60
rotations:
  - {joint: 2, start_deg: [0, -10, 0, 0, 90, 0], end_deg: 60, speeds_deg_per_s: [30], ramp_s: 0.7, settle_s: 0.3,
     sample_period_s: 0.04, move_speed: 0.9, acceleration_deg_per_s2: 120}
"""
CHOICE = ("gas_loss", "coulomb_level", "current_offset")
COUNTS = Counts(seeds=1, nulls=1, unlisted=1, pairs=0, twins=False, effects=("gas_loss",))
CLOSE = 1e-6
SEED = 5


@pytest.fixture(scope="module")
def session(tmp_path_factory: pytest.TempPathFactory) -> str:
    file = tmp_path_factory.mktemp("sessions") / "sweeps.yaml"
    file.write_text(SESSION, encoding="utf-8")
    return str(file)


@pytest.fixture(scope="module")
def choice() -> Mapping[str, Effect]:
    effects = catalogue()
    return {name: effects[name] for name in CHOICE}


@pytest.fixture(scope="module")
def setup(session: str, choice: Mapping[str, Effect]) -> Setup:
    return prepare(Lab(session), choice, np.random.default_rng([SEED, NULL_STREAM]))


def run(setup: Setup, folder: Path, executor: Executor = SERIAL) -> tuple[Outcome, ...]:
    """Run the study on a setup that was prepared before."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(study, "prepare", lambda *arguments, executor: setup)
        return run_study(Settings(SEED, setup.lab.session, counts=COUNTS), folder, executor)


@pytest.fixture(scope="module")
def done(setup: Setup, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("study")
    outcomes = run(setup, folder, Processes(2))
    write_study(outcomes, scores_of(outcomes), Settings(SEED, setup.lab.session, counts=COUNTS), "Two sweeps.", folder)
    return folder


def test_every_campaign_is_a_row(done: Path) -> None:
    content = json.loads((done / RESULTS).read_text())
    assert [row["kind"] for row in content["campaigns"]] == ["unlisted", "single", "null"]
    assert content["campaigns"][1]["truth"][0]["effect"] == "gas_loss"
    assert all(row["diagnose_s"] > 0 and "found" in row["marks"] for row in content["campaigns"])


def test_page_needs_nothing_else(done: Path) -> None:
    page = (done / PAGE).read_text()
    assert "3 campaigns" in page
    assert "false alarms on null data" in page
    assert not re.search(r"(src|href)=\"(?!data:)", page)
    assert "<script" not in page


def test_interrupted_study_goes_on(done: Path, setup: Setup, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The last row is cut off, as by a power failure; it alone is done again, and comes out the same."""
    rows = (done / ROWS).read_text().splitlines()
    (tmp_path / ROWS).write_text("\n".join(rows[:-1]) + "\n" + rows[-1][:50])
    ran: list[str] = []

    def noted(trial: Trial, setup: Setup, seed: int) -> Outcome:
        ran.append(trial.name)
        return run_trial(trial, setup, seed)

    monkeypatch.setattr(study, "run_trial", noted)
    outcomes = run(setup, tmp_path)
    lost = Outcome.from_json(rows[-1])
    (again,) = (one for one in outcomes if one.name == lost.name)
    assert ran == [lost.name]
    assert len(outcomes) == 3
    assert (again.truth, again.answer.kind) == (lost.truth, lost.answer.kind)


def test_other_settings_are_another_study(done: Path, session: str) -> None:
    with pytest.raises(InputError, match="another folder"):
        run_study(Settings(SEED + 1, session, counts=COUNTS), done)


def test_diagnosis_is_given_the_campaign_alone(setup: Setup, monkeypatch: pytest.MonkeyPatch) -> None:
    """What acts is drawn after all else that is handed in was made, and none of its names stands in the campaign."""
    given: list[tuple[object, ...]] = []

    def spy(*arguments: object) -> object:
        given.append(arguments)
        raise InputError("enough seen.")

    monkeypatch.setattr(study, "diagnose_with", spy)
    outcome = run_trial(Trial("one", "single", ("coulomb_level",), size="clear"), setup, 1)
    ((campaign, compiled, effects),) = given
    assert type(campaign) is Campaign
    assert compiled is setup.compiled  # nominal
    assert effects is setup.catalogue
    assert "coulomb" not in campaign.notes + " ".join(run.name for run in campaign.runs)
    assert outcome.answer.kind == "failed"
    assert outcome.truth[0].effect == "coulomb_level"


def test_detection_limit_is_where_evidence_reaches_the_threshold(setup: Setup, rng: np.random.Generator) -> None:
    """Data of the nominal model with a current offset of that size, which acts linearly, and without noise."""
    from bench.diagnose.linearise.marginal import Nuisances

    effect = setup.catalogue["current_offset"]
    way = Way.draw(effect, effect.places(setup.compiled)[1], setup.compiled, rng)
    limit = detection_limit(way, setup.linear, setup.blur, setup.threshold)
    replay = setup.linear.replay
    at_limit = replay.predict(World(acting=(way.at(limit, setup.compiled),))) - replay.predict(World())
    column = setup.linear.whiten(at_limit[:, :, None])
    products = Nuisances(setup.linear.jacobian).products(column[:, 0], column / limit)
    evidence = products.log_evidence(np.array([0]), np.array([1 / np.sqrt(3)]))
    assert evidence == pytest.approx(setup.threshold, rel=CLOSE)
    (size,) = (p for p in effect.parameters if not p.is_shape)
    assert abs(way.at(1.0, setup.compiled).values["offset"] - size.null) == pytest.approx(size.high)


def test_what_is_narrower_than_a_bin_is_seen_as_little_as_its_data_show_it(setup: Setup) -> None:
    """Many periods of a ripple within a bin: they show where a bin is one instant, and blur where it is a stretch."""
    ripple, offset = catalogue()["friction_ripple"], catalogue()["current_offset"]
    place = ripple.places(setup.compiled)[1]
    fine = World(acting=(Acting(ripple, place, ripple.complete({"sin": 0.3, "period": 0.011})),))
    even = World(acting=(Acting(offset, place, offset.complete({"offset": 0.2})),))
    replay = setup.linear.replay
    sizes = {}
    for name, world in (("fine", fine), ("even", even)):
        at_instants = replay.predict(world) - replay.predict(World())
        sizes[name] = np.nanstd(setup.blur.change(world)) / np.nanstd(at_instants)
    assert sizes["fine"] < 0.6
    assert sizes["even"] == pytest.approx(1.0)


def test_what_finds_no_rest_is_drawn_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """One robot of 688 once ended the whole study."""
    tried: list[object] = []

    def made(*about: object) -> str:
        tried.append(about)
        if len(tried) < make_module.TRIES:
            raise ConvergenceError("no equilibrium")
        return "a campaign"

    monkeypatch.setattr(make_module, "_made", made)
    monkeypatch.setattr(make_module, "lab_of", lambda *about: None)
    trial = Trial("single", "single")
    assert make_module.make(trial, None, 1) == "a campaign"  # type: ignore[arg-type, comparison-overlap]
    assert len({id(about[-1]) for about in tried if isinstance(about, tuple)}) == 1  # the random numbers go on


@pytest.mark.parametrize("world", WORLDS)
def test_campaigns_of_every_world_have_the_same_channels(setup: Setup, world: WorldName) -> None:
    plain = make_module.make(Trial("one", "null"), setup, SEED)
    other = make_module.make(Trial("one", "single", ("gas_loss",), size="clear", world=world), setup, SEED)
    assert [run.name for run in other.campaign.runs] == [run.name for run in plain.campaign.runs]
    for first, second in zip(plain.campaign.runs, other.campaign.runs, strict=True):
        assert set(first.columns) == set(second.columns)
        assert len(first) == len(second)
        assert np.max(np.abs(second.columns["current_2_a"] - first.columns["current_2_a"])) > 0.1
    assert [one.acting.effect.name for one in other.effects] == ["gas_loss"]
    assert bool(other.others) == (world == "messy")
