"""Friction that joints hold at rest: how much there may be, and that part of it may have been let go of."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.linearise.torque_response import TorqueResponse
from bench.diagnose.replay.nuisances import Nuisance
from bench.diagnose.replay.play import is_loose
from bench.diagnose.replay.replay import Replay
from bench.effects.effect import Acting
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot
from bench.simulate.plant import Trace

# exact: root mean square of the part of its friction that a joint lets go of at rest: anything between none and all
LET_GO = 3**-0.5
# exact: the same of a joint whose motor gave to a load and came back: between none of it and twice, the other way round
TURNED = 2 * LET_GO


def held_friction(
    replay: Replay, traces: list[Trace], responses: tuple[TorqueResponse, ...]
) -> tuple[tuple[Nuisance, ...], Array]:
    """Return q nuisances for how much of its friction a joint still holds at rest, and their changes, shape (T, c, q).

    Settling and shaking let go of part of it, on each side of the gear, and more in one joint than in another. A load
    that the motor's friction does not hold moves the motor until the servo brings it back, and the link with it: that
    may turn the friction of both round, from what the load alone would leave. A link may arrive with its friction
    turned round as well, if it has a load; one whose friction holds it anywhere does rest anywhere (`LINK_VISIT`).
    """
    found, sensitivities = [], []
    gave = [
        segment.is_static & motor_gave(replay.compiled, response)
        for segment, response in zip(replay.segments, responses, strict=True)
    ]
    otherwise = [
        arrived_otherwise(replay.compiled, trace) * ~is_loose(replay.compiled, response.link_load)[0]
        if segment.is_static
        else np.zeros_like(trace.theta)
        for segment, trace, response in zip(replay.segments, traces, responses, strict=True)
    ]
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
        arrived = [
            response.link[:, :, j] * change[:, [j]] for response, change in zip(responses, otherwise, strict=True)
        ]
        if any(np.any(change) for change in arrived):
            found.append(Nuisance(f"link-side friction held at rest by {drive.joint} as it arrived", "", LET_GO))
            sensitivities.append(LET_GO * np.concatenate(arrived))
        if any(np.any(moved[:, j]) for moved in gave):
            for side in ("motor", "link"):
                turned = [
                    moved[:, [j]] * getattr(response, side)[:, :, j] * getattr(trace, f"{side}_friction")[:, [j]]
                    for trace, response, moved in zip(traces, responses, gave, strict=True)
                ]
                name = f"{side}-side friction held at rest by {drive.joint} after its motor gave"
                found.append(Nuisance(name, "", TURNED))
                sensitivities.append(TURNED * np.concatenate(turned))
    return tuple(found), np.stack(sensitivities, axis=2)


def arrived_otherwise(compiled: CompiledRobot, trace: Trace) -> Array:
    """Return by how much the friction of links changes at the rests of a visit if they arrive the other way, (T, n).

    A link whose joint stops briskly is thrown forward and comes back, which may turn its friction round. The loads
    that follow move it on, until its friction is what they alone leave.
    """
    level, stiffness, hold = compiled.link_coulomb, compiled.stiffness, compiled.link_presliding
    friction = -trace.link_friction[0]
    theta = trace.theta[0] + 2 * friction / stiffness
    found = [2 * friction]
    for at, held in zip(trace.theta[1:], trace.link_friction[1:], strict=True):
        # k (theta - at) = other - held, where other = friction - hold (theta - theta before) within its levels
        stays = friction - hold * (at - held / stiffness - theta)
        stays /= 1 + hold / stiffness
        new = np.clip(stays, -level, level)
        theta, friction = at + (new - held) / stiffness, new
        found.append(new - held)
    return np.asarray(found, dtype=np.float64)


def motor_gave(compiled: CompiledRobot, response: TorqueResponse) -> NDArray[np.bool_]:
    """Return at which rests of a visit a load has changed by more than the motor's friction holds, shape (T, n)."""
    change: Array = np.abs(np.diff(response.transmitted, axis=0, prepend=response.transmitted[:1]))
    moved: NDArray[np.bool_] = np.logical_or.accumulate(change > compiled.motor_coulomb, axis=0)
    return moved


def levels_of(compiled: CompiledRobot, traces: Sequence[Trace] = (), acting: Sequence[Acting] = ()) -> Array:
    """Return up to which friction of links and motors holds, shape (2, n) [Nm] or [N].

    That is its level, and what it held where that is more: friction rises at low speed, under load, in one direction.
    Friction within a gear (hysteresis) holds a link as well.

    Args:
        compiled: The robot.
        traces: What it did.
        acting: What was added to its model.
    """
    levels = np.stack([compiled.link_coulomb, compiled.motor_coulomb])
    for trace in traces:
        held = np.stack([np.abs(trace.link_friction).max(axis=0), np.abs(trace.motor_friction).max(axis=0)])
        levels = np.maximum(levels, held)
    for one in acting:
        if one.effect.holds:
            levels[0, one.place.index] += one.values[one.effect.holds]
    return levels
