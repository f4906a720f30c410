"""Loads, masses and the force sensor against each other."""

import numpy as np
import pytest

from bench.record.campaign import Array
from bench.record.finding import Finding
from tests.record.build import examine, loading, motion, static, sweep


def test_healthy_tables_say_nothing() -> None:
    assert not examine(static(loading()))
    columns = sweep() | {"load_mass_kg": np.full(2500, 20.0), "load_z_n": np.full(2500, -20 * 9.81)}
    assert not [finding for finding in examine(motion(columns)) if finding.column.startswith("load")]


@pytest.mark.parametrize(
    ("mass", "load", "is_told"), [(40, 20, True), (20, 20, False), (20, 40, False), (0.5, 0, False)]
)
def test_a_mass_weighs_no_more_than_what_hangs(mass: float, load: float, is_told: bool) -> None:
    columns = sweep() | {"load_mass_kg": np.full(2500, mass), "load_z_n": np.full(2500, -load * 9.81)}
    found = [finding for finding in examine(motion(columns)) if finding.column == "load_mass_kg"]
    assert bool(found) == is_told
    if is_told:
        assert found[0].level == "doubt"
        assert "40 kg weigh 392.3 N, but load_z_n is -196.2 N" in found[0].message
        assert found[0].row == 1


@pytest.mark.parametrize(("factor", "is_told"), [(0.7, True), (1.5, True), (1.02, False)])
def test_a_sensor_that_reads_another_load_is_a_warning(factor: float, is_told: bool) -> None:
    columns: dict[str, Array] = loading()
    columns["force_z_n"] = factor * columns["force_z_n"]
    found = [finding for finding in examine(static(columns)) if finding.column == "force_z_n"]
    assert bool(found) == is_told
    if is_told:
        assert found[0].level == "warning"
        assert f"is {factor:.3g} times load_z_n" in found[0].message


def test_a_sensor_that_is_a_little_askew_is_none() -> None:
    """A slanting load read by a sensor that is turned by 15 mrad: 12 % off in its smaller part, not in its size."""
    columns: dict[str, Array] = loading()
    size = -columns["load_z_n"]
    columns |= {"load_x_n": 0.14 * size, "force_x_n": 0.123 * size + columns["force_x_n"]}
    assert not examine(static(columns))


def found_in(columns: dict[str, Array]) -> list[Finding]:
    return [finding for finding in examine(static(columns)) if finding.column == "force_z_n"]


def test_loads_that_are_exchanged_between_steps_are_told() -> None:
    columns = loading()
    step = columns["load_step"]
    columns["load_z_n"] = np.select([step == 1, step == 2, step == 3], [-900.0, -300.0, -600.0], columns["load_z_n"])
    (finding,) = found_in(columns)
    assert finding.level == "warning"
    assert "contradicts the loads by up to 6" in finding.message
    columns = loading()
    columns["load_z_n"][[3, 4, 5]] = -600.0  # one state of 28 alone
    (finding,) = found_in(columns)
    assert "rows 4 to 6" in finding.message


def test_a_force_without_any_column_of_loads_is_told() -> None:
    columns = {name: values for name, values in loading().items() if not name.startswith("load_") or "step" in name}
    (finding,) = found_in(columns)
    assert "while no load is stated to change" in finding.message


@pytest.mark.parametrize(
    ("masses", "factor", "is_told"), [((10, 20), 2.0, True), ((10, 10), 2.0, False), ((10, 20), 1.001, False)]
)
def test_loads_that_are_twice_the_weight_of_every_mass_are_doubted(
    masses: tuple[float, float], factor: float, is_told: bool
) -> None:
    """Beside one mass something else may pull."""
    mass = np.repeat(np.array(masses, dtype=np.float64), 1250)
    columns = sweep() | {"load_mass_kg": mass, "load_z_n": -factor * 9.81 * mass}
    found = [finding for finding in examine(motion(columns)) if finding.column == "load_z_n"]
    assert [finding.level for finding in found] == ["doubt"] * is_told


@pytest.mark.parametrize(("zero", "is_told"), [(-200.0, True), (60.0, True), (-20.0, False)])
def test_a_force_that_is_there_before_any_load_is_told(zero: float, is_told: bool) -> None:
    """A diagnosis found nothing, said that the channel scatters 672 times too much, and moved gain and tilt."""
    columns = loading()
    columns["force_z_n"] = columns["force_z_n"] + zero
    found = found_in(columns)
    assert bool(found) == is_told
    if is_told:
        assert found[0].level == "warning"
        assert "N while no load is stated" in found[0].message
        assert found[0].row == 1


@pytest.mark.parametrize(("lever", "is_told"), [(0.2, True), (0.01, False)])
@pytest.mark.parametrize("is_stated", [False, True])
def test_moments_about_another_point_are_told_unless_the_load_has_them(
    lever: float, is_told: bool, is_stated: bool
) -> None:
    columns = loading()
    zeros = np.zeros_like(columns["load_z_n"])
    moment = -lever * columns["load_z_n"]
    columns |= dict.fromkeys(("force_x_n", "force_y_n", "moment_x_nm", "moment_z_nm"), zeros)
    columns["moment_y_nm"] = moment + 1e-3 * np.random.default_rng(1).standard_normal(len(zeros))
    if is_stated:
        columns["load_my_nm"] = moment
    found = [finding for finding in examine(static(columns)) if finding.column.startswith("moment")]
    assert bool(found) == (is_told and not is_stated)
    if found:
        assert found[0].level == "warning"
        assert f"pulled {lever:.2g} m beside the point" in found[0].message
