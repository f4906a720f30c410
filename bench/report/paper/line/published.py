"""What the paper says about the line, in words or numbers, beside what the virtual robot does."""

from collections.abc import Iterator

import numpy as np

from bench.identify.line_passes import AXES
from bench.report.paper.line.figures import busiest_joint
from bench.report.paper.line.run import LineReport
from bench.report.paper.published import PublishedRow, Relation, interval


def published_rows(report: LineReport) -> tuple[PublishedRow, ...]:
    """Return the paper's statements of section 6 that this report has the methods for."""
    return tuple(_rows(report))


def _rows(report: LineReport) -> Iterator[PublishedRow]:
    unloaded = report.model.passes.of("unloaded", "out").reflector
    sigma = float(np.sqrt(2) * report.model.passes.of("unloaded", "out").sigma_reflector[0])
    length = float(unloaded[-1, 0] - unloaded[0, 0])
    length_mm, sigma_mm = 1e3 * length, 1e3 * sigma
    yield PublishedRow("way in x as tracked, Table 8", "mm", length_mm, 600.0, "equal", *interval(length_mm, sigma_mm))
    yield from _friction_rows(report)
    z = AXES.index("z")
    for name in report.methods:
        ratio = report.methods[name].comparison["out"][z]
        relation: Relation = "less" if name == "force" else "equal"
        quantity = f"{name} method: predicted over measured deflection in z, Fig. 16"
        yield PublishedRow(quantity, "", ratio.ratio, 1.0, relation, *interval(ratio.ratio, ratio.ratio_error))
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
