"""A line scenario for the two-joint robot: 60 mm in its plane, with the orientation free."""

from pathlib import Path

from bench.scenario.line import Line


def small_line(robot: Path, **changes: object) -> Line:
    content = {
        "experiment": "line",
        "robot": str(robot),
        "seed": 3,
        "start_m": [0.95, 0.0, 0.55],
        "end_m": [0.98, 0.0, 0.60],
        "tool_point": "hook",
        "approach": None,
        "near_deg": [17, 3],
        "speed_m_per_s": 0.02915475947422650,  # two seconds for the length of sqrt(0.03^2 + 0.05^2) m
        "force_n": 250,
        "lead_in_s": 2.0,
        "settle_s": 0.5,
        "load_ramp_s": 0.5,
        "sample_period_s": 0.04,
    }
    return Line.model_validate(content | changes)
