"""What a small extra torque on a link or on a motor does to every quantity, instant by instant, in closed form.

With the motors' motion prescribed, a torque f on link j lets the link give by f / k_j, unloads the motor by f, and
moves the reflectors by their Jacobian. A torque on the motor is paid by the motor alone. Rigid elsewhere: good to some
parts in a thousand, which is enough for scatter and for shapes; effects themselves are simulated.
"""

from dataclasses import dataclass

import mujoco
import numpy as np

from bench.diagnose.replay.play import link_load, transmitted
from bench.diagnose.replay.quantities import Quantity
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot
from bench.robot.mass_matrix import mass_matrix
from bench.simulate.trace import Trace


@dataclass(frozen=True)
class TorqueResponse:
    """Change of every quantity with a unit torque; T instants, c quantities, n drives.

    Attributes:
        link: Shape (T, c, n), per Nm (or N) on the link.
        motor: Shape (T, c, n), per Nm (or N) on the motor.
        link_inertia: Shape (T, n), of everything that each joint carries, about it [kg m^2] or [kg].
        rotor_inertia: Shape (n,), on the joint side.
        transmitted: Shape (T, n) [Nm] or [N], torque of the elastic elements on the motors.
        link_load: Shape (T, n) [Nm] or [N], what drives and friction together hold.
    """

    link: Array
    motor: Array
    link_inertia: Array
    rotor_inertia: Array
    transmitted: Array
    link_load: Array


def torque_response(compiled: CompiledRobot, trace: Trace, quantities: tuple[Quantity, ...]) -> TorqueResponse:
    """Return the response along a trace of the nominal robot."""
    model, at, n = compiled.model, compiled.at, compiled.n_joints
    link = np.zeros((len(trace), len(quantities), n))
    motor = np.zeros_like(link)
    compliance = 1 / compiled.stiffness
    reflectors = sorted({quantity.index for quantity in quantities if quantity.kind == "reflector"})
    jacobians = {k: np.empty((len(trace), 3, n)) for k in reflectors}
    data = mujoco.MjData(model)
    jacobian, inertia = np.empty((3, model.nv)), np.empty((len(trace), n))
    for i in range(len(trace)):
        data.qpos[at.theta] = trace.theta[i]
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_makeM(model, data)
        inertia[i] = mass_matrix(model, data)[at.theta_dof, at.theta_dof]
        for k in reflectors:
            mujoco.mj_jacSite(model, data, jacobian, None, int(at.reflectors[k]))
            jacobians[k][i] = jacobian[:, at.theta_dof]
    for c, quantity in enumerate(quantities):
        j = quantity.index
        if quantity.is_drive:
            paid = -1.0 if quantity.kind == "tau_motor" else -1.0 / compiled.torque_constant[j]
            link[:, c, j] = motor[:, c, j] = paid
        elif quantity.kind == "reflector":
            link[:, c] = jacobians[j][:, quantity.axis] * compliance
        elif quantity.kind == "q_link":
            link[:, c, j] = compliance[j]
    rotor_inertia = model.dof_armature[at.q_dof].copy()
    return TorqueResponse(link, motor, inertia, rotor_inertia, transmitted(compiled, trace), link_load(compiled, trace))
