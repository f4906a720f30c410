"""Friction that joints hold at rest: how much there may be, and that part of it may have been let go of."""

from collections.abc import Sequence

import numpy as np

from bench.diagnose.linearise.torque_response import TorqueResponse
from bench.diagnose.replay.nuisances import Nuisance
from bench.diagnose.replay.replay import Replay
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot
from bench.simulate.plant import Trace

# exact: root mean square of the part of its friction that a joint lets go of at rest: anything between none and all
LET_GO = 3**-0.5


def held_friction(
    replay: Replay, traces: list[Trace], responses: tuple[TorqueResponse, ...]
) -> tuple[tuple[Nuisance, ...], Array]:
    """Return nuisances for how much of its friction a joint still holds at rest, and their changes, shape (T, c, 2 n).

    Settling and shaking let go of part of it, on each side of the gear, and more in one joint than in another.
    """
    found, sensitivities = [], []
    for j, drive in enumerate(replay.compiled.robot.figures.drives):
        for side in ("motor", "link"):
            change = [
                (segment.is_static or segment.standing[j])
                * getattr(response, side)[:, :, j]
                * getattr(trace, f"{side}_friction")[:, [j]]
                for segment, trace, response in zip(replay.segments, traces, responses, strict=True)
            ]
            found.append(Nuisance(f"{side}-side friction held at rest by {drive.joint}", "", LET_GO))
            sensitivities.append(LET_GO * np.concatenate(change))
    return tuple(found), np.stack(sensitivities, axis=2)


def levels_of(compiled: CompiledRobot, traces: Sequence[Trace] = ()) -> Array:
    """Return up to which friction of links and motors holds, shape (2, n) [Nm] or [N].

    That is its level, and what it held where that is more: friction rises at low speed, under load, in one direction.

    Args:
        compiled: The robot.
        traces: What it did.
    """
    levels = np.stack([compiled.link_coulomb, compiled.motor_coulomb])
    for trace in traces:
        held = np.stack([np.abs(trace.link_friction).max(axis=0), np.abs(trace.motor_friction).max(axis=0)])
        levels = np.maximum(levels, held)
    return levels
