"""A stranger's MJCF or URDF as text, looked through before MuJoCo's parser sees it.

What is refused here has a line; what only the parser finds out is tried in a process of its own (`trial.py`).
"""

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from xml.parsers import expat

from bench.errors import UNPRINTABLE, RobotError
from bench.record.limits import ASSET_BYTES, MODEL_BYTES, MODEL_COPIES, MODEL_DEPTH, MODEL_ELEMENTS, MODEL_INCLUDES
from bench.record.plain_file import FileFault, expect_plain, read_plain

COPIED = ("replicate", "composite", "flexcomp")  # elements that stand for `count` of what is in them
REMEDY = "give the file that `xacro ARM.xacro > ARM.urdf` makes"
DIRECTORIES = ("meshdir", "texturedir", "assetdir")  # attributes of <compiler>
XACRO = ("${", "$(")  # begin what xacro fills in
OURS, WORDS = "bench.", ("element",)  # plugins of the bench, and what of their attributes is no number
_NAN = re.compile(r"(?:^|\s)[+-]?(nan|inf)(?:inity|\(\w*\))?(?=\s|$)", re.IGNORECASE)


def look_through(file: Path) -> None:
    """Look through a file and all that it includes.

    Raises:
        RobotError: It is not XML, has entities, nests too deep, includes too much, copies too often, has numbers that
            are none or names that no line holds, is meant for xacro, or names files that are no plain files; with file
            and line.
    """
    _Reader(file).read(file, depth=0)


class _Reader:
    """Keeps count over all files of one model."""

    def __init__(self, main: Path) -> None:
        self._folder = main.parent
        self._bytes = 0
        self._elements = 0
        self._seen: set[Path] = set()
        self._directories = {Path()}

    def read(self, file: Path, depth: int) -> None:
        self._seen.add(file.resolve())
        if MODEL_INCLUDES.exceeded(len(self._seen) - 1) or MODEL_INCLUDES.exceeded(depth):
            raise RobotError(f"{file}: more than {MODEL_INCLUDES}; {MODEL_INCLUDES.remedy}.")
        try:
            data = read_plain(file, MODEL_BYTES)
        except FileFault as fault:
            raise RobotError(f"{file}: {fault}; {fault.remedy}.") from fault
        self._bytes += len(data)
        if MODEL_BYTES.exceeded(self._bytes):
            raise RobotError(f"{file}: with its includes more than {MODEL_BYTES}; {MODEL_BYTES.remedy}.")
        parser = expat.ParserCreate("utf-8")
        included: list[str] = []
        copies: list[int] = [1]
        plugins: list[str] = [""]  # of each element that is open, by which plugin it is

        def refuse(what: str, remedy: str) -> None:
            raise RobotError(f"{file}: line {parser.CurrentLineNumber}: {what}; {remedy}.")

        def begin(tag: str, attributes: Mapping[str, str]) -> None:
            self._elements += 1
            if MODEL_ELEMENTS.exceeded(self._elements):
                refuse(f"more than {MODEL_ELEMENTS}", MODEL_ELEMENTS.remedy)
            if MODEL_DEPTH.exceeded(len(copies)):
                refuse(f"more than {MODEL_DEPTH} of elements in each other", MODEL_DEPTH.remedy)
            copies.append(copies[-1] * (_count(attributes) if tag in COPIED else 1))
            if MODEL_COPIES.exceeded(copies[-1]):
                refuse(f"<{tag}> makes more than {MODEL_COPIES}", MODEL_COPIES.remedy)
            plugins.append(attributes.get("plugin", plugins[-1]))
            if tag == "config" and plugins[-1].startswith(OURS) and attributes.get("key") not in WORDS:
                for word in attributes.get("value", "").split():
                    if not _is_decimal(word):  # the engine takes hexadecimal ones
                        refuse(
                            f"{attributes.get('key')} is {word[:40]!r}, which is no number", "write it as 900 or 9e2"
                        )
            if tag.startswith("xacro:"):
                refuse(f"<{tag}> is for xacro", REMEDY)
            for name, value in attributes.items():
                if any(sign in value for sign in XACRO):
                    refuse(f"<{tag}>: {name} holds {value[:40]!r}, which is for xacro", REMEDY)
                if name == "name" and ("\n" in value or UNPRINTABLE.search(value)):
                    refuse(f"<{tag}>: name {value[:40]!r} has a line break or control character", "give another name")
                if "\ufffd" in value:
                    refuse(f"<{tag}>: {name} is not UTF-8", "save the file as UTF-8")
                if name != "name" and (found := _NAN.search(value)):
                    word = found[1].lower()
                    if word == "nan" or not name.endswith("range"):  # a range may be open
                        refuse(f"<{tag}>: {name} holds {word}", "write a number")
            if tag == "compiler":
                self._directories |= {Path(attributes[name]) for name in DIRECTORIES if name in attributes}
            if tag == "include" and "file" in attributes:
                included.append(attributes["file"])
            else:
                for name in ("file", "filename"):
                    if name in attributes:
                        self._expect_plain(attributes[name], refuse)

        def end(tag: str) -> None:
            copies.pop()
            plugins.pop()

        parser.StartElementHandler, parser.EndElementHandler = begin, end
        parser.StartDoctypeDeclHandler = lambda *_: refuse("has a document type", "remove it; entities are not read")
        try:
            parser.Parse(data.decode("utf-8", "replace").encode(), True)
        except expat.ExpatError as error:
            raise RobotError(
                f"{file}: line {error.lineno}: not XML ({expat.ErrorString(error.code)}); correct that line."
            ) from error
        for name in included:
            for place in dict.fromkeys((self._folder / name, file.parent / name)):  # MuJoCo's own rule has changed
                if place.exists() and place.resolve() not in self._seen:
                    self.read(place, depth + 1)

    def _expect_plain(self, name: str, refuse: Callable[[str, str], None]) -> None:
        """Refuse a mesh or texture that is a pipe, a device or endless; one that is not there is MuJoCo's to name."""
        for directory in self._directories:
            for place in (self._folder / directory / name, self._folder / directory / Path(name).name):
                if place.exists():
                    try:
                        expect_plain(place, ASSET_BYTES)
                    except FileFault as fault:
                        refuse(f"{name} {fault}", fault.remedy)


def _is_decimal(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return "_" not in word


def _count(attributes: Mapping[str, str]) -> int:
    """Return how many copies an element makes: the product of the numbers of `count`."""
    product = 1
    for word in attributes.get("count", "1").split():
        product *= max(int(word), 1) if word.isascii() and word.isdigit() and len(word) < 19 else 1
        if len(word) >= 19:
            return MODEL_COPIES.value + 1
    return product
