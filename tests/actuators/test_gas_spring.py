"""The gas law in its limits: Eq. (8), energy, isothermal and adiabatic gas, seals, end of the stroke, the picture."""

from pathlib import Path

import mujoco
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from bench.actuators.laws import SMALLEST_GAP, GasSpring
from bench.actuators.state import TEMPERATURE_RISE, state_of
from tests.actuators.slider import TIMESTEP, Array, follow, slider

C, L_C = 4771.4, 0.9112  # [Nm], [m], Eq. (47)
PAPER = GasSpring(constant=C, critical_length=L_C)
EXACT = 1e-9  # relative, closed forms
STROKE = np.linspace(0.52, 0.75, 300)
THERE_AND_BACK = np.concatenate([STROKE, STROKE[::-1]])


def work(force: Array, length: Array) -> float:
    """Return the work of a force along a path, by trapezoids."""
    return float(np.sum((force[1:] + force[:-1]) / 2 * np.diff(length)))


def test_pulls_by_eq_8():
    np.testing.assert_allclose(follow(slider(PAPER), STROKE)[:, 0], -C / (L_C - STROKE), rtol=EXACT)


def test_polytropic_force_is_eq_8_at_the_reference_length():
    law = GasSpring(constant=C, critical_length=L_C, exponent=1.4, reference_length=0.6, gas_amount=0.9)
    force = follow(slider(law), [0.6, 0.7])[:, 0]
    at_reference = -0.9 * C / (L_C - 0.6)
    np.testing.assert_allclose(force, [at_reference, at_reference * ((L_C - 0.6) / (L_C - 0.7)) ** 1.4], rtol=EXACT)


def test_isothermal_gas_gives_back_all_work():
    force = follow(slider(PAPER), THERE_AND_BACK)[:, 0]
    assert work(force, THERE_AND_BACK) == pytest.approx(0, abs=1e-12 * C)
    closed_form = C * np.log((L_C - STROKE[-1]) / (L_C - STROKE[0]))
    assert work(force[: STROKE.size], STROKE) == pytest.approx(closed_form, rel=1e-5)  # 300 trapezoids


def test_isothermal_gas_conserves_energy_in_motion():
    """Kinetic energy and -C ln(l_c - l): the drift of the integrator is bounded and falls with the time step."""
    swings = []
    for timestep in (1e-4, 5e-5):
        model = slider(GasSpring(constant=20, critical_length=L_C))
        model.opt.timestep = timestep
        data = mujoco.MjData(model)
        data.qpos[0] = 0.5
        data.qvel[0] = 0.9
        energies = []
        for _ in range(int(0.5 / timestep)):
            energies.append(5 * data.qvel[0] ** 2 - 20 * np.log(L_C - data.qpos[0]))
            mujoco.mj_step(model, data)
        assert data.qpos[0] < 0.5, "the gas turned it round"
        swings.append(np.ptp(energies) / (5 * 0.9**2))
    assert swings[0] < 2e-3
    assert swings[1] == pytest.approx(swings[0] / 2, rel=0.05)


def thermal(tau: float) -> GasSpring:
    return GasSpring(constant=C, critical_length=L_C, heat_capacity_ratio=1.4, relaxation_time=tau)


def test_fast_relaxation_is_isothermal():
    np.testing.assert_allclose(
        follow(slider(thermal(1e-13)), THERE_AND_BACK), follow(slider(PAPER), THERE_AND_BACK), rtol=EXACT
    )


def test_slow_relaxation_is_adiabatic():
    isothermal = -C / (L_C - THERE_AND_BACK)
    adiabatic = isothermal * ((L_C - STROKE[0]) / (L_C - THERE_AND_BACK)) ** 0.4
    np.testing.assert_allclose(follow(slider(thermal(1e13)), THERE_AND_BACK)[:, 0], adiabatic, rtol=EXACT)


def test_relaxation_between_the_limits_is_the_solution_of_the_first_law():
    """Exact for a volume that shrinks at a constant relative rate, however long the step."""
    tau, rate = 0.02, 5.0  # [s], [1/s]
    time = np.arange(40) * TIMESTEP
    volume = 0.4 * np.exp(-rate * time)
    with np.errstate(under="ignore"):  # scipy probes the smallest step
        exact = solve_ivp(
            lambda t, y: 0.4 * rate * y - (y - 1) / tau, (0, time[-1]), [1.0], t_eval=time, rtol=1e-12, atol=1e-12
        ).y[0]
    np.testing.assert_allclose(follow(slider(thermal(tau)), L_C - volume)[:, 0], -C / volume * exact, rtol=EXACT)


def test_warm_gas_cools_at_rest():
    model = slider(thermal(0.5))
    data = mujoco.MjData(model)
    data.qpos[0] = 0.6
    state_of(model, data, 0)[TEMPERATURE_RISE] = 0.1
    for _ in range(100):
        data.qpos[0], data.qvel[0] = 0.6, 0
        mujoco.mj_step(model, data)
    assert state_of(model, data, 0)[TEMPERATURE_RISE] == pytest.approx(0.1 * np.exp(-99 * TIMESTEP / 0.5), rel=EXACT)


@pytest.mark.parametrize(
    "law",
    [thermal(0.1), GasSpring(constant=C, critical_length=L_C, seal_friction=0.05, seal_presliding=1e6)],
    ids=["relaxation", "seals"],
)
def test_losses_take_energy(law: GasSpring):
    assert work(follow(slider(law), THERE_AND_BACK)[:, 0], THERE_AND_BACK) < -1


def test_seals_are_a_part_of_the_gas_force_against_the_motion():
    law = GasSpring(constant=C, critical_length=L_C, seal_friction=0.05, seal_presliding=1e8)
    force = follow(slider(law), THERE_AND_BACK)[:, 0]
    gas = C / (L_C - THERE_AND_BACK)
    out, back = slice(1, STROKE.size), slice(STROKE.size + 1, None)
    np.testing.assert_allclose(force[out], -1.05 * gas[out], rtol=EXACT)
    np.testing.assert_allclose(force[back], -0.95 * gas[back], rtol=EXACT)


def test_end_of_the_stroke_warns_once_and_stays_finite(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)  # MuJoCo writes its warnings to MUJOCO_LOG.TXT
    force = follow(slider(PAPER), [L_C - 1e-6, L_C, L_C + 1])[:, 0]
    np.testing.assert_allclose(force, -C / (SMALLEST_GAP * L_C), rtol=EXACT)
    log = (tmp_path / "MUJOCO_LOG.TXT").read_text()
    assert log.count("reaches critical_length 0.9112 m; the gap is held at 0.0009112 m") == 1


def test_viewer_shows_housing_and_rod_between_the_end_sites():
    model = slider(PAPER)
    data = mujoco.MjData(model)
    data.qpos[0] = 0.7
    mujoco.mj_forward(model, data)
    option = mujoco.MjvOption()

    def cylinders() -> list[mujoco.MjvGeom]:
        scene = mujoco.MjvScene(model, maxgeom=50)
        mujoco.mjv_updateScene(model, data, option, None, mujoco.MjvCamera(), mujoco.mjtCatBit.mjCAT_ALL, scene)
        return [geom for geom in scene.geoms[: scene.ngeom] if geom.type == mujoco.mjtGeom.mjGEOM_CYLINDER]

    housing, rod = cylinders()
    assert housing.size[0] > rod.size[0]
    np.testing.assert_allclose(rod.pos, [0.35, 0, 0], atol=1e-6)
    assert rod.size[2] == pytest.approx(0.35)
    option.tendongroup[:] = 0
    assert cylinders() == []
