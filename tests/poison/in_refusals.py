"""What a sixth poisoner found: folders without a robot, sizes without a unit, one-sided drives, coarse encoders."""

import shutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from bench.report.diagnosis.file_names import ROBOT, VERDICT
from bench.robot.folder import FIGURES_FILE
from tests import stranger
from tests.poison.in_results import APPLY, FOUND, GIVEN, PREDICT
from tests.poison.variant import Sheet, Variant, in_column, tables

COMPARE = ("compare", ".", ".", "--robot", FOUND)
STARTED = ("new-robot", "mine", "--mjcf", "arm.xml", "-o", "out")


def diagnoses_without_a_robot(rng: np.random.Generator) -> Iterator[Variant]:
    """Give what a diagnosis left that ended before anything was weighed; it was an unknown robot."""

    def spoil(folder: Path) -> None:
        shutil.rmtree(folder / FOUND / ROBOT)
        (folder / FOUND / VERDICT).write_text("{}")

    for command in (PREDICT, APPLY, GIVEN, COMPARE):
        words = (FOUND, "handed no robot over")
        yield Variant("diagnoses without a robot", command[0], spoil, "error", words, command)


def robots_that_cannot_be_read(rng: np.random.Generator) -> Iterator[Variant]:
    """Give a robot folder whose figures are no file; it was an unknown robot."""

    def loop(folder: Path) -> None:
        (folder / "robot" / FIGURES_FILE).unlink()
        (folder / "robot" / FIGURES_FILE).symlink_to(FIGURES_FILE)

    def nested(folder: Path) -> None:
        (folder / "robot" / FIGURES_FILE).unlink()
        (folder / "robot" / FIGURES_FILE).mkdir()

    for name, spoil, words in (("a loop of links", loop, "symbolic links"), ("a folder", nested, "is a folder")):
        for command in (("check", "."), ("apply", "robot", "-o", "out")):
            places = (FIGURES_FILE, words)
            yield Variant("robots that cannot be read", f"{name}, {command[0]}", spoil, "error", places, command)


def sizes_without_a_unit(rng: np.random.Generator) -> Iterator[Variant]:
    """Limit the store by a bare number; five was five bytes, and all that was kept was removed."""
    for size in ("5", "500", "1.5", "\u0665MB", "9" * 400 + "GB"):
        command = ("store", "--limit", size)
        yield Variant("sizes without a unit", size[:9], lambda folder: None, "error", (size[:9],), command)


def recordings_of_some_runs(rng: np.random.Generator) -> Iterator[Variant]:
    """Name a recording in some runs; the others silently were one more."""
    for which in (1, 2):

        def spoil(folder: Path, which: int = which) -> None:
            file = folder / "campaign.yaml"
            parts = file.read_text().split("- name: ")
            parts[which] = parts[which].replace("  start_s:", "  recording: may\n  start_s:", 1)
            file.write_text("- name: ".join(parts))

        words = ("campaign.yaml", "recording: is missing, and other runs have one")
        yield Variant("recordings of some runs", f"run {which}", spoil, "error", words)


def drives_that_cannot_be(rng: np.random.Generator) -> Iterator[Variant]:
    """Start a robot of drives that pull one way, or about an axis beyond numbers (a traceback)."""
    for name, old, new, words in (
        ("one way", 'forcerange="-250.0 250.0"', 'forcerange="-250 0"', "a drive pulls both ways"),
        ("never at rest", 'forcerange="-250.0 250.0"', 'forcerange="10 250"', "a drive pulls both ways"),
        ("an axis of 1e300", 'name="j1" axis="0 0 1"', 'name="j1" axis="1e300 1e300 0"', "length of its axis"),
    ):

        def spoil(folder: Path, old: str = old, new: str = new) -> None:
            (folder / "arm.xml").write_text(stranger.mjcf().replace(old, new))

        yield Variant("drives that cannot be", name, spoil, "error", ("arm.xml", words), STARTED)


def coarse_encoders(rng: np.random.Generator) -> Iterator[Variant]:
    """Read motor angles in coarse steps: nothing was said of 1 mrad, and of 10 mrad that rows were lost."""
    for step in (1e-3, 1e-2):
        spoil = in_column(lambda v, step=step: np.round(v / step) * step, "q_motor_1_rad")
        words = ("q_motor_1_rad: reads in steps of", "resolution_rad")
        yield Variant("coarse encoders", f"steps of {step:g} rad", spoil, "harmless", words)


def copies_with_noise(rng: np.random.Generator) -> Iterator[Variant]:
    """Copy a run, and give it far less noise than its instruments have: it counted twice."""

    def spoil(folder: Path) -> None:
        motions = [file for file in tables(folder) if "pose" not in Sheet(file).names]
        names, *rows = (line.split(",") for line in motions[0].read_text().splitlines())
        draws = np.random.default_rng(1)
        values = np.array(rows, dtype=float)
        for column, name in enumerate(names):
            if name.startswith(("current", "reflector", "force", "moment", "gas_pressure")):
                values[:, column] += 1e-5 * np.ptp(values[:, column]) * draws.normal(size=len(values))
        lines = [",".join(names), *(",".join(map(repr, row)) for row in values.tolist())]
        motions[1].write_text("\n".join(lines) + "\n")

    words = ("holds the same readings as",)
    yield Variant("copies with noise", "1e-5 of each range", spoil, "doubt", words)


FAMILIES = (
    diagnoses_without_a_robot,
    robots_that_cannot_be_read,
    sizes_without_a_unit,
    recordings_of_some_runs,
    drives_that_cannot_be,
    coarse_encoders,
    copies_with_noise,
)
