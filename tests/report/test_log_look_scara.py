"""A SCARA whose quill moves a payload beside its axis: constants of its drives, and which way the quill counts."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.identify.drive_scale import drive_scale
from bench.record.look.families import Family
from bench.record.look.values import evenly
from bench.report.log_look.look import look
from bench.report.log_look.scaled import scaled
from bench.robot.nominal_dynamics import NominalDynamics
from tests import scara
from tests.report.proposals import proposed
from tests.stranger_started import erring, started

NINETY = 1.645  # exact: standard deviations to either side that hold 90 %
LOGS = 8  # four factors each
LEAST_HELD, LEAST_HELD_OF_LAST = 25, 5  # of 32 and of 8 intervals of 90 %: fewer come by chance once in 100 (binomial)
OFFSET = np.array([1.0, 0.5, 4.0, 0.1])  # [Nm], [N]: 0.03 A
STICKING = (7.0, 3.0, 60.0, 0.35)  # [Nm], [N]: friction that holds the quill and its load up


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> NominalDynamics:
    """Return the robot as `bench new-robot` starts it."""
    return replace(started(tmp_path_factory.mktemp("scara"), scara.mjcf()), torque_offset_sigma=OFFSET)


def test_constants_beside_a_payload_that_hangs_beside_the_axis(robot: NominalDynamics) -> None:
    """The last drive's came out 40 % off with +- 11 %: its load was looked for in the axis alone."""
    scores = []
    for seed in range(LOGS):
        rng = np.random.default_rng(200 + seed)
        load = scara.Load(rng.uniform(0.5, 2.0), tuple(0.04 * rng.normal(size=3)))
        log = scara.moved(rng, load)
        names = [f"{kind}{j}" for kind in "qy" for j in range(scara.N)]
        clock, slow = evenly(log.time, dict(zip(names, np.hstack([log.position, log.current]).T, strict=True)))
        values = np.stack([slow[name] for name in names], axis=1)[5:-5]
        scale = drive_scale(erring(robot, rng), clock[5:-5], values[:, : scara.N], values[:, scara.N :])
        scores.append(np.log(np.abs(scale.factor) / scara.CONSTANT) / scale.sigma)
    held = np.abs(scores) < NINETY
    assert np.sum(held) >= LEAST_HELD
    assert np.sum(held[:, -1]) >= LEAST_HELD_OF_LAST
    assert np.std(scores) > 0.4  # nor are they wide for nothing


def test_a_constant_that_an_unknown_load_hides_is_not_told(tmp_path: Path, robot: NominalDynamics) -> None:
    """Where no axis moves that carries it, the load's inertia and the constant of the last drive are one number."""
    log = scara.moved(np.random.default_rng(3), scara.BESIDE, moves=(0, 0, 1, 1))
    text = look(log.written(tmp_path / "x.csv"), nominal=robot).text
    (untold,) = re.findall(r"this log does not tell the torque constant of (.*)", text)
    assert "J4" in untold
    assert not re.search(r"J4 [\d.]+ \+- ", text)


@pytest.mark.parametrize("signs", [(1.0,) * scara.N, scara.UP])
@pytest.mark.parametrize("load", [None, scara.BESIDE])
def test_the_weight_of_a_quill_tells_which_way_it_counts(
    tmp_path: Path, robot: NominalDynamics, signs: tuple[float, ...], load: scara.Load | None
) -> None:
    """A quill that counts upwards was taken as it was: an offset of 20 N held it up."""
    log = scara.moved(np.random.default_rng(4), load)
    text = look(log.written(tmp_path / "x.csv", signs), nominal=robot).text
    form = proposed(tmp_path, text)
    assert form.columns["q_motor_3_m"].factor == form.columns["current_3_a"].factor == signs[2]
    assert ("positions of J3 count the other way round" in text) is (signs[2] < 0)
    assert not re.search(r"the direction of [J\d, ]*J3[J\d, ]* is not told", text)


@pytest.mark.parametrize("signs", [(1.0,) * scara.N, scara.UP])
def test_a_quill_that_friction_could_hold_is_said_not_to_be_told(
    tmp_path: Path, robot: NominalDynamics, signs: tuple[float, ...]
) -> None:
    log = scara.moved(np.random.default_rng(4), None, STICKING)
    text = look(log.written(tmp_path / "x.csv", signs), nominal=robot).text
    assert proposed(tmp_path, text).columns["q_motor_3_m"].factor == 1
    assert "the direction of J3 is not told by torques (but for its weight it needs the same" in text


def test_mirrored_axes_are_said_where_nothing_is_turned(tmp_path: Path, robot: NominalDynamics) -> None:
    """It was said only where another axis was turned."""
    log = scara.moved(np.random.default_rng(4), scara.BESIDE)
    text = look(log.written(tmp_path / "x.csv"), nominal=robot).text
    assert "count the other way round" not in text
    (told,) = re.findall(r"the direction of (.*) is not told by torques \(an arm and its mirror image", text)
    assert {"J1", "J2"} <= set(told.split(", "))


def test_degrees_and_millimetres_side_by_side(tmp_path: Path, robot: NominalDynamics) -> None:
    """Command and angle of the first two drives were taken for the angles of all four."""
    log = scara.moved(np.random.default_rng(4), scara.BESIDE)
    to_logged = np.array([180 / np.pi, 180 / np.pi, 1e3, 180 / np.pi])
    units, columns = ["Grad", "Grad", "mm", "Grad"], [log.time]
    for j, factor in enumerate(to_logged):
        columns += [factor * np.roll(log.position[:, j], -1), factor * log.position[:, j], log.current[:, j]]
    names = [f"{q}_J{j}_{u}" for j, unit in enumerate(units, 1) for q, u in (("Soll", unit), ("Ist", unit), ("I", "A"))]
    file = tmp_path / "x.csv"
    np.savetxt(
        file, np.column_stack(columns), delimiter=";", header=";".join(["Zeit", *names]), comments="", fmt="%.6f"
    )
    form = proposed(tmp_path, look(file, nominal=robot).text)
    ends = ["rad", "rad", "m", "rad"]
    for j, (unit, end) in enumerate(zip(units, ends, strict=True), 1):
        assert form.columns[f"q_cmd_{j}_{end}"].source == f"Soll_J{j}_{unit}"
        assert form.columns[f"q_motor_{j}_{end}"].source == f"Ist_J{j}_{unit}"
        assert form.columns[f"q_motor_{j}_{end}"].factor == pytest.approx(1 / to_logged[j - 1])


def test_a_current_whose_sign_is_not_told_is_not_turned(robot: NominalDynamics) -> None:
    """The last of a wrist whose motors are coupled was turned, by a factor of -0.3 +- 0.9."""
    log = scara.moved(np.random.default_rng(4), scara.BESIDE)
    scale = drive_scale(robot, log.time, log.position, log.current)
    unsure = replace(scale, factor=-scale.factor, sigma=np.array([0.1, 0.1, 0.1, 3.0]))
    lines = list(scaled(Family("current", False, ("i1", "i2", "i3", "i4"), "", ""), unsure, robot, []))
    assert [line.factor for line in lines] == [-1, -1, -1, 1]
    assert "does not tell its sign" in lines[-1].why
