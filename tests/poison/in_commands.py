"""Commands whose options contradict each other, and names that cannot be written."""

import os
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from tests.poison.in_results import APPLY, FOUND, PREDICT
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


def options_given_twice(rng: np.random.Generator) -> Iterator[Variant]:
    """Give an option twice; the last one counted, and campaigns or files of effects named before were left out."""
    fit, hide = ("identify", ".", "--method", "dynamics"), ("hide", "--none", "--scenario", "line")
    for option, command in {
        "--held-out": (*fit, "--held-out", "one", "--held-out", "other"),
        "--file": ("diagnose", ".", "-o", "out", "--file", "one.py", "--file", "other.py"),
        "--out": ("apply", FOUND, "-o", "one", "--out", "other"),
        "--seed": (*hide, "-o", "../out", "--seed", "1", "--seed=2"),
        "--no-store": ("check", ".", "--store", "--no-store"),
    }.items():
        words = (f"{option}: is given twice",)
        yield Variant("options given twice", option, lambda folder: None, "error", words, command)
    free = (*PREDICT, "--free", "friction", "--free", "payload")
    yield Variant("options given twice", "--free, which may be", lambda folder: None, "harmless", (), free)


def options_that_count_for_nothing(rng: np.random.Generator) -> Iterator[Variant]:
    """Give options that another one makes idle; nothing was said of them."""
    hide, log = ("hide", "--scenario", "line", "-o", "../out"), "runs/loaded-out.csv"
    for option, command in {
        "--joint 3": (*hide, "coulomb_level@2=0.1", "--joint", "3"),
        "--joint 2": (*hide, "--none", "--joint", "2"),
        "--weights": ("identify", ".", "--method", "dynamics", "--weights", "equal"),
        "--reference": ("identify", ".", "--method", "dynamics", "--reference", "first-load"),
        "--parquet": ("convert", "--look", log, "--parquet"),
        "--window-s": ("convert", "--look", log, "--window-s", "0", "1"),
        "LOGS": ("convert", "robot", "runs", "--look", log),
        "--topic": ("convert", "robot", "runs", "-o", "out", "--topic", "/joints"),
    }.items():
        words = (f"{option}: ", "leave it out")
        yield Variant("options that count for nothing", option, lambda folder: None, "error", words, command)


def names_that_are_too_long(rng: np.random.Generator) -> Iterator[Variant]:
    """Name a file by what stands in it, as a variable of the shell may; six of eight ended in a traceback."""
    name = "x" * 5000
    for what, command in {
        "a motion": (*APPLY, "--motion", name),
        "effects": ("diagnose", ".", "-o", "out", "--file", f"{name}.py"),
        "a model": ("new-robot", "mine", "--mjcf", name),
        "a recording": ("view", name),
        "a scenario": ("run", name, "-o", "../out"),
        "a log.yaml": ("convert", "robot", "runs", "-o", "out", "--log", name),
        "a log": ("convert", "--look", name),
        "a campaign": ("check", name),
    }.items():
        words = ("xxx", "File name too long")
        yield Variant("names that are too long", what, lambda folder: None, "error", words, command)


def motions_that_are_too_large(rng: np.random.Generator) -> Iterator[Variant]:
    """Command a motion of more bytes than are read; it ended in a traceback."""

    def spoil(folder: Path) -> None:
        with (folder / "motion.csv").open("wb") as file:
            file.truncate(500_000_001)  # of zeros, which take no room

    words = ("motion.csv", "500 000 001 bytes", "BENCH_MOST_TABLE_BYTES")
    command = (*APPLY, "--motion", "motion.csv")
    yield Variant("motions that are too large", "of zeros", spoil, "error", words, command)


def models_of_the_bench(rng: np.random.Generator) -> Iterator[Variant]:
    """Start a robot from an MJCF whose actuators have several controls, as all of the bench have; a traceback."""
    command = ("new-robot", "mine", "--mjcf", "robot/small.xml", "--joints", "hinge_a", "hinge_b", "-o", "out")
    words = ("2 drives: hinge_a, hinge_b", "left out: 7 actuators, 3 tendons")
    yield Variant("models of the bench", "of a robot folder", lambda folder: None, "harmless", words, command)


FAMILIES = (
    options_given_twice,
    options_that_count_for_nothing,
    names_that_are_too_long,
    motions_that_are_too_large,
    models_of_the_bench,
    the_same_twice,
    filters_that_filter_nothing,
    numbers_that_are_none,
    names_that_are_no_utf_8,
    devices_for_files,
    robots_of_other_campaigns,
    files_that_are_there,
)
