"""Where friction slides, however slowly, and where it may be between its levels: nothing is read there."""

from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.replay.turning import STANDS, between_levels, presliding_travel
from bench.record.campaign import Array
from tests.diagnose.assumed.motion import CHANGE, JOINT, SAMPLE, SPEED, TIME, at_speed, beginnings, setting

SLOW = (TIME > 5) & (TIME < 7)


def read_in(speed: Array) -> int:
    """Return how many bins of the current of a joint are read between 5.3 s and 6.7 s of a motion."""
    found = at_speed(speed)
    begins = beginnings(found)
    return int(np.count_nonzero((begins > 5.3) & (begins < 6.7) & ~found.turning[:, JOINT]))


@pytest.mark.parametrize("share", [0.07, 0.01])
def test_what_goes_slowly_on_slides(share: float) -> None:
    compiled, _ = setting()
    path = np.zeros((len(TIME), compiled.n_joints))
    path[:, JOINT] = np.cumsum(np.where(SLOW, share * SPEED, SPEED)) * SAMPLE
    between = between_levels(path, TIME, 5, presliding_travel(compiled))[:, JOINT]
    assert not np.any(between[SLOW])


def test_what_stands_or_turns_round_all_the_time_is_not_read() -> None:
    compiled, _ = setting()
    travel = presliding_travel(compiled)[JOINT]
    swings = 0.3 * travel * 2 * np.pi * np.cos(2 * np.pi * TIME)  # through 0.6 of the travel, once a second
    assert not read_in(np.where(SLOW, 0.0, SPEED))
    assert not read_in(np.where(SLOW, swings, SPEED))


def test_what_comes_to_stand_is_not_read_at_last() -> None:
    """A stranger's friction fell off over the last millimetre, and a rest holds anything between the levels."""
    compiled, _ = setting()
    path = np.zeros((len(TIME), compiled.n_joints))
    path[:, JOINT] = np.minimum(SPEED * TIME, SPEED * CHANGE)  # until it stands
    between = between_levels(path, TIME, 5, presliding_travel(compiled))[:, JOINT]
    left = path[-1, JOINT] - path[:, JOINT]
    slides = (TIME > 1.0) & (left > presliding_travel(compiled)[JOINT] + 5 * SAMPLE * SPEED)
    assert not np.any(between[slides])
    assert np.all(between[left < presliding_travel(compiled)[JOINT] - 5 * SAMPLE * SPEED])


def test_friction_slides_again_after_twice_its_level_over_its_stiffness() -> None:
    """A joint that turns round: its element, as the plugin has it, is at its level where it is said to be."""
    compiled, _ = setting()
    level, stiffness = compiled.motor_coulomb[JOINT], compiled.motor_presliding[JOINT]
    known = compiled.robot.figures.uncertainty.model_copy(update={"presliding": 0.0})
    figures = compiled.robot.figures.model_copy(update={"uncertainty": known})
    exactly = replace(compiled, robot=replace(compiled.robot, figures=figures))
    softer = replace(exactly, motor_presliding=compiled.motor_presliding / 50)
    travel = presliding_travel(softer)
    assert travel[JOINT] == pytest.approx(2 * level / (stiffness / 50))
    assert np.all(presliding_travel(compiled) > presliding_travel(exactly))
    angle = 0.02 * np.sin(np.pi * TIME)
    friction, before = np.zeros_like(angle), 0.0
    for i, moved in enumerate(np.diff(angle, prepend=angle[0])):
        before = friction[i] = np.clip(before - stiffness / 50 * moved, -level, level)
    path = np.zeros((len(TIME), compiled.n_joints))
    path[:, JOINT] = angle
    between = between_levels(path, TIME, 5, travel)[:, JOINT]
    later = (TIME > 2.0) & (TIME < 11.8) & (np.abs(np.gradient(angle, SAMPLE)) > 2 * STANDS)  # it has turned round
    np.testing.assert_array_equal(between[later], (np.abs(friction) < level * (1 - 1e-9))[later])
