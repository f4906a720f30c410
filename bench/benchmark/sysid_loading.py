"""The loading experiment for mujoco.sysid: each visit to a pose is one rollout, in which load follows load.

The rotors stand where their encoders saw them, friction is not in the model, and the elastic elements are damped until
the arm rests well before it is read. One stiffness for each joint is fitted to what the tracker read of the reflectors.
"""

from collections.abc import Callable
from contextlib import redirect_stdout
from dataclasses import dataclass
from importlib import import_module
from io import StringIO
from typing import Any, Literal

import mujoco
import numpy as np

from bench.identify.readings import StaticReadings
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot
from bench.simulate.bare import bare_spec

STEP_S = 2e-3  # [s]
HOLD_S = 0.6  # [s], for each load; after it, 1e-4 of a change of load is left to come
DAMPING_S = 0.03  # [s], damping over stiffness of the elements
HEAVY = 1e9  # [kg m^2]; a rotor that stands still
START, BOUNDS = 0.5, (0.05, 20.0)  # times the nominal stiffness

Residual = Literal["weighted", "default"]


@dataclass(frozen=True, eq=False)
class SysidFit:
    """What mujoco.sysid finds.

    Attributes:
        stiffness: Shape (n,) [Nm/rad].
        interval: Shape (2, n), lower and upper ends.
    """

    stiffness: Array
    interval: Array


def fit_with_sysid(compiled: CompiledRobot, readings: StaticReadings, residual: Residual, level: float) -> SysidFit:
    """Fit the stiffness of every joint.

    Args:
        compiled: The robot; its stiffness serves as scale and, halved, as start.
        readings: States at rest; every series has equally many.
        residual: "weighted": deflections from the unloaded state by the standard deviation of a mean reading.
            "default": what mujoco.sysid does by itself, positions over the norm of each channel.
        level: Of the intervals.
    """
    sysid = import_module("mujoco.sysid")  # an extra; untyped like the rest of the package
    spec = loading_spec(compiled)
    sequences = _sequences(sysid, spec, readings, compiled)
    names = [drive.element for drive in compiled.robot.figures.drives]
    params = sysid.ParameterDict()
    for name, nominal in zip(names, compiled.stiffness, strict=True):
        params.add(sysid.Parameter(name, START, *BOUNDS, modifier=_stiffness_of(name, float(nominal))))
    mean_sigma = readings.sigma_reflector / np.sqrt(readings.n_repeats.mean())
    options = {"modify_residual": _deflections(mean_sigma)} if residual == "weighted" else {}
    residual_fn = sysid.build_residual_fn(models_sequences=[sequences], n_threads=1, **options)
    with redirect_stdout(StringIO()):  # each iteration is printed
        found, result = sysid.optimize(params, residual_fn, verbose=False)
    left, _, _ = residual_fn(found.as_vector(), found)
    jacobian = np.asarray(result.jac)
    # calculate_intervals takes sigma from the residuals, as a fit of this toolbox is meant to be read
    _, half_width = sysid.calculate_intervals(left, jacobian, alpha=1 - level)
    scale, best = compiled.stiffness, found.as_vector()
    return SysidFit(scale * best, scale * np.stack([best - half_width, best + half_width]))


def loading_spec(compiled: CompiledRobot) -> mujoco.MjSpec:
    """Return the robot without servos and friction, with forces and moments on its load point as controls."""
    spec, figures = bare_spec(compiled.robot), compiled.robot.figures
    gas = figures.counterbalance.actuator if figures.counterbalance else None
    for actuator in [actuator for actuator in spec.actuators if actuator.name != gas]:
        spec.delete(actuator)
    for key in list(spec.keys):
        spec.delete(key)
    for drive, stiffness in zip(figures.drives, compiled.stiffness, strict=True):
        spec.joint(drive.rotor).armature = HEAVY
        element = spec.tendon(drive.element)
        element.damping = np.array([DAMPING_S * stiffness, 0.0, 0.0])
    spec.worldbody.add_site(name="base_axes")
    for axis in range(6):
        load = spec.add_actuator(name=f"load{axis}", target=figures.load_point, refsite="base_axes")
        load.trntype = mujoco.mjtTrn.mjTRN_SITE
        load.gear = np.eye(6)[axis]
    for name in figures.reflectors:
        spec.add_sensor(
            name=name, type=mujoco.mjtSensor.mjSENS_FRAMEPOS, objtype=mujoco.mjtObj.mjOBJ_SITE, objname=name
        )
    spec.option.timestep = STEP_S
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    return spec


def _sequences(sysid: Any, spec: mujoco.MjSpec, readings: StaticReadings, compiled: CompiledRobot) -> Any:
    model = spec.compile()
    controls_of = sysid.TimeSeries.compute_all_control_mapping(model)
    sensors_of = sysid.TimeSeries.compute_all_sensor_mapping(model)
    starts, controls, seen, names = [], [], [], []
    for series in np.unique(readings.series):
        rows = np.flatnonzero(readings.series == series)
        n = len(rows)
        qpos = np.zeros(model.nq)
        for drive, angle in zip(compiled.robot.figures.drives, readings.q_motor[rows].mean(axis=0), strict=True):
            qpos[model.joint(drive.joint).qposadr[0]] = qpos[model.joint(drive.rotor).qposadr[0]] = angle
        ctrl = np.zeros((2 * n, model.nu))
        first = model.actuator("load0").id
        ctrl[:, first : first + 6] = np.repeat(np.nan_to_num(readings.wrench[rows]), 2, axis=0)
        begins = HOLD_S * np.arange(n)
        times = np.stack([begins, begins + HOLD_S - STEP_S], axis=1).ravel()
        starts.append(sysid.create_initial_state(model, qpos))
        controls.append(sysid.TimeSeries(times, ctrl, controls_of))
        positions = readings.reflectors[rows].reshape(n, -1)
        seen.append(sysid.TimeSeries(begins + HOLD_S - 2 * STEP_S, positions, sensors_of))
        names.append(f"series {series}")
    return sysid.ModelSequences("loading", spec, names, starts, controls, seen)


def _stiffness_of(element: str, nominal: float) -> Callable[[mujoco.MjSpec, Any], None]:
    def change(spec: mujoco.MjSpec, parameter: Any) -> None:
        stiffness = np.array(spec.tendon(element).stiffness, dtype=np.float64)
        stiffness[0] = nominal * parameter.value[0]
        spec.tendon(element).stiffness = stiffness

    return change


def _deflections(sigma: float) -> Callable[..., Any]:
    def modify(
        params: Any, predicted: Any, measured: Any, model: mujoco.MjModel, return_pred_all: bool, **others: Any
    ) -> Any:
        at_rest = type(measured)(measured.times, predicted.resample(measured.times).data, measured.signal_mapping)
        # the first of a series is unloaded, and what is constant over a series cancels
        moved = [values.data[1:] - values.data[0] for values in (measured, at_rest)]
        return (moved[0] - moved[1]) / (np.sqrt(2) * sigma), at_rest, measured

    return modify
