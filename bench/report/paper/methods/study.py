"""Which method to trust where: every analysis over friction, noise, and the protocol of the experiment."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from threadpoolctl import threadpool_limits

from bench.executor.contract import Executor, Progress, in_order
from bench.identify.advice import Method
from bench.identify.arm import Arm
from bench.identify.current import identify_current
from bench.identify.force import identify_force
from bench.identify.force_paper import identify_force_paper
from bench.identify.from_campaign import static_readings
from bench.identify.joint import identify_joint
from bench.identify.options import PLAIN, Options
from bench.report.paper.methods.protocols import AS_PLANNED, Protocol
from bench.robot.bodies import Array
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.edits import proportional_servo, shared_friction
from bench.robot.folder import Robot, load_robot
from bench.robot.instruments import ForceSensor, Instruments, Tracker
from bench.robot.links import rigid_bodies
from bench.scenario.loading import Loading
from bench.simulate.quasistatic import RestLog, rests_of


@dataclass(frozen=True)
class Analysis:
    """A method and how it is used.

    Attributes:
        method: The method.
        options: Its options; plain least squares unless others are given.
        among_loaded: Loaded states are held against the first loaded one, not against the unloaded one.
    """

    method: Method
    options: Options = PLAIN
    among_loaded: bool = False


WEIGHTED = Options()
METHODS = {
    "current": Analysis(identify_current, WEIGHTED),
    "force": Analysis(identify_force, WEIGHTED),
    "joint": Analysis(identify_joint, WEIGHTED),
}
ANALYSES = METHODS | {
    "current, plain Eq. (41)": Analysis(identify_current),
    "force, plain Eq. (35)": Analysis(identify_force),
    "force, plain Eq. (25)": Analysis(identify_force_paper),
    "current, from the first load": Analysis(identify_current, WEIGHTED, among_loaded=True),
    "force, from the first load": Analysis(identify_force, WEIGHTED, among_loaded=True),
}
AS_THE_PAPER = {name: ANALYSES[name] for name in ("current, plain Eq. (41)", "force, plain Eq. (35)")}


@dataclass(frozen=True)
class Condition:
    """How an experiment is done, and on what.

    Attributes:
        friction: Static friction of both sides together, relative to the link-side figures of the robot.
        link_share: Share of it on the link side, behind the elastic element.
        noise: Noise of tracker and force sensor, relative to their figures.
        direction_rad: Direction error of a load that does not hang [rad].
        protocol: Approach and loads.
        servo: "integral" or "proportional".
        orientation: The reflector is carried round its nests at each load, as Eq. (25) needs.
    """

    friction: float = 1.0
    link_share: float = 1.0
    noise: float = 1.0
    direction_rad: float = 0.005
    protocol: Protocol = AS_PLANNED
    servo: str = "proportional"
    orientation: bool = False


@dataclass(frozen=True)
class ConditionResult:
    """What the analyses made of one condition, n joints.

    Attributes:
        condition: Which.
        error: Analysis -> shape (seeds, n), relative error of the stiffness; nan where the readings could not tell.
    """

    condition: Condition
    error: Mapping[str, Array]

    def bias(self, analysis: str) -> Array:
        """Shape (n,), mean relative error over the seeds; nan where no seed gave an estimate."""
        return _over_seeds(np.nanmean, self.error[analysis])

    def spread(self, analysis: str) -> Array:
        """Shape (n,), standard deviation of the relative error over the seeds."""
        return _over_seeds(np.nanstd, self.error[analysis])

    def typical(self, analysis: str) -> float:
        """Median over the joints of |bias|."""
        return float(np.nanmedian(np.abs(self.bias(analysis))))

    def ratio(self, force: str = "force", current: str = "current") -> Array:
        """Shape (n,), stiffness by the force method over that by the current method, as in Table 6."""
        return _over_seeds(np.nanmean, (1 + self.error[force]) / (1 + self.error[current]))


def study_methods(
    scenario: Loading,
    conditions: Sequence[Condition],
    seeds: int,
    progress: Progress,
    executor: Executor,
    analyses: Mapping[str, Analysis] = METHODS,
) -> list[ConditionResult]:
    """Run a loading scenario under every condition, from rest to rest, and identify it with noise of several seeds.

    Args:
        scenario: Poses, loads and repeats; friction, servo and protocol are those of the conditions.
        conditions: What to go through.
        seeds: Campaigns per condition; 0: one, read by ideal instruments.
        progress: Called with the share that is done.
        executor: Where to simulate.
        analyses: What is made of each campaign.
    """
    jobs = [(scenario, condition, seeds, dict(analyses)) for condition in conditions]
    return in_order(executor, _study, jobs, progress)


def _study(job: tuple[Loading, Condition, int, dict[str, Analysis]], progress: Progress) -> ConditionResult:
    scenario, condition, seeds, analyses = job
    log = _rests(scenario, condition)
    arm, truth, figures = Arm(rigid_bodies(log.compiled)), log.compiled.stiffness, log.compiled.robot.figures
    error = {name: np.empty((max(seeds, 1), len(truth))) for name in analyses}
    with threadpool_limits(1, "blas"):
        for seed in range(max(seeds, 1)):
            rng = np.random.default_rng([scenario.seed, seed]) if seeds else None
            readings = static_readings(log.read(rng), figures)
            for name, analysis in analyses.items():
                used = readings.among_loaded() if analysis.among_loaded else readings
                estimate = analysis.method(arm, log.compiled.counterbalance, used, analysis.options)
                error[name][seed] = estimate.stiffness / truth - 1
            progress((seed + 1) / max(seeds, 1))
    return ConditionResult(condition, error)


def _rests(scenario: Loading, condition: Condition) -> RestLog:
    edits = [shared_friction(condition.friction, condition.link_share)]
    if condition.servo == "proportional":
        edits.append(proportional_servo)
    robot = load_robot(scenario.robot)
    noisy = replace(robot, figures=robot.figures.model_copy(update={"instruments": _instruments(robot, condition)}))
    compiled: CompiledRobot = compile_robot(noisy, edits)
    done = condition.protocol.of(scenario, Arm(rigid_bodies(compiled)), robot.figures.load_point)
    return rests_of(done.model_copy(update={"orientation": condition.orientation}), compiled)


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
