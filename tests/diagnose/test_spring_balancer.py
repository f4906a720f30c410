"""A spring on a lever that nobody stated: by the law of cosines, where the bench has three harmonics."""

from pathlib import Path

import numpy as np
import pytest

from bench.diagnose.diagnose import diagnose
from bench.diagnose.linearise.candidates import causes_of
from bench.diagnose.name.beginning import told_by
from bench.effects.catalogue import LEFT_OUT, catalogue
from bench.identify.dynamics.equations import BALANCER
from bench.identify.dynamics.first_pass import first_pass
from bench.record.campaign import Array, Campaign, Run
from bench.report.diagnosis.write import write_diagnosis
from bench.robot.compiled import CompiledRobot
from bench.robot.folder import load_robot
from bench.robot.nominal_dynamics import nominal_dynamics
from bench.robot.starter.folder import start_robot
from bench.robot.starter.source import read_source
from tests.effects.rest import rest
from tests.stranger import mjcf, moved

LISTED = (*LEFT_OUT, "dress_pack", "load_friction", "rolling_friction", "link_com", "torque_offset", "spring_balancer")
HOOKS, FREE, TURNED = (0.2, 0.3), 0.25, 0.25  # [m], length without a force [m], angle at which it is longest [rad]
STIFFNESS = 900.0  # [N/m]


@pytest.fixture
def compiled(tmp_path: Path) -> CompiledRobot:
    (tmp_path / "arm.xml").write_text(mjcf())
    return start_robot("arm", read_source(tmp_path / "arm.xml"), tmp_path / "arm").compiled


def carried(angle: Array) -> Array:
    """Return what the spring takes from its drive [Nm] at angles [rad]."""
    a, b = HOOKS
    length = np.sqrt(a**2 + b**2 + 2 * a * b * np.cos(angle - TURNED))
    return STIFFNESS * (length - FREE) * a * b * np.sin(angle - TURNED) / length


def campaign(rng: np.random.Generator, stronger: float = 1.0) -> Campaign:
    """Return two motions of the arm of the file, with a spring balancer at its second joint, so many times as stiff."""
    runs = []
    for k in range(2):
        motion = moved(rng, seconds=15.0, swing=2.5)
        torque = motion.torque.copy()
        torque[:, 1] -= stronger * carried(motion.position[:, 1])
        columns = {"time_s": motion.time}
        columns |= {f"q_motor_{j + 1}_rad": motion.position[:, j] for j in range(3)}
        columns |= {f"tau_motor_{j + 1}_nm": torque[:, j] for j in range(3)}
        runs.append(Run(f"run{k}", "motion", 60.0 * k, columns))
    return Campaign("balanced", tuple(runs))


def test_it_is_named_and_what_is_handed_over_pulls_as_it_does(compiled: CompiledRobot, tmp_path: Path) -> None:
    """On a stranger's palletising arm a floor, wrong masses and an offset stood for it, with links of 0.1 kg."""
    one = campaign(np.random.default_rng(3))
    first = first_pass(one, nominal_dynamics(compiled))
    assert first.has["balancer"] == (1,)
    found = diagnose(one, compiled, {name: catalogue()[name] for name in LISTED}, proposes=False, first=first)
    friction = {(name, f"joint {j}") for name in ("coulomb_friction", "viscous_friction") for j in (1, 2, 3)}
    assert {cause.name for cause in found.verdict.explanations[0].causes} == {*friction, ("spring_balancer", "joint 2")}
    out = tmp_path / "out"
    out.mkdir()
    write_diagnosis(found, out, one)
    robots = (compiled.robot, load_robot(out / "robot"))
    angles = np.linspace(-1.2, 1.2, 9)
    offset = robots[1].figures.fitted.readings.torque_offset_nm["j2"]  # of the reading: the law has no constant term
    less = [np.subtract(*(rest(robot, [], np.array([0.0, q, 0.0])).torque[1] for robot in robots)) for q in angles]
    assert np.abs(carried(angles)).max() > 15.0
    np.testing.assert_allclose(np.array(less) - offset, carried(angles), atol=0.6)  # [Nm], as a reading scatters


@pytest.mark.parametrize("stronger", [0.5, 2.2])
def test_a_first_pass_has_one_however_strong_it_is(compiled: CompiledRobot, stronger: float) -> None:
    """Of a strong one all that a drive missed was explained, which counted less than most of it: it was refused."""
    first = first_pass(campaign(np.random.default_rng(3), stronger), nominal_dynamics(compiled))
    assert first.has["balancer"] == (1,)
    sine, cosine = (first.parameters[first.layout.of_drives(name)][1] for name in BALANCER[:2])
    assert told_by(first)["spring_balancer", 1] == pytest.approx(np.hypot(sine, cosine))  # its sine is below zero


def test_without_one_nobody_looks_for_it(compiled: CompiledRobot) -> None:
    effect, measured = catalogue()["spring_balancer"], frozenset({"tau_motor", "q_motor"})
    assert not causes_of([effect], compiled, measured)
    told = {("spring_balancer", 1): 20.0}
    assert [cause.place.index for cause in causes_of([effect], compiled, measured, told=told)] == [1]
