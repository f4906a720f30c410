"""What is held out: whole runs, there and back together; blocks with gaps where there is one run."""

import numpy as np
import pytest

from bench.identify.arm import Arm
from bench.identify.dynamics.band import Band
from bench.identify.dynamics.equations import Equations, equations_of
from bench.identify.dynamics.folds import folds_of
from bench.identify.dynamics.samples import MotionSamples
from bench.record.held_out import BLOCKS
from tests.identify.dynamics.rigid_world import arm, fourier, robot

BAND = Band(10.0, np.nan)


def stretch(run: str, path: np.ndarray) -> Equations:
    time = np.arange(len(path)) / 100.0
    samples = MotionSamples(run, "", 100.0, time, path, path, np.ones_like(path), np.zeros((len(path), 6)), 0 * time)
    nominal = robot(arm())
    return equations_of(samples, BAND, Arm(nominal.bodies), nominal, np.ones(path.shape[1]))


def paths(rng: np.random.Generator, count: int) -> list[np.ndarray]:
    return [fourier(rng, seconds=10.0, rate=100.0)[1] for _ in range(count)]


def test_runs_are_folds(rng: np.random.Generator) -> None:
    folds = folds_of([stretch(f"r{k}", path) for k, path in enumerate(paths(rng, 3))])
    assert folds.by == "run"
    assert folds.names == ("r0", "r1", "r2")
    assert not folds.repeats


@pytest.mark.parametrize(("runs", "parts"), [(1, BLOCKS), (2, BLOCKS), (3, 6), (5, 5), (9, 9)])
def test_few_folds_are_cut_in_time(rng: np.random.Generator, runs: int, parts: int) -> None:
    """What is gained is held against how its parts differ: two runs of which each is held out whole are two numbers."""
    folds = folds_of([stretch(f"r{k}", path) for k, path in enumerate(paths(rng, runs))])
    part, count = folds.parts()
    assert count == parts
    assert set(np.concatenate(part)) == set(range(count))
    for own, of in zip(part, folds.of, strict=True):
        np.testing.assert_array_equal(own // (count // len(folds)), of)
        assert np.all(np.diff(own) >= 0)


def test_there_and_back_is_one_fold(rng: np.random.Generator) -> None:
    one, other = paths(rng, 2)
    folds = folds_of([stretch("there", one), stretch("other", other), stretch("back", one[::-1])])
    assert folds.names == ("there and back", "other")


def test_one_run_is_cut_into_blocks_with_gaps(rng: np.random.Generator) -> None:
    (path,) = paths(rng, 1)
    folds = folds_of([stretch("only", path)])
    assert folds.by == "block"
    assert 1 < len(folds) <= BLOCKS
    (of,), (near,) = folds.of, folds.near
    for fold in range(len(folds)):
        beside = np.flatnonzero(near[:, fold])
        assert len(beside) > 0
        assert not np.any(of[beside] == fold)


def test_a_path_repeated_throughout_is_said(rng: np.random.Generator) -> None:
    (path,) = paths(rng, 1)
    folds = folds_of([stretch("one", path), stretch("two", path[::-1])])
    assert folds.repeats
    assert len(folds) == 2


def in_a_plane(seed: int) -> np.ndarray:
    """Return a Fourier run of two joints; the third stands."""
    path = fourier(np.random.default_rng(seed), seconds=20.0, rate=100.0)[1]
    return np.asarray(path * [1, 1, 0])


def test_two_runs_of_two_joints_are_two_paths() -> None:
    """They were "the same angles": in a plane every path lies near every other one that crosses it often."""
    time = np.arange(6000) / 100
    one, two = (
        np.column_stack([np.sin(a * time + 0.3), np.sin(b * time), 0 * time]) for a, b in ((1.3, 2.1), (1.9, 1.1))
    )
    folds = folds_of([stretch("one", one), stretch("two", two)])
    assert not folds.repeats


def test_there_and_back_at_another_speed_is_one_fold_in_a_plane(rng: np.random.Generator) -> None:
    there, other = in_a_plane(0), in_a_plane(1)
    slowly = np.stack([np.interp(np.arange(0, 1999, 0.6), np.arange(2000), values) for values in there.T], axis=1)
    back = slowly[::-1] + 1e-5 * rng.normal(size=slowly.shape) * [1, 1, 0]
    folds = folds_of([stretch("there", there), stretch("other", other), stretch("back", back)])
    assert folds.names == ("there and back", "other")


def test_one_axis_has_one_path() -> None:
    one, two = (in_a_plane(seed) * [1, 0, 0] for seed in (0, 1))
    assert folds_of([stretch("one", one), stretch("two", two)]).repeats
