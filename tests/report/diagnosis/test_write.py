"""The files of a real diagnosis, of what was found, of nothing, and of something unlisted."""

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rerun.chunk import RrdReader

from bench.diagnose.diagnose import Diagnosis, diagnose
from bench.diagnose.extend.refit import refit
from bench.diagnose.linearise.generic import Block, anew
from bench.diagnose.name.candidate_model import with_shape
from bench.diagnose.name.models import Model
from bench.diagnose.name.naming import Naming
from bench.diagnose.verdict import Unfinished, Unlisted
from bench.effects.catalogue import catalogue
from bench.effects.effect import Acting
from bench.errors import RobotError
from bench.hide.campaign import hide_campaign
from bench.record.campaign import Campaign
from bench.report.diagnosis.file_names import DIFFERENCE, FIGURES, NOMINAL_MJCF, RECORDING, REPORT, ROBOT, TEXT, VERDICT
from bench.report.diagnosis.readings import readings_of
from bench.report.diagnosis.recording_clock import recording_clock_of
from bench.report.diagnosis.words import places_of
from bench.report.diagnosis.write import write_diagnosis
from bench.report.handover.readme import AGREES
from bench.report.recording.view import recordings_in
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.scenario.rotation import Rotation

LARGEST = 20e6  # [byte], of a recording
NOTE = "After service <script>alert(1)</script>"
SWEEP = Rotation(
    experiment="rotation",
    robot="hh150",
    joint=2,
    start_deg=(0, -20, 0, 0, 90, 0),
    end_deg=50,
    speeds_deg_per_s=(20,),
    ramp_s=1.0,
    sample_period_s=0.08,
)


@pytest.fixture(scope="module")
def campaign() -> Campaign:
    robot, effect = load_robot("hh150"), catalogue()["coulomb_level"]
    place = effect.places(compile_robot(robot))[1]
    acting = Acting(effect, place, effect.complete({"change": 0.8}))
    made = hide_campaign(robot, SWEEP, [acting], np.random.default_rng(3)).campaign
    return replace(made, notes=NOTE)


@pytest.fixture(scope="module")
def found(campaign: Campaign) -> Diagnosis:
    names = ("coulomb_level",)
    effects = catalogue()
    return diagnose(campaign, compile_robot(load_robot("hh150")), {name: effects[name] for name in names})


def named(found: Diagnosis, kind: str) -> Diagnosis:
    """Return the same data with another verdict."""
    naming, verdict = found.naming, found.verdict
    empty = replace(verdict, kind=kind, explanations=(), rivals=(), gain=(), steps=(), next=())
    if kind == "nothing found":
        changed: Naming = replace(naming, kind="nothing found", models=())
        return replace(found, naming=changed, verdict=empty)
    if kind == "unlisted cause":
        shape = next(entry.what for entry in naming.screening.entries if entry.cause is None)
        assert isinstance(shape, Block)
        block = anew(naming.linear, shape)
        own = with_shape(naming.linear, block)
        changed = replace(naming, kind="unlisted cause", models=(Model(refit(own, (), {}), block),))
        unlisted = Unlisted(block.place, block.kind, block.depends_on)
        return replace(found, naming=changed, verdict=replace(empty, unlisted=unlisted))
    return found


@pytest.fixture(scope="module", params=["cause", "nothing found", "unlisted cause"])
def folder(
    request: pytest.FixtureRequest, found: Diagnosis, campaign: Campaign, tmp_path_factory: pytest.TempPathFactory
) -> Path:
    made = tmp_path_factory.mktemp("diagnosis")
    write_diagnosis(named(found, request.param), made, campaign, "bench diagnose campaign -o out")
    return made


def test_the_files_are_there(folder: Path) -> None:
    names = {path.name for path in folder.iterdir()}
    assert names == {VERDICT, TEXT, REPORT, RECORDING, ROBOT, NOMINAL_MJCF, DIFFERENCE, FIGURES}
    content = json.loads((folder / VERDICT).read_text())
    assert content["handed_over"]["disagreement"] < AGREES
    assert content["handed_over"]["missing"] == []
    assert content["data"]["runs"][0]["name"]
    assert content["command"].startswith("bench diagnose")


def test_all_words_are_kept_and_what_decides_is_printed(found: Diagnosis, tmp_path: Path) -> None:
    printed = write_diagnosis(found, tmp_path)
    kept = (tmp_path / TEXT).read_text().splitlines()
    *lines, more = printed
    assert more.startswith(f"More in {TEXT} and on the page: what ")
    assert set(lines) < set(kept)
    assert lines[0] == kept[0]
    assert "What these data cannot show" in kept


def test_what_is_no_robot_costs_nobody_the_verdict(
    found: Diagnosis, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A gear as stiff as 3.8e11 Nm/rad was refused by the robot folder, and eighteen minutes were lost."""

    def refuses(*_: object) -> None:
        (tmp_path / ROBOT).mkdir()
        (tmp_path / NOMINAL_MJCF).touch()
        raise RobotError("a stiffness that no part has")

    monkeypatch.setattr("bench.report.diagnosis.write.hand_over", refuses)
    write_diagnosis(found, tmp_path)
    assert not any((tmp_path / name).exists() for name in (ROBOT, NOMINAL_MJCF, DIFFERENCE))
    said = json.loads((tmp_path / VERDICT).read_text())["handed_over"]["missing"]
    assert said == ["everything: what was fitted is no robot: a stiffness that no part has"]
    assert any(line.startswith("robot      none") for line in places_of(tmp_path))


def test_a_library_that_cannot_be_loaded_costs_nobody_the_verdict(
    found: Diagnosis, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where memory was short for Rerun's library, a diagnosis that was done ended in a traceback and left nothing."""
    monkeypatch.setitem(sys.modules, "rerun.blueprint", None)  # an ImportError where it is loaded
    *_, told = write_diagnosis(found, tmp_path)
    assert told.startswith("no Rerun recording is written: a library cannot be loaded: ")
    assert {VERDICT, REPORT, ROBOT} <= {path.name for path in tmp_path.iterdir()}
    assert not (tmp_path / RECORDING).exists()
    assert RECORDING not in (tmp_path / REPORT).read_text()


def test_a_robot_of_a_diagnosis_that_was_not_done_says_so(found: Diagnosis, folder: Path, tmp_path: Path) -> None:
    said = "Its diagnosis ended before it was done"
    assert said not in (folder / ROBOT / "README.md").read_text()
    stopped = replace(found, verdict=replace(found.verdict, unfinished=Unfinished("interrupted", "naming")))
    write_diagnosis(stopped, tmp_path)
    assert said in (tmp_path / ROBOT / "README.md").read_text()
    assert not load_robot(folder / ROBOT).figures.fitted.unfinished
    assert load_robot(tmp_path / ROBOT).figures.fitted.unfinished == "interrupted"


def test_the_page_shows_the_pictures_and_no_script(folder: Path) -> None:
    page = (folder / REPORT).read_text()
    assert "<script" not in page
    assert "&lt;script&gt;" in page
    assert page.count("data:image/svg+xml;base64,") >= 2


def test_the_recording_opens_and_has_robot_channels_and_verdict(folder: Path) -> None:
    path = folder / RECORDING
    assert path.stat().st_size < LARGEST
    assert recordings_in(folder) == (path,)
    entities = {chunk.entity_path for chunk in RrdReader(path).stream().to_chunks()}
    for start in ("/robot/elastic/", "/robot/compared/", "/channels/current_2_a/measured", "/left/", "/verdict"):
        assert any(entity.startswith(start) for entity in entities), start
    is_named = bool(json.loads((folder / VERDICT).read_text())["explanations"])
    assert any(entity.startswith("/probability/") for entity in entities) == is_named


def test_what_was_found_explains_the_channel_that_was_wrong(found: Diagnosis) -> None:
    readings = readings_of(found)
    assert readings.after is not None
    worst = readings.channels[[c.before for c in readings.channels].index(max(c.before for c in readings.channels))]
    assert worst.channel == "current_2_a"
    assert worst.after is not None
    assert worst.after < 2.0 < worst.before


def test_residuals_and_simulations_agree(found: Diagnosis) -> None:
    readings = readings_of(found)
    np.testing.assert_allclose(
        found.linear.whiten(readings.measured - readings.simulated), readings.before, rtol=1e-6, atol=1e-6
    )


def test_the_recording_runs_without_the_hours_in_between(found: Diagnosis) -> None:
    time = recording_clock_of(found.linear)
    assert np.all(np.diff(time.seconds) > 0)
    assert time.is_break.sum() == len(found.linear.segments) - 1
    angle = time.curve(readings_of(found).angle[:, 1])
    assert np.array_equal(np.isnan(angle), time.is_break)
