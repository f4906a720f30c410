"""Silence of the engine while models are only tried.

A search steps to where the gas of a cylinder has no room left or a torque is no number, is turned back there, and says
so where it has to. MuJoCo warns of every such step on the terminal and in a file MUJOCO_LOG.TXT in the user's folder.
"""

from collections.abc import Iterator
from contextlib import contextmanager

import mujoco


@contextmanager
def engine_silent() -> Iterator[None]:
    """Let MuJoCo's warnings go nowhere, in workers that are forked meanwhile, too; a handler that is set already stays.

    The handler is the process's, so this is for whoever has the process to itself, such as a command.
    """
    if mujoco.get_mju_user_warning() is not None:
        yield
        return
    mujoco.set_mju_user_warning(lambda words: None)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(None)
