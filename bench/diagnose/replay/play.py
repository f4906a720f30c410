"""Gears with play: where a link that nothing pushes to a flank may rest, nobody can say but that it is in the gap."""

from collections.abc import Iterable
from dataclasses import replace

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.diagnose.replay.crossing import Gears, crossing_of
from bench.effects.friction import CoulombLevel
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot
from bench.robot.mass_matrix import link_mass_matrix
from bench.simulate.trace import Trace

# derived: of its stated Coulomb level, below which a level may be in 95 % of what the catalogue expects of it: a link
# with less load than that is not surely at a flank
LOOSE = 1 + 1.645 * CoulombLevel.parameters[0].sigma
UNLOADED = 1e-3  # rounding: of the largest load on a link; less than that is none


def transmitted(compiled: CompiledRobot, trace: Trace) -> Array:
    """Return the torques of the elastic elements on their motors, shape (T, n) [Nm] or [N]."""
    torsion, half = trace.theta - trace.q, compiled.play / 2
    torque: Array = compiled.stiffness * (torsion - np.clip(torsion, -half, half))
    return torque


def link_load(compiled: CompiledRobot, trace: Trace) -> Array:
    """Return what gravity, inertia and loads ask of drives and friction together, shape (T, n) [Nm] or [N]."""
    load: Array = transmitted(compiled, trace) - trace.link_friction
    return load


def is_loose(compiled: CompiledRobot, load: Array) -> NDArray[np.bool_]:
    """Return where links have so little load that friction holds them anywhere within the play, shape (T, n).

    Args:
        compiled: The robot.
        load: Shape (T, n) [Nm] or [N], on the links.
    """
    size = np.abs(load)
    loose: NDArray[np.bool_] = size <= LOOSE * compiled.link_coulomb + UNLOADED * size.max(axis=0)
    return loose


def pushing(compiled: CompiledRobot, transmitted: Array, load: Array, standing: NDArray[np.bool_]) -> Array:
    """Return what pushes links to the flanks of their gears in motion, shape (T, n) [Nm] or [N].

    The link of a motor that stands moves where its load is more than friction holds; elsewhere it stays, and that is 0.

    Args:
        compiled: The robot.
        transmitted: Shape (T, n) [Nm] or [N], torques of the gears.
        load: Shape (T, n) [Nm] or [N], on the links.
        standing: Shape (n,), which motors stand.
    """
    level = compiled.link_coulomb
    found: Array = np.where(standing, load - np.clip(load, -level, level), transmitted)
    return found


def expected(
    compiled: CompiledRobot, trace: Trace, stretches: Iterable[tuple[slice, NDArray[np.bool_] | None]]
) -> Trace:
    """Return a trace with links where they are to be expected, within what play leaves open.

    At rest a loose link is expected in the middle: by friction alone it would lag behind its motor, but stopping throws
    it forward, and some bounce. In motion links take a while to cross from flank to flank (`crossing.py`), and instants
    are means over a while.

    Args:
        compiled: The robot.
        trace: As replayed: instants of a stretch of motion are the middles of equal intervals.
        stretches: Where each stretch is, and which motors stand in it, shape (n,); None: it is of rests.
    """
    half = compiled.play / 2
    if not np.any(half):
        return trace
    torsion = np.clip(trace.theta - trace.q, -half, half)
    torque, load = transmitted(compiled, trace), link_load(compiled, trace)
    shift = np.zeros_like(torsion)
    for rows, standing in stretches:
        if standing is None:
            shift[rows] = np.where(is_loose(compiled, load[rows]), -torsion[rows], 0.0)
        else:
            push = pushing(compiled, torque[rows], load[rows], standing)
            places = _places(compiled, trace[rows], push)
            shift[rows] = np.where(push != 0, places * half - torsion[rows], 0.0)
    return _shifted(compiled, trace, shift)


def _places(compiled: CompiledRobot, trace: Trace, push: Array) -> Array:
    """Return where links are in the gaps of their gears in a stretch of motion, shape (T, n), as of a `Crossing`.

    Mass matrices take as long as all else of a replay, so none is made where no link crosses.
    """
    crosses = (np.min(push, axis=0) < 0) & (np.max(push, axis=0) > 0) & (compiled.play > 0)
    if not np.any(crosses):
        return np.where(push < 0, -1.0, 1.0)
    inertia = np.diag(link_mass_matrix(compiled, trace.theta.mean(axis=0)))
    gears = Gears(inertia, compiled.stiffness, compiled.damping, compiled.play)
    return crossing_of(push, trace.time, gears).places


def _shifted(compiled: CompiledRobot, trace: Trace, shift: Array) -> Trace:
    """Return a trace with links moved by small angles, shape (T, n) [rad] or [m], and all that they carry."""
    moved = np.flatnonzero(np.any(shift != 0, axis=1))
    if not len(moved):
        return trace
    model, at = compiled.model, compiled.at
    theta, sites = trace.theta + shift, np.append(at.reflectors, at.load_point)
    points = np.concatenate([trace.reflectors, trace.load_point[:, None]], axis=1)
    data = mujoco.MjData(model)
    for i in moved:  # passive hinges have their own angles, which stay: what moves is the difference
        for links, sign in ((trace.theta[i], -1.0), (theta[i], 1.0)):
            data.qpos[at.theta] = links
            mujoco.mj_kinematics(model, data)
            points[i] += sign * data.site_xpos[sites]
    return replace(trace, theta=theta, reflectors=points[:, :-1], load_point=points[:, -1])
