"""`gymnasium.make`: robots of a diagnosis, robots drawn from its posterior, several environments at once."""

from pathlib import Path

import gymnasium
import mujoco
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from bench.environment.drawn import PosteriorDraws
from bench.environment.entry import make
from bench.errors import InputError, RobotError
from bench.report.handover.posterior_file import read_posterior
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import Robot, load_robot
from bench.simulate.env import BenchEnv, Drawn
from tests.found import write_found
from tests.report.handover.made import torque_robot

DRAWS = 2000
# Of the inverses between a posterior and the readings that it is given as; condition numbers reach 1e6 here.
ROUNDING = 1e-6
# Standard errors of 2000 draws, five of which one of a few hundred numbers passes by chance once in 10,000 runs
FAR = 5.0


@pytest.fixture(scope="module")
def compiled(found: Path) -> CompiledRobot:
    return compile_robot(load_robot(found / "robot"))


@pytest.fixture(scope="module")
def draws(found: Path, compiled: CompiledRobot) -> PosteriorDraws:
    return PosteriorDraws(read_posterior(found / "robot"), compiled)


def drawn_values(draws: PosteriorDraws, count: int) -> np.ndarray:
    """Return deviations, shape (count, d); of what is known to a factor, of its logarithm."""
    rng = np.random.default_rng(11)
    drawn = np.array([list(draws(rng).parameters.values()) for _ in range(count)])
    is_factor = np.array([name.startswith(("stiffness of", "presliding stiffness")) for name in draws.names])
    factor, sigma = drawn[:, is_factor], draws.sigmas[is_factor]
    drawn[:, is_factor] = np.log1p(factor) / np.log1p(sigma) * sigma
    return drawn


def test_a_diagnosis_stands_for_its_robot(found: Path, compiled: CompiledRobot) -> None:
    env = gymnasium.make("bench:Bench-v0", robot=str(found)).unwrapped
    assert isinstance(env, BenchEnv)
    np.testing.assert_array_equal(env.plant.model.body_mass, compiled.model.body_mass)


def test_what_is_drawn_has_the_covariance_of_the_posterior(found: Path, draws: PosteriorDraws) -> None:
    posterior = read_posterior(found / "robot")
    index = {one.name: i for i, one in enumerate(posterior.parameters)}
    lasting = [i for i, name in enumerate(draws.names) if not name.startswith(("torque constant", "current offset"))]
    at = [index[draws.names[i]] for i in lasting]
    assert 20 < len(at) < len(draws.names)
    assert "loss of gas: lost, as found before" in draws.names
    assert draws.held == ()
    drawn = draws.covariance[np.ix_(lasting, lasting)]
    np.testing.assert_allclose(drawn, posterior.covariance[np.ix_(at, at)], atol=ROUNDING)
    for i in set(range(len(draws.names))) - set(lasting):  # what drifts is known less of a recording to come
        known = posterior.covariance[index[draws.names[i]], index[draws.names[i]]]
        assert known < draws.covariance[i, i] + ROUNDING < 1 + 2 * ROUNDING
    assert np.max(np.abs(draws.covariance - np.diag(np.diag(draws.covariance)))) > 0.05, "some trade against others"


def test_draws_scatter_as_the_covariance_says(draws: PosteriorDraws) -> None:
    values = drawn_values(draws, DRAWS) / draws.sigmas
    spread = np.diag(draws.covariance)
    np.testing.assert_array_less(np.abs(values.mean(axis=0)), FAR * np.sqrt(spread / DRAWS))
    error = np.sqrt((np.outer(spread, spread) + draws.covariance**2) / DRAWS)  # of a covariance of normal numbers
    np.testing.assert_array_less(np.abs(values.T @ values / DRAWS - draws.covariance), FAR * error)


def test_the_robot_is_the_one_that_was_drawn(found: Path, compiled: CompiledRobot) -> None:
    env = make(posterior=found, truth=True)
    _, info = env.reset(seed=4)
    drawn, nominal = info["parameters"], compiled.model
    assert isinstance(env.draw, PosteriorDraws)
    assert env.draw.names == tuple(drawn)
    assert env.plant.model.body("fore").mass[0] == pytest.approx(
        nominal.body("fore").mass[0] * (1 + drawn["mass of fore"])
    )
    x = env.plant.model.body("fore").ipos[2] - nominal.body("fore").ipos[2]
    assert x == pytest.approx(drawn["centre of mass of fore, z"], abs=1e-12)
    share = env.plant.model.dof_armature[compiled.at.q_dof[0]] / nominal.dof_armature[compiled.at.q_dof[0]]
    assert share == pytest.approx(1 + drawn["rotor inertia of hinge_a"])
    gas, now = compiled.counterbalance, env.plant.compiled.counterbalance
    assert gas
    assert now
    lost = drawn["loss of gas: lost, as found before"]
    constant = (1 - lost) * (1 + drawn["gas constant C"])
    assert now.gas_constant / gas.gas_constant == pytest.approx(constant)
    assert env.instruments.errors.current_gain[0] == pytest.approx(drawn["torque constant of hinge_a"])


def test_drives_that_report_torque_have_gains_that_were_drawn(tmp_path: Path) -> None:
    found = write_found(torque_robot(tmp_path / "small"), tmp_path / "found")
    env = make(posterior=found, truth=True)
    _, info = env.reset(seed=4)
    gains = env.plant.compiled.robot.figures.fitted.readings.torque_gain
    for j, name in enumerate(("hinge_a", "hinge_b")):
        expected = (1 + gains.get(name, 0.0)) * (1 + info["parameters"][f"torque constant of {name}"]) - 1
        assert env.instruments.errors.torque_gain[j] == pytest.approx(expected)
    env.reset(seed=5)
    assert env.instruments.errors.torque_gain[0] != pytest.approx(expected)


def test_what_the_diagnosis_says_nothing_of_is_drawn_by_the_instruments(found: Path) -> None:
    env = make(posterior=found)
    shifts = []
    for _ in range(2):
        env.reset()
        shifts.append(env.instruments.errors.frame_shift)
    assert np.all(shifts[0] != shifts[1])


def test_each_reset_is_another_robot_and_each_seed_the_same(found: Path) -> None:
    env = make(posterior=found, truth=True)
    action = {"q_cmd": np.array([0.1, -0.1]), "wrench": np.zeros(6)}

    def episode(seed: int | None) -> tuple[float, np.ndarray]:
        _, info = env.reset(seed=seed)
        return info["parameters"]["mass of fore"], env.step(action)[0]["current"]

    first, other, again = episode(1), episode(None), episode(1)
    assert first[0] == again[0]
    np.testing.assert_array_equal(first[1], again[1])
    assert first[0] != other[0]


@pytest.mark.filterwarnings("ignore:.*symmetric and normalized space")  # actions are commands in rad and N, not learned
@pytest.mark.parametrize("action", ["position", "torque"])
def test_drawn_robots_conform_to_gymnasium(found: Path, action: str) -> None:
    options = {"truth": True, "velocities": True, "action": action}
    made = gymnasium.make("bench:Bench-v0", posterior=str(found), **options)
    check_env(made.unwrapped, skip_render_check=True)


@pytest.mark.parametrize("mode", ["sync", "async"])
def test_several_at_once(found: Path, mode: str) -> None:
    options = {"posterior": str(found), "velocities": True, "truth": True}
    several = gymnasium.make_vec("bench:Bench-v0", num_envs=2, vectorization_mode=mode, **options)
    try:
        several.action_space.seed(1)
        observation, info = several.reset(seed=[1, 2])
        assert observation["current"].shape == (2, 2)
        masses = info["parameters"]["mass of fore"]
        assert masses[0] != masses[1]
        for _ in range(3):
            observation, reward, terminated, truncated, _ = several.step(several.action_space.sample())
        assert several.observation_space.contains(observation)
        assert not np.any(terminated | truncated)
        assert reward.tolist() == [0, 0]
    finally:
        several.close()


@pytest.mark.parametrize("failures", [3, 20])
def test_draws_that_make_no_model_are_drawn_again(small_robot: Path, failures: int) -> None:
    drawn: list[float] = []

    def draw(rng: np.random.Generator) -> Drawn:
        share = -1.0 if len(drawn) < failures else 2.0
        drawn.append(share)

        def edit(spec: mujoco.MjSpec, robot: Robot) -> None:
            spec.body("fore").mass *= share

        return Drawn((edit,), {}, {"mass": share})

    env = BenchEnv(str(small_robot), truth=True, draw=draw)
    if failures == 20:
        with pytest.raises(
            RobotError, match=r"none of 20 robots drawn in a row makes a model; the last: .*mass is -25"
        ):
            env.reset(seed=0)
    else:
        assert env.reset(seed=0)[1]["parameters"] == {"mass": 2.0}
        assert len(drawn) == failures + 1


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({}, "robot: name one"),
        ({"robot": "hh150", "posterior": "found"}, "give one of the two"),
        ({"posterior": "found", "draw": lambda rng: None}, "both draw the robot"),
        ({"robot": "hh151"}, "unknown robot 'hh151'"),
        ({"posterior": "hh150"}, "posterior.json: does not exist"),
        ({"posterior": "nowhere"}, "does not exist; give the folder that a finished `bench diagnose` wrote"),
    ],
)
def test_options_that_do_not_go_together_are_told(options: dict, said: str) -> None:
    with pytest.raises(InputError, match=said):
        gymnasium.make("bench:Bench-v0", **options)
