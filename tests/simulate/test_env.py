"""The stepping interface keeps Gymnasium's contract."""

from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from bench.errors import InputError, RobotError
from bench.simulate.env import BenchEnv


@pytest.fixture
def env(small_robot: Path) -> BenchEnv:
    return BenchEnv(str(small_robot), truth=True)


@pytest.mark.filterwarnings("ignore:.*symmetric and normalized space")  # actions are commands in rad and N, not learned
def test_conforms_to_gymnasium(small_robot: Path) -> None:
    made = gymnasium.make("bench:Bench-v0", robot=str(small_robot))
    check_env(made.unwrapped, skip_render_check=True)


def test_same_seed_same_readings(env: BenchEnv) -> None:
    def readings(seed: int) -> list[np.ndarray]:
        env.reset(seed=seed)
        action = {"q_cmd": np.array([0.1, -0.1]), "wrench": np.zeros(6)}
        return [env.step(action)[0]["current"] for _ in range(5)]

    np.testing.assert_array_equal(readings(3), readings(3))
    assert not np.array_equal(readings(3), readings(4))


def test_actions_that_do_not_fit_are_refused(env: BenchEnv) -> None:
    env.reset(seed=0)
    good = {"q_cmd": np.zeros(2), "wrench": np.zeros(6)}
    for bad in ({"q_cmd": np.zeros(3)}, {"q_cmd": np.zeros(1)}, {"wrench": np.zeros(5)}):
        with pytest.raises(ValueError, match="do not fit"):
            env.step(good | bad)
    with pytest.raises(KeyError):
        env.step({"q_cmd": np.zeros(2)})
    env.step(good)


def test_observations_have_the_order_of_their_space(env: BenchEnv) -> None:
    first, _ = env.reset(seed=0)
    second = env.step({"q_cmd": np.zeros(2), "wrench": np.zeros(6)})[0]
    assert list(first) == list(second)
    assert env.observation_space.contains(second)


def test_truth_only_when_asked(small_robot: Path, env: BenchEnv) -> None:
    assert "truth" in env.reset(seed=0)[1]
    silent = BenchEnv(str(small_robot))
    assert silent.reset(seed=0)[1] == {}
    assert silent.step(silent.action_space.sample())[4] == {}


def test_starts_at_rest_where_told(env: BenchEnv) -> None:
    q = np.array([0.5, -0.4])
    _, info = env.reset(seed=0, options={"q": q})
    np.testing.assert_array_equal(info["truth"].q[0], q)
    for _ in range(10):
        _, _, _, _, info = env.step({"q_cmd": q, "wrench": np.zeros(6)})
    np.testing.assert_allclose(info["truth"].q[0], q, atol=1e-12)


def test_perfect_instruments_tell_the_truth(small_robot: Path) -> None:
    perfect = BenchEnv(str(small_robot), truth=True, perfect_instruments=True)
    perfect.reset(seed=0)
    push = np.array([10.0, 5.0, -80.0, 1.0, 2.0, 3.0])
    for _ in range(20):
        seen, _, _, _, info = perfect.step({"q_cmd": np.array([0.1, 0.2]), "wrench": push})
    truth = info["truth"]
    np.testing.assert_array_equal(seen["q_motor"], truth.q[0])
    np.testing.assert_array_equal(seen["current"], truth.motor_torque[0] / 100.0)
    np.testing.assert_array_equal(seen["reflectors"], truth.reflectors[0])
    np.testing.assert_array_equal(np.concatenate([seen["force"], seen["moment"]]), truth.wrench[0])
    np.testing.assert_array_equal(seen["gas_pressure"], truth.counterbalance_force / 0.001)


def test_unknown_names_are_told(small_robot: Path) -> None:
    with pytest.raises(RobotError, match="unknown robot 'hh151'"):
        BenchEnv("hh151")
    with pytest.raises(InputError, match="render_mode"):
        BenchEnv(str(small_robot), render_mode="human")


def test_renders(small_robot: Path) -> None:
    env = BenchEnv(str(small_robot), render_mode="rgb_array")
    env.reset(seed=0)
    try:
        image = env.render()
    except (ImportError, RuntimeError, AttributeError) as reason:
        pytest.skip(f"no GL context on this machine: {reason}")
    assert image is not None
    assert image.shape == (480, 640, 3)
    assert image.std() > 0, "an empty picture"
    env.close()
