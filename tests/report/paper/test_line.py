"""The line from scenario to report: exact in a perfect world, honest about what is left in a real one."""

import json
from pathlib import Path

import numpy as np
import pytest

from bench.errors import InputError
from bench.identify.estimate import StiffnessEstimate
from bench.identify.line_deflection import measured_deflection
from bench.identify.line_passes import AXES, WAYS
from bench.report.paper.line.figures import figure_15, figure_16, figure_17
from bench.report.paper.line.published import published_rows
from bench.report.paper.line.results import CURVES, NUMBERS, line_conclusions, write_line
from bench.report.paper.line.run import LineReport, run_line
from bench.robot.bodies import Array
from tests.simulate.line_small import small_line
from tests.small_robot import FRICTION, K

RINGING = 2e-6  # [m]; what a lead-in of two seconds leaves of the arm's vibration, and the servo's lag
IN_SUM = 1e-12  # [m]
SIGMA = 0.03  # relative, of the stiffness that the methods are given
TRUE = 1 / np.array(K)  # [rad/Nm]


def estimate(method: str, compliance: Array) -> StiffnessEstimate:
    covariance = np.diag((SIGMA * TRUE) ** 2)
    return StiffnessEstimate(
        method, ("hinge_a", "hinge_b"), compliance, covariance, np.inf, 1.0, np.ones(2, dtype=bool), {}, ()
    )


def ignore(share: float) -> None:
    """Show no progress."""


@pytest.fixture(scope="module")
def perfect(small_robot: Path, tmp_path_factory: pytest.TempPathFactory) -> LineReport:
    """No friction, no noise; one method is given the truth, the other compliances that are 10 % too small."""
    scenario = small_line(small_robot, friction="none", perfect_instruments=True)
    estimates = {"current": estimate("current", TRUE), "force": estimate("force", 0.9 * TRUE)}
    return run_line(tmp_path_factory.mktemp("perfect"), estimates, ignore, scenario)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("real")


@pytest.fixture(scope="module")
def real(small_robot: Path, folder: Path) -> LineReport:
    estimates = {"current": estimate("current", 1.1 * TRUE), "force": estimate("force", TRUE)}
    return run_line(folder, estimates, ignore, small_line(small_robot))


def test_without_friction_the_true_stiffness_predicts_the_deflection(perfect: LineReport) -> None:
    for way in WAYS:
        measured, _ = measured_deflection(perfect.model.passes, way)
        predicted = perfect.methods["current"].deflection[way].displacement
        np.testing.assert_allclose(predicted, measured, rtol=0, atol=RINGING)
        assert np.abs(measured).max() > 100 * RINGING


def test_a_compliance_too_small_predicts_as_much_too_little(perfect: LineReport) -> None:
    ratio = perfect.methods["force"].comparison["out"][AXES.index("z")].ratio
    assert ratio == pytest.approx(0.9, abs=0.01)


def test_without_friction_compensation_leaves_the_predicted_remainder(perfect: LineReport) -> None:
    """Nothing with the true stiffness; a tenth of the deformation with compliances a tenth too small."""
    for way in WAYS:
        np.testing.assert_allclose(
            perfect.methods["current"].after[way].true, perfect.before[way].parts["following"], atol=2e-5
        )
        left = perfect.methods["force"].after[way]
        elastic = left.true - left.parts["following"]
        np.testing.assert_allclose(elastic, 0.1 * perfect.before[way].parts["deformation"], atol=2e-5)
        np.testing.assert_allclose(left.parts["stiffness"], elastic, atol=2e-5)
    assert perfect.reduction("current", "z").true > 50
    assert perfect.reduction("force", "z").by_stiffness == pytest.approx(10, rel=0.02)


def test_the_parts_of_the_error_add_up(real: LineReport) -> None:
    for errors in (real.before, *(found.after for found in real.methods.values())):
        for way in WAYS:
            np.testing.assert_allclose(sum(errors[way].parts.values()), errors[way].error, rtol=0, atol=IN_SUM)


def test_friction_of_both_sides_is_found(real: LineReport) -> None:
    friction = real.friction
    z = (friction.level - 2 * np.array(FRICTION)) / friction.sigma  # the small robot has the level on either side
    assert np.all(np.abs(z) < 4)


def test_each_method_errs_by_the_friction_that_it_does_not_look_at(real: LineReport) -> None:
    """Half of it sits on either side here, so current and force err by as much, in opposite directions."""
    current, force = (real.methods[name].after["out"].parts["torque"] for name in ("current", "force"))
    along = np.sum(current * force) / (np.linalg.norm(current) * np.linalg.norm(force))
    assert along < -0.9
    share = real.methods["force"].link_share
    low, high = share.interval()
    assert low < 0.5 < high


def test_the_reduction_in_truth_is_what_the_error_of_the_estimate_allows(real: LineReport) -> None:
    for axis in ("x", "z"):
        reduction = real.reduction("current", axis)
        assert reduction.true == pytest.approx(reduction.by_estimate, rel=0.1)
        assert reduction.by_stiffness == pytest.approx(10, rel=0.1)  # a compliance that is a tenth too large


def test_files(real: LineReport, folder: Path) -> None:
    write_line(real, folder)
    numbers = json.loads((folder / NUMBERS).read_text())
    assert set(numbers["methods"]) == {"current", "force"}
    assert numbers["conclusions"] == line_conclusions(real)
    curves = np.genfromtxt(folder / CURVES, delimiter=",", names=True)
    assert len(curves) == len(real.place)
    np.testing.assert_allclose(curves["error_out_before_z_m"], real.before["out"].error[:, 2])
    for name in ("uncompensated", "compensated-current", "compensated-force"):
        assert (folder / name / "campaign" / "campaign.yaml").is_file()
        assert (folder / name / "session.rrd").is_file()
        assert (folder / name / "truth").is_dir()


def test_what_the_paper_says_stands_beside_ours(real: LineReport) -> None:
    rows = published_rows(real)
    assert len({row.quantity for row in rows}) == len(rows)
    for row in rows:
        assert row.difference == row.ours - row.paper
        assert row.holds is (None if row.relation == "equal" else (row.difference < 0) == (row.relation == "less"))


def test_figures_show_every_method_and_both_axes(real: LineReport) -> None:
    assert [panel.get_title(loc="left")[:2] for panel in figure_15(real).axes] == ["a)", "b)", "c)"]
    for figure in (figure_16(real), figure_17(real)):
        names = {text.get_text() for legend in figure.legends for text in legend.get_texts()}
        assert {"current method", "force method"} <= names
        assert [panel.get_title(loc="left")[0] for panel in figure.axes[:2]] == ["x", "z"]


def test_a_scenario_of_another_experiment_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="not a Line"):
        run_line(tmp_path, {}, ignore, "loading")
