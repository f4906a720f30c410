"""models/emps holds the published figures of the EMPS, and its nominal model leaves out what is to be found."""

import numpy as np

from bench.identify.rigid_motion_fit import Filtering, axis_columns, fit_motion, smooth_motion
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.robot.links import rigid_bodies
from bench.robot.logs import log_format_of
from bench.simulate.plant import Plant

MASS, VISCOUS = 95.109, 203.50  # [kg], [N s/m], published
GAIN, KP, KV = 35.15065188248547, 160.18, 243.45  # [N/V], [1/s], [V s/m], published
PERIOD = 1e-3  # [s], sampling of the recordings
FINE = 5e-5  # [s]
INTEGRATION = 0.01  # implicitfast adds about step * (kv + damping) to the inertia that the reported force shows, 0.6 %


def test_published_figures() -> None:
    robot = load_robot("emps")
    compiled = compile_robot(robot)
    model, at = compiled.model, compiled.at
    screw = model.dof_armature[at.q_dof] + model.body_mass[model.dof_bodyid[at.q_dof]]
    np.testing.assert_allclose(rigid_bodies(compiled).mass + screw, MASS)
    np.testing.assert_allclose(np.ravel(model.dof_damping[at.q_dof])[0], VISCOUS)
    np.testing.assert_allclose(-model.actuator_biasprm[at.servo[0], 1:3], [GAIN * KV * KP, GAIN * KV], rtol=1e-6)
    np.testing.assert_allclose(model.actuator_forcerange[at.servo[0]], [-10 * GAIN, 10 * GAIN], rtol=1e-4)
    assert log_format_of(robot).columns["tau_motor_1_n"].factor == GAIN


def test_nominal_model_has_no_static_friction() -> None:
    compiled = compile_robot(load_robot("emps"))
    assert compiled.motor_coulomb[0] == compiled.link_coulomb[0] == 0


def test_simulated_sweep_is_fitted_with_the_figures_of_the_model() -> None:
    """The regression that the data set was published with finds mass and viscous friction of the simulated axis."""
    plant = Plant(load_robot("emps"), timestep=FINE)
    time = PERIOD * np.arange(1, 4001)
    commands = 0.1 * (1 - np.cos(3 * time))[:, None]
    trace = plant.advance(commands, np.zeros((len(time), 6)), PERIOD)
    settled = slice(500, -200)  # the command starts with a step of its acceleration
    filtering = Filtering()
    position, force = (
        trace.q.reshape(len(time), -1).mean(axis=1),
        trace.motor_torque.reshape(len(time), -1).mean(axis=1),
    )
    motion = smooth_motion(time, position[:, None], filtering)
    columns = {name: values[settled] for name, values in axis_columns(motion, 0).items()}
    fit = fit_motion(columns, force[settled], filtering)
    np.testing.assert_allclose([fit["inertia"], fit["viscous"]], [MASS, VISCOUS], rtol=INTEGRATION)
    np.testing.assert_allclose([fit["coulomb"], fit["offset"]], 0, atol=0.05)
