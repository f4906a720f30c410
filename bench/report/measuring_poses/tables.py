"""Designed poses as tables, as JSON, and as a scenario file that `bench run` takes."""

import json
from pathlib import Path

import numpy as np

from bench.identify.pose_precision import Precision
from bench.record.yaml_text import dump_yaml
from bench.report.files import replacing
from bench.report.jsonable import to_jsonable
from bench.report.measuring_poses.plan import PosePlan
from bench.report.tables import Column, Measured, Row, print_table
from bench.scenario.loading import Loading

DIGITS = 4  # of angles [deg] and directions


def scenario_of(plan: PosePlan) -> Loading:
    """Return the designed poses as a loading scenario that `bench run` takes."""
    visits = plan.design.visits
    poses = [
        {
            "q_deg": np.round(q, DIGITS).tolist(),
            "force_n": np.round(load.forces).tolist(),
            "direction": np.round(load.direction, DIGITS).tolist(),
        }
        for q, load in zip(plan.design.q_deg, visits.loads, strict=True)
    ]
    notes = f"D-optimal for the {plan.design.method} method (bench poses)"
    return Loading.model_validate({"experiment": "loading", "robot": plan.robot, "notes": notes, "poses": poses})


def write_scenario(plan: PosePlan, file: Path) -> None:
    """Write the designed poses as a scenario file.

    Raises:
        InputError: The folder does not exist or cannot be written to.
    """
    with replacing(file) as partial:
        content = scenario_of(plan).model_dump(mode="json", exclude_defaults=True)
        partial.write_text(dump_yaml({"experiment": "loading", "robot": plan.robot} | content), encoding="utf-8")


def print_plan(plan: PosePlan) -> None:
    """Print poses and loads, then what to expect of them and of the reference."""
    design, names = plan.design, plan.design.precision.joint_names
    columns = [*(Column(name, "deg", 0) for name in names), *(Column(f"largest f{axis}", "N", 0) for axis in "xyz")]
    rows = [
        Row(str(i + 1), tuple(Measured(value) for value in (*q, *(max(load.forces) * np.array(load.direction) + 0.0))))
        for i, (q, load) in enumerate(zip(design.q_deg, design.visits.loads, strict=True))
    ]
    steps = ", ".join(f"{force:.0f}" for force in design.visits.loads[0].forces)
    print_table(f"poses for the {design.method} method", columns, rows, [f"Read unloaded, then at {steps} N."])
    expected = [("these poses" if plan.after is None else f"these after {plan.after}", design.precision)]
    if plan.reference is not None:
        expected.append((f"{plan.against} alone", plan.reference))
    rows = [
        Row(name, tuple(Measured(100 * value) for value in precision.standard_error / precision.stiffness))
        for name, precision in expected
    ]
    print_table(
        "expected standard error of k, from instrument noise",
        [Column(name, "%", 2) for name in names],
        rows,
        _words(plan),
    )


def _words(plan: PosePlan) -> list[str]:
    precision, reference = plan.design.precision, plan.reference
    words = [f"Condition number {precision.condition_number:.1f}."]
    if reference is not None:
        words = [
            f"Condition number {precision.condition_number:.1f}; of {plan.against} {reference.condition_number:.1f}.",
            f"D-efficiency {plan.efficiency:.2f}: {plan.against} needs so many times the repeats for the same.",
        ]
    gain = 100 * np.sqrt(np.diag(precision.gain)).max()
    return [*words, f"Gain errors of the instruments add up to {gain:.1f} %, whatever the poses.", *plan.notes]


def print_json(plan: PosePlan) -> None:
    """Print the plan as JSON, units in the keys; what is undefined is null."""
    scenario, precision = scenario_of(plan), plan.design.precision
    content = {
        "robot": plan.robot,
        "method": plan.design.method,
        "poses": [pose.model_dump(mode="json") for pose in scenario.poses],
        "joints": list(precision.joint_names),
        "expected": _as_json(precision),
        "after": plan.after,
        "against": plan.against,
        "expected_against": None if plan.reference is None else _as_json(plan.reference),
        "d_efficiency": None if plan.efficiency is None else to_jsonable(plan.efficiency),
        "notes": list(plan.notes),
    }
    print(json.dumps(content, indent=2))


def _as_json(precision: Precision) -> dict[str, object]:
    return {
        "stiffness_nm_per_rad": to_jsonable(precision.stiffness),
        "standard_error_nm_per_rad": to_jsonable(precision.standard_error),
        "standard_error_with_gain_nm_per_rad": to_jsonable(precision.total_standard_error),
        "condition_number": to_jsonable(precision.condition_number),
    }
