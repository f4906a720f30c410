"""Friction that joints hold at rest: how much there may be, and that part of it may have been let go of."""

from collections.abc import Iterable, Sequence

import numpy as np

from bench.diagnose.linearise.torque_response import TorqueResponse
from bench.diagnose.replay.nuisances import Nuisance
from bench.diagnose.replay.play import is_loose
from bench.diagnose.replay.replay import Replay
from bench.effects.effect import Acting
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot
from bench.simulate.trace import Trace

# exact: root mean square of the part of its friction that a joint lets go of at rest: anything between none and all
LET_GO = 3**-0.5


def held_friction(
    replay: Replay, traces: list[Trace], responses: tuple[TorqueResponse, ...], levels: Array
) -> tuple[tuple[Nuisance, ...], Array]:
    """Return q nuisances for how much of its friction a joint still holds at rest, and their changes, shape (T, c, q).

    Settling and shaking let go of part of it, on each side of the gear, and more in one joint than in another. A load
    that the motor's friction does not hold moves the motor until the servo brings it back, and the link with it, which
    turns the friction of both round (`came_back`). A link may arrive with its friction turned round as well, if it has
    a load; one whose friction holds it anywhere does rest anywhere (`LINK_VISIT`).

    Args:
        replay: The campaign.
        traces: What the robot did, segment by segment.
        responses: To torques on links and motors, segment by segment.
        levels: Up to which friction of links and motors holds, shape (2, n) [Nm] or [N].
    """
    nothing = [np.zeros_like(trace.theta) for trace in traces]
    gave, otherwise = [(zeros, zeros) for zeros in nothing], list(nothing)
    for i, (segment, trace, response) in enumerate(zip(replay.segments, traces, responses, strict=True)):
        if segment.is_static:
            loaded = ~is_loose(replay.compiled, response.link_load)[0]
            gave[i] = came_back(replay.compiled, trace, response.transmitted, levels)
            otherwise[i] = arrived_otherwise(replay.compiled, trace) * loaded
    found, sensitivities = [], []
    has_rests = any(segment.is_static for segment in replay.segments)

    def add(name: str, to: Sequence[Array], changes: Iterable[Array]) -> None:
        found.append(Nuisance(name, "", LET_GO))
        sensitivities.append(LET_GO * np.concatenate([one * change for one, change in zip(to, changes, strict=True)]))

    for j, drive in enumerate(replay.compiled.robot.figures.drives):
        to_motor, to_link = ([getattr(one, side)[:, :, j] for one in responses] for side in ("motor", "link"))
        for side, to in (("motor", to_motor), ("link", to_link)):
            held = [
                (segment.is_static or segment.standing[j]) * getattr(trace, f"{side}_friction")[:, [j]]
                for segment, trace in zip(replay.segments, traces, strict=True)
            ]
            add(f"{side}-side friction held at rest by {drive.joint}", to, held)
        if has_rests:  # also where friction is none yet: a world that has some holds it in the same ways
            name = f"link-side friction held at rest by {drive.joint} as it arrived"
            add(name, to_link, [change[:, [j]] for change in otherwise])
            words = f"friction held at rest by {drive.joint} after its motor gave"
            add(f"motor-side {words}", to_motor, [motors[:, [j]] for motors, _ in gave])
            add(f"link-side {words}", to_link, [links[:, [j]] for _, links in gave])
    return tuple(found), np.stack(sensitivities, axis=2)


def arrived_otherwise(compiled: CompiledRobot, trace: Trace) -> Array:
    """Return by how much the friction of links changes at the rests of a visit if they arrive the other way, (T, n).

    A link whose joint stops briskly is thrown forward and comes back, which may turn its friction round. The loads
    that follow move it on, until its friction is what they alone leave.
    """
    friction = -trace.link_friction[0]
    theta = trace.theta[0] + 2 * friction / compiled.stiffness
    found = [2 * friction]
    for i in range(1, len(trace)):
        theta, friction = _moved_on(compiled, trace, i, theta, friction, compiled.link_coulomb)
        found.append(friction - trace.link_friction[i])
    return np.asarray(found, dtype=np.float64)


def came_back(compiled: CompiledRobot, trace: Trace, transmitted: Array, levels: Array) -> tuple[Array, Array]:
    """Return by how much the friction of motors and of links changes where motors gave and came back, (T, n) each.

    A replay knows where motors are at a rest, not where they were since the rest before. What a new load asks beyond
    what the motor's friction has left to hold moves the motor out, the farther the more it asks, until its servo brings
    it back; on the way back friction builds up in the other direction. That it asked for twice the level is taken to
    turn friction round altogether; how soft the servo is, is left to the nuisance. A link goes out and back with its
    motor, also where that slides nowhere and gives as its friction element does. What follows goes on from there.

    Args:
        compiled: The robot.
        trace: What the replay has at the rests of a visit, loads one after the other.
        transmitted: Shape (T, n) [Nm] or [N], torques of the elastic elements on the motors.
        levels: Shape (2, n) [Nm] or [N], up to which friction of links and motors holds.
    """
    level, most = levels
    motor, link, theta = trace.motor_friction[0], trace.link_friction[0], trace.theta[0]
    motors, links = [np.zeros_like(motor)], [np.zeros_like(link)]
    for i in range(1, len(trace)):
        push = transmitted[i] - transmitted[i - 1]
        side = np.sign(push)
        beyond = np.clip(np.abs(push) - (most + side * motor), 0.0, 2 * most)  # friction of -side * most is all it has
        moved = trace.motor_friction[i] - trace.motor_friction[i - 1]
        motor = np.clip(np.where(beyond > 0, trace.motor_friction[i] + side * beyond, motor + moved), -most, most)
        share = np.clip(np.divide(np.abs(push), most, out=np.zeros_like(push), where=most > 0), 0.0, 2.0)
        _, kept = _moved_on(compiled, trace, i, theta, link, level)
        link = np.clip(kept + side * share * level, -level, level)
        theta = trace.theta[i] + (link - trace.link_friction[i]) / compiled.stiffness
        motors.append(motor - trace.motor_friction[i])
        links.append(link - trace.link_friction[i])
    return np.asarray(motors, dtype=np.float64), np.asarray(links, dtype=np.float64)


def _moved_on(
    compiled: CompiledRobot, trace: Trace, i: int, theta: Array, friction: Array, level: Array
) -> tuple[Array, Array]:
    """Return angles and friction of links at the next rest, shape (n,) each, from others than the replay has.

    Args:
        compiled: The robot.
        trace: What the replay has.
        i: The next rest.
        theta: Shape (n,), where links are at the rest before.
        friction: Shape (n,), what holds them there.
        level: Shape (n,), up to which friction holds.
    """
    stiffness, hold, at, held = compiled.stiffness, compiled.link_presliding, trace.theta[i], trace.link_friction[i]
    # k (theta - at) = other - held, where other = friction - hold (theta - theta before) within its levels
    stays = (friction - hold * (at - held / stiffness - theta)) / (1 + hold / stiffness)
    new = np.clip(stays, -level, level)
    return at + (new - held) / stiffness, new


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
