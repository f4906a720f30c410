"""What a diagnosis left, handed on: numbers that nobody can check one by one, cut, changed, or of another robot."""

import json
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from bench.predict.promises import PROMISES
from bench.report.handover.posterior_file import POSTERIOR
from tests.poison.variant import Spoil, Variant

FOUND = "found"  # beside the tables of the base
PREDICT = ("predict", FOUND, ".")
GIVEN = ("diagnose", ".", "--given", FOUND, "-o", "out", "--at-most", "5")
APPLY = ("apply", FOUND, "-o", "out")
COMMANDS = {PROMISES: PREDICT, POSTERIOR: GIVEN}
ODD = (None, True, -1, 0, 1e308, 1e-320, float("nan"), float("inf"), "x", "\x1b[31m", [], {}, [[]], "x" * 100_000)


def _leaves(content: Any, place: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    yield place
    if isinstance(content, dict):
        for key, part in content.items():
            yield from _leaves(part, (*place, key))
    elif isinstance(content, list):
        for i in range(min(len(content), 2)):
            yield from _leaves(content[i], (*place, i))


def _changed(name: str, change: Callable[[Any], Any]) -> Spoil:
    def spoil(folder: Path) -> None:
        file = folder / FOUND / "robot" / name
        file.write_text(json.dumps(change(json.loads(file.read_text()))))

    return spoil


def _anywhere(name: str, seed: int) -> Spoil:
    """Put something odd at a place that the seed chooses, or take that place out."""

    def change(content: Any) -> Any:
        rng = np.random.default_rng(seed)
        places = [place for place in _leaves(content) if place]
        *way, last = places[int(rng.integers(len(places)))]
        part = content
        for key in way:
            part = part[key]
        if rng.random() < 0.2:
            del part[last]
            return content
        odd = [value for value in ODD if repr(value) != repr(part[last])]
        part[last] = odd[int(rng.integers(len(odd)))]
        return content

    return _changed(name, change)


def _bytes(name: str, change: Callable[[bytes], bytes]) -> Spoil:
    def spoil(folder: Path) -> None:
        file = folder / FOUND / "robot" / name
        file.write_bytes(change(file.read_bytes()))

    return spoil


def _in_place(name: str, put: Callable[[Path], object]) -> Spoil:
    def spoil(folder: Path) -> None:
        file = folder / FOUND / "robot" / name
        file.unlink()
        put(file)

    return spoil


def numbers_of_a_diagnosis(rng: np.random.Generator) -> Iterator[Variant]:
    for name, command in COMMANDS.items():
        for k in range(12):
            spoil = _anywhere(name, int(rng.integers(2**31)))
            yield Variant("numbers of a diagnosis", f"{name}, number {k}", spoil, "error", (name,), command)
        twice = _bytes(name, lambda data: data.replace(b'"format": 1', b'"format": 1, "format": 1'))
        yield Variant("numbers of a diagnosis", f"{name}, a key twice", twice, "error", (name, "twice"), command)


def files_of_a_diagnosis(rng: np.random.Generator) -> Iterator[Variant]:
    puts: dict[str, Callable[[Path], object]] = {
        "a folder": lambda file: file.mkdir(),
        "a pipe": lambda file: os.mkfifo(file),
        "a device": lambda file: file.symlink_to("/dev/zero"),
        "a loop of links": lambda file: file.symlink_to(file.name),
        "a link to nothing": lambda file: file.symlink_to("nowhere"),
        "nothing": lambda file: file.write_text(""),
        "brackets": lambda file: file.write_text("[" * 100_000),
        "random bytes": lambda file: file.write_bytes(np.random.default_rng(1).bytes(1000)),
    }
    for name, command in COMMANDS.items():
        for what, put in puts.items():
            yield Variant("files of a diagnosis", f"{name}: {what}", _in_place(name, put), "error", (name,), command)
        half = _bytes(name, lambda data: data[: len(data) // 2])
        yield Variant("files of a diagnosis", f"{name}: cut", half, "error", (name,), command)
    away = _in_place(POSTERIOR, lambda file: None)
    yield Variant("files of a diagnosis", "no posterior", away, "error", (POSTERIOR, "does not exist"), GIVEN)
    other = _bytes("small.xml", lambda data: data.replace(b'name="fore"', b'name="fore" '))
    yield Variant("files of a diagnosis", "another robot", other, "error", ("was changed after",), GIVEN)
    for name in ("small.xml", "figures.yaml"):
        gone = _in_place(name, lambda file: None)
        for command in (PREDICT, GIVEN, APPLY):
            yield Variant("files of a diagnosis", f"no {name}: {command[0]}", gone, "error", (FOUND,), command)


FAMILIES = (numbers_of_a_diagnosis, files_of_a_diagnosis)
