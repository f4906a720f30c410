"""An angle that counts the other way round while its torque does not: the model explains it by friction that drives."""

from pathlib import Path

import numpy as np

from bench.diagnose.plausibility.channels import doubts_of
from bench.robot.starter.folder import start_robot
from bench.robot.starter.source import read_source
from tests.identify.dynamics.rigid_world import arm, drawn, mjcf, recorded, robot
from tests.identify.dynamics.test_turned import CRUDE, FRICTION, turned


def test_an_angle_that_is_turned_by_itself_is_doubted(tmp_path: Path, rng: np.random.Generator) -> None:
    """Joint 3 of this arm, and joint 1 of a poisoner's, were believed: gravity is even in them."""
    nominal = robot(arm(), **CRUDE)
    (tmp_path / "arm.xml").write_text(mjcf(nominal))
    compiled = start_robot("arm", read_source(tmp_path / "arm.xml"), tmp_path / "arm").compiled
    campaign = recorded(drawn(nominal, rng), FRICTION, rng)
    assert not any("sense of turning" in str(doubt) for doubt in doubts_of(campaign, compiled))
    said = [str(doubt) for doubt in doubts_of(turned(campaign, 2, ("q_motor", "q_cmd")), compiled)]
    assert any(
        "q_motor_3: joint3 moves against the model's sense of turning, and its torque does not" in x for x in said
    )
