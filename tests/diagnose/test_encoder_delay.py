"""Angles that were read before the rest of their row: torques are those of a later motion, accelerations included."""

import numpy as np
import pytest

from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.diagnose.replay.world import NOMINAL, World
from bench.effects.catalogue import catalogue
from bench.effects.effect import WHOLE, Acting
from bench.record.campaign import Array, Campaign, Run
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.robot.nominal_dynamics import nominal_dynamics

LATE_S = 4e-3  # of the angles
TIME = np.arange(0, 8, 2e-3)


def slide(late_by: float) -> tuple[Array, Array, Array]:
    """Return position, speed and acceleration of a slide some time before, shape (rows,) each."""
    turn = 2 * np.pi * 0.8
    phase = turn * (TIME - late_by)
    return 0.1 * np.sin(phase), 0.1 * turn * np.cos(phase), -0.1 * turn**2 * np.sin(phase)


def residual(acting: tuple[Acting, ...]) -> float:
    """Return the root mean square of what a world leaves of the force of a rigid slide whose encoder is late [N]."""
    compiled = compile_robot(load_robot("emps"))
    nominal = nominal_dynamics(compiled)
    mass = float(nominal.bodies.mass[0] + nominal.rotor_inertia[0])
    drag = float(nominal.viscous[0])
    _, speed, acceleration = slide(0.0)
    columns = {"time_s": TIME, "q_motor_1_m": slide(LATE_S)[0], "tau_motor_1_n": mass * acceleration + drag * speed}
    campaign = Campaign("emps", (Run("run", "motion", 0.0, columns),))
    quantities = quantities_of(campaign.runs, compiled)
    replay = Replay(compiled, segments_of(campaign, compiled, quantities), quantities)
    observed = np.concatenate([segment.observed for segment in replay.segments])
    left = observed - replay.predict(World(acting=acting) if acting else NOMINAL)
    return float(np.sqrt(np.nanmean(left[5:-5] ** 2)))


def test_it_explains_torques_as_well_as_angles() -> None:
    effect = catalogue()["encoder_delay"]
    plain = residual(())
    late = residual((Acting(effect, WHOLE, {"delay": LATE_S}),))
    assert plain > 0.5  # [N]: 4 ms of an acceleration that changes by 2.5 m/s^2 in 0.3 s, on 95 kg
    assert late < 0.1 * plain


@pytest.mark.parametrize("share", [0.5, 1.5])
def test_another_delay_explains_less(share: float) -> None:
    effect = catalogue()["encoder_delay"]
    right, wrong = (residual((Acting(effect, WHOLE, {"delay": x * LATE_S}),)) for x in (1.0, share))
    assert wrong > 3 * right
