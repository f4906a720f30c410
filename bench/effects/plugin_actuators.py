"""Actuators of the engine plugin that an effect adds to a spec."""

from collections.abc import Mapping

import mujoco

from bench.actuators.laws import Friction, TorqueTable, config
from bench.robot.plugins import name_instances, unused_name


def add_torque_table(
    spec: mujoco.MjSpec, name: str, law: TorqueTable, *, joint: str | None = None, tendon: str | None = None
) -> None:
    """Add a torque table that acts on a joint or along a tendon."""
    _add(spec, name, "bench.torque_table", config(law), joint, tendon)


def add_fixed_tendon(spec: mujoco.MjSpec, name: str, coefficients: Mapping[str, float]) -> str:
    """Add a tendon over joints that has neither stiffness nor damping, and return its name.

    Args:
        spec: To which it is added.
        name: What it is called, if nothing is called so.
        coefficients: Joint -> length of the tendon over its angle.
    """
    full = unused_name(spec, name)
    tendon = spec.add_tendon(name=full)
    for joint, coefficient in coefficients.items():
        tendon.wrap_joint(joint, coefficient)
    return full


def add_friction(
    spec: mujoco.MjSpec, name: str, law: Friction, *, joint: str | None = None, tendon: str | None = None
) -> None:
    """Add an elasto-plastic element that acts on a joint or along a tendon."""
    _add(spec, name, "bench.friction", config(law), joint, tendon)


def _add(
    spec: mujoco.MjSpec, name: str, plugin: str, attributes: Mapping[str, str], joint: str | None, tendon: str | None
) -> None:
    spec.activate_plugin(plugin)
    name_instances(spec)
    full = unused_name(spec, name)
    # attributes live in an instance of its own: MuJoCo 4.0.0 crashes on the `config` of a new actuator's own plugin
    instance = spec.add_plugin(name=full, plugin_name=plugin)
    instance.config = dict(attributes)
    actuator = spec.add_actuator(name=full)
    actuator.trntype = mujoco.mjtTrn.mjTRN_JOINT if joint else mujoco.mjtTrn.mjTRN_TENDON
    actuator.target = joint or tendon
    used = actuator.plugin
    used.name, used.plugin_name, used.active = full, plugin, True
