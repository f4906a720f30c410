"""The stepping interface keeps Gymnasium's contract."""

from pathlib import Path

import gymnasium
import mujoco
import numpy as np
import pytest
import yaml
from gymnasium.utils.env_checker import check_env

from bench.errors import InputError, RobotError
from bench.robot.compiled import read_spec
from bench.simulate.env import CONTROL_PERIOD, BenchEnv
from tests.small_robot import FIGURES, write_small_robot

TORQUE_ERROR = 1e-5  # [Nm]; `torque_plant.GAIN` times a few radians


@pytest.fixture
def env(small_robot: Path) -> BenchEnv:
    return BenchEnv(str(small_robot), truth=True)


@pytest.mark.filterwarnings("ignore:.*symmetric and normalized space")  # actions are commands in rad and N, not learned
@pytest.mark.parametrize("action", ["position", "torque"])
@pytest.mark.parametrize("truth", [False, True])
@pytest.mark.parametrize("options", [{}, {"velocities": True}, {"velocities": True, "perfect_instruments": True}])
def test_conforms_to_gymnasium(small_robot: Path, action: str, truth: bool, options: dict[str, bool]) -> None:
    made = gymnasium.make("bench:Bench-v0", robot=str(small_robot), action=action, truth=truth, **options)
    check_env(made.unwrapped, skip_render_check=True)


def test_same_seed_same_readings(env: BenchEnv) -> None:
    def readings(seed: int) -> list[np.ndarray]:
        env.reset(seed=seed)
        action = {"q_cmd": np.array([0.1, -0.1]), "wrench": np.zeros(6)}
        return [env.step(action)[0]["current"] for _ in range(5)]

    np.testing.assert_array_equal(readings(3), readings(3))
    assert not np.array_equal(readings(3), readings(4))


GOOD = {"q_cmd": np.zeros(2), "wrench": np.zeros(6)}


@pytest.mark.parametrize(
    ("bad", "said"),
    [
        ({"q_cmd": np.zeros(3)}, r"q_cmd: has the shape \(3,\), which does not fit; give \(2,\)"),
        ({"q_cmd": np.zeros(1)}, "do(es)? not fit"),
        ({"wrench": np.zeros(5)}, "wrench: has the shape"),
        ({"q_cmd": np.zeros((2, 1))}, "does not fit"),
        ({"q_cmd": np.array([0.0, np.nan])}, r"q_cmd\[1\]: is nan"),
        ({"q_cmd": np.array([2.1, 0.0])}, r"q_cmd\[0\]: 2.1 is outside of -1 to 2; clip it to env.action_space"),
        ({"wrench": np.array([0.0, 0.0, -301.0, 0.0, 0.0, 0.0])}, r"wrench\[2\]: -301 is outside of -300 to 300"),
        ({"wrench": np.full(6, np.inf)}, r"wrench\[5\]: inf is outside of -50 to 50"),
    ],
)
def test_actions_that_do_not_fit_are_refused(env: BenchEnv, bad: dict[str, np.ndarray], said: str) -> None:
    env.reset(seed=0)
    with pytest.raises(InputError, match=said):
        env.step(GOOD | bad)
    assert env.plant.data.time == 0, "nothing has moved"
    env.step(GOOD)


def test_an_action_lacks_no_part(env: BenchEnv) -> None:
    env.reset(seed=0)
    with pytest.raises(KeyError):
        env.step({"q_cmd": np.zeros(2)})


def test_the_ends_of_the_ranges_are_taken_in_single_precision_too(env: BenchEnv) -> None:
    env.reset(seed=0)
    for end in ("low", "high"):
        action = {name: getattr(space, end) for name, space in env.action_space.items()}
        env.step(action)
        env.step({name: part.astype(np.float32) for name, part in action.items()})


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


@pytest.mark.parametrize("q", [[0.1], [0.1, np.nan], "home", [[0.1, 0.2]], [0.1, None]])
def test_starts_nowhere_else(env: BenchEnv, q: object) -> None:
    with pytest.raises(InputError, match=r"reset: options\['q'\]"):
        env.reset(options={"q": q})
    with pytest.raises(InputError, match="unknown option 'qpos'"):
        env.reset(options={"qpos": [0.0, 0.0]})


def test_velocities_are_what_the_encoders_advanced_by(small_robot: Path) -> None:
    env = BenchEnv(str(small_robot), truth=True, velocities=True)
    first, _ = env.reset(seed=0)
    np.testing.assert_array_equal(first["q_motor_velocity"], 0)
    q, interval = first["q_motor"], CONTROL_PERIOD - env.plant.timestep
    for i in range(1, 101):
        seen, _, _, _, info = env.step(GOOD | {"q_cmd": np.array([0.4, -0.2]) * i * CONTROL_PERIOD})
        np.testing.assert_array_equal(seen["q_motor_velocity"], (seen["q_motor"] - q) / interval)
        q, interval = seen["q_motor"], CONTROL_PERIOD
    np.testing.assert_allclose(info["truth"].q_velocity[0], [0.4, -0.2], rtol=0.01)
    np.testing.assert_allclose(seen["q_motor_velocity"], [0.4, -0.2], rtol=0.01)
    assert env.reset(seed=0)[0]["q_motor_velocity"].tolist() == [0, 0]


def test_velocities_need_encoders(tmp_path: Path) -> None:
    robot = write_small_robot(tmp_path / "small")
    instruments = FIGURES["instruments"] | {"encoder": None}
    (robot / "figures.yaml").write_text(yaml.safe_dump(FIGURES | {"instruments": instruments}))
    with pytest.raises(InputError, match="no motor encoders"):
        BenchEnv(str(robot), velocities=True)


def test_torques_that_held_the_robot_hold_it(small_robot: Path) -> None:
    env = BenchEnv(str(small_robot), truth=True, action="torque")
    _, info = env.reset(seed=0, options={"q": [0.3, -0.4]})
    assert np.all(np.abs(info["torque"]) > 1)
    for _ in range(250):
        *_, seen = env.step({"torque": info["torque"], "wrench": np.zeros(6)})
    np.testing.assert_allclose(seen["truth"].q[0], [0.3, -0.4], atol=1e-9)
    np.testing.assert_allclose(seen["truth"].motor_torque[0], info["torque"], atol=TORQUE_ERROR)


def test_torques_act_on_the_rotors(small_robot: Path) -> None:
    """Beside MuJoCo's own steps of the robot without servos, with the same torques as forces on its joints."""
    env = BenchEnv(str(small_robot), truth=True, action="torque")
    _, info = env.reset(seed=0)
    at = env.plant.compiled.at
    spec = read_spec(env.plant.compiled.robot)
    for drive in env.plant.compiled.robot.figures.drives:
        spec.delete(spec.actuator(drive.servo))
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qpos[:] = env.plant.data.qpos
    torque = info["torque"] + [400.0, -250.0]
    push = np.array([0.0, 0.0, 60.0, 0.0, 0.0, 0.0])
    for i in range(50):
        env.step({"torque": torque, "wrench": push})
        for k in range(4):
            data.qfrc_applied[at.q_dof] = torque
            data.xfrc_applied[at.load_body] = push * (k / 4 if i == 0 else 1)
            mujoco.mj_step(model, data)
    assert np.all(np.abs(data.qpos[at.q] - [0, 0]) > 0.01), "it has moved"
    np.testing.assert_allclose(env.plant.data.qpos, data.qpos, atol=1e-8)
    np.testing.assert_allclose(env.plant.data.qvel, data.qvel, atol=1e-7)


def test_torques_are_within_the_drives_limits(small_robot: Path) -> None:
    env = BenchEnv(str(small_robot), action="torque")
    env.reset(seed=0)
    with pytest.raises(InputError, match=r"torque\[1\]: 9001 is outside of -9000 to 9000"):
        env.step({"torque": np.array([0.0, 9001.0]), "wrench": np.zeros(6)})
    with pytest.raises(KeyError):
        env.step(GOOD)


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
    with pytest.raises(InputError, match="unknown kind of action 'force'"):
        BenchEnv(str(small_robot), action="force")  # type: ignore[arg-type]
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
