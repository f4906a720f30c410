"""What all tests share."""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # small matrices, and pytest-xdist has the cores already
os.environ.setdefault("MUJOCO_GL", "egl")  # read when MuJoCo is imported; machines that run tests have no display

import gc
import signal
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings

from tests.small_robot import write_small_robot

settings.register_profile("bench", deadline=None)  # machines are shared: nothing is said of seconds
settings.load_profile("bench")

# A shell that runs the tests in the background lets them ignore Ctrl-C, and so the processes that they start.
signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Iterator[None]:
    """Look for no garbage among what is collected, a quarter of the time, nor later among modules and tests."""
    gc.disable()
    yield
    gc.freeze()
    gc.enable()


@pytest.fixture(autouse=True)
def floating_point_errors_raise() -> Iterator[None]:
    with np.errstate(all="raise", under="ignore"):  # a weight that underflows is zero, which is what it means
        yield


@pytest.fixture(scope="session", autouse=True)
def no_store_of_the_user(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Commands that tests run, also in processes of their own, keep signatures in a folder of the test session.

    It is one for all of its workers: what one has simulated, another reads.
    """
    base = tmp_path_factory.getbasetemp()
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("BENCH_STORE", str((base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "store"))
        yield


@pytest.fixture(scope="session")
def small_robot(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a two-joint robot."""
    return write_small_robot(tmp_path_factory.mktemp("robots") / "small")


@pytest.fixture(scope="session")
def found(small_robot: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a diagnosis of the two-joint robot, as far as other commands read it."""
    from tests.found import write_found

    return write_found(small_robot, tmp_path_factory.mktemp("diagnoses") / "found")


@pytest.fixture
def rng() -> np.random.Generator:
    """Random numbers that are the same in every run."""
    return np.random.default_rng(20261121)
