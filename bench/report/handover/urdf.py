"""The links of a robot as URDF: kinematics, inertials, limits, friction; no shapes."""

from collections.abc import Iterable, Mapping
from xml.etree import ElementTree

import numpy as np

from bench.report.handover.applied import Applied
from bench.report.handover.drag import drag_of
from bench.robot.bodies import Array

LEVEL = 1e-9  # cosine of the pitch, below which roll and yaw turn about the same axis and the yaw is taken as 0


def urdf_of(applied: Applied, name: str) -> str:
    """Return the robot as URDF. Numbers have all digits of a double.

    Links have the names of the bodies that carry the driven joints; the load point and the reflectors are links without
    mass on fixed joints. `friction` of a joint is the Coulomb level, and `damping` the viscous friction, of motor and
    link side together.

    Args:
        applied: The robot.
        name: Of the robot in the file.
    """
    compiled, bodies, figures = applied.compiled, applied.bodies, applied.compiled.robot.figures
    model, at = compiled.model, compiled.at
    carriers = [str(model.body(int(model.jnt_bodyid[joint])).name) for joint in at.joint]
    links = _unlike([*carriers, "base", figures.load_point, *figures.reflectors])
    base, links_of_points = links[len(carriers)], links[len(carriers) + 1 :]
    root = ElementTree.Element("robot", name=name)
    ElementTree.SubElement(root, "link", name=base)
    for i in range(bodies.n_joints):
        link = ElementTree.SubElement(root, "link", name=links[i])
        if bodies.mass[i] > 0:
            _inertial(link, float(bodies.mass[i]), bodies.com[i], bodies.inertia[i])
    coulomb, damping = compiled.motor_coulomb + compiled.link_coulomb, drag_of(compiled)[:, 0]
    for i, joint in enumerate(bodies.names):
        is_limited = bool(model.jnt_limited[at.joint[i]])
        kind = ("revolute" if is_limited else "continuous") if bodies.is_hinge[i] else "prismatic"
        parent = links[bodies.parent[i]] if bodies.parent[i] >= 0 else base
        found = _joint(root, joint, kind, parent, links[i], bodies.position[i], bodies.rotation[i])
        ElementTree.SubElement(found, "axis", xyz=_numbers(bodies.axis[i]))
        limit = {
            "effort": model.actuator_forcerange[at.servo[i], 1],
            "velocity": figures.drives[i].speed_limit_rad_per_s,
        }
        if is_limited or kind == "prismatic":
            limit |= {"lower": bodies.limits[i, 0], "upper": bodies.limits[i, 1]}
        ElementTree.SubElement(found, "limit", _texts(limit))
        ElementTree.SubElement(found, "dynamics", _texts({"damping": damping[i], "friction": coulomb[i]}))
    for site, frame in zip((figures.load_point, *figures.reflectors), links_of_points, strict=True):
        point = bodies.points[site]
        parent = links[point.body] if point.body >= 0 else base
        ElementTree.SubElement(root, "link", name=frame)
        _joint(root, f"{frame}_fixed", "fixed", parent, frame, point.position, point.rotation)
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode", xml_declaration=True) + "\n"


def _unlike(names: Iterable[str]) -> list[str]:
    """Return names of which no two are the same: those that are there already get a number."""
    found: list[str] = []
    for name in names:
        wanted, count = name, 1
        while wanted in found:
            count += 1
            wanted = f"{name}_{count}"
        found.append(wanted)
    return found


def _inertial(link: ElementTree.Element, mass: float, com: Array, inertia: Array) -> None:
    inertial = ElementTree.SubElement(link, "inertial")
    ElementTree.SubElement(inertial, "origin", xyz=_numbers(com), rpy="0 0 0")
    ElementTree.SubElement(inertial, "mass", _texts({"value": mass}))
    entries = {f"i{'xyz'[i]}{'xyz'[j]}": inertia[i, j] for i in range(3) for j in range(i, 3)}
    ElementTree.SubElement(inertial, "inertia", _texts(entries))


def _joint(
    root: ElementTree.Element, name: str, kind: str, parent: str, child: str, position: Array, rotation: Array
) -> ElementTree.Element:
    joint = ElementTree.SubElement(root, "joint", name=name, type=kind)
    ElementTree.SubElement(joint, "parent", link=parent)
    ElementTree.SubElement(joint, "child", link=child)
    ElementTree.SubElement(joint, "origin", xyz=_numbers(position), rpy=_numbers(_roll_pitch_yaw(rotation)))
    return joint


def _roll_pitch_yaw(rotation: Array) -> Array:
    """Return angles r, p, y with rotation = Rz(y) Ry(p) Rx(r), as URDF has them, shape (3,) [rad]."""
    level = float(np.hypot(rotation[0, 0], rotation[1, 0]))
    pitch = np.arctan2(-rotation[2, 0], level)
    if level < LEVEL:
        return np.array([np.arctan2(-rotation[1, 2], rotation[1, 1]), pitch, 0.0])
    roll, yaw = np.arctan2(rotation[2, 1], rotation[2, 2]), np.arctan2(rotation[1, 0], rotation[0, 0])
    return np.array([roll, pitch, yaw])


def _numbers(values: Array) -> str:
    return " ".join(repr(float(value)) for value in values)


def _texts(values: Mapping[str, float]) -> dict[str, str]:
    return {name: repr(float(value)) for name, value in values.items()}
