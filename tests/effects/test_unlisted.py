"""Unlisted effects: sign and size of some, so that tests of the verdict hide what they say."""

import numpy as np

from bench.effects.conditions import Conditions
from bench.effects.effect import Effect
from bench.effects.unlisted import unlisted
from bench.robot.compiled import CompiledRobot, SpecEdit
from bench.robot.folder import Robot
from tests.effects.rest import rest, sweep

SMALL = 0.3  # [Nm]; links sag a little more


def edit_of(effect: Effect, compiled: CompiledRobot, values: dict[str, float]) -> SpecEdit:
    place = effect.places(compiled)[-1]
    edit = effect.edit(place, effect.complete(values), Conditions.reference(compiled.n_joints))
    assert edit is not None
    return edit


def extra(small: Robot, edit: SpecEdit, angle: float) -> float:
    """Return what the second motor pays for it at rest [Nm]."""
    q = np.array([0.1, angle])
    return float((rest(small, [edit], q).torque - rest(small, [], q).torque)[1])


def test_detent(small: Robot, small_compiled: CompiledRobot) -> None:
    edit = edit_of(unlisted()["detent"], small_compiled, {"torque": 40.0, "angle": 0.3, "width": 0.1})
    np.testing.assert_allclose(extra(small, edit, 0.4), 40, atol=SMALL)
    np.testing.assert_allclose(extra(small, edit, 0.2), -40, atol=SMALL)
    np.testing.assert_allclose(extra(small, edit, 1.2), 0, atol=SMALL)


def test_cable(small: Robot, small_compiled: CompiledRobot) -> None:
    edit = edit_of(unlisted()["snapping_cable"], small_compiled, {"torque": 25.0, "angle": 0.2})
    np.testing.assert_allclose(extra(small, edit, 0.15), 25, atol=SMALL)
    np.testing.assert_allclose(extra(small, edit, 0.25), 0, atol=SMALL)


def test_drag_grows_with_the_square_of_speed(small: Robot, small_compiled: CompiledRobot) -> None:
    edit = edit_of(unlisted()["quadratic_drag"], small_compiled, {"coefficient": 500.0})
    for speed in (0.2, -0.4):
        motion = np.zeros(2), np.array([0.0, speed])
        paid = sweep(small, [edit], *motion).motor_torque[-1, 1] - sweep(small, [], *motion).motor_torque[-1, 1]
        np.testing.assert_allclose(paid, 500 * speed * abs(speed), rtol=0.01)
