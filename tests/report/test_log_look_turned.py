"""An axis that a proposed `log.yaml` leaves turned in angle and torque alike is asked about."""

from pathlib import Path

import numpy as np
import pytest

from bench.report.log_look.trial import refusals
from tests.identify.dynamics.rigid_world import Friction, arm, drawn, recorded, robot

CRUDE = {"mass": 0.3, "centre_of_mass_m": 0.03, "rotor_inertia": 0.3}
FRICTION = Friction(np.array([20.0, 15.0, 8.0]), np.array([30.0, 20.0, 10.0]), np.array([1.0, -2.0, 0.5]))
COLUMNS = ("time_s", *(f"q_motor_{j}_rad" for j in (1, 2, 3)), *(f"tau_motor_{j}_nm" for j in (1, 2, 3)))


@pytest.mark.parametrize("turned", [(), (2,), (3,)])
def test_an_axis_that_is_turned_in_both_is_asked_about(tmp_path: Path, turned: tuple[int, ...]) -> None:
    rng = np.random.default_rng(0)
    (run,) = recorded(drawn(robot(arm(), **CRUDE), rng), FRICTION, rng, runs=1, seconds=40.0).runs
    signs = [-1.0 if any(f"_{j}_" in name for j in turned) else 1.0 for name in COLUMNS]
    rows = np.column_stack([run.columns[name] for name in COLUMNS]) * signs
    np.savetxt(tmp_path / "x.csv", rows, delimiter=",", header=",".join(COLUMNS), comments="", fmt="%.9g")
    text = "columns:\n" + "".join(f"  {name}: {{from: {name}}}\n" for name in COLUMNS)
    asked = list(refusals(tmp_path / "x.csv", text, robot(arm(), **CRUDE)))
    assert len(asked) == len(turned)
    assert all("angle and torque or current alike" in one for one in asked)
