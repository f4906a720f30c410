"""A robot is a folder: MJCF, `figures.yaml`, README. This finds one and reads its figures."""

import errno
import os
from collections.abc import Iterator
from dataclasses import dataclass
from math import inf
from pathlib import Path

from pydantic import BaseModel, ValidationError

from bench import paths
from bench.errors import RobotError, UnknownRobotError, unknown_name
from bench.record.rules.values import IMPOSSIBLE
from bench.record.schema_words import faults_of, words_of
from bench.record.yaml_text import YamlFault, load_typed_yaml
from bench.robot.figures import Figures
from bench.robot.one_or_each import LIST, NUMBER

FIGURES_FILE = "figures.yaml"
NOT_THERE = (errno.ENOENT, errno.ENOTDIR, errno.ENAMETOOLONG, errno.ELOOP)  # of a folder: it leads nowhere
MJCF_ENDINGS = (".xml", ".mjcf")


@dataclass(frozen=True)
class Robot:
    """A robot folder whose figures have been validated; the MJCF is read when it is compiled.

    Attributes:
        name: Folder name.
        folder: Where it stands.
        figures: Contents of `figures.yaml`.
        not_carried: Bodies of the MJCF that are left out when it is read, with all that hangs on them.
    """

    name: str
    folder: Path
    figures: Figures
    not_carried: tuple[str, ...] = ()

    @property
    def mjcf(self) -> Path:
        """The MJCF of the robot alone."""
        return self.folder / self.figures.mjcf

    @property
    def figures_file(self) -> Path:
        """The file with its figures."""
        return self.folder / FIGURES_FILE

    @property
    def n_joints(self) -> int:
        """Number of driven joints."""
        return len(self.figures.drives)


def robot_names() -> tuple[str, ...]:
    """Return the names of the robots that come with the package, sorted."""
    return tuple(sorted(entry.parent.name for entry in paths.models_dir().glob(f"*/{FIGURES_FILE}")))


def load_robot(name_or_folder: str | Path) -> Robot:
    """Read a robot by the name of a folder in `models/`, or by a path to a folder of one's own.

    Raises:
        UnknownRobotError: No such robot.
        RobotError: Its figures break the schema; every fault is listed.
    """
    known = robot_names()
    folder = paths.models_dir() / name_or_folder if str(name_or_folder) in known else Path(name_or_folder)
    source = folder / FIGURES_FILE
    try:
        is_there = bool(os.lstat(source))
    except ValueError:  # a byte of zero
        is_there = False
    except OSError as error:
        if error.errno not in NOT_THERE:
            raise RobotError(f"{source}: cannot be read: {error.strerror}; make it readable.") from error
        is_there = False
    if not is_there:
        raise UnknownRobotError(
            unknown_name("robot", str(name_or_folder), known)
            + f" A robot folder holds a {FIGURES_FILE}; `bench diagnose -o DIR` writes one as DIR/robot."
        )
    try:
        figures = Figures.model_validate(load_typed_yaml(source))
    except YamlFault as fault:
        raise RobotError(f"{source}: {fault}; {fault.remedy}.") from fault
    except ValidationError as error:
        raise RobotError(problems_of(error, str(source), Figures)) from error
    if faults := [
        f"{source}: {key}: {value:g} is no figure of a robot." for key, value in _too_large(figures.model_dump())
    ]:
        raise RobotError(faults)
    robot = Robot(folder.resolve().name, folder.resolve(), figures)
    if faults := [
        f"{source}: {key}: there is no MJCF (.xml) {name!r} beside it."
        for key, name in (("mjcf", figures.mjcf), ("scene", figures.scene))
        if name is not None and not _is_mjcf(robot.folder / name)
    ]:
        raise RobotError(faults)
    return robot


def _is_mjcf(file: Path) -> bool:
    return file.suffix in MJCF_ENDINGS and file.is_file()


def _too_large(content: object, key: str = "") -> Iterator[tuple[str, float]]:
    """Yield key and value of each number that no figure reaches, in what a model holds."""
    if isinstance(content, dict):
        for name, part in content.items():
            yield from _too_large(part, f"{key}.{name}".lstrip("."))
    elif isinstance(content, list | tuple):
        for i, part in enumerate(content):
            yield from _too_large(part, f"{key}[{i}]")
    elif isinstance(content, int | float) and IMPOSSIBLE < abs(content) < inf:
        yield key, content


def problems_of(error: ValidationError, file: str, model: type[BaseModel] | None = None) -> list[str]:
    """Return one sentence per fault of a pydantic validation as `model`, each with its place in the file."""
    sentences = []
    for fault in faults_of(error):
        keys = [part for part in fault["loc"] if part not in (NUMBER, LIST)]
        place = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in keys).lstrip(".")
        is_told = fault["type"] == "extra_forbidden" or isinstance(fault["input"], dict | list)
        given = "" if is_told else f", not {str(fault['input'])[:80]!r}"
        sentences.append(f"{file}: {place or 'top level'}: {words_of(fault, model)}{given}")
    return sentences
