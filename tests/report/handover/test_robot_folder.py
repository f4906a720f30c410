"""The robot folder that is handed over predicts what was fitted, and every command takes it."""

import csv
import json
import shutil
import subprocess
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path

import gymnasium
import mujoco
import numpy as np
import pytest
import yaml

from bench.cli import main
from bench.diagnose.extend.fit import Fit, unknowns_of
from bench.diagnose.extend.refit import refit
from bench.diagnose.measure.figures import FittedFigure, fitted_figures
from bench.diagnose.measure.leave_out import tangent_of
from bench.diagnose.picture.candidates import Cause
from bench.diagnose.picture.design import Design, design_of
from bench.diagnose.replay.nuisances import nuisances_of
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.diagnose.replay.world import NOMINAL
from bench.effects.catalogue import catalogue
from bench.effects.effect import WHOLE, Effect, Place
from bench.effects.learned import values_of
from bench.effects.learned_readings import OF_READING, LearnedScale
from bench.effects.sensing_drive import EncoderDelay
from bench.hide.campaign import hide_campaign
from bench.report.handover.figures_table import COLUMNS, csv_of, moved_sentences
from bench.report.handover.readme import AGREES
from bench.report.handover.robot_folder import TOLERANCES, hand_over
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from tests.simulate.loading_small import small_loading
from tests.simulate.rotation_small import small_rotation
from tests.small_robot import FIGURES, write_small_robot

PAYLOADS_KG = (0.0, 6.0)  # of the segments in turn
WARM_K = 25.0
FAR = 100.0  # times as much as folder and fit may differ, by which each of the two differs from the nominal robot
SECOND = Place("joint", 1, "hinge_b")
Values = Mapping[str, float]


@dataclass(frozen=True)
class Case:
    """What acts beside deviations of all figures."""

    causes: tuple[tuple[Effect, Place, Values], ...]
    beside: tuple[str, ...] = ()  # effects that no MJCF holds


EFFECTS = catalogue()
TORQUE_CONSTANT = (EFFECTS["torque_constant"], SECOND, {"change": 0.08})
SCALE = LearnedScale(values_of(OF_READING[:3], OF_READING[:3], "A", 1.0), "current", 30.0)
CASES = {
    "figures alone": Case(()),
    "friction": Case(((EFFECTS["coulomb_level"], SECOND, {"change": 0.4}),)),
    "a joint more": Case(((EFFECTS["base_compliance"], WHOLE, {}),)),
    "play": Case(((EFFECTS["backlash"], SECOND, {"gap": 4e-4}),)),
    "torque constant": Case((TORQUE_CONSTANT,)),
    "torque constant and saturation": Case(
        (TORQUE_CONSTANT, (EFFECTS["torque_saturation"], SECOND, {"curvature": 2e-4})),
        ("torque_constant", "torque_saturation"),
    ),
    "current offset": Case((TORQUE_CONSTANT, (EFFECTS["current_offset"], SECOND, {"offset": 0.4}))),
    "current offset and saturation": Case(
        ((EFFECTS["current_offset"], SECOND, {"offset": 0.4}), (EFFECTS["torque_saturation"], SECOND, {})),
        ("current_offset", "torque_saturation"),
    ),
    "encoder delay": Case(((EFFECTS["encoder_delay"], WHOLE, {"delay": 3e-3}),), ("encoder_delay",)),
    "learned reading": Case(
        ((SCALE, SECOND, {"square": 0.5, "cube": -0.3, "signed_square": 0.8}),), ("learned_scale",)
    ),
    "unstated payload": Case(((EFFECTS["unstated_payload"], WHOLE, {"mass": 4.0, "inertia": 0.05}),)),
    "payload that is heavier": Case(((EFFECTS["payload_mass"], WHOLE, {"change": 0.1}),), ("payload_mass",)),
    "payload beside its place": Case(((EFFECTS["payload_com"], WHOLE, {"x": 0.02, "z": 0.03}),), ("payload_com",)),
    "warm friction": Case(((EFFECTS["friction_temperature"], SECOND, {"decrease": 0.02}),), ("friction_temperature",)),
}


def torque_robot(folder: Path) -> Path:
    """Write the two-joint robot with drives that report torque instead of current, and a secondary encoder."""
    write_small_robot(folder)
    instruments = FIGURES["instruments"] | {
        "current": None,
        "torque": {"sigma_nm": 1.0, "offset_sigma_nm": 2.0},
        "link_encoder": {"joints": ["hinge_b"], "offset_sigma_rad": 1e-4},
    }
    (folder / "figures.yaml").write_text(yaml.safe_dump(FIGURES | {"instruments": instruments}))
    return folder


@pytest.fixture(scope="module", params=["current", "torque"])
def design(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Design:
    folder = tmp_path_factory.mktemp("robots") / "small"
    (write_small_robot if request.param == "current" else torque_robot)(folder)
    return design_for(compile_robot(load_robot(folder)))


def design_for(compiled: CompiledRobot) -> Design:
    """Return a campaign with motion, rests under load, payloads, and drives that warm up."""
    robot = compiled.robot
    campaign = hide_campaign(robot, small_rotation(robot.folder), [], np.random.default_rng(1)).campaign
    loads = hide_campaign(robot, small_loading(robot.folder), [], np.random.default_rng(2)).campaign
    campaign = replace(campaign, runs=(*campaign.runs[:1], *loads.runs))
    quantities = quantities_of(campaign.runs, compiled)
    segments = []
    for i, segment in enumerate(segments_of(campaign, compiled, quantities, 60)):
        warm = segment.conditions.gear_k + WARM_K * (i % 3)
        conditions = replace(segment.conditions, payload_kg=PAYLOADS_KG[i % 2], gear_k=warm)
        segments.append(replace(segment, conditions=conditions))
    return design_of(Replay(compiled, tuple(segments), quantities), nuisances_of(compiled, quantities))


def fit_of(design: Design, case: Case, rng: np.random.Generator) -> Fit:
    """Return a fit in which every figure is off, as nobody would fit it."""
    causes, values = [], []
    for effect, place, given in case.causes:
        sizes = tuple(p for p in effect.parameters if not p.is_shape)
        shapes = tuple(p for p in effect.parameters if p.is_shape)
        causes.append(Cause(effect, place, sizes, shapes))
        values += [given.get(p.name, p.null if given else p.typical) for p in (*sizes, *shapes)]
    unknowns = unknowns_of(tuple(causes))
    k, nuisances = len(unknowns), rng.standard_normal(len(design.nuisances))
    residual = np.zeros(design.replay.shape)
    slopes = np.zeros((*residual.shape, k))
    return Fit(tuple(causes), unknowns, np.array(values), np.eye(k), nuisances, 0.0, 0.0, residual, slopes, design.play)


def predictions(design: Design, fit: Fit, folder: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return what the fit predicts, the folder, and the nominal robot, in units of each channel's largest reading."""
    compiled, campaign = design.replay.compiled, (design.segments, design.quantities)
    nominal = Replay(compiled, *campaign, TOLERANCES[0])
    handed = Replay(compile_robot(load_robot(folder)), *campaign, TOLERANCES[0])
    fitted = nominal.predict(fit.world(design))
    scale = np.nanmax(np.fmax(np.abs(fitted), np.concatenate([s.sigma for s in design.segments])), axis=0)
    return fitted / scale, handed.predict(NOMINAL) / scale, nominal.predict(NOMINAL) / scale


@pytest.mark.parametrize("name", CASES)
def test_the_folder_predicts_what_was_fitted(design: Design, name: str, tmp_path: Path) -> None:
    if ("current" in name or "saturation" in name) and not design.replay.compiled.robot.figures.instruments.current:
        pytest.skip("the drives report no current")
    fit = fit_of(design, CASES[name], np.random.default_rng(7))
    handed = hand_over(design, fit, tmp_path / "robot", tmp_path / "nominal.xml")
    assert handed.missing == ()
    assert handed.disagreement < AGREES
    fitted, found, nominal = predictions(design, fit, tmp_path / "robot")
    np.testing.assert_allclose(found, fitted, atol=AGREES)
    assert np.nanmax(np.abs(fitted - nominal)) > FAR * AGREES
    listed = load_robot(tmp_path / "robot").figures.fitted.effects
    assert tuple(one.effect for one in listed) == CASES[name].beside
    mujoco.MjModel.from_xml_path(str(tmp_path / "robot" / "small.xml"))
    assert mujoco.MjModel.from_xml_path(str(tmp_path / "nominal.xml")).nv == design.replay.compiled.model.nv


def test_friction_held_at_rest_is_left_out(design: Design, tmp_path: Path) -> None:
    """It is of the campaign: with it alone off, the folder is the nominal robot."""
    held = np.array([float("held at rest" in nuisance.name) for nuisance in design.nuisances])
    assert held.any()
    fit = replace(fit_of(design, Case(()), np.random.default_rng(1)), nuisances=held)
    handed = hand_over(design, fit, tmp_path / "robot", tmp_path / "nominal.xml")
    assert handed.difference == ""
    figures = load_robot(tmp_path / "robot").figures
    assert figures.model_copy(update={"title": FIGURES["title"]}) == design.replay.compiled.robot.figures
    rows = fitted_figures(design, replace(fit, covariance=np.zeros((0, 0))))
    assert {row.kind for row in rows if "held at rest" in row.name} == {"campaign"}


def test_what_was_handed_over_can_be_diagnosed_and_handed_over_again(design: Design, tmp_path: Path) -> None:
    """Figures are found on top of figures. Tilts of the force sensor, which are large, add to first order alone."""
    rng = np.random.default_rng(3)
    fit = fit_of(design, CASES["encoder delay"], rng)
    hand_over(design, fit, tmp_path / "robot", tmp_path / "nominal.xml")
    again = replace(design, replay=Replay(compile_robot(load_robot(tmp_path / "robot")), *design_parts(design)))
    names = [nuisance.name for nuisance in design.nuisances]
    assert names == [nuisance.name for nuisance in again.nuisances]
    second = fit_of(again, CASES["torque constant"], rng)
    is_tilt = np.array([name.startswith("tilt of the force sensor") for name in names])
    second = replace(second, nuisances=np.where(is_tilt, 0.0, second.nuisances))
    handed = hand_over(again, second, tmp_path / "again", tmp_path / "nominal-again.xml")
    assert handed.disagreement < AGREES
    figures = load_robot(tmp_path / "again").figures
    assert figures.title == f"{FIGURES['title']}, as fitted"
    assert [one.effect for one in figures.fitted.effects] == ["encoder_delay"]


def design_parts(design: Design) -> tuple:
    return design.segments, design.quantities


def test_an_effect_of_a_users_own_file_is_said_to_be_missing(design: Design, tmp_path: Path) -> None:
    class Own(EncoderDelay):
        name = "own_delay"

    case = Case(((Own(), WHOLE, {"delay": 3e-3}),))
    handed = hand_over(
        design, fit_of(design, case, np.random.default_rng(2)), tmp_path / "robot", tmp_path / "nominal.xml"
    )
    assert len(handed.missing) == 1
    assert "own_delay" in handed.missing[0]
    assert handed.disagreement > FAR * AGREES
    readme = (tmp_path / "robot" / "README.md").read_text()
    assert "own_delay" in readme
    assert "differs from what was fitted" in readme


def test_an_effect_that_the_robot_alone_has_no_place_for_is_of_the_campaign(design: Design, tmp_path: Path) -> None:
    case = Case(((EFFECTS["encoder_delay"], SECOND, {"delay": 3e-3}),))  # all encoders are late, or none
    handed = hand_over(
        design, fit_of(design, case, np.random.default_rng(2)), tmp_path / "robot", tmp_path / "nominal.xml"
    )
    assert len(handed.missing) == 1
    assert "is of this campaign" in handed.missing[0]
    assert handed.disagreement > FAR * AGREES
    assert load_robot(tmp_path / "robot").figures.fitted.effects == ()


def test_the_torque_constant_stands_where_every_command_looks_for_it(design: Design, tmp_path: Path) -> None:
    fit = fit_of(design, CASES["torque constant"], np.random.default_rng(7))
    hand_over(design, fit, tmp_path / "robot", tmp_path / "nominal.xml")
    figures = load_robot(tmp_path / "robot").figures
    for j, drive in enumerate(figures.drives):
        (gain, *_) = (
            x * n.sigma
            for n, x in zip(design.nuisances, fit.nuisances, strict=True)
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


def test_the_difference_makes_the_new_mjcf_of_the_nominal_one(design: Design, tmp_path: Path) -> None:
    fit = fit_of(design, CASES["friction"], np.random.default_rng(7))
    handed = hand_over(design, fit, tmp_path / "robot", tmp_path / "nominal.xml")
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


def test_the_table_is_the_fit(design: Design) -> None:
    """Values and errors of findings are those of the fit; the table reads back as it was written."""
    effect = EFFECTS["coulomb_level"]
    fit = refit(design, (Cause(effect, SECOND, effect.parameters, ()),), {})
    rows = fitted_figures(design, fit)
    assert len(rows) == len(design.nuisances) + 1
    found = rows[0]
    assert found.kind == "finding"
    assert (found.found, found.stated) == (fit.values[0], 0.0)
    np.testing.assert_allclose((found.high - found.low) / 2 / 1.959964, fit.sigma[0], rtol=1e-6)
    by_name = {(row.name, row.kind): row for row in rows}
    for nuisance, x in zip(design.nuisances, fit.nuisances, strict=True):
        row = by_name.get((nuisance.name, "figure")) or by_name[nuisance.name, "campaign"]
        if nuisance.name.startswith("torque constant of"):
            stated = 100.0 if "current_1_a" in [quantity.column for quantity in design.quantities] else 1.0
            constant = row.found + (row.stated == 0)
            np.testing.assert_allclose(constant * (1 + x * nuisance.sigma), stated)
            assert row.low < row.found < row.high
            assert row.sigmas == -x
        else:
            assert (row.found, row.sigmas, row.sigma) == (x * nuisance.sigma, x, nuisance.sigma)
            assert row.high - row.low <= 2 * 1.96 * nuisance.sigma * (1 + 1e-9)  # data never know less than was stated
    names = [*(nuisance.name for nuisance in design.nuisances), found.name]
    columns = np.linalg.solve(tangent_of(design, fit).precision, np.eye(len(names)))
    rho = columns / np.sqrt(np.outer(np.diag(columns), np.diag(columns))) - np.eye(len(names))
    assert len(set(names)) == len(names)
    partners = [names[i] if abs(row[i]) > np.sqrt(0.5) else "" for row in rho for i in [int(np.argmax(np.abs(row)))]]
    weights = by_name["weights that hang", "figure"]  # the sensor reads (1 + gain) (1 + share) of what was written down
    assert weights.trades_with == "gain of the force sensor"
    assert weights.correlation < 0
    for row in rows:
        assert row.trades_with == partners[names.index(row.name)]
        assert np.isnan(row.correlation) == (row.trades_with == "")
    read = list(csv.DictReader(csv_of(rows).splitlines()))
    assert list(read[0]) == list(COLUMNS)
    for row, text in zip(rows, read, strict=True):
        for field in fields(FittedFigure):
            value = getattr(row, field.name)
            if isinstance(value, str):
                assert text[field.name] == value
            else:
                assert (text[field.name] == "") if np.isnan(value) else float(text[field.name]) == value


def test_a_figure_that_moved_is_named_with_what_it_trades_against() -> None:
    moved = FittedFigure("stiffness of a", "figure", "", 0.0, 0.09, 0.07, 0.11, 0.03, 3.0, "mass of b", -0.8)
    turned = FittedFigure("turn", "figure", "rad", 0.0, -1e-3, -1.2e-3, -8e-4, 2e-4, -5.0, "", np.nan)
    still = replace(moved, sigmas=1.9)
    held = replace(moved, kind="campaign")
    assert list(moved_sentences([moved, still, held, turned])) == [
        "stiffness of a: +9.0 % (7.0 to 11.0), 3.0 times its stated uncertainty; it trades against mass of b "
        "(correlation -0.80)",
        "turn: -0.057 deg (-0.069 to -0.046), 5.0 times its stated uncertainty",
    ]
    constant = FittedFigure(
        "torque constant of a", "figure", "Nm/A", 220.8, 247.6, 246.6, 248.6, 4.4, 5.2, "weights", 0.9
    )
    assert list(moved_sentences([constant])) == [
        "torque constant of a: 247.6 Nm/A (246.6 to 248.6) instead of 220.8, 5.2 times its stated uncertainty; "
        "it trades against weights (correlation +0.90)"
    ]
