"""A loading scenario for the two-joint robot."""

from pathlib import Path

from bench.scenario.loading import Loading


def small_loading(robot: Path, **changes: object) -> Loading:
    content = {
        "experiment": "loading",
        "robot": str(robot),
        "seed": 3,
        "approach_deg": 3.0,
        "approach_speed_deg_per_s": 4.0,
        "load_ramp_s": 0.5,
        "settle_s": 1.5,
        "repeats": 3,
        "poses": [
            {"q_deg": [20, 10], "force_n": [100, 250]},
            {"q_deg": [-10, 40], "force_n": [100, 250], "direction": [1, 0, -1]},
        ],
    }
    return Loading.model_validate(content | changes)
