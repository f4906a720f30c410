"""The line experiment as files: numbers (JSON), curves (CSV), figures; and what follows from it in sentences."""

import json
from dataclasses import asdict
from pathlib import Path

import numpy as np

from bench.identify.line_deflection import measured_deflection
from bench.identify.line_passes import AXES, WAYS
from bench.record.table import FORMATS
from bench.report.figures.style import save
from bench.report.jsonable import to_jsonable
from bench.report.paper import published
from bench.report.paper.line.budget import TrajectoryError
from bench.report.paper.line.figures import SHOWN, figure_15, figure_16, figure_17
from bench.report.paper.line.published import published_rows
from bench.report.paper.line.run import LineReport
from bench.robot.bodies import Array

NUMBERS, CURVES = "line.json", "line.csv"
MM, UM = 1e3, 1e6


def write_line(report: LineReport, folder: Path) -> None:
    """Write `line.json`, `line.csv` and the figures 15 to 17 into an existing folder."""
    (folder / NUMBERS).write_text(json.dumps(line_as_json(report), indent=1, allow_nan=False) + "\n", encoding="utf-8")
    FORMATS[".csv"].write(folder / CURVES, line_curves(report))
    save(figure_15(report), folder / "figure-15.png")
    save(figure_16(report), folder / "figure-16.png")
    save(figure_17(report), folder / "figure-17.png")


def line_as_json(report: LineReport) -> dict[str, object]:
    """Return the numbers as plain data, units in the keys; what is undefined is null."""
    friction = report.friction
    return {
        "joints": list(report.joint_names),
        "friction_nm": to_jsonable(friction.level),
        "friction_standard_error_nm": to_jsonable(friction.sigma),
        "error_before_m": {way: _budget(report.before[way]) for way in WAYS},
        "methods": {
            name: {
                "deflection": {way: [to_jsonable(asdict(axis)) for axis in found.comparison[way]] for way in WAYS},
                "lost_motion": [to_jsonable(asdict(axis)) for axis in found.lost_motion],
                "link_side_share_of_friction": to_jsonable(
                    asdict(found.link_share)
                    | {"sigma": found.link_share.sigma, "interval": found.link_share.interval()}
                ),
                "error_after_m": {way: _budget(found.after[way]) for way in WAYS},
                "reduction": {axis: to_jsonable(asdict(report.reduction(name, axis))) for axis in SHOWN},
            }
            for name, found in report.methods.items()
        },
        "beside_the_paper": published.as_json(published_rows(report)),
        "conclusions": line_conclusions(report),
    }


def line_curves(report: LineReport) -> dict[str, Array]:
    """Return the curves of the figures, column name -> shape (T,), in SI units."""
    passes, friction = report.model.passes, report.friction
    columns = {"place_m": report.place}
    for way in WAYS:
        measured, _ = measured_deflection(passes, way)
        columns |= _columns(f"deflection_{way}_measured", measured)
        columns |= _columns(f"error_{way}_before", report.before[way].error)
        for name, found in report.methods.items():
            columns |= _columns(f"deflection_{way}_{name}", found.deflection[way].displacement)
            columns |= _columns(f"deflection_{way}_{name}_se", found.deflection[way].standard_error)
            columns |= _columns(f"error_{way}_{name}", found.after[way].error)
    for j, name in enumerate(report.joint_names):
        columns[f"q_cmd_{name}_rad"] = passes.of("loaded", "out").q_cmd[:, j]
        columns[f"torque_out_{name}_nm"] = passes.of("loaded", "out").current_torque[:, j]
        columns[f"torque_back_{name}_nm"] = passes.of("loaded", "back").current_torque[:, j]
        columns[f"friction_{name}_nm"] = np.where(friction.direction[:, j] == 0, np.nan, friction.torque[:, j])
    return columns


def line_conclusions(report: LineReport) -> list[str]:
    """Return in sentences what the line shows; every number computed."""
    sentences = []
    for name, found in report.methods.items():
        z = found.comparison["out"][AXES.index("z")]
        within = "as its covariance allows" if z.as_expected else "more than its covariance allows"
        sentences.append(
            f"{name}: predicts {100 * z.ratio:.1f} ± {100 * z.ratio_error:.1f} % of the deflection in z; rms error "
            f"{UM * z.rms:.0f} µm (up to {UM * z.rms_allowed:.0f} expected: {within}), largest {UM * z.maximum:.0f} µm."
        )
    for name, found in report.methods.items():
        reduction = report.reduction(name, "z")
        left = {part: MM * found.after["out"].rms("z", part) for part in found.after["out"].parts}
        largest = sorted(left.items(), key=lambda item: -item[1])[:3]
        ranked = ", ".join(f"{part} {size:.2f} mm" for part, size in largest)
        sentences.append(
            f"{name}: compensation divides the error in z by {reduction.achieved:.1f} as tracked "
            f"({reduction.expected:.1f} expected beforehand) and by {reduction.true:.1f} in truth; the error of the "
            f"estimate alone allows {reduction.by_estimate:.1f}, that of its stiffness {reduction.by_stiffness:.1f}. "
            f"Left on the way out, rms: {ranked}."
        )
    for name, found in report.methods.items():
        share = found.link_share
        sentences.append(
            f"{name}: the lost motion between out and back puts {100 * share.value:.0f} ± {100 * share.sigma:.0f} % of "
            "the friction on the link side."
        )
    return sentences


def _budget(error: TrajectoryError) -> dict[str, dict[str, float]]:
    return {axis: {"all": error.rms(axis)} | {part: error.rms(axis, part) for part in error.parts} for axis in AXES}


def _columns(name: str, values: Array) -> dict[str, Array]:
    return {f"{name}_{axis}_m": values[:, a] for a, axis in enumerate(AXES)}
