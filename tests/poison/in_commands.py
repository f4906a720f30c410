"""Commands whose options contradict each other, and names that cannot be written."""

import os
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from tests.poison.in_results import PREDICT
from tests.poison.in_scenarios import LOG, ROWS
from tests.poison.variant import Variant


def the_same_twice(rng: np.random.Generator) -> Iterator[Variant]:
    """Give one thing twice; the last one counted."""
    hide = ("hide", "--scenario", "line", "-o", "../out")
    for first, second in (("gas_loss=0.1", "gas_loss=0.2"), ("coulomb_level@2=0.2", "coulomb_level@joint2:change=0.3")):
        command = (*hide, first, second)
        yield Variant("the same twice", f"{first} {second}", lambda folder: None, "error", (second, "twice"), command)
    fit = ("identify", ".", "--method", "dynamics")
    held_out = (*fit, "--held-out", ".")
    yield Variant("the same twice", "fitted and held out", lambda folder: None, "error", (".", "twice"), held_out)


def filters_that_filter_nothing(rng: np.random.Generator) -> Iterator[Variant]:
    """Ask for a low-pass that no sampling rate has."""
    for cutoff in ("1e9", "inf", "nan", "0"):
        command = ("identify", ".", "--method", "dynamics", "--cutoff-hz", cutoff)
        place = ("cut-off",)
        yield Variant("filters that filter nothing", cutoff, lambda folder: None, "error", place, command)


def numbers_that_are_none(rng: np.random.Generator) -> Iterator[Variant]:
    """Ask what numbers of the code move that nobody named so; the answer was nothing, and success."""
    for pattern in ("zzz", ""):
        command = ("study", "-o", "../study", f"--vary={pattern}")
        words = (f"--vary {pattern}: no number is named so",) if pattern else ("--vary", "no number is named so")
        yield Variant("numbers that are none", repr(pattern), lambda folder: None, "error", words, command)


def names_that_are_no_utf_8(rng: np.random.Generator) -> Iterator[Variant]:
    """Give commands that write such names; one ended in a traceback after minutes of simulation."""
    odd, shown = os.fsdecode(b"ru\xff"), r"ru\xff: is no UTF-8"
    for name, command in {
        "of a run": ("run", "line", "-o", f"../{odd}"),
        "of a robot": ("new-robot", "mine", "--mjcf", "robot/small.xml", f"--out={odd}"),
        "of a hidden campaign": ("hide", "gas_loss", "--scenario", "line", "-o", f"../{odd}/new"),
        "of a first pass": ("identify", ".", "--method", "dynamics", "-o", odd),
        "of the results of the paper": ("paper", "-o", odd),
        "of what is diagnosed": ("diagnose", odd, "-o", "out"),
        "of a model": ("new-robot", "mine", "--mjcf", odd),
    }.items():
        places = (shown,) if "/new" not in command[-1] else (r"ru\xff/new: is no UTF-8",)
        yield Variant("names that are no UTF-8", name, lambda folder: None, "error", places, command)

    def log(folder: Path) -> None:
        (folder / "logs").mkdir()
        (folder / "robot" / "log.yaml").write_text(LOG)
        (folder / "logs" / f"{odd}.csv").write_text(ROWS)

    command = ("convert", "robot", "logs", "-o", "out")
    yield Variant("names that are no UTF-8", "of a log", log, "error", (r"ru\xff.csv: is no UTF-8",), command)


def devices_for_files(rng: np.random.Generator) -> Iterator[Variant]:
    """Name what is there and no file; it was called missing."""
    for file, words in (("/dev/zero", "is a device"), ("pipe", "is a named pipe")):
        for name, command in {
            "a model": ("new-robot", "mine", "-o", "out", "--mjcf", file),
            "a log.yaml": ("convert", "robot", "log.csv", "-o", "out", "--log", file),
        }.items():

            def spoil(folder: Path) -> None:
                (folder / "log.csv").write_text(ROWS)
                os.mkfifo(folder / "pipe")

            yield Variant("devices for files", f"{file} for {name}", spoil, "error", (f"{file}: {words}",), command)


def robots_of_other_campaigns(rng: np.random.Generator) -> Iterator[Variant]:
    """Hold a campaign against a nominal robot with other drives; it ended in a traceback."""
    for robot, words in (("hh150", "no angle of drive 3, 4, 5, 6"), ("emps", "joint 1 is a slide")):
        command = (*PREDICT, "--nominal", robot)
        places = (f"--nominal {robot}", words)
        yield Variant("robots of other campaigns", robot, lambda folder: None, "error", places, command)


def files_that_are_there(rng: np.random.Generator) -> Iterator[Variant]:
    """Name what is there as a file to write; a manifest was replaced, a folder ended in a traceback."""
    for out in ("campaign.yaml", "runs", "robot/figures.yaml", "link"):
        for name, command in {
            "poses": ("poses", "--robot", "robot", "-n", "3"),
            "a log.yaml": ("convert", "--look", "log.csv", "--robot", "robot"),
        }.items():

            def spoil(folder: Path) -> None:
                (folder / "log.csv").write_text(ROWS)
                (folder / "link").symlink_to("nowhere")

            words = (f"{out}: is there already",)
            yield Variant("files that are there", f"{out} for {name}", spoil, "error", words, (*command, "-o", out))


FAMILIES = (
    the_same_twice,
    filters_that_filter_nothing,
    numbers_that_are_none,
    names_that_are_no_utf_8,
    devices_for_files,
    robots_of_other_campaigns,
    files_that_are_there,
)
