"""Where loads act on somebody's robot, and where its reflectors are: sites of the file, or links by their frames."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np

from bench.errors import RobotError, unknown_names
from bench.robot.bodies import Array

TOOL_SITES = (
    *("attachment_site", "tool0", "tcp", "ee_site", "end_effector"),
    *("tool_flange", "flange", "tool", "grip_site", "pinch"),
)
KIND = "site or link (its frame) behind the last driven joint"


@dataclass(frozen=True)
class Place:
    """A point of the last link.

    Attributes:
        body: Body that carries it.
        position: Shape (3,) [m], in that body.
        origin: Where it comes from, in words.
    """

    body: str
    position: Array
    origin: str


def places(
    file: Path, spec: mujoco.MjSpec, last: str, load_point: str, reflectors: Sequence[str]
) -> tuple[Place, tuple[Place, ...]]:
    """Return the load point, and the reflectors in the order given; give bodies of the last link a name.

    A URDF has no sites: there a link that is fixed to the last one stands for the point in which its frame lies.

    Args:
        file: Where the robot came from.
        spec: Its links with the driven joints alone.
        last: Name of the last driven joint.
        load_point: Name of a site, or of a body behind the last driven joint; empty: a site with a usual name, else
            the end of the chain.
        reflectors: Names likewise.

    Raises:
        RobotError: A name is not known there, or a reflector is named twice.
    """
    link = spec.joint(last).parent
    bodies = [link, *link.find_all("body")]
    named = {body.name for body in bodies} | {site.name for body in bodies for site in body.sites}
    faults = [
        f"{file}: {option}: {' '.join(problems)}"
        for option, names in (("--load-point", [load_point] if load_point else []), ("--reflectors", reflectors))
        if (problems := unknown_names(KIND, names, named - {""}))
    ]
    if len(set(reflectors)) < len(reflectors):
        faults.append(f"{file}: --reflectors: {' '.join(reflectors)} names one twice; name each once.")
    if faults:
        raise RobotError(faults)
    for number, body in enumerate(bodies, start=1):
        if not body.name:
            body.name = f"link_{last}" if number == 1 else f"link_{last}_{number}"
    known = {
        body.name: Place(body.name, np.zeros(3), f"frame of link {body.name!r} of the file")
        for body in bodies
        if body.name in named
    }
    sites = {
        site.name: Place(site.parent.name, np.array(site.pos), f"site {site.name!r} of the file")
        for body in bodies
        for site in body.sites
        if site.name
    }
    known |= sites
    chosen = load_point or next((name for name in TOOL_SITES if name in sites), "")
    return known[chosen] if chosen else _end(spec, bodies), tuple(known[name] for name in reflectors)


def _end(spec: mujoco.MjSpec, bodies: Sequence[mujoco.MjsBody]) -> Place:
    """Return the end of the chain: the frame of its last body, or the centre of mass of its only one."""
    if len(bodies) > 1:
        name = bodies[-1].name
        return Place(name, np.zeros(3), f"origin of body {name!r}, the last of the chain; --load-point names another")
    name = bodies[0].name
    centre = spec.copy().compile().body(name).ipos  # of the spec itself it is unknown where shapes have the mass
    return Place(name, np.array(centre), f"centre of mass of the last link, {name!r}")
