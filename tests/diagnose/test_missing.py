"""A campaign that lacks something is diagnosed as far as it goes, and the verdict says what was missing."""

import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from bench.diagnose.diagnose import diagnose
from bench.diagnose.verdict import Verdict
from bench.effects.catalogue import catalogue
from bench.errors import InputError
from bench.paths import models_dir
from bench.record.campaign import Array, Campaign
from bench.report.diagnosis.words import words_of
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from tests.diagnose.sweeps import LOADS, SWEEPS, changed, made

CHOICE = ("coulomb_level", "viscous_level", "gas_loss", "friction_temperature", "tracker_frame", "force_gain")
HIDDEN = {"coulomb_level": 0.6}
TEMPERATURES = ("gear_temperature", "motor_temperature", "ambient_temperature")


@pytest.fixture(scope="module")
def sweeps() -> Campaign:
    return made(SWEEPS, seed=3, hidden=HIDDEN)


@pytest.fixture(autouse=True)
def without_proposals(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave out the next experiment, which takes most of the time."""
    monkeypatch.setattr("bench.diagnose.diagnose.propose", lambda *given: ())


def verdict_on(campaign: Campaign, robot: CompiledRobot) -> Verdict:
    effects = catalogue()
    return diagnose(campaign, robot, {name: effects[name] for name in CHOICE}).verdict


def lacking(campaign: Campaign, *beginnings: str) -> Campaign:
    def drop(columns: dict[str, Array]) -> None:
        for name in [name for name in columns if name.startswith(beginnings)]:
            del columns[name]

    return changed(campaign, drop)


def named(verdict: Verdict) -> list[str]:
    return [cause.effect for explanation in verdict.explanations for cause in explanation.causes]


def shown_by(verdict: Verdict, effect: str, place: str) -> tuple[str, ...] | None:
    """Return what would show an effect that is not to be seen; None if it is."""
    found = [spot.shown_by for spot in verdict.blind if spot.effect == effect and place in spot.places]
    return found[0] if found else None


@pytest.mark.parametrize(
    ("without", "effect"),
    [
        (("tracker", "link_encoder"), "tracker_frame"),
        (("force",), "force_gain"),
        (TEMPERATURES, "friction_temperature"),
    ],
)
def test_what_is_there_is_enough_and_what_is_not_is_said(
    without: tuple[str, ...], effect: str, robot: CompiledRobot
) -> None:
    verdict = verdict_on(made(SWEEPS, seed=3, hidden=HIDDEN, without=without), robot)
    assert "coulomb_level" in named(verdict)
    assert effect in verdict.missing or effect in {spot.effect for spot in verdict.blind}
    title = catalogue()[effect].title
    assert any(title in line for line in words_of(verdict) if line.startswith("Not "))


def test_without_currents_friction_is_not_to_be_seen_and_currents_would_show_it(
    sweeps: Campaign, robot: CompiledRobot
) -> None:
    blind = verdict_on(lacking(sweeps, "current", "reflector"), robot)
    assert "coulomb_level" not in named(blind)
    assert "current" in (shown_by(blind, "coulomb_level", "joint 2") or ())
    assert "current" in (shown_by(blind, "viscous_level", "joint 2") or ())
    assert any("motor currents or torques (current_i_a" in line for line in words_of(blind))
    assert shown_by(verdict_on(sweeps, robot), "coulomb_level", "joint 2") is None


def test_one_run_is_enough_for_a_cause(sweeps: Campaign, robot: CompiledRobot) -> None:
    verdict = verdict_on(replace(sweeps, runs=sweeps.runs[:1]), robot)
    assert named(verdict) == ["coulomb_level"]
    assert verdict.held_out_by == "block", "no whole run can be left out"


@pytest.mark.parametrize("runs", [1, 4])
def test_rests_alone_say_that_friction_takes_motion(runs: int, robot: CompiledRobot) -> None:
    loads = made(LOADS, seed=6)
    verdict = verdict_on(replace(loads, runs=loads.runs[:runs]), robot)
    assert verdict.kind == "nothing found"
    assert shown_by(verdict, "viscous_level", "joint 2") == ()
    assert any("other joints, speeds" in line for line in words_of(verdict))


def test_motor_angles_are_not_needed_where_commands_are(sweeps: Campaign, robot: CompiledRobot) -> None:
    assert "coulomb_level" in named(verdict_on(lacking(sweeps, "q_motor"), robot))


@pytest.mark.parametrize("left", [("force", "moment"), ()])
def test_nothing_to_go_by_is_an_error_that_says_what_to_log(
    left: tuple[str, ...], sweeps: Campaign, robot: CompiledRobot
) -> None:
    kinds = {"current", "reflector", "gas", "force", "moment"} - set(left)
    effects = catalogue()
    with pytest.raises(InputError, match="log motor currents or torques"):
        diagnose(lacking(sweeps, *kinds), robot, {name: effects[name] for name in ("coulomb_level", "gas_loss")})


@pytest.mark.parametrize(
    ("is_stated", "ramp"), [(True, 0.1), (True, 1.0), (False, 1.0), pytest.param(False, 0.1, marks=pytest.mark.study)]
)
def test_friction_of_slow_motion_is_not_to_be_seen_in_fast_one(is_stated: bool, ramp: float, tmp_path: Path) -> None:
    """A rise at standstill does not show in sweeps that start and stop within a bin, and half of it in longer ramps.

    Nor beside friction that was found: a stranger's gantry has none in its file, and a Stribeck effect that did not
    show was not listed either.
    """
    folder = Path(shutil.copytree(models_dir() / "hh150", tmp_path / "hh150"))
    mjcf = folder / "hh150.xml"
    if not is_stated:
        mjcf.write_text(mjcf.read_text().replace(" 309.2 309.2", " 0 309.2").replace(" 132.5 132.5", " 0 132.5"))
    effects = {name: catalogue()[name] for name in ("coulomb_friction", "stribeck")}
    campaign = made(SWEEPS.model_copy(update={"ramp_s": ramp}), seed=3)
    verdict = diagnose(campaign, compile_robot(load_robot(folder)), effects).verdict
    assert named(verdict) == ([] if is_stated else ["coulomb_friction"])
    (spot,) = (one for one in verdict.blind if one.effect == "stribeck" and "joint 2" in one.places)
    (line,) = (line for line in words_of(verdict) if "several slow steady speeds would show" in line)
    if ramp < 0.2:
        assert not spot.below
        assert "Stribeck effect (joint" in line
    else:
        assert spot.unit == "rad/s"
        assert 0.003 < spot.below[spot.places.index("joint 2")] <= 0.1  # what is plausible
        assert "Stribeck effect (joint 2) of a speed below " in line
