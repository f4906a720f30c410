"""Spoil a copy of the base, run a command on it, and hold the answer against the right one."""

import os
import re
import shutil
import signal
import subprocess
import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from dataclasses import dataclass, replace
from io import StringIO
from pathlib import Path
from tempfile import mkdtemp
from time import monotonic
from types import FrameType
from typing import Literal

import numpy as np

from bench.cli import main
from bench.diagnose.cross_validation.predicted_error import PredictedError
from bench.hide.campaign import hide_campaign
from bench.predict.promises import write_promises
from bench.record.write import write_campaign
from bench.report.diagnosis.file_names import ROBOT
from bench.robot.folder import load_robot
from tests.found import write_found
from tests.poison import (
    in_channels,
    in_commands,
    in_cross_checks,
    in_effects,
    in_files,
    in_loads,
    in_manifests,
    in_models,
    in_parquet,
    in_readings,
    in_refusals,
    in_results,
    in_robots,
    in_runs,
    in_scenarios,
    in_statistics,
    in_stops,
    in_tables,
    in_values,
)
from tests.poison.variant import Family, Variant
from tests.simulate.session_small import QUICK, small_session
from tests.small_robot import write_small_robot

LONGEST_S = 20.0  # the wall clock of one variant
MOST_LINES = 50  # of a check; what is longer than a screen is not read
SEED = 20261122
FAMILIES: Sequence[Family] = (
    *(*in_tables.FAMILIES, *in_channels.FAMILIES, *in_cross_checks.FAMILIES, *in_runs.FAMILIES),
    *(*in_manifests.FAMILIES, *in_files.FAMILIES, *in_parquet.FAMILIES, *in_readings.FAMILIES, *in_models.FAMILIES),
    *(*in_stops.FAMILIES, *in_statistics.FAMILIES, *in_values.FAMILIES),
    *(*in_robots.FAMILIES, *in_scenarios.FAMILIES, *in_results.FAMILIES, *in_loads.FAMILIES, *in_commands.FAMILIES),
    *(*in_refusals.FAMILIES, *in_effects.FAMILIES),
)
PROMISE = PredictedError("current_1_a", "A", "motion", 4, 0.02, 0.01, 0.05)
Kind = Literal["right", "silent", "wrong", "traceback", "hang"]


@dataclass(frozen=True)
class Outcome:
    """What came of a variant.

    Attributes:
        variant: What was spoilt.
        kind: "right"; "silent": a fault that nothing was said of; "wrong": another answer than the right one, or
            without its place; "traceback"; "hang".
        said: What the command printed.
        seconds: It took.
    """

    variant: Variant
    kind: Kind
    said: str
    seconds: float


def variants(seed: int = SEED) -> list[Variant]:
    """Return all variants of a seed."""
    return [variant for family in FAMILIES for variant in family(np.random.default_rng(seed))]


def write_base(folder: Path) -> Path:
    """Write a healthy campaign with its robot in it, and what a diagnosis left of that robot."""
    robot = write_small_robot(folder / "robot")
    session = small_session(robot, loading=QUICK | {"repeats": 5})
    hidden = hide_campaign(load_robot(robot), session, (), np.random.default_rng(1))
    write_campaign(replace(hidden.campaign, robot="robot"), folder / "base")
    write_found(robot, folder / "base" / in_results.FOUND)
    for table in (folder / "base" / in_results.FOUND).glob("*.csv"):
        table.unlink()  # no command reads it, and in the folder of a campaign it is a table that no run names
    write_promises(folder / "base" / in_results.FOUND / ROBOT, [PROMISE])
    shutil.move(robot, folder / "base" / "robot")
    return folder / "base"


def run(variant: Variant, base: Path) -> Outcome:
    """Try one variant in a copy of the base."""
    place = mkdtemp()
    try:
        folder = Path(place) / "campaign"
        shutil.copytree(base, folder)
        variant.spoil(folder)
        begin = monotonic()
        code, said = _run(variant.command, folder)
        seconds = monotonic() - begin
        leftovers = [entry.name for entry in folder.parent.iterdir() if entry.name.startswith(".")]
    finally:
        subprocess.run(["rm", "-rf", place], check=True)  # folders 1200 deep are too much for shutil
    if code == "hang" or seconds > LONGEST_S:
        return Outcome(variant, "hang", said, seconds)
    if code == "traceback" or leftovers:
        return Outcome(variant, "traceback", said + "".join(leftovers), seconds)
    return Outcome(variant, _judged(variant, int(code), said), said, seconds)


def _judged(variant: Variant, code: int, said: str) -> Kind:
    flat = " ".join(said.split())
    missing = [place for place in variant.places if place not in flat]
    worst = {label for label in ("error", "failed check") if re.search(rf"^{label}", said, re.MULTILINE)}
    is_doubt = code == 3 and worst == {"failed check"}  # an error outranks it
    is_error = code in (2, 3, 4) and not is_doubt
    is_harmless = code == 0 and not worst
    fits = {
        "error": is_error,
        "doubt": is_doubt,
        "harmless": is_harmless,
        "error or harmless": is_error or is_doubt or is_harmless,
    }[variant.answer]
    is_clean = "Warning:" not in said  # Python's own; nobody can act on it
    is_short = variant.command[0] != "check" or len(said.splitlines()) <= MOST_LINES
    if fits and not missing and is_clean and is_short:
        return "right"
    return "silent" if code == 0 and variant.answer in ("error", "doubt") else "wrong"


def _run(command: Sequence[str], folder: Path) -> tuple[str, str]:
    """Run a command in a folder; return its exit code, "traceback" or "hang", and what it printed."""
    said = StringIO()
    before = Path.cwd()
    os.chdir(folder)
    try:
        with _no_longer_than(2 * LONGEST_S), redirect_stdout(said), redirect_stderr(said):
            return str(main(list(command))), said.getvalue()
    except SystemExit as ended:
        return str(ended.code), said.getvalue()
    except TimeoutError:
        return "hang", said.getvalue()
    except Exception:  # noqa: BLE001  whatever comes out of a command is what is looked for here
        return "traceback", said.getvalue() + traceback.format_exc()
    finally:
        os.chdir(before)


@contextmanager
def _no_longer_than(seconds: float) -> Iterator[None]:
    def heard(number: int, frame: FrameType | None) -> None:
        raise TimeoutError

    before = signal.signal(signal.SIGALRM, heard)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
