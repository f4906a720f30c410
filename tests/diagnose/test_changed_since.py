"""What is found otherwise than by the diagnosis given is said, and stands in the table in the same terms."""

import csv
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from bench.diagnose.cross_validation.figures import FittedFigure, fitted_figures
from bench.diagnose.cross_validation.posterior import posterior_of
from bench.diagnose.diagnose import diagnose
from bench.diagnose.extend.fit import Fit
from bench.diagnose.extend.refit import refit
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.replay.given import Posterior, given_by
from bench.diagnose.replay.levels import with_recordings
from bench.diagnose.replay.nuisances import nuisances_of
from bench.effects.drifts import COULOMB, DAY_K
from bench.effects.effect import Acting, Place
from bench.hide.campaign import hide_campaign
from bench.record.campaign import Campaign
from bench.report.diagnosis.changed import changed_lines
from bench.report.diagnosis.headline import headline
from bench.report.handover.figures_table import SHARE, csv_of
from bench.report.handover.posterior_file import read_posterior, write_posterior
from bench.report.handover.robot_folder import hand_over
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from tests.diagnose.test_given import BINS, linear_of
from tests.report.handover.made import EFFECTS, torque_robot
from tests.simulate.rotation_small import small_rotation
from tests.small_robot import FRICTION

LEVEL = FRICTION[0]  # [Nm]
COLDER = 0.88  # of the friction, as on a stranger's SCARA
JOINT = Place("joint", 0, "hinge_a")
NAME = "motor-side Coulomb friction of hinge_a"
LATER_GAIN = 1e-3  # share of an offset: the gain that is found later multiplies it as well, and that is no more
STATED_FRICTION = 0.2  # what a robot from a drawing says of it


@dataclass(frozen=True, eq=False)
class Day:
    """A fit, and the robot that it hands over, with its posterior."""

    linear: LinearisedModel
    fit: Fit
    robot: CompiledRobot
    posterior: Posterior

    @property
    def rows(self) -> dict[str, FittedFigure]:
        """Its table, by name."""
        return {row.name: row for row in fitted_figures(self.linear, self.fit)}


@pytest.fixture(scope="module")
def nominal(tmp_path_factory: pytest.TempPathFactory) -> CompiledRobot:
    """Return a robot whose file has no friction in one joint, and that to a fifth."""
    folder = torque_robot(tmp_path_factory.mktemp("changed") / "small")
    file = folder / "small.xml"
    none = '<config key="coulomb" value="0"/>'
    held = '<config key="coulomb" value="300"/>'  # of the joint that stands: its link is never pushed over it
    text = file.read_text().replace(f'<config key="coulomb" value="{LEVEL}"/>', none)
    file.write_text(text.replace(f'<config key="coulomb" value="{FRICTION[1]}"/>', held))
    small = load_robot(folder)
    known = small.figures.uncertainty.model_copy(update={"friction": STATED_FRICTION})
    return compile_robot(replace(small, figures=small.figures.model_copy(update={"uncertainty": known})))


def recorded(nominal: CompiledRobot, seed: int, level: float) -> Campaign:
    acting = [Acting(EFFECTS["coulomb_friction"], JOINT, {"level": level})]
    rng = np.random.default_rng(seed)
    return hide_campaign(nominal.robot, small_rotation(nominal.robot.folder), acting, rng, background=False).campaign


def fitted(linear: LinearisedModel, causes: tuple[Cause, ...], folder: Path) -> Day:
    fit = refit(linear, causes, {})
    hand_over(linear, fit, folder / "robot", folder / "nominal.xml")
    write_posterior(folder / "robot", posterior_of(linear, fit))
    return Day(linear, fit, compile_robot(load_robot(folder / "robot")), read_posterior(folder / "robot"))


@pytest.fixture(scope="module")
def first(nominal: CompiledRobot, tmp_path_factory: pytest.TempPathFactory) -> Day:
    effect = EFFECTS["coulomb_friction"]
    cause = Cause(effect, JOINT, effect.parameters_at(nominal, JOINT), ())
    return fitted(linear_of(recorded(nominal, 1, LEVEL), nominal), (cause,), tmp_path_factory.mktemp("first"))


@pytest.fixture(scope="module")
def second(nominal: CompiledRobot, first: Day, tmp_path_factory: pytest.TempPathFactory) -> Day:
    linear = linear_of(recorded(nominal, 2, COLDER * LEVEL), first.robot, first.posterior)
    return fitted(linear, (), tmp_path_factory.mktemp("second"))


def test_friction_of_another_day_is_said(nominal: CompiledRobot, first: Day) -> None:
    """It moved by 12 %, within the fifth that is stated of friction: nothing named it, and it was called unseen."""
    sought = {name: EFFECTS[name] for name in ("coulomb_level", "gas_loss")}
    given = first.posterior
    colder = diagnose(recorded(nominal, 2, COLDER * LEVEL), first.robot, sought, most_bins=BINS, given=given).verdict
    assert headline(colder).endswith("Changed since the earlier diagnosis: motor-side Coulomb friction (hinge_a).")
    (found,) = colder.changed
    assert found.low < COLDER - 1 < found.high < 0
    (line,) = changed_lines(colder)
    assert line.startswith("motor-side Coulomb friction: hinge_a -1")
    assert float(line.split()[4]) == pytest.approx(100 * found.found, rel=1e-3)
    assert line.endswith(f"; {abs(found.found) / (np.sqrt(2) * COULOMB * DAY_K):.1f} times what was to be expected)")
    assert [spot.places for spot in colder.blind if spot.effect == "coulomb_level"] == [("joint 2",)]  # which stands
    same = diagnose(recorded(nominal, 3, LEVEL), first.robot, sought, most_bins=BINS, given=given).verdict
    assert same.changed == ()
    assert "Changed" not in headline(same)


def test_friction_that_was_found_is_as_uncertain_as_days_differ(first: Day) -> None:
    """A fifth was stated of what the file has, which is nothing."""
    quantities = first.linear.quantities
    stated = {one.name: one.sigma for one in nuisances_of(first.robot, quantities)}
    left = given_by(first.posterior, nuisances_of(first.robot, quantities), first.robot)
    given = {one.name: one for one in left.nuisances}
    assert stated[NAME] == STATED_FRICTION
    assert given[NAME].sigma == pytest.approx(np.sqrt(2) * COULOMB * DAY_K)
    assert given[NAME.replace("_a", "_b")].sigma == STATED_FRICTION


def test_a_column_means_one_thing_in_every_row(nominal: CompiledRobot, first: Day, second: Day) -> None:
    """Differences from the earlier model stood beside values, such as offsets of currents beside torque constants."""
    before, after = first.rows, second.rows
    table = {row["name"]: row for row in csv.DictReader(csv_of(after.values()).splitlines())}
    shared = [name for name in before if name in after and not name.startswith("Coulomb friction")]
    assert len(shared) > 20
    for name in shared:
        row = table[name]
        assert row["unit"] == (before[name].unit or SHARE)
        assert float(row["stated"]) == pytest.approx(before[name].stated, abs=1e-12)
        if before[name].kind == "figure":
            assert float(row["earlier"]) == pytest.approx(before[name].found, rel=1e-9, abs=1e-12)
        assert float(row["low"]) <= float(row["found"]) <= float(row["high"])
        if after[name].unit and after[name].stated == 0:
            off = float(row["found"]) - float(row["earlier"] or 0.0)
            assert off == pytest.approx(float(row["sigmas"]) * float(row["sigma"]), abs=1e-12)
    level = "Coulomb friction that the model leaves out (joint 1): level"
    assert float(table[f"{level}, as found before"]["earlier"]) == pytest.approx(before[level].found)
    assert float(table[f"{level}, as found before"]["found"]) == pytest.approx(LEVEL, rel=0.02)
    # found is what the robot has that is handed over, whatever was there before
    readings = second.robot.robot.figures.fitted.readings
    for drive in second.robot.robot.figures.drives:
        offset = float(table[f"torque offset of {drive.joint}"]["found"])
        assert readings.torque_offset_nm.get(drive.joint, 0.0) == pytest.approx(offset, rel=LATER_GAIN, abs=1e-9)
        constant = float(table[f"torque constant of {drive.joint}"]["found"])
        assert readings.torque_gain.get(drive.joint, 0.0) == pytest.approx(1 / (1 + constant) - 1, rel=1e-6, abs=1e-9)
    mass = float(table["mass of fore"]["found"])
    masses = [one.model.body("fore").mass[0] for one in (second.robot, nominal)]
    assert masses[0] / masses[1] - 1 == pytest.approx(mass, rel=1e-6, abs=1e-9)
    place = float(table["centre of mass of fore, x"]["found"])
    centres = [one.model.body("fore").ipos[0] for one in (second.robot, nominal)]
    assert centres[0] - centres[1] == pytest.approx(place, rel=1e-6, abs=1e-9)


def test_without_an_earlier_diagnosis_there_is_nothing_to_compare(first: Day) -> None:
    assert all(np.isnan(row.earlier) and not row.has_changed for row in first.rows.values())


def test_what_was_found_before_counts_once_in_several_recordings(first: Day) -> None:
    """What drifts has a part in each recording beside the one that lasts, from which each part is a difference."""
    nuisances = given_by(first.posterior, nuisances_of(first.robot, first.linear.quantities), first.robot).nuisances
    found = [one for one in with_recordings(nuisances, first.robot, ("may", "june")) if one.earlier]
    drifting = {one.name for one in nuisances if one.own > 0 and one.lasting > 0}
    assert any(one.name in drifting and one.recording is None for one in found)
    assert not any(one.name in drifting and one.recording for one in found)
    assert {one.name for one in found if one.recording} <= {one.name for one in nuisances if one.lasting == 0}
