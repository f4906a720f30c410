"""A session scenario for the two-joint robot: every part, in half a minute."""

from pathlib import Path

from bench.scenario.session import SessionScenario

POSE = {"q_deg": [20, 10], "force_n": [250]}
QUICK = {"approach_speed_deg_per_s": 6.0, "load_ramp_s": 0.3, "settle_s": 0.5, "repeats": 2, "poses": [POSE]}
SWEEP = {"joint": 1, "start_deg": [-20, 10], "end_deg": 40, "speeds_deg_per_s": [30], "ramp_s": 0.5, "settle_s": 0.2}
PARTS: dict[str, object] = {
    "repeat_at_end": {"loading": QUICK | {"approach": [1]}, "rotation": SWEEP},
    "loading": QUICK,
    "rotations": [SWEEP | {"payloads_kg": [5]}, SWEEP | {"joint": 2, "start_deg": [10, -20]}],
    "line": {
        "start_m": [0.95, 0.0, 0.55],
        "end_m": [0.98, 0.0, 0.60],
        "tool_point": "hook",
        "approach": None,
        "near_deg": [17, 3],
        "speed_m_per_s": 0.02915475947422650,
        "force_n": 250,
        "lead_in_s": 1.0,
        "settle_s": 0.3,
        "load_ramp_s": 0.3,
        "sample_period_s": 0.04,
    },
    "dwell": {"from_deg": [0, 0], "q_deg": [30, 20], "read_every_s": 60, "simulated_s": 0.5},
}


def small_session(robot: Path, **changes: object) -> SessionScenario:
    content = {"experiment": "session", "robot": str(robot), "seed": 5, **PARTS} | changes
    return SessionScenario.model_validate({key: value for key, value in content.items() if value is not None})
