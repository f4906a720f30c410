"""The state of an actuator: what it holds, and how to begin with a given friction force. README.md has the layout."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import mujoco

HELD, POSITION, ANCHORED, TEMPERATURE_RISE = range(4)


def state_of(model: "mujoco.MjModel", data: "mujoco.MjData", actuator: int) -> NDArray[np.float64]:
    """Return the part of `data.plugin_state` that belongs to an actuator, as a view, shape (3,) or (4,).

    Args:
        model: Compiled model.
        data: Its data.
        actuator: Id of an actuator of this package.
    """
    instance = model.actuator_plugin[actuator]
    sharing = np.flatnonzero(model.actuator_plugin == instance)
    size = model.plugin_statenum[instance] // sharing.size
    start = model.plugin_stateadr[instance] + size * int(np.searchsorted(sharing, actuator))
    state: NDArray[np.float64] = data.plugin_state[start : start + size]
    return state


def begin_with(model: "mujoco.MjModel", data: "mujoco.MjData", actuator: int, force: float) -> None:
    """Let an actuator hold a friction force [N] or [Nm] at the position that the next step finds; 0 is unstressed.

    A force above the friction level is cut to it.
    """
    state_of(model, data, actuator)[[HELD, POSITION, ANCHORED]] = force, 0.0, 0.0
