"""Files that an MJCF names, copied into another robot folder."""

import filecmp
import shutil
from collections.abc import Iterable
from pathlib import Path, PurePath

import mujoco

from bench.errors import RobotError

ASSETS = "assets"


def copy_assets(spec: mujoco.MjSpec, base: Path, folder: Path) -> None:
    """Copy meshes, textures, height fields and skins, and point the spec at the copies.

    Args:
        spec: It is changed, and then belongs to the folder.
        base: Folder of the file that it was read from.
        folder: Where to; the copies stand in `assets` in it.

    Raises:
        RobotError: A file is not there.
    """
    named = False
    for directory, elements in (
        (spec.meshdir, (*spec.meshes, *spec.hfields, *spec.skins)),
        (spec.texturedir or spec.meshdir, spec.textures),
    ):
        for element in elements:
            if element.file:
                element.file, named = _copy(element.file, (base / directory, base), folder), True
    for texture in spec.textures:
        files = list(texture.cubefiles)
        places = (base / spec.texturedir, base)
        texture.cubefiles = [_copy(file, places, folder) if file else "" for file in files]
        named = named or any(files)
    spec.meshdir = spec.texturedir = ASSETS if named else ""
    spec.modelfiledir = str(folder)


def _copy(file: str, places: Iterable[Path], folder: Path) -> str:
    """Copy one file, keeping its folder where it has one below the robot's; return its new path in the assets."""
    pure = PurePath(file)
    target = pure.name if pure.is_absolute() or ".." in pure.parts else pure.as_posix()
    for place in places:
        for candidate in (place / file, place / pure.name):
            if candidate.is_file():
                copy = folder / ASSETS / target
                if pure.is_absolute() and copy.exists() and not filecmp.cmp(copy, candidate, shallow=False):
                    target = f"{candidate.parent.name}_{target}"
                    copy = folder / ASSETS / target
                copy.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(candidate, copy)
                return target
    raise RobotError(f"{file}: the robot's file names it, but it was not found beside it.")
