"""Rotation scenarios for the two-joint robot."""

from pathlib import Path

from bench.scenario.rotation import Rotation


def small_rotation(robot: Path, **changes: object) -> Rotation:
    content = {
        "experiment": "rotation",
        "robot": str(robot),
        "seed": 5,
        "joint": 1,
        "start_deg": [-30, 10],
        "end_deg": 60,
        "speeds_deg_per_s": [15, 25],
        "payloads_kg": [5, 20],
        "sample_period_s": 0.012,
    }
    return Rotation.model_validate(content | changes)
