"""Hidden machines differ from recording to recording as a joint diagnosis expects them to."""

from collections.abc import Callable
from dataclasses import fields, replace
from functools import cache

import numpy as np
import pytest

from bench.diagnose.replay.levels import with_recordings
from bench.diagnose.replay.nuisances import Nuisance, nuisances_of
from bench.diagnose.replay.quantities import Quantity
from bench.effects.drifts import BETWEEN, own_shares
from bench.hide.background import Background
from bench.hide.recordings import background_in, errors_in
from bench.robot.compiled import compile_robot
from bench.simulate.instruments import Instruments, SystematicErrors
from tests.diagnose.recordings_small import ZEROED, compiled

DAYS = ("A", "B")
MACHINES = 900
# Four standard deviations of what so many pairs say of a correlation, and of a standard deviation as a share of itself
CORRELATION, SPREAD = 4 / np.sqrt(MACHINES), 4 / np.sqrt(2 * MACHINES)

NAMES: dict[str, Callable[[Background, SystematicErrors], float]] = {
    "viscous friction of joint2": lambda background, errors: background.deviations["viscous friction of joint2"],
    "mass of column": lambda background, errors: background.deviations["mass of column"],
    "weights that hang": lambda background, errors: background.hung,
    "weights bolted on": lambda background, errors: background.bolted,
    "torque constant of joint2": lambda background, errors: errors.current_gain[1],
    "current offset of joint2": lambda background, errors: errors.current_offset[1],
    "zero of link encoder 2": lambda background, errors: errors.link_encoder_offset[1],
    "gain of the force sensor": lambda background, errors: errors.force_gain,
    "tilt of the force sensor, x": lambda background, errors: errors.force_tilt[0],
    "tracker frame, shift x": lambda background, errors: errors.frame_shift[0],
    "tracker frame, turn x": lambda background, errors: errors.frame_rotation[0],
    "nest of reflector 1, x": lambda background, errors: errors.placement[0, 0],
}


@cache
def drawn() -> dict[str, np.ndarray]:
    """Return errors of many machines in two recordings each by their names in a diagnosis, shape (MACHINES, 2)."""
    found: dict[str, list[list[float]]] = {}
    for seed in range(MACHINES):
        both = [_of_one(seed, day) for day in range(len(DAYS))]
        for name in both[0]:
            found.setdefault(name, []).append([one[name] for one in both])
    return {name: np.array(pairs) for name, pairs in found.items()}


def _of_one(seed: int, day: int) -> dict[str, float]:
    robot, machine, rng = compiled(), np.random.default_rng([1, seed]), np.random.default_rng([2, seed, day])
    background = background_in(robot, Background.draw(robot, machine), Background.draw(robot, rng), rng)
    errors = errors_in(robot, Instruments(robot, machine).errors, Instruments(robot, rng).errors)
    return {name: value(background, errors) for name, value in NAMES.items()}


@cache
def expected() -> tuple[Nuisance, ...]:
    columns = ("current_2_a", "force_x_n", "reflector_1_x_m", "q_link_2_rad")
    kinds, index = ("current", "force", "reflector", "q_link"), (1, 0, 0, 1)
    quantities = (Quantity(*one, "", i) for *one, i in zip(columns, kinds, index, strict=True))
    return with_recordings(nuisances_of(compiled(), tuple(quantities)), compiled(), DAYS)


@pytest.mark.parametrize("name", list(NAMES))
def test_errors_repeat_from_recording_to_recording_as_a_diagnosis_expects(name: str) -> None:
    pairs = drawn()[name]
    variance = {
        who: sum(n.sigma**2 for n in expected() if n.name == name and n.recording == who) for who in (None, "A")
    }
    total = sum(variance.values())
    assert np.sqrt(np.mean(pairs**2)) == pytest.approx(np.sqrt(total), rel=SPREAD)
    assert np.corrcoef(pairs.T)[0, 1] == pytest.approx(variance[None] / total, abs=CORRELATION)


def test_a_zero_that_mostly_lasts_repeats_on_both_sides() -> None:
    """An encoder that is set to the other one within 2 mrad, and zeroed within half of that in each recording."""
    robot = compiled().robot
    figures = robot.figures
    encoder = figures.instruments.link_encoder
    assert encoder
    encoder = encoder.model_copy(update={"zeroing_sigma_rad": 0.5 * encoder.offset_sigma_rad})
    instruments = figures.instruments.model_copy(update={"link_encoder": encoder})
    assert own_shares(figures.model_copy(update={"instruments": instruments}))["link_encoder_offset"] == 0.25
    own = replace(robot, figures=figures.model_copy(update={"instruments": instruments}))
    (zero,) = nuisances_of(compile_robot(own), (Quantity("q_link_2_rad", "q_link", "", 1),))[-1:]
    assert [one.sigma for one in with_recordings((zero,), compiled(), DAYS)[:3]] == pytest.approx(
        [np.sqrt(0.75) * ZEROED, ZEROED / 2, ZEROED / 2]
    )


def test_every_error_of_an_instrument_says_what_becomes_of_it() -> None:
    assert set(BETWEEN) == {field.name for field in fields(SystematicErrors)}
