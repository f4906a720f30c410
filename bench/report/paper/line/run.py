"""Section 6 from scenario to numbers: friction, deflection by every method against the tracker, compensation."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.executor.contract import Executor, Progress
from bench.executor.serial import SERIAL
from bench.identify.arm import Arm
from bench.identify.compensation import Compensation, compensation
from bench.identify.estimate import StiffnessEstimate
from bench.identify.friction_pairs import PairFriction
from bench.identify.line_comparison import AxisComparison, compare
from bench.identify.line_deflection import (
    LineModel,
    Prediction,
    line_model,
    measured_deflection,
    measured_lost_motion,
    predicted_deflection,
    predicted_lost_motion,
)
from bench.identify.line_passes import AXES, WAYS
from bench.identify.link_share import LinkShare, link_share
from bench.report.paper.line.budget import TrajectoryError, tracker_sigma, trajectory_error
from bench.report.paper.line.sessions import LineSession, compensated, run_line_sessions
from bench.robot.bodies import Array
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.robot.links import rigid_bodies
from bench.scenario.files import read_as
from bench.scenario.line import Line

UNCOMPENSATED = "uncompensated"
FIRST_SHARE = 0.45  # of the progress, for the first session


@dataclass(frozen=True)
class MethodOnLine:
    """What one method says about the line, and what it achieves there.

    Attributes:
        deflection: Way -> predicted deflection by the load.
        comparison: Way -> measured less predicted, per axis.
        lost_motion: Place on the way out less that on the way back, under load: measured less predicted, per axis.
        link_share: Share of friction on the link side that the lost motion shows, with this stiffness.
        after: Way -> error of the trajectory with them.
        expected_error: Way -> shape (T, 3) [m], standard deviation of that error as covariance of the estimate and
            figures of the tracker let one expect it beforehand.
    """

    deflection: Mapping[str, Prediction]
    comparison: Mapping[str, tuple[AxisComparison, ...]]
    lost_motion: tuple[AxisComparison, ...]
    link_share: LinkShare
    after: Mapping[str, TrajectoryError]
    expected_error: Mapping[str, Array]


@dataclass(frozen=True)
class Reduction:
    """By which factor compensation reduces the rms error along one axis, out and back together.

    Attributes:
        achieved: Of the error that the tracker sees.
        expected: The same as covariance of the estimate and figures of the tracker let one expect it beforehand.
        true: Of the true error, without those of the tracker.
        by_stiffness: Of the true error, if that of the identified stiffness were all that is left of the deformation.
        by_estimate: The same with the error of the torques, friction above all.
    """

    achieved: float
    expected: float
    true: float
    by_stiffness: float
    by_estimate: float


@dataclass(frozen=True)
class LineReport:
    """The experiment and everything computed from it.

    Attributes:
        scenario: What was run.
        joint_names: Length n.
        place: Shape (T,) [m], distance from the start of the line.
        model: Arm, passes and friction by Eq. (48).
        before: Way -> error of the trajectory without compensation.
        methods: Method -> what it says and achieves.
    """

    scenario: Line
    joint_names: tuple[str, ...]
    place: Array
    model: LineModel
    before: Mapping[str, TrajectoryError]
    methods: Mapping[str, MethodOnLine]

    @property
    def friction(self) -> PairFriction:
        """Friction under load, Eq. (48)."""
        return self.model.friction["loaded"]

    def reduction(self, method: str, axis: str) -> Reduction:
        """Return the factors of reduction of a method along an axis."""
        found = self.methods[method]
        seen = _rms([self.before[way].error for way in WAYS], axis)
        true = _rms([self.before[way].true for way in WAYS], axis)

        def of(*parts: str) -> float:
            left = [sum((found.after[way].parts[part] for part in parts), np.zeros(3)) for way in WAYS]
            return _factor(true, _rms(left, axis))

        return Reduction(
            achieved=_factor(seen, _rms([found.after[way].error for way in WAYS], axis)),
            expected=_factor(seen, _rms([found.expected_error[way] for way in WAYS], axis)),
            true=_factor(true, _rms([found.after[way].true for way in WAYS], axis)),
            by_stiffness=of("stiffness"),
            by_estimate=of("stiffness", "torque"),
        )


def run_line(
    folder: Path,
    estimates: Mapping[str, StiffnessEstimate],
    progress: Progress,
    scenario: str | Line = "line",
    executor: Executor = SERIAL,
) -> LineReport:
    """Run the line out and back, unloaded and loaded; predict; run it again compensated by each method.

    Args:
        folder: Existing folder; campaign, truth and recording of each session are written into subfolders of it.
        estimates: Method -> stiffness, from an experiment before (`bench.report.identification`).
        progress: Called with the share that is done.
        scenario: Name or file of a line scenario, or the scenario.
        executor: Where to simulate.

    Raises:
        InputError: The scenario is not one of a line, or does not fit its robot.
    """
    base = scenario if isinstance(scenario, Line) else read_as(Line, scenario)
    robot = load_robot(base.robot)
    compiled = compile_robot(robot)
    arm = Arm(rigid_bodies(compiled))
    [first] = run_line_sessions([(base, folder / UNCOMPENSATED)], lambda share: progress(FIRST_SHARE * share), executor)
    model = line_model(arm, compiled.counterbalance, first.passes)
    corrections = {name: compensation(model, estimate) for name, estimate in estimates.items()}
    jobs = [(compensated(base, given), folder / f"compensated-{name}") for name, given in corrections.items()]
    sessions = run_line_sessions(jobs, lambda share: progress(FIRST_SHARE + (1 - FIRST_SHARE) * share), executor)
    nominal = first.passes.of("loaded", "out")
    sigma = tracker_sigma(robot.figures.instruments.tracker, nominal.reflector, nominal.sigma_reflector)
    rng = np.random.default_rng(base.seed)
    return LineReport(
        scenario=base,
        joint_names=arm.joint_names,
        place=base.length_m * first.passes.share,
        model=model,
        before={way: trajectory_error(arm, first, nominal, way) for way in WAYS},
        methods={
            name: _on_line(model, estimate, corrections[name], session, sigma, rng)
            for (name, estimate), session in zip(estimates.items(), sessions, strict=True)
        },
    )


def _on_line(
    model: LineModel,
    estimate: StiffnessEstimate,
    given: Compensation,
    session: LineSession,
    sigma: Array,
    rng: np.random.Generator,
) -> MethodOnLine:
    deflection = {way: predicted_deflection(model, estimate, way) for way in WAYS}
    nominal = model.passes.of("loaded", "out")
    return MethodOnLine(
        deflection=deflection,
        comparison={way: compare(*measured_deflection(model.passes, way), deflection[way], rng) for way in WAYS},
        lost_motion=compare(
            *measured_lost_motion(model.passes, "loaded"), predicted_lost_motion(model, estimate, "loaded"), rng
        ),
        link_share=link_share(model, estimate),
        after={way: trajectory_error(model.arm, session, nominal, way, given) for way in WAYS},
        expected_error={way: np.hypot(given.ways[way].removed.standard_error, sigma) for way in WAYS},
    )


def _factor(before: float, after: float) -> float:
    return before / after if after > 0 else np.inf


def _rms(values: list[Array], axis: str) -> float:
    return float(np.sqrt(np.mean(np.concatenate([each[:, AXES.index(axis)] for each in values]) ** 2)))
