"""The robot folder that is handed over predicts what was fitted, and every command takes it."""

import json
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import gymnasium
import mujoco
import numpy as np
import pytest
import yaml

from bench.cli import main
from bench.diagnose.cross_validation.figures import fitted_figures
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.replay.nuisances import MOTOR_ZERO
from bench.diagnose.replay.replay import Replay
from bench.effects.effect import WHOLE
from bench.effects.sensing_drive import EncoderDelay
from bench.report.handover.readme import AGREES
from bench.report.handover.robot_folder import hand_over
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from tests.report.handover.made import CASES, EFFECTS, FAR, SECOND, Case, design_for, fit_of, predictions
from tests.simulate.loading_small import small_loading
from tests.small_robot import FIGURES, write_small_robot


@pytest.mark.parametrize("name", CASES)
def test_the_folder_predicts_what_was_fitted(linear: LinearisedModel, name: str, tmp_path: Path) -> None:
    if ("current" in name or "saturation" in name) and not linear.replay.compiled.robot.figures.instruments.current:
        pytest.skip("the drives report no current")
    fit = fit_of(linear, CASES[name], np.random.default_rng(7))
    handed = hand_over(linear, fit, tmp_path / "robot", tmp_path / "nominal.xml")
    assert handed.missing == ()
    assert handed.disagreement < AGREES
    fitted, found, nominal = predictions(linear, fit, tmp_path / "robot")
    np.testing.assert_allclose(found, fitted, atol=AGREES)
    assert np.nanmax(np.abs(fitted - nominal)) > FAR * AGREES
    listed = load_robot(tmp_path / "robot").figures.fitted.effects
    assert tuple(one.effect for one in listed) == CASES[name].beside
    mujoco.MjModel.from_xml_path(str(tmp_path / "robot" / "small.xml"))
    assert mujoco.MjModel.from_xml_path(str(tmp_path / "nominal.xml")).nv == linear.replay.compiled.model.nv


def test_zeros_of_motors_are_handed_over(tmp_path: Path) -> None:
    folder = write_small_robot(tmp_path / "own")
    instruments = FIGURES["instruments"] | {"encoder": {"offset_sigma_rad": 1e-4}}
    (folder / "figures.yaml").write_text(yaml.safe_dump(FIGURES | {"instruments": instruments}))
    linear = design_for(compile_robot(load_robot(folder)))
    fit = fit_of(linear, Case(()), np.random.default_rng(7))
    handed = hand_over(linear, fit, tmp_path / "robot", tmp_path / "nominal.xml")
    assert handed.missing == ()
    assert handed.disagreement < AGREES
    held = {one.place: one.values for one in load_robot(tmp_path / "robot").figures.fitted.effects}
    zeros = {
        n.name.removeprefix(MOTOR_ZERO): {"offset": n.sigma * x}
        for n, x in zip(linear.nuisances, fit.nuisances, strict=True)
        if n.encoder is not None
    }
    assert held == zeros
    assert len(zeros) == 2


def test_friction_held_at_rest_is_left_out(linear: LinearisedModel, tmp_path: Path) -> None:
    """It is of the campaign: with it alone off, the folder is the nominal robot."""
    held = np.array([float("held at rest" in nuisance.name) for nuisance in linear.nuisances])
    assert held.any()
    fit = replace(fit_of(linear, Case(()), np.random.default_rng(1)), nuisances=held)
    handed = hand_over(linear, fit, tmp_path / "robot", tmp_path / "nominal.xml")
    assert handed.difference == ""
    figures = load_robot(tmp_path / "robot").figures
    assert figures.model_copy(update={"title": FIGURES["title"]}) == linear.replay.compiled.robot.figures
    rows = fitted_figures(linear, replace(fit, covariance=np.zeros((0, 0))))
    assert {row.kind for row in rows if "held at rest" in row.name} == {"campaign"}


def test_what_was_handed_over_can_be_diagnosed_and_handed_over_again(linear: LinearisedModel, tmp_path: Path) -> None:
    """Figures are found on top of figures. Tilts of the force sensor, which are large, add to first order alone."""
    rng = np.random.default_rng(3)
    fit = fit_of(linear, CASES["encoder delay"], rng)
    hand_over(linear, fit, tmp_path / "robot", tmp_path / "nominal.xml")
    again = replace(linear, replay=Replay(compile_robot(load_robot(tmp_path / "robot")), *design_parts(linear)))
    names = [nuisance.name for nuisance in linear.nuisances]
    assert names == [nuisance.name for nuisance in again.nuisances]
    second = fit_of(again, CASES["torque constant"], rng)
    is_tilt = np.array([name.startswith("tilt of the force sensor") for name in names])
    second = replace(second, nuisances=np.where(is_tilt, 0.0, second.nuisances))
    handed = hand_over(again, second, tmp_path / "again", tmp_path / "nominal-again.xml")
    assert handed.disagreement < AGREES
    figures = load_robot(tmp_path / "again").figures
    assert figures.title == f"{FIGURES['title']}, as fitted"
    assert [one.effect for one in figures.fitted.effects] == ["encoder_delay"]


def design_parts(linear: LinearisedModel) -> tuple:
    return linear.segments, linear.quantities


@pytest.mark.parametrize(("names", "kept"), [(("may", "june"), "june"), (("", ""), "")])
def test_the_folder_says_which_recording_it_is_of(
    linear: LinearisedModel, tmp_path: Path, names: tuple[str, str], kept: str
) -> None:
    segments, quantities = design_parts(linear)
    first, rest = len(segments) // 2, len(segments) - len(segments) // 2
    whose = [names[0]] * first + [names[1]] * rest
    told = tuple(replace(segment, recording=name) for segment, name in zip(segments, whose, strict=True))
    both = replace(linear, replay=Replay(linear.replay.compiled, told, quantities))
    hand_over(both, fit_of(both, CASES["encoder delay"], np.random.default_rng(3)), tmp_path / "r", tmp_path / "n.xml")
    assert load_robot(tmp_path / "r").figures.fitted.recording == kept


def test_an_effect_of_a_users_own_file_is_said_to_be_missing(linear: LinearisedModel, tmp_path: Path) -> None:
    class Own(EncoderDelay):
        name = "own_delay"

    case = Case(((Own(), WHOLE, {"delay": 3e-3}),))
    handed = hand_over(
        linear, fit_of(linear, case, np.random.default_rng(2)), tmp_path / "robot", tmp_path / "nominal.xml"
    )
    assert len(handed.missing) == 1
    assert "own_delay" in handed.missing[0]
    assert handed.disagreement > FAR * AGREES
    readme = (tmp_path / "robot" / "README.md").read_text()
    assert "own_delay" in readme
    assert "differs from what was fitted" in readme


def test_an_effect_that_the_robot_alone_has_no_place_for_is_of_the_campaign(
    linear: LinearisedModel, tmp_path: Path
) -> None:
    case = Case(((EFFECTS["encoder_delay"], SECOND, {"delay": 3e-3}),))  # all encoders are late, or none
    handed = hand_over(
        linear, fit_of(linear, case, np.random.default_rng(2)), tmp_path / "robot", tmp_path / "nominal.xml"
    )
    assert len(handed.missing) == 1
    assert "is of this campaign" in handed.missing[0]
    assert handed.disagreement > FAR * AGREES
    assert load_robot(tmp_path / "robot").figures.fitted.effects == ()


def test_the_torque_constant_stands_where_every_command_looks_for_it(linear: LinearisedModel, tmp_path: Path) -> None:
    fit = fit_of(linear, CASES["torque constant"], np.random.default_rng(7))
    hand_over(linear, fit, tmp_path / "robot", tmp_path / "nominal.xml")
    figures = load_robot(tmp_path / "robot").figures
    for j, drive in enumerate(figures.drives):
        (gain, *_) = (
            x * n.sigma
            for n, x in zip(linear.nuisances, fit.nuisances, strict=True)
            if n.name == f"torque constant of {drive.joint}"
        )
        change = 1.08 if j == 1 else 1.0
        if figures.instruments.current:
            assert drive.torque_constant_nm_per_a == pytest.approx(100.0 * change / (1 + gain))
        else:
            assert figures.fitted.readings.torque_gain[drive.joint] == pytest.approx((1 + gain) / change - 1)


def patched(text: str, difference: str) -> str:
    """Apply a unified difference of one file."""
    lines, found, at = text.splitlines(True), [], 0
    for line in difference.splitlines(True)[2:]:
        if line.startswith("@@"):
            start = int(line.split()[1].split(",")[0].removeprefix("-")) - 1
            found += lines[at:start]
            at = start
        elif line.startswith("+"):
            found.append(line[1:])
        else:
            assert lines[at] == line[1:]
            found += [lines[at]] if line.startswith(" ") else []
            at += 1
    return "".join(found + lines[at:])


def test_the_difference_makes_the_new_mjcf_of_the_nominal_one(linear: LinearisedModel, tmp_path: Path) -> None:
    fit = fit_of(linear, CASES["friction"], np.random.default_rng(7))
    handed = hand_over(linear, fit, tmp_path / "robot", tmp_path / "nominal.xml")
    expected = (tmp_path / "robot" / "small.xml").read_text()
    assert patched((tmp_path / "nominal.xml").read_text(), handed.difference) == expected
    program = shutil.which("patch")
    if program:
        (tmp_path / "robot.diff").write_text(handed.difference)
        subprocess.run([program, "nominal.xml", "robot.diff"], cwd=tmp_path, check=True, capture_output=True)
        assert (tmp_path / "nominal.xml").read_text() == expected


@pytest.fixture(scope="module")
def handed(small_robot: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder that was handed over."""
    made = tmp_path_factory.mktemp("handed")
    first = design_for(compile_robot(load_robot(small_robot)))
    hand_over(
        first, fit_of(first, CASES["unstated payload"], np.random.default_rng(5)), made / "robot", made / "nominal.xml"
    )
    return made / "robot"


def test_what_is_stated_of_each_drive_is_written_back(tmp_path: Path) -> None:
    stated = {"rotor_inertia": [0.1, 3.0], "stiffness": [3.0, 0.03], "friction": [0.05, 0.2], "presliding": 1.0}
    nominal = write_small_robot(tmp_path / "small")
    (nominal / "figures.yaml").write_text(yaml.safe_dump(FIGURES | {"uncertainty": stated}))
    linear = design_for(compile_robot(load_robot(nominal)))
    names = {nuisance.name: nuisance.sigma for nuisance in linear.nuisances}
    assert (names["rotor inertia of hinge_a"], names["rotor inertia of hinge_b"]) == (0.1, 3.0)
    fit = fit_of(linear, CASES["unstated payload"], np.random.default_rng(5))
    hand_over(linear, fit, tmp_path / "robot", tmp_path / "nominal.xml")
    assert yaml.safe_load((tmp_path / "robot" / "figures.yaml").read_text())["uncertainty"] == stated
    assert load_robot(tmp_path / "robot").figures.uncertainty == load_robot(nominal).figures.uncertainty


def test_commands_take_the_folder(handed: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["robots", str(handed)]) == 0
    assert "tracker shift" in capsys.readouterr().out
    assert main(["effects", "--robot", str(handed)]) == 0
    scenario = tmp_path / "scenario.yaml"
    scenario.write_text(yaml.safe_dump(small_loading(handed, orientation=True).model_dump(mode="json")))
    assert main(["run", str(scenario), "-o", str(tmp_path / "run")]) == 0
    campaign = str(tmp_path / "run" / "campaign")
    assert main(["check", campaign]) == 0
    capsys.readouterr()
    assert main(["identify", campaign, "--method", "joint", "--json", "--robot", str(handed)]) == 0
    assert "joint" in json.loads(capsys.readouterr().out)["estimates"]


def test_the_environment_takes_the_folder(handed: Path) -> None:
    environment = gymnasium.make("bench:Bench-v0", robot=str(handed))
    observation, _ = environment.reset(seed=1)
    assert np.all(np.isfinite(observation["q_motor"]))
    environment.close()
