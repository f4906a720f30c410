"""A ROS 2 bag (MCAP) as a log: one topic as the rows, another one beside it with its own clock."""

from pathlib import Path

import numpy as np
import pytest

from bench.errors import CampaignError
from bench.record.convert import convert
from bench.record.log_format import LogFormat

pytest.importorskip("mcap_ros2", reason="the extra 'mcap' is not installed")

HEADER = """std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""
FORCE = "float64 z\nuint8[] raw\n"
START = 1_700_000_000_000_000_000  # [ns]


def write_bag(file: Path) -> None:
    """Joint states at 250 Hz, 3 ms late in the log, and a force at 50 Hz."""
    from mcap_ros2.writer import Writer

    with file.open("wb") as stream:
        writer = Writer(stream)
        states = writer.register_msgdef("sensor_msgs/msg/JointState", HEADER)
        force = writer.register_msgdef("my/msg/Force", FORCE)
        for k in range(100):
            at = START + 4_000_000 * k
            message = {
                "header": {"stamp": {"sec": at // 10**9, "nanosec": at % 10**9}, "frame_id": ""},
                "name": ["elbow", "wrist"],
                "position": [0.01 * k, -0.02 * k],
                "velocity": [],
                "effort": [float(k), 0.0],
            }
            writer.write_message("/joint_states", states, message, at + 3_000_000, at + 3_000_000)
            if k % 5 == 0:
                writer.write_message("/force", force, {"z": 0.1 * k, "raw": b"ab"}, at, at)
        writer.finish()


COLUMNS = {
    "time_s": {"from": "log_time"},
    "q_motor_1_rad": {"from": "position.elbow"},
    "q_motor_2_rad": {"from": "position.wrist"},
    "tau_motor_1_nm": {"from": "effort.elbow"},
}


def test_topics_with_their_own_clocks(tmp_path: Path) -> None:
    write_bag(tmp_path / "bag.mcap")
    force = {"force_z_n": {"from": "z", "table": "force"}}
    form = LogFormat.model_validate(
        {
            "topic": "/joint_states",
            "tables": {"force": {"topic": "/force", "time_s": {"from": "log_time"}}},
            "columns": COLUMNS | force,
            "runs": {"windows_s": [[0.0, 0.3]]},
        }
    )
    converted = convert(tmp_path, form, "mine")
    (run,) = converted.campaign.runs
    k = np.arange(len(run))
    np.testing.assert_allclose(run.columns["time_s"], 0.004 * k, atol=1e-6)  # a double holds 2e-7 s of such a time
    np.testing.assert_array_equal(run.columns["q_motor_2_rad"], -0.02 * k)
    np.testing.assert_array_equal(run.columns["tau_motor_1_nm"], k)
    np.testing.assert_allclose(run.columns["force_z_n"], 0.1 * (k + 0.75), atol=1e-4)  # 3 ms later than the bag says
    assert converted.unused == {"bag.mcap": ("header.stamp", "effort.wrist")}


@pytest.mark.parametrize(
    ("topic", "said"),
    [
        ("", r"bag\.mcap: has 2 topics: /force, /joint_states; write `topic: NAME`"),
        ("/joint_state", r"unknown topic '/joint_state'\. Did you mean '/joint_states'"),
    ],
)
def test_a_topic_that_is_not_there(tmp_path: Path, topic: str, said: str) -> None:
    write_bag(tmp_path / "bag.mcap")
    with pytest.raises(CampaignError, match=said):
        convert(tmp_path, LogFormat.model_validate({"topic": topic, "columns": COLUMNS}), "mine")


@pytest.mark.parametrize("damage", ["cut", "noise", "empty"])
def test_a_damaged_recording_is_one_error(tmp_path: Path, damage: str) -> None:
    write_bag(tmp_path / "bag.mcap")
    data = (tmp_path / "bag.mcap").read_bytes()
    spoilt = {"cut": data[: len(data) // 2], "noise": b"x" * 400, "empty": b""}[damage]
    (tmp_path / "bag.mcap").write_bytes(spoilt)
    with pytest.raises(CampaignError, match=r"bag\.mcap: "):
        convert(tmp_path, LogFormat.model_validate({"topic": "/joint_states", "columns": COLUMNS}), "mine")
