"""Run a scenario: a policy drives the environment, what is read becomes a campaign, the truth stays apart."""

from collections.abc import Callable
from dataclasses import dataclass

from bench.record.campaign import Campaign, Run
from bench.robot.compiled import CompiledRobot, SpecEdit, compile_robot
from bench.robot.edits import friction_on, proportional_servo
from bench.robot.folder import Robot, load_robot
from bench.scenario.files import Experiment
from bench.scenario.types import ScenarioBase
from bench.simulate.drive import Log, Progress, drive, stacked
from bench.simulate.env import BenchEnv
from bench.simulate.instruments import Instruments, Reading
from bench.simulate.line import line_sittings
from bench.simulate.loading import loading_sittings
from bench.simulate.plant import Trace
from bench.simulate.policy import Mark, Sitting
from bench.simulate.rotation import rotation_sittings
from bench.simulate.tables import run_of, with_link_angles

BREAK = 60.0  # [s], between two sittings of one session

SITTINGS: dict[str, Callable[..., tuple[Sitting, ...]]] = {
    "line": line_sittings,
    "loading": loading_sittings,
    "rotation": rotation_sittings,
}


@dataclass(frozen=True)
class Film:
    """Instants of a session at a low rate, for people to look at.

    Attributes:
        trace: True quantities at each instant.
        reading: What the instruments showed at the same instants.
        events: (time [s], words) in order.
    """

    trace: Trace
    reading: Reading
    events: tuple[tuple[float, str], ...]


@dataclass(frozen=True)
class Session:
    """What running a scenario gives.

    Attributes:
        campaign: What the instruments read.
        compiled: The robot as simulated, without a payload.
        instruments: The instruments with their systematic errors (truth).
        ideal: What ideal instruments would have read, with the link angles beside it; run by run (truth).
        marks: Where each read instant belongs, in order.
        instants: True quantities at each read instant (truth).
        film: The session at a low rate.
    """

    campaign: Campaign
    compiled: CompiledRobot
    instruments: Instruments
    ideal: tuple[Run, ...]
    marks: tuple[Mark, ...]
    instants: Trace
    film: Film


def run_session(scenario: Experiment, progress: Progress = lambda share: None) -> Session:
    """Run a scenario on the virtual robot.

    Args:
        scenario: A validated scenario; it is held against the robot first.
        progress: Called now and then with the share of the session that is done, 0 to 1.

    Raises:
        InputError: The scenario does not fit the robot.
    """
    robot = load_robot(scenario.robot)
    compiled = compile_robot(robot, edits_of(scenario))
    scenario.check(robot, compiled.limits)
    sittings = SITTINGS[scenario.experiment](scenario, robot)
    log, instruments = _sit(scenario, robot, sittings, progress)
    instants = Trace.concatenate(log.instants)
    gravity, carried = compiled.model.opt.gravity, any(step.move_reflector for step in log.steps)

    def runs(reading: Reading) -> tuple[Run, ...]:
        return tuple(run_of(name, log, reading, gravity, carried) for name in log.run_names)

    return Session(
        campaign=Campaign(scenario.robot, runs(stacked(log.observations, log.instants)), notes=scenario.notes),
        compiled=compiled,
        instruments=instruments,
        ideal=tuple(with_link_angles(run, log, instants) for run in runs(Instruments(compiled, None).read(instants))),
        marks=tuple(step.mark for step in log.steps if step.mark),
        instants=instants,
        film=Film(Trace.concatenate(log.film), stacked(log.film_observations, log.film), tuple(log.events)),
    )


def edits_of(scenario: ScenarioBase) -> tuple[SpecEdit, ...]:
    """Return the changes of the model that a scenario asks for."""
    servo = (proportional_servo,) if scenario.servo == "proportional" else ()
    return (friction_on(scenario.friction), *servo)


def _sit(
    scenario: ScenarioBase, robot: Robot, sittings: tuple[Sitting, ...], progress: Progress
) -> tuple[Log, Instruments]:
    log, now = Log(), 0.0
    instruments: Instruments | None = None
    for i, sitting in enumerate(sittings):
        env = BenchEnv(
            str(robot.folder),
            edits=(*edits_of(scenario), *sitting.edits),
            truth=True,
            perfect_instruments=scenario.perfect_instruments,
        )
        env.reset(seed=scenario.seed if i == 0 else None, options={"q": sitting.start})
        if instruments is None:
            instruments = env.instruments
        env.instruments = instruments  # the same ones throughout a session, with the same errors
        now = BREAK + drive(env, sitting, now, log, lambda share, i=i: progress((i + share) / len(sittings)))  # type: ignore[misc]
    assert instruments is not None
    progress(1.0)
    return log, instruments
