"""The paper beside the virtual robot: Table 5 and the loading experiment, by every method."""

import csv
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.identify.estimate import StiffnessEstimate
from bench.report import identification, scoring
from bench.report.plots import save
from bench.report.residual_plot import residual_figure
from bench.report.stiffness_plot import StiffnessSource, stiffness_figure
from bench.report.tables import Column, Measured, Row, print_table
from bench.report.worlds import WorldResult, run_worlds
from bench.robot.bodies import Array
from bench.robot.folder import Robot, load_robot
from bench.scenario.files import read_scenario

Progress = Callable[[float], None]

RESULTS = "results.json"
SCENARIO = "loading"
PUBLISHED = "paper"  # folder of published data in the robot's folder
MNM = 1e6  # [Nm/rad], the unit of Table 6


@dataclass(frozen=True)
class PaperResult:
    """What `bench paper` found.

    Attributes:
        robot: The robot of the scenario.
        table6: Method -> shape (n,) [Nm/rad], as published.
        worlds: The virtual robot in each friction world.
    """

    robot: Robot
    table6: Mapping[str, Array]
    worlds: tuple[WorldResult, ...]


def run_paper(folder: Path, progress: Progress) -> PaperResult:
    """Identify Table 5, run the loading experiment in every friction world and identify it.

    Args:
        folder: Existing folder; campaigns, truth and recordings are written into it.
        progress: Called with the share that is done.
    """
    worlds = run_worlds(SCENARIO, folder, progress)
    robot = load_robot(read_scenario(SCENARIO).robot)
    return PaperResult(robot, read_table6(robot.folder / PUBLISHED / "table6.csv"), tuple(worlds))


def read_table6(file: Path) -> dict[str, Array]:
    """Return the published stiffness, method -> shape (n,) [Nm/rad]."""
    with file.open(encoding="utf-8") as lines:
        rows = list(csv.DictReader(lines))
    return {row["method"]: np.array([float(row[f"k{j}_nm_per_rad"]) for j in range(1, len(row))]) for row in rows}


def write_paper(result: PaperResult, folder: Path) -> None:
    """Write numbers (JSON) and figures into the results folder."""
    content = {
        "table6_nm_per_rad": {name: identification.plain(values) for name, values in result.table6.items()},
        "worlds": {
            found.world.name: {
                "title": found.world.title,
                "estimates": {name: identification.as_json(estimate) for name, estimate in found.estimates.items()},
                "scores": {name: scoring.as_json(scores) for name, scores in found.scores.items()},
            }
            for found in result.worlds
        },
        "conclusions": conclusions(result),
    }
    (folder / RESULTS).write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
    save(stiffness_figure(_sources(result)), folder / "stiffness.png")
    for found in result.worlds:
        for name, estimate in found.estimates.items():
            title = f"Residuals: {name} method, {found.world.title}"
            save(residual_figure(estimate.residuals, title), folder / found.world.name / f"residuals-{name}.png")


def print_paper(result: PaperResult) -> None:
    """Print the table and what follows from it."""
    joints = next(iter(result.worlds[0].estimates.values())).joint_names
    columns = [Column(name, "1e6 Nm/rad", 3) for name in joints]
    columns += [Column("median error", "%", 1), Column("truth inside", "of the joints", 0)]
    unknown = (Measured(np.nan), Measured(np.nan))
    rows = [
        Row(f"paper, Table 6: {name}", (*(Measured(k / MNM) for k in values), *unknown))
        for name, values in result.table6.items()
    ]
    for found in result.worlds:
        truth = [score.truth / MNM for score in next(iter(found.scores.values()))]
        rows.append(Row(found.world.title, (*(Measured(k) for k in truth), *unknown)))
        for name, estimate in found.estimates.items():
            scored = (Measured(100 * found.median_error(name)), Measured(found.covered(name)[0]))
            rows.append(Row(f"  {name}", (*_with_intervals(estimate), *scored)))
    print_table("Joint stiffness, with half the width of the 95 % interval", columns, rows, conclusions(result))


def conclusions(result: PaperResult) -> list[str]:
    """Return in sentences which method is right where, and by how much the others are off; computed, not asserted."""
    sentences = []
    for found in result.worlds:
        errors = {name: found.median_error(name) for name in found.estimates}
        right = [name for name in errors if all(found.covered(name)) and len(set(found.covered(name))) == 1]
        ranked = ", ".join(f"{name} {100 * error:.1f} %" for name, error in sorted(errors.items(), key=lambda e: e[1]))
        sentences.append(
            f"{found.world.title}: median error {ranked}; all intervals contain the truth for: {', '.join(right) or 'none'}."
        )
    return sentences


def _with_intervals(estimate: StiffnessEstimate) -> list[Measured]:
    halves = np.diff(estimate.interval(), axis=1)[:, 0] / 2
    return [Measured(value / MNM, half / MNM) for value, half in zip(estimate.stiffness, halves, strict=True)]


def _sources(result: PaperResult) -> list[StiffnessSource]:
    return [
        StiffnessSource(
            found.world.title,
            found.estimates,
            {},
            np.array([score.truth for score in next(iter(found.scores.values()))]),
        )
        for found in result.worlds
    ]
