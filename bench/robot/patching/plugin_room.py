"""Room in a compiled model for the attributes of its plugin instances, so that other texts can be written over them.

MuJoCo keeps the attributes of an instance as texts one after the other, each as long as it was when the model was
compiled. Here each gets blanks behind it; one that is not given is all blanks, which the plugin takes for not given.
"""

from collections.abc import Mapping, Sequence
from dataclasses import fields

import mujoco
import numpy as np

from bench.actuators.laws import Friction, GasSpring, TorqueTable
from bench.robot.patching.numbers import NotPatchableError

LAWS = {"bench.friction": Friction, "bench.gas_spring": GasSpring, "bench.torque_table": TorqueTable}
LISTS = ("forward", "backward")  # attributes with as many numbers as one likes
NAMES = ("element",)  # attributes that name tendons
NUMBER = 25  # characters of a number to full precision, and a blank


def attributes(plugin: str) -> list[str]:
    """Return the attributes of a plugin in the order in which a model keeps them: numbers before lists and names."""
    names = [field.name for field in fields(LAWS[plugin])]
    return sorted(names, key=lambda name: name in LISTS or name in NAMES)


def widths(plugin: str, config: Mapping[str, str], sharing: int, tendons: Sequence[str]) -> dict[str, int]:
    """Return how many characters each attribute of an instance may take.

    Args:
        plugin: Its law.
        config: Its attributes as they are.
        sharing: Number of actuators that use it.
        tendons: Names of all tendons.
    """
    found = {}
    for name in attributes(plugin):
        text = config.get(name, "")
        if name in LISTS:
            found[name] = NUMBER * len(text.split())
        else:
            longest = max((len(tendon.encode()) + 1 for tendon in tendons), default=1)
            found[name] = max((longest if name in NAMES else NUMBER) * sharing, len(text.encode()))
    return found


def padded(config: Mapping[str, str], room: Mapping[str, int]) -> dict[str, str]:
    """Return the attributes of an instance, each with blanks up to its room.

    Raises:
        NotPatchableError: A text is longer than its room, or an attribute has none.
    """
    if unknown := config.keys() - room.keys():
        raise NotPatchableError(f"attributes {sorted(unknown)} of a plugin")
    found = {}
    for name, width in room.items():
        text = config.get(name, "")
        missing = width - len(text.encode())
        if missing < 0:
            raise NotPatchableError(f"a text of attribute {name} that is longer than its room")
        found[name] = text + " " * missing
    return found


def write(model: mujoco.MjModel, instance: int, config: Mapping[str, str], room: Mapping[str, int]) -> None:
    """Write the attributes of an instance over those of a model that was compiled with this room for them."""
    texts = "\0".join(padded(config, room).values())
    start = int(model.plugin_attradr[instance])
    written = np.frombuffer(texts.encode(), dtype=np.int8)
    model.plugin_attr[start : start + len(written)] = written
