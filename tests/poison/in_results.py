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


def motions_to_apply(rng: np.random.Generator) -> Iterator[Variant]:
    """Give `bench apply` what no robot is commanded; a sound motion passes, however its clock begins."""
    family, command = "motions to apply", (*APPLY, "--motion", "motion.csv")
    time = np.arange(101) / 100
    turn = 2 * np.pi
    names = "time_s,q_cmd_1_rad,q_cmd_2_rad,velocity_1,velocity_2,acceleration_1,acceleration_2"
    sound = np.stack(
        [
            time,
            0.2 * (1 - np.cos(turn * time)),
            0 * time,
            0.2 * turn * np.sin(turn * time),
            0 * time,
            0.2 * turn**2 * np.cos(turn * time),
            0 * time,
        ],
        axis=1,
    )

    def given(column: int = 0, factor: float = 1.0, offset: float = 0.0, columns: int = 7) -> Spoil:
        def spoil(folder: Path) -> None:
            rows = sound.copy()
            rows[:, column] = factor * rows[:, column] + offset
            lines = [
                ",".join(names.split(",")[:columns]),
                *(",".join(map(repr, row[:columns])) for row in rows.tolist()),
            ]
            (folder / "motion.csv").write_text("\n".join(lines) + "\n")

        return spoil

    faults: dict[str, tuple[Spoil, str]] = {
        "a clock in nanoseconds": (given(factor=1e9, columns=3), "time_s: goes on by 1e+07 s"),
        "a clock in milliseconds": (given(factor=1e3, columns=3), "time_s: goes on by 10 s"),
        "a clock in kiloseconds": (given(factor=1e-3, columns=3), "time_s: makes a joint"),
        "a clock of 1e-11 s a row": (given(factor=1e-9, columns=3), "time_s: goes on by 1e-11 s"),
        "a clock of nan": (given(factor=float("nan"), columns=3), "time_s"),
        "a clock that stands": (given(factor=0, columns=3), "time_s: has to grow"),
        "angles in degrees": (given(1, 57.3), "q_cmd_1_rad"),
        "speeds in degrees": (given(3, 57.3), "velocity_1"),
        "speeds of another sign": (given(3, -1), "velocity_1"),
        "speeds of nan": (given(3, float("nan")), "velocity_1"),
        "accelerations in degrees": (given(5, 57.3), "acceleration_1"),
    }
    for name, (spoil, place) in faults.items():
        yield Variant(family, name, spoil, "error", ("motion.csv", place), command)
    yield Variant(family, "nothing", given(), "harmless", (), command)

    def lost(folder: Path) -> None:
        given(columns=3)(folder)
        lines = (folder / "motion.csv").read_text().splitlines()
        (folder / "motion.csv").write_text("\n".join([*lines[:30], *lines[70:]]) + "\n")

    yield Variant(
        family, "0.4 s of rows lost", lost, "harmless", ("time_s: 0.41 s pass before row 30", "lost rows?"), command
    )
    yield Variant(family, "a clock that counts since 1970", given(offset=1.7e9, columns=3), "harmless", (), command)
    for mass, answer in (("-1", "error"), ("nan", "error"), ("1e9", "error"), ("4000", "error"), ("30", "harmless")):
        spoil, place = given(), ("--payload-kg",) if answer == "error" else ()
        yield Variant(family, f"{mass} kg", spoil, answer, place, (*APPLY, f"--payload-kg={mass}"))  # type: ignore[arg-type]


FAMILIES = (numbers_of_a_diagnosis, files_of_a_diagnosis, motions_to_apply)
