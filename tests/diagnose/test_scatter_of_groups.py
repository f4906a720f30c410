"""The scatter of samples about a parabola through each group of them."""

from itertools import pairwise

import numpy as np
import pytest

from bench.diagnose.replay.noise import FEWEST, Noise
from bench.diagnose.replay.quantities import quantities_of
from bench.record.campaign import Campaign, Run
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot

SIGMA = 0.3
CLOSE = 0.25  # relative: forty samples tell a standard deviation to 11 %, the median of few groups a little worse


@pytest.mark.parametrize("sizes", [(12, 40), (40, 60, 80, 100), (50, 50, 51), (200,)])
def test_groups_of_any_sizes_have_a_scatter(sizes: tuple[int, ...], rng: np.random.Generator) -> None:
    """Where half of the groups are short and half long, none is as long as the median says."""
    edges = np.cumsum((0, *sizes))
    groups = [np.arange(a, b) for a, b in pairwise(edges.tolist())]
    slow = np.linspace(0, 1, edges[-1]) ** 2
    values = np.stack([slow + rng.normal(0, SIGMA, edges[-1]) for _ in range(50)], axis=1)
    assert np.median(Noise.of_groups(values, groups)) == pytest.approx(SIGMA, rel=CLOSE)


@pytest.mark.parametrize("sizes", [(), (1,), (FEWEST - 1, FEWEST - 1, 100)])
def test_groups_that_are_too_short_have_none(sizes: tuple[int, ...]) -> None:
    groups = [np.arange(size) for size in sizes]
    assert np.array_equal(Noise.of_groups(np.ones((100, 2)), groups), np.zeros(2))


def test_a_reflector_with_one_coordinate_has_a_noise() -> None:
    """A warning of NumPy was shown: mean of an empty slice."""
    rows = 20
    columns = {"time_s": np.arange(rows) * 0.1, "q_cmd_1_rad": np.zeros(rows), "reflector_1_x_m": np.full(rows, 2.0)}
    run = Run("a", "motion", 0.0, columns)
    robot = compile_robot(load_robot("hh150"))
    (quantity,) = quantities_of((run,), robot)
    noise = Noise(Campaign("hh150", (run,)), robot.robot.figures).of(quantity, columns["reflector_1_x_m"], run)
    assert np.all(noise > 0)
