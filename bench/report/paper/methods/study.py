"""Which method to trust where: current, force and joint method over friction, noise and the way of measuring."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from threadpoolctl import threadpool_limits

from bench.executor.contract import Executor, Progress, in_order
from bench.identify.arm import Arm
from bench.identify.from_campaign import static_readings
from bench.identify.methods import METHODS
from bench.identify.options import Options
from bench.robot.bodies import Array
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.edits import proportional_servo, shared_friction
from bench.robot.figures import ForceSensor, Instruments, Tracker
from bench.robot.folder import Robot, load_robot
from bench.robot.links import rigid_bodies
from bench.scenario.loading import Loading
from bench.simulate.quasistatic import RestLog, rests_of

STUDIED = ("current", "force", "joint")


@dataclass(frozen=True)
class Condition:
    """How an experiment is done, and on what.

    Attributes:
        friction: Static friction of both sides together, relative to the link-side figures of the robot.
        link_share: Share of it on the link side, behind the elastic element.
        noise: Noise of tracker and force sensor, relative to their figures.
        direction_rad: Direction error of a load that does not hang [rad].
        approach: Directions from which poses are approached.
        unload: Whether loads are also taken off in steps.
        servo: "integral" or "proportional".
    """

    friction: float = 1.0
    link_share: float = 1.0
    noise: float = 1.0
    direction_rad: float = 0.005
    approach: tuple[int, ...] = (1, -1)
    unload: bool = True
    servo: str = "proportional"


@dataclass(frozen=True)
class ConditionResult:
    """What the methods made of one condition, n joints.

    Attributes:
        condition: Which.
        error: Method -> shape (seeds, n), relative error of the stiffness; nan where the readings could not tell.
    """

    condition: Condition
    error: dict[str, Array]

    def bias(self, method: str) -> Array:
        """Shape (n,), mean relative error over the seeds; nan where no seed gave an estimate."""
        return _over_seeds(np.nanmean, self.error[method])

    def spread(self, method: str) -> Array:
        """Shape (n,), standard deviation of the relative error over the seeds."""
        return _over_seeds(np.nanstd, self.error[method])

    def ratio(self) -> Array:
        """Shape (n,), stiffness by the force method over that by the current method, as in Table 6."""
        return _over_seeds(np.nanmean, (1 + self.error["force"]) / (1 + self.error["current"]))


def study_methods(
    scenario: Loading, conditions: Sequence[Condition], seeds: int, progress: Progress, executor: Executor
) -> list[ConditionResult]:
    """Run a loading scenario under every condition, from rest to rest, and identify it with noise of several seeds.

    Args:
        scenario: Poses, loads and repeats; its friction, servo and way of approach are those of the conditions.
        conditions: What to go through.
        seeds: Campaigns per condition.
        progress: Called with the share that is done.
        executor: Where to simulate.
    """
    return in_order(executor, _study, [(scenario, condition, seeds) for condition in conditions], progress)


def _study(job: tuple[Loading, Condition, int], progress: Progress) -> ConditionResult:
    scenario, condition, seeds = job
    log = _rests(scenario, condition)
    arm, truth, figures = Arm(rigid_bodies(log.compiled)), log.compiled.stiffness, log.compiled.robot.figures
    error = {name: np.empty((seeds, len(truth))) for name in STUDIED}
    with threadpool_limits(1, "blas"):
        for seed in range(seeds):
            readings = static_readings(log.read(np.random.default_rng([scenario.seed, seed])), figures)
            for name in STUDIED:
                estimate = METHODS[name](arm, log.compiled.counterbalance, readings, Options())
                error[name][seed] = estimate.stiffness / truth - 1
            progress((seed + 1) / seeds)
    return ConditionResult(condition, error)


def _rests(scenario: Loading, condition: Condition) -> RestLog:
    changes = {"approach": condition.approach, "unload": condition.unload, "orientation": False}
    edits = [shared_friction(condition.friction, condition.link_share)]
    if condition.servo == "proportional":
        edits.append(proportional_servo)
    robot = load_robot(scenario.robot)
    noisy = replace(robot, figures=robot.figures.model_copy(update={"instruments": _instruments(robot, condition)}))
    compiled: CompiledRobot = compile_robot(noisy, edits)
    return rests_of(scenario.model_copy(update=changes), compiled)


def _instruments(robot: Robot, condition: Condition) -> Instruments:
    known = robot.figures.instruments
    changes: dict[str, Tracker | ForceSensor] = {}
    if known.tracker:
        sigma = known.tracker.sigma_per_distance * condition.noise
        changes["tracker"] = known.tracker.model_copy(update={"sigma_per_distance": sigma})
    if known.force:
        update = {"sigma_n": known.force.sigma_n * condition.noise, "direction_sigma_rad": condition.direction_rad}
        changes["force"] = known.force.model_copy(update=update)
    return known.model_copy(update=changes)


def _over_seeds(reduce: Callable[..., Array], values: Array) -> Array:
    known = np.isfinite(values).any(axis=0)
    result = np.full(values.shape[1], np.nan)
    result[known] = reduce(values[:, known], axis=0)
    return result
