"""What stands in a folder in place of a file: pipes, devices, folders, links."""

import gzip
import os
import socket
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from tests.poison.variant import Variant

TABLE = "runs/dwell.csv"


def _socket(path: Path) -> None:
    here = Path.cwd()
    os.chdir(path.parent)  # a socket's path has a hundred characters at most
    with socket.socket(socket.AF_UNIX) as made:
        made.bind(path.name)
    os.chdir(here)


def _loop(path: Path) -> None:
    other = path.with_name("other")
    path.symlink_to(other)
    other.symlink_to(path)


def _sparse(path: Path) -> None:
    with path.open("wb") as file:
        file.truncate(10**11)


KINDS: dict[str, tuple[Callable[[Path], None], str]] = {
    "a named pipe": (os.mkfifo, "is a named pipe"),
    "a folder": (Path.mkdir, "is a folder"),
    "a socket": (_socket, "is a socket"),
    "a loop of links": (_loop, "cannot be read"),
    "a link to nowhere": (lambda path: path.symlink_to("nowhere"), "cannot be read"),
    "100 GB of nothing": (_sparse, "more than"),
    "nothing": (lambda path: None, "cannot be read"),
}
DEVICES = ("/dev/zero", "/dev/random", "/dev/tty", "/proc/self/mem", "/proc/self/pagemap", "/etc/shadow")


def _in_place_of(family: str, file: str, words: str = "") -> Iterator[Variant]:
    for name, (make, said) in KINDS.items():

        def spoil(folder: Path, make: Callable[[Path], None] = make) -> None:
            (folder / file).unlink()
            make(folder / file)

        yield Variant(family, name, spoil, "error", (Path(file).name, words or said))
    for device in DEVICES:

        def link(folder: Path, device: str = device) -> None:
            (folder / file).unlink()
            (folder / file).symlink_to(device)

        yield Variant(family, f"a link to {device}", link, "error", (Path(file).name,))


def in_place_of_a_table(rng: np.random.Generator) -> Iterator[Variant]:
    for variant in _in_place_of("in place of a table", TABLE):
        places = ("campaign.yaml",) if "a link to /" in variant.name else variant.places  # is outside
        places = ("dwell",) if "link" in variant.name else places
        yield Variant(variant.family, variant.name, variant.spoil, "error", places)


def other_files_named_csv(rng: np.random.Generator) -> Iterator[Variant]:
    """Rename what is no text, or no table, to .csv."""
    begins = {
        "a workbook": (b"PK\x03\x04" + rng.bytes(500), "is a workbook"),
        "a compressed table": (gzip.compress(b"time_s\n1\n"), "is compressed by gzip"),
        "a pointer": (
            b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 1\n",
            "is a pointer of Git LFS",
        ),
    }
    for name, (content, words) in begins.items():

        def spoil(folder: Path, content: bytes = content) -> None:
            (folder / TABLE).write_bytes(content)

        yield Variant("other files named .csv", name, spoil, "error", (TABLE, words))


def in_place_of_a_manifest(rng: np.random.Generator) -> Iterator[Variant]:
    yield from _in_place_of("in place of a manifest", "campaign.yaml")


def in_place_of_a_robots_file(rng: np.random.Generator) -> Iterator[Variant]:
    yield from _in_place_of("in place of figures.yaml", "robot/figures.yaml", "robot")
    for variant in _in_place_of("in place of the MJCF", "robot/small.xml", "small.xml"):
        yield Variant(variant.family, variant.name, variant.spoil, variant.answer, variant.places)


def odd_folders(rng: np.random.Generator) -> Iterator[Variant]:
    def deep(folder: Path) -> None:
        here = Path.cwd()
        os.chdir(folder)
        for _ in range(1200):
            Path("d").mkdir()
            os.chdir("d")
        os.chdir(here)

    def crowd(folder: Path) -> None:
        (folder / "many").mkdir()
        for i in range(3000):
            (folder / "many" / f"{i}.txt").touch()

    def bytes_in_names(folder: Path) -> None:
        (Path(os.fsdecode(bytes(folder) + b"/\xff\xfe.csv"))).touch()

    tricks: dict[str, tuple[Callable[[Path], None], tuple[str, ...]]] = {
        "a loop of folders": (lambda folder: (folder / "again").symlink_to(folder), ()),
        "a loop of links": (lambda folder: _loop(folder / "again.csv"), ()),
        "a link to the root": (lambda folder: (folder / "root").symlink_to("/"), ()),
        "a pipe that nobody names": (lambda folder: os.mkfifo(folder / "pipe.csv"), ("pipe.csv",)),
        "folders 1200 deep": (deep, ()),
        "a crowd of files": (crowd, ()),
        "a table that nobody names": (lambda folder: (folder / "x.csv").touch(), ("x.csv",)),
        "a name that is no text": (bytes_in_names, ("no run names",)),
        "a name with a line break": (lambda folder: (folder / "a\nb.csv").touch(), ("no run names",)),
    }
    for name, (spoil, places) in tricks.items():
        yield Variant("odd folders", name, spoil, "harmless", places)


FAMILIES = (in_place_of_a_table, other_files_named_csv, in_place_of_a_manifest, in_place_of_a_robots_file, odd_folders)
