"""Two sliders with a spring between them, actuators of this package on the first, and a way to prescribe their motion.

The tendon "rod" is as long as slider x is far from the origin, for x > 0; the spring "gear" has the length x - w.
"""

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from bench.actuators.laws import Friction, GasSpring, TorqueTable, config

Law = GasSpring | Friction | TorqueTable
Array = NDArray[np.float64]

NAMES = {GasSpring: "bench.gas_spring", Friction: "bench.friction", TorqueTable: "bench.torque_table"}
TIMESTEP = 1e-3  # [s]


def attributes(law: Law, **overrides: str) -> str:
    """Return the <config> elements of a law."""
    items = config(law) | overrides
    return "".join(f'<config key="{key}" value="{value}"/>' for key, value in items.items())


def element(law: Law, name: str = "actuator", **overrides: str) -> str:
    """Return a law as an actuator element."""
    target = 'tendon="rod"' if isinstance(law, GasSpring) else 'joint="x"'
    return f'<plugin name="{name}" plugin="{NAMES[type(law)]}" {target}>{attributes(law, **overrides)}</plugin>'


def mjcf(actuators: str, gear: str = 'stiffness="0"', extension: str = "") -> str:
    """Return the model as text."""
    return f"""
    <mujoco>
      <option timestep="{TIMESTEP}" gravity="0 0 0" integrator="implicitfast">
        <flag contact="disable"/>
      </option>
      <extension>
        <plugin plugin="bench.gas_spring"/><plugin plugin="bench.torque_table"/>
        <plugin plugin="bench.friction">{extension}</plugin>
      </extension>
      <worldbody>
        <site name="origin"/>
        <body><joint name="x" type="slide" axis="1 0 0"/><geom size="0.1" mass="10"/><site name="end"/></body>
        <body><joint name="w" type="slide" axis="1 0 0"/><geom size="0.1" mass="10"/></body>
      </worldbody>
      <tendon>
        <spatial name="rod"><site site="origin"/><site site="end"/></spatial>
        <fixed name="gear" {gear}><joint joint="x" coef="1"/><joint joint="w" coef="-1"/></fixed>
      </tendon>
      <actuator>{actuators}</actuator>
    </mujoco>"""


def slider(*laws: Law, gear: str = 'stiffness="0"') -> mujoco.MjModel:
    """Compile the sliders with the given laws on slider x."""
    text = "".join(element(law, f"actuator{i}") for i, law in enumerate(laws))
    return mujoco.MjModel.from_xml_string(mjcf(text, gear))


def follow(model: mujoco.MjModel, x: ArrayLike, v: ArrayLike = 0.0, w: ArrayLike = 0.0) -> Array:
    """Return the forces of all actuators while the sliders are put to x, w at speed v, step by step; shape (n, nu)."""
    data = mujoco.MjData(model)
    path = np.broadcast_arrays(np.asarray(x, dtype=float), v, w)
    forces = np.empty((path[0].size, model.nu))
    for i, (position, speed, other) in enumerate(zip(*path, strict=True)):
        data.qpos[:] = position, other
        data.qvel[:] = speed, 0
        mujoco.mj_step(model, data)
        forces[i] = data.actuator_force
    return forces
