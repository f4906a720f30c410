"""What is held out: whole runs, there and back together; blocks with gaps where there is one run."""

import numpy as np

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
