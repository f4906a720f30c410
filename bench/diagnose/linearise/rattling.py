"""How links scatter within the gaps of gears with play while the arm moves: crossing, and bouncing off their flanks.

A link that rings leaves its flank where the torque that the ringing asks for is more than what pushes it there. It
rings when the slope of its torque changes and when it lands from a crossing; by how much follows from the mode of a
link that swings on its gear, w = sqrt(k/I): a change of slope s leaves a torque of s/w, a landing at speed v one of
v sqrt(k I). From there on it fades. A link with that torque A against a push P flies off by (A^2 - P^2) / (2 k P).
"""

import numpy as np

from bench.diagnose.linearise.torque_response import TorqueResponse
from bench.diagnose.replay.crossing import Gears, crossing_of
from bench.diagnose.replay.motion_segments import DAMPING_RATIO
from bench.diagnose.replay.play import pushing
from bench.diagnose.replay.segments import Segment
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot

# exact: of a gap: a link that crosses, or that lies in it loosely, may be anywhere within it
PLACED = 12**-0.5
# exact: of how far it flies off, for a link that bounces: anywhere between that and its flank, counted from the flank
BOUNCES = 3**-0.5
TINY = 1e-300  # rounding: so that nothing is divided by zero


def rattling(compiled: CompiledRobot, segment: Segment, response: TorqueResponse, play: Array) -> Array:
    """Return how links scatter while they cross the gaps of their gears and bounce, shape (T, n), in gaps.

    Args:
        compiled: The robot.
        segment: A motion.
        response: Of its readings to torques.
        play: Shape (n,) [rad] or [m], of the gears.
    """
    torque = pushing(compiled, response.transmitted, response.link_load, segment.standing)
    time = segment.motion.time[segment.motion.read]
    gears = Gears(response.link_inertia.mean(axis=0), compiled.stiffness, compiled.damping, play)
    crossing = crossing_of(torque, time, gears)
    swing = np.sqrt(response.link_inertia / compiled.stiffness)
    # a link whose motor stands has to slip to leave its flank
    slips = np.abs(response.link_load) + compiled.link_coulomb
    held = np.where(segment.standing, slips, np.abs(torque))
    rings = ringing(torque, time, crossing.landing * compiled.stiffness * swing, swing)
    height = np.minimum(flight_height(rings, held, compiled.stiffness), play) / np.where(play > 0, play, 1.0)
    scatter = np.where(np.abs(crossing.places) < 1, PLACED, BOUNCES * height)
    found: Array = np.where(play > 0, scatter, 0.0)
    return found


def ringing(torque: Array, time: Array, struck: Array, swing: Array) -> Array:
    """Return the torque with which links ring, shape (T, n) [Nm] or [N]: what excitations left, all in step.

    Args:
        torque: Shape (T, n) [Nm] or [N], on the gears.
        time: Shape (T,) [s].
        struck: Shape (T, n) [Nm] or [N], left by landings.
        swing: Shape (T, n) [s], 1/w.
    """
    found = struck.copy()
    steps = np.diff(time)[:, None]
    if len(time) > 2:
        found[1:-1] += np.abs(np.diff(np.diff(torque, axis=0) / steps, axis=0)) * swing[1:-1]
    for i, step in enumerate(steps):
        found[i + 1] += found[i] * np.exp(-DAMPING_RATIO * step / swing[i])
    return found


def flight_height(ringing: Array, push: Array, stiffness: Array) -> Array:
    """Return how far links fly off their flanks [rad] or [m], any shapes; 0 where they stay, inf where nothing holds.

    Args:
        ringing: [Nm] or [N], torque with which a link rings.
        push: [Nm] or [N], that holds it to its flank.
        stiffness: [Nm/rad] or [N/m], of its gear.
    """
    with np.errstate(over="ignore"):
        height: Array = np.maximum(ringing**2 - push**2, 0.0) / (2 * stiffness * np.maximum(push, TINY))
    return height
