"""What the paper says about the line, in words or numbers, beside what the virtual robot does."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from bench.identify.line_passes import AXES
from bench.report.line import LineReport
from bench.report.line_plots import busiest_joint

Relation = Literal["equal", "less", "more"]


@dataclass(frozen=True)
class PublishedRow:
    """One statement of the paper beside ours.

    Attributes:
        quantity: What it is.
        unit: "" for a ratio.
        ours: Our value.
        paper: The paper's value, or the bound that its words draw.
        relation: Whether the paper says that the quantity equals `paper`, is less, or is more.
        sigma: Standard error of ours; 0 where it has none to speak of.
    """

    quantity: str
    unit: str
    ours: float
    paper: float
    relation: Relation
    sigma: float = 0.0

    @property
    def difference(self) -> float:
        """Ours less the paper's."""
        return self.ours - self.paper

    @property
    def holds(self) -> bool | None:
        """Whether what the paper says in words is so here; None where it prints a number."""
        match self.relation:
            case "less":
                return self.ours < self.paper
            case "more":
                return self.ours > self.paper
            case _:
                return None


def published_rows(report: LineReport) -> tuple[PublishedRow, ...]:
    """Return the paper's statements of section 6 that this report has the methods for."""
    return tuple(_rows(report))


def _rows(report: LineReport) -> Iterator[PublishedRow]:
    unloaded = report.model.passes.of("unloaded", "out").reflector
    sigma = float(np.sqrt(2) * report.model.passes.of("unloaded", "out").sigma_reflector[0])
    length = float(unloaded[-1, 0] - unloaded[0, 0])
    yield PublishedRow("way in x as tracked, Table 8", "mm", 1e3 * length, 600.0, "equal", 1e3 * sigma)
    yield from _friction_rows(report)
    z = AXES.index("z")
    for name in report.methods:
        ratio = report.methods[name].comparison["out"][z]
        relation: Relation = "less" if name == "force" else "equal"
        quantity = f"{name} method: predicted over measured deflection in z, Fig. 16"
        yield PublishedRow(quantity, "", ratio.ratio, 1.0, relation, ratio.ratio_error)
    for name in report.methods:
        for axis in ("x", "z"):
            after = 1 / report.reduction(name, axis).achieved
            yield PublishedRow(f"{name} method: rms error in {axis} after over before, Fig. 17", "", after, 1.0, "less")
    if {"current", "force"} <= set(report.methods):
        current, force = (report.methods[name].comparison["out"][z].rms for name in ("current", "force"))
        yield PublishedRow("rms of the prediction in z, current over force, Fig. 16", "", current / force, 1.0, "less")
        for axis, relation in (("z", "less"), ("x", "equal")):
            kept = report.reduction("force", axis).achieved / report.reduction("current", axis).achieved
            quantity = f"rms error in {axis} after compensation, current over force, Fig. 17"
            yield PublishedRow(quantity, "", kept, 1.0, relation)


def _friction_rows(report: LineReport) -> Iterator[PublishedRow]:
    j = busiest_joint(report)
    out, back = (report.model.passes.of("loaded", way) for way in ("out", "back"))
    falling = float(np.mean(np.diff(out.q_cmd[:, j]) < 0))
    name = report.joint_names[j]
    yield PublishedRow(f"share of the way out on which {name} falls, Fig. 15a", "", falling, 1.0, "equal")
    ratio = float(np.mean(np.abs(out.current_torque[:, j])) / np.mean(np.abs(back.current_torque[:, j])))
    yield PublishedRow(f"current of {name}, out over back, Fig. 15b", "", ratio, 1.0, "more")
