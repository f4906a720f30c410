"""An axis that a proposed `log.yaml` leaves turned in angle and torque alike is asked about."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.identify.directions import directions, most_at_once
from bench.record.log_format import read_log_format
from bench.report.log_look.look import look
from bench.report.log_look.trial import refusals
from tests import seven_joints
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


@pytest.mark.parametrize("stated", [True, False])
def test_currents_are_torques_by_stated_constants_alone(tmp_path: Path, stated: bool) -> None:
    """Without constants each current has a scale of its own, and an axis was asked about that was right."""
    rng = np.random.default_rng(0)
    constants = np.array([300.0, 30.0, 30.0])
    (run,) = recorded(drawn(robot(arm(), **CRUDE), rng), FRICTION, rng, runs=1, seconds=40.0).runs
    table = {"time_s": run.columns["time_s"]}
    table |= {f"q_motor_{j}_rad": run.columns[f"q_motor_{j}_rad"] * (-1 if j == 2 else 1) for j in (1, 2, 3)}
    table |= {
        f"current_{j}_a": run.columns[f"tau_motor_{j}_nm"] / constants[j - 1] * (-1 if j == 2 else 1) for j in (1, 2, 3)
    }
    rows = np.column_stack(list(table.values()))
    np.savetxt(tmp_path / "x.csv", rows, delimiter=",", header=",".join(table), comments="", fmt="%.9g")
    text = "columns:\n" + "".join(f"  {name}: {{from: {name}}}\n" for name in table)
    known = constants if stated else np.full(3, np.nan)
    nominal = replace(robot(arm(), **CRUDE), torque_constant=np.where(stated, constants, 1.0), stated_constant=known)
    assert len(list(refusals(tmp_path / "x.csv", text, nominal))) == stated


@pytest.mark.parametrize(
    ("angle", "current"), [((), ()), ((), (4,)), ((4,), ()), ((4,), (4,)), ((2,), (2,)), ((2, 3), ())]
)
def test_of_seven_drives_too_the_turned_one_is_told(
    tmp_path: Path, angle: tuple[int, ...], current: tuple[int, ...]
) -> None:
    """Beyond six drives no direction was tried, and three right currents were turned for one angle."""
    arm = seven_joints.started(tmp_path)
    log = seven_joints.moved(arm, np.random.default_rng(2))
    log = replace(log, angle=log.angle * signs(angle), current=log.current * signs(current))
    text = look(log.written(tmp_path / "x.csv"), nominal=arm).text
    (tmp_path / "log.yaml").write_text(text)
    columns = read_log_format(tmp_path / "log.yaml").columns
    every = range(1, seven_joints.N + 1)
    assert [columns[f"q_motor_{j}_rad"].factor for j in every] == list(signs(angle))
    assert [columns[f"current_{j}_a"].factor for j in every] == list(signs(current))
    assert ("tried two at a time at most" in text) is bool(angle or current)


def signs(turned: tuple[int, ...]) -> np.ndarray:
    return np.where(np.isin(np.arange(1, seven_joints.N + 1), turned), -1.0, 1.0)


@pytest.mark.parametrize(("n", "at_once", "trials"), [(3, 3, 8), (6, 6, 64), (7, 2, 29), (10, 2, 56), (11, 1, 12)])
def test_as_many_directions_are_tried_as_six_drives_have(n: int, at_once: int, trials: int) -> None:
    tried = directions(n)
    assert not np.any(tried[0])
    assert len(tried) == len({tuple(turned) for turned in tried}) == trials
    assert max(map(sum, tried)) == most_at_once(n) == at_once
