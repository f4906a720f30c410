"""Single places of a reflector that are out of line are told; noise with tails, jerks and settling are not."""

import numpy as np
import pytest

from bench.record.campaign import Run
from bench.record.finding import Finding
from bench.record.rules.out_of_line import CHANCE, places_in_line
from bench.record.rules.sheet import Sheet
from tests.record.build import motion, static

ROWS, STEP_S, SIGMA_M = 300, 0.02, 30e-6
AXES = [f"reflector_1_{axis}_m" for axis in "xyz"]


def sweep(seed: int, freedom: float = 30.0, sigma: float = SIGMA_M) -> dict[str, np.ndarray]:
    """Return a reflector on a quarter of a circle of 2 m, in 6 s."""
    rng = np.random.default_rng(seed)
    time = STEP_S * np.arange(ROWS)
    angle = np.pi / 2 * (1 - np.cos(np.pi * time / time[-1])) / 2
    place = 2.0 * np.stack([np.cos(angle), np.sin(angle), 0 * angle])
    noise = sigma * rng.standard_t(freedom, place.shape)
    return {"time_s": time, "q_cmd_1_rad": angle, **dict(zip(AXES, place + noise, strict=True))}


def rests(seed: int, freedom: float = 30.0, repeats: int = 5) -> dict[str, np.ndarray]:
    """Return a reflector at rest under many loads."""
    step = np.repeat(np.arange(40.0), repeats)
    noise = SIGMA_M * np.random.default_rng(seed).standard_t(freedom, (3, len(step)))
    labels = {"pose": 0 * step + 1, "approach": 0 * step + 1, "load_step": step, "q_cmd_1_rad": 0 * step}
    return labels | dict(zip(AXES, 2.0 + noise - 0.001 * step, strict=True))


def found(*runs: Run) -> list[Finding]:
    return list(places_in_line([Sheet(run, f"{run.name}.csv", tuple(run.columns)) for run in runs]))


@pytest.mark.parametrize("off", [0.003, 0.005, -0.05])
def test_a_row_of_a_motion_is_told(off: float) -> None:
    columns = sweep(1)
    assert not found(motion(columns))
    columns[AXES[2]][150] += off
    (finding,) = found(motion(columns))
    assert (finding.level, finding.column, finding.row) == ("warning", "reflector_1", 151)
    assert round(float(finding.message.split()[1])) == round(1e3 * abs(off))


def test_several_rows_of_a_motion_are_told() -> None:
    columns = sweep(2)
    for row, off in ((50, 0.004), (150, -0.006), (250, 0.005)):
        columns[AXES[0]][row] += off
    (finding,) = found(motion(columns))
    assert "rows 51, 151 and 251" in finding.message


@pytest.mark.parametrize("off", [0.002, 0.005])
def test_a_repeat_at_rest_is_told(off: float) -> None:
    columns = rests(3)
    assert not found(static(columns))
    columns[AXES[0]][77] += off
    (finding,) = found(static(columns))
    assert finding.row == 78


def test_of_few_repeats_an_arm_that_sways_is_not_told() -> None:
    columns = rests(4, repeats=3)
    columns[AXES[0]][77] += 0.005
    assert not found(static(columns))


@pytest.mark.parametrize("freedom", [4.0, 6.0, 30.0])
def test_tails_of_noise_are_told_as_rarely_as_declared(freedom: float) -> None:
    """Of 400 reflectors the declared rate makes 0.4; four or more would come of it once in a thousand times."""
    assert CHANCE == 1e-3
    said = sum(len(found(motion(sweep(seed, freedom)), static(rests(seed, freedom)))) for seed in range(200))
    assert said < 4


def test_a_jerk_and_a_jump_are_no_single_rows() -> None:
    time = STEP_S * np.arange(ROWS)
    jerked, jumped = sweep(5), sweep(6)
    jerked[AXES[2]] += np.where(time > 3.0, 0.5 * (time - 3.0), 0.0)  # half a metre per second at once
    jumped[AXES[2]] += np.where(time > 3.0, 0.005, 0.0)
    assert not found(motion(jerked))
    assert not found(motion(jumped))


def test_rows_around_one_that_was_lost_are_believed() -> None:
    columns = {name: np.delete(values, 150) for name, values in sweep(7).items()}
    assert not found(motion(columns))


def test_an_instrument_that_repeats_its_last_reading_is_left_alone() -> None:
    columns = sweep(8)
    for name in AXES:
        columns[name] = np.repeat(columns[name][::10], 10)
    assert not found(motion(columns))
