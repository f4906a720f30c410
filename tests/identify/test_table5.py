"""Table 5 against the paper's Table 6 and the published reconstructions; what is concluded from it."""

import json
from pathlib import Path

import numpy as np
import pytest

from bench.errors import InputError
from bench.identify.current import identify_current
from bench.identify.force import identify_force
from bench.identify.options import PLAIN
from bench.identify.table5 import read_reconstructions, read_table5, read_table6
from bench.identify.table5_conclusions import conclusions
from bench.identify.table5_lines import fit_lines
from bench.identify.table5_study import FITS, study_table5

PAPER = Path(__file__).parents[2] / "models/hh150/paper"
CONFIGURATIONS = json.loads((PAPER / "configurations.json").read_text())
NAMED = ("A1", "A3", "B1")
ROUNDING = 2e-3  # of the angles and stiffnesses in configurations.json, which are rounded to 1e-4
TABLE_6 = 5e-3  # B1 was forced to reproduce Table 6 and does so within 0.3 %
METHODS = {"current": identify_current, "force": identify_force}


@pytest.fixture(scope="module")
def study():
    return study_table5(PAPER, NAMED)


def test_the_table_is_read_as_printed():
    table = read_table5(PAPER)
    assert len(table.configuration) == 24
    assert table.is_reference.sum() == 6
    np.testing.assert_array_equal(np.unique(table.configuration[~table.hangs]), [5, 6])
    np.testing.assert_allclose(table.force[4], [0, 0, 1078])
    np.testing.assert_allclose(table.current[4], [-0.13, 10.28, 11.79, -3.96, -0.50, 0.90])
    np.testing.assert_allclose(table.deflection[4], np.array([1.3219, -0.3607, -2.6608]) * 1e-3)


def test_readings_carry_the_signs_that_were_found():
    table = read_table5(PAPER)
    readings = read_reconstructions(PAPER)[0].readings(table)
    np.testing.assert_allclose(readings.wrench[4], [0, 0, -1078, 0, 0, 0])
    np.testing.assert_allclose(readings.wrench[-1], [-374, -985, -580, 0, 0, 0])
    change = readings.current_torque[1] - readings.current_torque[0]
    assert change[1] < 0, "the load pushes joint 2 up, the motor holds against it"


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", NAMED)
def test_plain_least_squares_is_that_of_the_reconstruction(name, method):
    table, reconstruction = read_table5(PAPER), {r.name: r for r in read_reconstructions(PAPER)}[name]
    found = METHODS[method](reconstruction.arm(table.experiment), None, reconstruction.readings(table), PLAIN)
    np.testing.assert_allclose(found.stiffness / 1e6, CONFIGURATIONS[name][f"k_LS_{method}_1e6"], rtol=ROUNDING)


@pytest.mark.parametrize("method", METHODS)
def test_b1_reproduces_table_6(study, method):
    found = study.estimates[f"{method}, plain"][NAMED.index("B1")].stiffness
    np.testing.assert_allclose(found, read_table6(PAPER)[method], rtol=TABLE_6)


def test_lines_are_fitted_to_loaded_states_only():
    lines = fit_lines(read_table5(PAPER))
    np.testing.assert_array_equal(lines.configuration, [1, 2, 3, 4])
    table = read_table5(PAPER)
    rows = slice(16, 20)  # configuration 4, loaded
    line = np.polyfit(table.force[rows, 2], table.deflection[rows, 2], 1)
    assert lines.deflection_gap[3, 2] == pytest.approx(line[1])


def test_every_fit_is_there_and_residuals_are_in_sigmas(study):
    assert set(study.estimates) == set(FITS)
    assert study.stiffness("joint").shape == (3, 6)
    assert np.all(study.residual_rms("joint") < 1.5), "the joint method has room for the friction that is there"
    assert np.all(study.residual_rms("force") > 2), "the force method has not"


def test_a_joint_that_no_reconstruction_tells_has_no_spread(study):
    """Only configurations 5 and 6 load joint 1, with one load each: from the first load on nothing is left of it."""
    spread = {fit: study.spread(fit) for fit in FITS}
    assert np.all(np.isfinite(spread["joint"]))
    first = next(fit for fit in FITS if "force" in fit and "first load" in fit)
    np.testing.assert_array_equal(np.isnan(spread[first]).all(axis=0), np.isnan(study.stiffness(first)).all(axis=0))
    assert np.isnan(spread[first][:, 0]).all()


def test_conclusions_name_numbers_and_limits(study):
    text = "\n".join(conclusions(study))
    for word in ("Without any pose", "times its noise", "standard errors", "does not decide between the methods"):
        assert word in text
    assert "nan" not in text


def test_missing_files_are_named(tmp_path):
    with pytest.raises(InputError, match=r"table5\.csv: no such file"):
        read_table5(tmp_path)
    (tmp_path / "table5.csv").write_text("configuration,fx_N\n1,0\n")
    with pytest.raises(InputError, match=r"experiment\.yaml: cannot be read: No such file"):
        read_table5(tmp_path)
    (tmp_path / "experiment.yaml").write_text((PAPER / "experiment.yaml").read_text())
    with pytest.raises(InputError, match="columns are missing: fy_N, fz_N, i1_A"):
        read_table5(tmp_path)


@pytest.mark.study
def test_over_all_reconstructions_only_joints_1_and_2_are_told():
    """119 alternatives beside A1, A3 and B1; these findings stand in the report."""
    study = study_table5(PAPER)
    assert len(study.reconstructions) == 122
    low, middle, high = study.spread("force, plain")
    np.testing.assert_array_equal((high - low) / middle < 0.5, [True, True, False, False, False, False])
    text = "\n".join(conclusions(study))
    assert "told whatever the poses: k1, k2." in text
    assert "this part of the friction is on the motor side" in text
