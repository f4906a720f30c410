"""What MuJoCo's reader of URDF leaves out, brought in: visual shapes, speed limits, meshes by `package://`."""

import math
import tempfile
import xml.etree.ElementTree as ElementTree
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

import mujoco

from bench.errors import RobotError
from bench.record.limits import ASSET_BYTES, MODEL_BYTES
from bench.record.plain_file import FileFault, expect_plain
from bench.robot.mjcf_text import look_through
from bench.robot.trial import expect_harmless

MESHES = (".stl", ".obj", ".msh")  # that MuJoCo reads
UNREAD = ("mimic", "safety_controller", "calibration", "transmission")  # of a URDF, that nothing here has a place for
LIMITS = ("lower", "upper", "effort", "velocity")  # of a joint in a URDF
LOOSE = 4  # names of links in one message
TURN = 6.3  # [rad], exact but for digits: of a roll, pitch or yaw, more says nothing new
ABOVE = 4  # folders above the URDF in which a package is looked for (assumed: urdf/ and robots/ lie one or two below)


@dataclass(frozen=True)
class Urdf:
    """A URDF.

    Attributes:
        file: Where it stands.
        root: Its elements.
        speed_limits: Joint -> [rad/s] or [m/s], of those that have one.
        left_out: Shapes that MuJoCo cannot read, in words.
        meshes: Files of its meshes, by the name that `root` has for them.
    """

    file: Path
    root: ElementTree.Element
    speed_limits: dict[str, float]
    left_out: tuple[str, ...]
    meshes: dict[str, Path]

    def spec(self) -> mujoco.MjSpec:
        """Return the robot with its visual shapes and with the bodies of tool frames; its meshes have absolute paths.

        Raises:
            RobotError: It breaks the limits, or ends the process that tries it.
            ValueError: MuJoCo cannot read it.
        """
        with tempfile.TemporaryDirectory() as name:
            copy = Path(name) / self.file.name
            for mesh, source in self.meshes.items():
                (Path(name) / mesh).symlink_to(source)
            ElementTree.ElementTree(self.root).write(copy, encoding="utf-8")
            try:
                expect_harmless(copy)
                spec = mujoco.MjSpec.from_file(str(copy))
            except RobotError as error:
                raise RobotError(problem.replace(str(copy), str(self.file)) for problem in error.problems) from error
        for mesh in spec.meshes:
            mesh.file = str(self.meshes.get(Path(mesh.file).name, mesh.file))
        spec.modelfiledir = str(self.file.resolve().parent)
        return spec


def read_urdf(file: Path) -> Urdf | None:
    """Read a URDF; None if the file is none.

    Raises:
        RobotError: It is no XML, breaks the limits for strangers' files, or has joints that cannot be.
    """
    try:
        expect_plain(file, MODEL_BYTES)
    except FileFault as fault:
        raise RobotError(f"{file}: {fault}; {fault.remedy}.") from fault
    look_through(file)
    try:
        # as MuJoCo reads it, whatever encoding it declares; `look_through` refuses what is no UTF-8
        root = ElementTree.parse(file, ElementTree.XMLParser(encoding="utf-8")).getroot()
    except ElementTree.ParseError as error:  # a prefix that stands for nothing is XML to others
        raise RobotError(f"{file}: not XML ({error}); correct that line.") from error
    for element in root.iter():  # a namespace, as of <robot xmlns="...">, says nothing more
        element.tag = element.tag.rpartition("}")[2]
    if root.tag != "robot":
        return None
    joints = root.findall("joint")
    faults = (*_repeated(joints), *_faulty_limits(joints), *_in_degrees(root), *_loose(root))
    if faults:
        raise RobotError(f"{file}: {fault}" for fault in faults)
    speeds = {}
    for joint in joints:
        limit = joint.find("limit")
        if limit is not None and (speed := _number(limit.get("velocity", ""))) > 0:
            speeds[joint.get("name", "")] = speed
    meshes: dict[str, Path] = {}
    missing: list[str] = []
    for link in root.iter("link"):
        for kind in ("visual", "collision"):
            for shape in link.findall(kind):
                _place_mesh(file, link, shape, meshes, missing)
    unread = [f"{len(found)} {tag}" for tag in UNREAD if (found := list(root.iter(tag)))]
    left_out = (f"{len(missing)} shapes: {'; '.join(missing)}",) if missing else ()
    left_out = (*left_out, *unread)
    extension = root.find("mujoco")
    extension = ElementTree.SubElement(root, "mujoco") if extension is None else extension
    compiler = extension.find("compiler")
    compiler = ElementTree.SubElement(extension, "compiler") if compiler is None else compiler
    compiler.attrib |= {"discardvisual": "false", "fusestatic": "false", "strippath": "false"}
    return Urdf(file, root, speeds, left_out, meshes)


def _repeated(joints: list[ElementTree.Element]) -> Iterator[str]:
    """Yield a sentence for each name that several joints have; MuJoCo would leave all but one without a name."""
    for name, count in Counter(joint.get("name", "") for joint in joints).items():
        if count > 1:
            yield f"{count} joints have the name {name!r}; give each its own."


def _loose(root: ElementTree.Element) -> Iterator[str]:
    """Yield a sentence if several links hang on no joint; MuJoCo would fix all of them to the world."""
    children = {child.get("link") for child in root.findall("joint/child")}
    roots = [name for link in root.findall("link") if (name := link.get("name", "")) not in children]
    if len(roots) > 1:
        names = " and ".join(repr(name) for name in roots[:LOOSE])
        more = f" and {len(roots) - LOOSE} more" if len(roots) > LOOSE else ""
        yield (
            f"links {names}{more} hang on no joint, and only the base may; write the joints that carry the others, "
            "or take those links out."
        )


def _faulty_limits(joints: list[ElementTree.Element]) -> Iterator[str]:
    """Yield a sentence for each limit of a joint that cannot be; MuJoCo takes it for one that is not given."""
    for joint in joints:
        limit, place = joint.find("limit"), f"joint {joint.get('name')!r}: limit"
        if limit is None:
            continue
        for key in LIMITS:
            if (text := limit.get(key)) is not None and not _is_number(text):
                yield f"{place}: {key} is {text!r}, no number."
        for key in ("effort", "velocity"):
            if (value := _number(limit.get(key, ""))) < 0:
                yield f"{place}: {key} is {value:g}; write how much it is either way, as a positive number."
        lower, upper = (_number(limit.get(key, "")) for key in ("lower", "upper"))
        if lower > upper:
            yield f"{place}: lower is {lower:g}, above upper, {upper:g}; exchange them."
        elif (
            lower == upper
            and joint.get("type") in ("revolute", "prismatic")
            and {"lower", "upper"} <= set(limit.keys())
        ):
            yield f'{place}: lower and upper are both {lower:g}; write how far it goes, or type="fixed".'


def _in_degrees(root: ElementTree.Element) -> Iterator[str]:
    """Yield a sentence for each origin that is turned by more than a turn: "90" is meant in degrees."""
    for element in (*root.iter("joint"), *root.iter("link")):
        for origin in element.iter("origin"):
            turned = origin.get("rpy", "")
            if any(abs(_number(one)) > TURN for one in turned.split()):
                yield (
                    f"{element.tag} {element.get('name')!r}: origin: rpy is {turned!r}, more than a whole turn; angles "
                    "in a URDF are in radians."
                )


def _place_mesh(
    file: Path, link: ElementTree.Element, shape: ElementTree.Element, meshes: dict[str, Path], missing: list[str]
) -> None:
    """Give the mesh of a shape a name of its own; take shapes out that cannot be read."""
    mesh = shape.find("geometry/mesh")
    if mesh is None:
        return
    written = mesh.get("filename", "")
    place = _find(file, written)
    if place is None or place.suffix.lower() not in MESHES:
        why = "not found" if place is None else f"MuJoCo reads {', '.join(MESHES)}"
        if shape.tag == "collision" and link.find("inertial") is None:
            raise RobotError(
                f"{file}: link {link.get('name')!r} has its mass in {written!r}, which is not read: {why}."
            )
        missing.append(f"{PurePosixPath(written).name} of {link.get('name')} ({why})")
        link.remove(shape)
        return
    try:
        expect_plain(place, ASSET_BYTES)
    except FileFault as fault:
        raise RobotError(f"{file}: {place}: {fault}; {fault.remedy}.") from fault
    known = next((name for name, other in meshes.items() if other == place), "")
    name = known or (place.name if place.name not in meshes else f"{len(meshes)}_{place.name}")
    meshes[name] = place
    mesh.set("filename", name)


def _find(file: Path, written: str) -> Path | None:
    """Return the file that a mesh names: a path, or one in a package whose folder lies beside or above the URDF."""
    here = file.resolve().parent
    if not written.startswith(("package://", "model://")):
        places = [here / written.removeprefix("file://"), here / PurePosixPath(written).name]
    else:
        path = PurePosixPath(written.split("://", 1)[1])
        folders = [here, *here.parents][: ABOVE + 1]
        inner = PurePosixPath(*path.parts[1:])
        places = [folder / way for folder in folders for way in (path, inner)] + [here / path.name]
    return next((place.resolve() for place in places if place.is_file()), None)


def _is_number(text: str) -> bool:
    try:
        return not math.isnan(float(text))
    except ValueError:
        return False


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return 0.0
