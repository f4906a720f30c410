"""Table 5 and the loading experiment in the friction worlds: the main table, its figures, and what follows."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from bench.identify.estimate import StiffnessEstimate
from bench.identify.table5_conclusions import conclusions
from bench.identify.table5_study import Table5Study, study_table5
from bench.report import identification, scoring
from bench.report.figures.residuals import residual_figure
from bench.report.figures.stiffness import StiffnessSource, stiffness_figure
from bench.report.figures.style import save
from bench.report.identification import MNM
from bench.report.jsonable import to_jsonable
from bench.report.paper.loading.worlds import WorldResult
from bench.report.tables import Column, Measured, Row, print_table
from bench.robot.bodies import Array

TABLE_5_FITS = ("current, plain", "force, plain", "joint")
AS_MODEL = "both-sides"  # the world in which the later experiments run


@dataclass(frozen=True)
class LoadingResult:
    """What the loading experiment shows, on paper and on the virtual robot.

    Attributes:
        worlds: The virtual robot in each friction world.
        table5: The published measurements in all reconstructions of their poses.
    """

    worlds: tuple[WorldResult, ...]
    table5: Table5Study

    @property
    def as_model(self) -> Mapping[str, StiffnessEstimate]:
        """Estimates for the later experiments, from their own world; without the variant that needs orientation."""
        found = next(result for result in self.worlds if result.world.name == AS_MODEL)
        return {name: found.estimates[name] for name in ("current", "force", "joint")}

    @property
    def sentences(self) -> list[str]:
        """What follows for the virtual robot, computed from the scores."""
        return [_verdict(found) for found in self.worlds]

    @property
    def data(self) -> dict[str, object]:
        """Everything as plain data."""
        study = self.table5
        return {
            "table6_nm_per_rad": to_jsonable(study.table6),
            "table5": {
                "reconstructions": len(study.reconstructions),
                "stiffness_5_50_95_percent_nm_per_rad": {
                    fit: to_jsonable(study.spread(fit)) for fit in study.estimates
                },
                "first_reconstruction": {
                    fit: identification.as_json(estimates[0]) for fit, estimates in study.estimates.items()
                },
                "residual_rms_in_sigma_first": {fit: float(study.residual_rms(fit)[0]) for fit in study.estimates},
                "lines": to_jsonable(asdict(study.lines)),
                "conclusions": list(conclusions(study)),
            },
            "worlds": {
                found.world.name: {
                    "title": found.world.title,
                    "estimates": {name: identification.as_json(estimate) for name, estimate in found.estimates.items()},
                    "scores": {name: scoring.as_json(scores) for name, scores in found.scores.items()},
                }
                for found in self.worlds
            },
            "conclusions": self.sentences,
        }


def loading_chapter(worlds: list[WorldResult], published: Path) -> LoadingResult:
    """Return the virtual robot's results together with Table 5, identified in every reconstruction of its poses.

    Args:
        worlds: From `bench.report.paper.loading.worlds`.
        published: Folder with the paper's tables.
    """
    with threadpool_limits(1, "blas"):
        return LoadingResult(tuple(worlds), study_table5(published))


def write_loading(result: LoadingResult, folder: Path) -> None:
    """Write the figures into the folder of the experiment, those of one world into its own."""
    save(stiffness_figure(_sources(result)), folder / "stiffness.png")
    for found in result.worlds:
        for name, estimate in found.estimates.items():
            title = f"Residuals: {name} method, {found.world.title}"
            save(residual_figure(estimate.residuals, title), folder / found.world.name / f"residuals-{name}.png")
    for fit in TABLE_5_FITS:
        residuals = result.table5.estimates[fit][0].residuals
        name = fit.replace(", ", "-")
        save(residual_figure(residuals, f"Residuals of Table 5: {fit}"), folder / f"table5-residuals-{name}.png")


def print_loading(result: LoadingResult) -> None:
    """Print the main table and what follows from it."""
    study = result.table5
    joints = next(iter(result.worlds[0].estimates.values())).joint_names
    columns = [Column(name, "1e6 Nm/rad", 3) for name in joints]
    columns += [Column("median error", "%", 1), Column("truth inside", "of the joints", 0)]
    nothing = (Measured(np.nan), Measured(np.nan))
    rows = [
        Row(f"paper, Table 6: {name}", (*(Measured(k / MNM) for k in values), *nothing))
        for name, values in study.table6.items()
    ]
    for fit in TABLE_5_FITS:
        low, middle, high = study.spread(fit) / MNM
        cells = (Measured(m, (h - b) / 2) for b, m, h in zip(low, middle, high, strict=True))
        rows.append(Row(f"Table 5: {fit}", (*cells, *nothing)))
    for found in result.worlds:
        truth = [score.truth / MNM for score in next(iter(found.scores.values()))]
        rows.append(Row(f"virtual robot, {found.world.title}", (*(Measured(k) for k in truth), *nothing)))
        for name, estimate in found.estimates.items():
            scored = (Measured(100 * found.median_error(name)), Measured(found.covered(name)[0]))
            rows.append(Row(f"  {name}", (*_with_intervals(estimate), *scored)))
    notes = [
        "Virtual robot: truth, then each method with half the width of its 95 % interval. Table 5: median over "
        f"{len(study.reconstructions)} reconstructions of the poses, which the paper does not print, and half their "
        "90 % band.",
        *result.sentences,
        "",
        "What Table 5 says:",
        *conclusions(study),
    ]
    print_table("Joint stiffness", columns, rows, notes)


def _verdict(found: WorldResult) -> str:
    errors = {name: found.median_error(name) for name in found.estimates}
    right = [name for name in errors if len(set(found.covered(name))) == 1]
    ranked = ", ".join(f"{name} {100 * error:.1f} %" for name, error in sorted(errors.items(), key=lambda e: e[1]))
    title = found.world.title[0].upper() + found.world.title[1:]
    return (
        f"{title} ({found.protocol}): median error {ranked}; all intervals contain the truth for "
        f"{', '.join(right) or 'no method'}."
    )


def _with_intervals(estimate: StiffnessEstimate) -> list[Measured]:
    halves = np.diff(estimate.interval(), axis=1)[:, 0] / 2
    return [Measured(value / MNM, half / MNM) for value, half in zip(estimate.stiffness, halves, strict=True)]


def _sources(result: LoadingResult) -> list[StiffnessSource]:
    study = result.table5
    references: dict[str, Array] = {f"paper, {name}": values for name, values in study.table6.items()}
    # The arm of a reconstruction has joint names of its own
    joints = next(iter(result.worlds[0].estimates.values())).joint_names
    measured = {
        fit.removesuffix(", plain"): replace(study.estimates[fit][0], joint_names=joints) for fit in TABLE_5_FITS
    }
    first = StiffnessSource(f"Table 5, poses {study.reconstructions[0].name}", measured, references)
    return [first, *(_source(found) for found in result.worlds)]


def _source(found: WorldResult) -> StiffnessSource:
    truth = np.array([score.truth for score in next(iter(found.scores.values()))])
    return StiffnessSource(found.world.title, found.estimates, {}, truth)
