"""Actuators of the engine plugin that an effect adds to a spec."""

from collections.abc import Mapping

import mujoco

from bench.actuators.laws import Friction, TorqueTable, config

PREFIX = "effect/"  # of the names of all parts that effects add


def add_torque_table(
    spec: mujoco.MjSpec, name: str, law: TorqueTable, *, joint: str | None = None, tendon: str | None = None
) -> None:
    """Add a torque table that acts on a joint or along a tendon."""
    _add(spec, name, "bench.torque_table", config(law), joint, tendon)


def add_friction(
    spec: mujoco.MjSpec, name: str, law: Friction, *, joint: str | None = None, tendon: str | None = None
) -> None:
    """Add an elasto-plastic element that acts on a joint or along a tendon."""
    _add(spec, name, "bench.friction", config(law), joint, tendon)


def unused_name(spec: mujoco.MjSpec, name: str) -> str:
    """Return `effect/name`, with a number behind it where the spec has that name already."""
    taken = {part.name for part in (*spec.actuators, *spec.joints, *spec.bodies, *spec.plugins)}
    wanted, count = PREFIX + name, 1
    while wanted in taken:
        count += 1
        wanted = f"{PREFIX}{name} {count}"
    return wanted


def _add(
    spec: mujoco.MjSpec, name: str, plugin: str, attributes: Mapping[str, str], joint: str | None, tendon: str | None
) -> None:
    spec.activate_plugin(plugin)
    _name_instances(spec)
    full = unused_name(spec, name)
    # attributes live in an instance of its own: MuJoCo 4.0.0 crashes on the `config` of a new actuator's own plugin
    instance = spec.add_plugin(name=full, plugin_name=plugin)
    instance.config = dict(attributes)
    actuator = spec.add_actuator(name=full)
    actuator.trntype = mujoco.mjtTrn.mjTRN_JOINT if joint else mujoco.mjtTrn.mjTRN_TENDON
    actuator.target = joint or tendon
    used = actuator.plugin
    used.name, used.plugin_name, used.active = full, plugin, True


def _name_instances(spec: mujoco.MjSpec) -> None:
    """Name the unnamed plugin instances: MuJoCo 4.0.0 saves no named instance that follows an unnamed one."""
    unnamed = [plugin for plugin in spec.plugins if not plugin.name]
    users = [actuator for actuator in spec.actuators if actuator.plugin.active and not actuator.plugin.name]
    if len(unnamed) != len(users):
        return  # some belong to other parts of the model
    for instance, actuator in zip(unnamed, users, strict=True):  # both in the order of the file
        used = actuator.plugin
        instance.name = instance_name = unused_name(spec, actuator.name)
        instance.plugin_name = used.plugin_name
        used.name = instance_name
