"""The MJCF of a started robot: the cleared links, and beside them rotors, elements, servos, friction, load body."""

import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator, Sequence

from bench.robot.bodies import Array
from bench.robot.starter.defaults import STEP, DriveFigures
from bench.robot.starter.source import Source

ORDER = ("compiler", "option", "size", "visual", "statistic", "extension", "default", "asset", "worldbody", "tendon")
ACTUATION = {"general", "motor", "position", "velocity", "intvelocity", "damper", "cylinder", "muscle", "adhesion"}
NOT_INHERITED = ACTUATION | {"pid", "dcmotor", "tendon", "equality", "pair"}
LOAD_BODY, LOAD_POINT, REFLECTOR = "bench_load", "bench_load_point", "bench_reflector"
# Written out so that defaults of the file do not reach the rotors
BARE_JOINT = {"frictionloss": "0", "stiffness": "0", "limited": "false", "actuatorfrclimited": "false", "axis": "1 0 0"}


def names_of(joint: str) -> dict[str, str]:
    """Return the names of a drive's parts, as `figures.yaml` wants them."""
    return {
        "joint": joint,
        "rotor": f"{joint}_rotor",
        "element": f"{joint}_element",
        "servo": f"{joint}_servo",
        "motor_friction": f"{joint}_motor_friction",
        "link_friction": f"{joint}_link_friction",
    }


def reflectors_of(source: Source) -> tuple[str, ...]:
    """Return the names of the sites that are added for reflectors; one, in the load point, where nobody said."""
    return tuple(f"{REFLECTOR}_{k}" for k in range(1, len(source.reflectors) + 1)) or (REFLECTOR,)


def clashes(source: Source) -> Iterator[str]:
    """Yield a sentence for each part of the file that has a name which a part that is added will have."""
    rotors = {names_of(joint.name)["rotor"] for joint in source.joints}
    for kind, parts, taken in (
        ("body", source.spec.bodies, {LOAD_BODY, *rotors}),
        ("joint", source.spec.joints, rotors),
        ("site", source.spec.sites, {LOAD_POINT, *reflectors_of(source)}),
    ):
        for part in parts:
            if part.name in taken:
                yield f"{source.file}: {kind} {part.name!r}: a part that is added will have this name; rename yours."


def mjcf_of(name: str, source: Source, drives: Sequence[DriveFigures], links: str) -> str:
    """Return the MJCF of the whole robot.

    Args:
        name: Of the model.
        source: What was read.
        drives: One for each driven joint.
        links: The cleared links as MJCF, as MuJoCo saves it.
    """
    root = ElementTree.fromstring(links)
    root.set("model", name)
    for parent in list(root.iter("default")):
        for child in [child for child in parent if child.tag in NOT_INHERITED]:
            parent.remove(child)
    sections = {child.tag: child for child in root}
    for tag in ("option", "extension", "tendon", "actuator"):
        if tag not in sections:
            sections[tag] = ElementTree.SubElement(root, tag)
    sections["option"].set("integrator", "implicitfast")
    sections["option"].set("timestep", f"{STEP:g}")
    ElementTree.SubElement(sections["extension"], "plugin", plugin="bench.friction")
    _add_load(root, source)
    for joint, drive in zip(source.joints, drives, strict=True):
        link = next(element for element in sections["worldbody"].iter("joint") if element.get("name") == joint.name)
        link.attrib |= {"limited": "true", "range": f"{joint.limits[0]:.12g} {joint.limits[1]:.12g}"}
        _add_drive(sections, names_of(joint.name), joint.is_slide, joint.limits, drive)
    root[:] = sorted(root, key=lambda child: ORDER.index(child.tag) if child.tag in ORDER else len(ORDER))
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"


def with_home(mjcf: str, qpos: Sequence[float], act: Sequence[float], ctrl: Sequence[float]) -> str:
    """Return the MJCF with a keyframe `home`."""
    root = ElementTree.fromstring(mjcf)
    key = ElementTree.SubElement(ElementTree.SubElement(root, "keyframe"), "key", name="home")
    for attribute, values in (("qpos", qpos), ("act", act), ("ctrl", ctrl)):
        if len(values):
            key.set(attribute, " ".join(f"{value:.12g}" for value in values))
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"


def _add_load(root: ElementTree.Element, source: Source) -> None:
    bodies = {name: body for body in root.iter("body") if (name := body.get("name"))}
    place = _numbers(source.load_point.position)
    load = ElementTree.SubElement(bodies[source.load_point.body], "body", name=LOAD_BODY, pos=place)
    ElementTree.SubElement(load, "inertial", mass="0", pos="0 0 0", diaginertia="0 0 0")
    ElementTree.SubElement(load, "site", name=LOAD_POINT, size="0.01")
    if not source.reflectors:
        ElementTree.SubElement(load, "site", name=REFLECTOR, size="0.01")
    for name, at in zip(reflectors_of(source), source.reflectors, strict=False):
        ElementTree.SubElement(bodies[at.body], "site", name=name, pos=_numbers(at.position), size="0.01")


def _numbers(position: Array) -> str:
    return " ".join(f"{x:.12g}" for x in position)


def _add_drive(
    sections: dict[str, ElementTree.Element],
    names: dict[str, str],
    is_slide: bool,
    limits: tuple[float, float],
    drive: DriveFigures,
) -> None:
    add = ElementTree.SubElement
    body = add(sections["worldbody"], "body", name=names["rotor"])
    add(body, "inertial", mass="0.001", pos="0 0 0", diaginertia="1e-6 1e-6 1e-6")
    rotor = add(body, "joint", name=names["rotor"], type="slide" if is_slide else "hinge")
    rotor.attrib |= BARE_JOINT | {"armature": f"{drive.rotor_inertia:g}", "damping": f"{drive.viscous:g}"}
    element = add(sections["tendon"], "fixed", name=names["element"])
    element.attrib |= {"stiffness": f"{drive.stiffness:g}", "damping": f"{drive.damping:g}"}
    add(element, "joint", joint=names["rotor"], coef="1")
    add(element, "joint", joint=names["joint"], coef="-1")
    servo = add(sections["actuator"], "pid", name=names["servo"], joint=names["rotor"], input="pos vel")
    servo.attrib |= {"kp": f"{drive.kp:g}", "kv": f"{drive.kv:g}", "ki": f"{drive.ki:g}"}
    most = drive.torque_limit / drive.ki if drive.ki else 0.0  # a rotor of 1e-310 kg m^2 has no servo, and is refused
    servo.attrib |= {"imax": f"{most:.4g}", "posrange": f"{limits[0]:.12g} {limits[1]:.12g}"}
    servo.attrib |= {"forcerange": f"{-drive.torque_limit:g} {drive.torque_limit:g}"}
    for side, joint, level, sigma in (
        ("motor_friction", names["rotor"], drive.coulomb, drive.motor_presliding),
        ("link_friction", names["joint"], 0.0, drive.link_presliding),
    ):
        friction = add(sections["actuator"], "plugin", name=names[side], joint=joint, plugin="bench.friction")
        add(friction, "config", key="coulomb", value=f"{level:g}")
        add(friction, "config", key="presliding_stiffness", value=f"{sigma:g}")
