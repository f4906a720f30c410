"""Run a scenario: a policy drives the environment, what is read becomes a campaign, the truth stays apart."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import chain, islice

import numpy as np

from bench.errors import ScenarioError
from bench.record.campaign import Campaign, Run
from bench.record.limits import SIMULATED_SECONDS
from bench.robot.compiled import CompiledRobot, SpecEdit, compile_robot
from bench.robot.edits import friction_on, proportional_servo
from bench.robot.folder import Robot, load_robot
from bench.scenario.files import Experiment
from bench.scenario.session import SessionScenario
from bench.scenario.types import ScenarioBase
from bench.simulate.bare import bare_spec
from bench.simulate.batch import course_of, follow, read_steps
from bench.simulate.drive import FILM_PERIOD, Log, Progress, drive, stacked
from bench.simulate.env import CONTROL_PERIOD, BenchEnv
from bench.simulate.instruments import Instruments, Reading
from bench.simulate.line import line_sittings
from bench.simulate.loading import loading_sittings
from bench.simulate.parts import session_sittings
from bench.simulate.plant import Left, Plant
from bench.simulate.policy import Mark, Sitting
from bench.simulate.rotation import rotation_sittings
from bench.simulate.tables import Joints, run_of, with_link_angles
from bench.simulate.trace import Trace

SITTINGS: dict[str, Callable[..., tuple[Sitting, ...]]] = {
    "line": line_sittings,
    "loading": loading_sittings,
    "rotation": rotation_sittings,
    "session": session_sittings,
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
    sittings = sittings_of(scenario, robot)
    run = _in_stretches if isinstance(scenario, SessionScenario) else _period_by_period
    record = run(scenario, compiled, sittings, progress)
    progress(1.0)
    log, instants = record.log, record.instants
    gravity, carried = compiled.model.opt.gravity, any(step.move_reflector for step in log.steps)
    joints = Joints.of(compiled)

    def runs(reading: Reading) -> tuple[Run, ...]:
        return tuple(run_of(name, log, reading, gravity, carried, joints) for name in log.run_names)

    return Session(
        campaign=Campaign(scenario.robot, runs(record.reading), notes=scenario.notes),
        compiled=compiled,
        instruments=record.instruments,
        ideal=tuple(with_link_angles(run, log, instants) for run in runs(Instruments(compiled, None).read(instants))),
        marks=tuple(step.mark for step in log.steps if step.mark),
        instants=instants,
        film=record.film,
    )


def sittings_of(scenario: Experiment, robot: Robot) -> tuple[Sitting, ...]:
    """Return what a scenario does on a robot that it fits.

    Raises:
        ScenarioError: It takes longer than is simulated; its steps are counted first.
    """
    most = round(SIMULATED_SECONDS.value / CONTROL_PERIOD)
    sittings = SITTINGS[scenario.experiment]
    steps = chain.from_iterable(sitting.steps for sitting in sittings(scenario, robot))
    if next(islice(steps, most, None), None):
        raise ScenarioError([f"experiment: takes more than {SIMULATED_SECONDS}; {SIMULATED_SECONDS.remedy}."])
    return sittings(scenario, robot)


def edits_of(scenario: ScenarioBase) -> tuple[SpecEdit, ...]:
    """Return the changes of the model that a scenario asks for."""
    servo = (proportional_servo,) if scenario.servo == "proportional" else ()
    return (friction_on(scenario.friction), *servo)


@dataclass(frozen=True)
class _Record:
    """What happened, however it was driven; `log` holds the steps that were read, `instants` and `reading` theirs."""

    log: Log
    instants: Trace
    reading: Reading
    instruments: Instruments
    film: Film


def _period_by_period(
    scenario: ScenarioBase, compiled: CompiledRobot, sittings: tuple[Sitting, ...], progress: Progress
) -> _Record:
    """Drive the environment."""
    log, now = Log(), 0.0
    instruments: Instruments | None = None
    left: Left | None = None
    for i, sitting in enumerate(sittings):
        env = BenchEnv(
            str(compiled.robot.folder),
            edits=(*edits_of(scenario), *sitting.edits),
            truth=True,
            perfect_instruments=scenario.perfect_instruments,
        )
        env.reset(seed=scenario.seed if i == 0 else None, options={"q": sitting.start})
        if instruments is None:
            instruments = env.instruments
        env.instruments = instruments  # the same ones throughout a session, with the same errors
        now += sitting.pause_s if i else 0.0
        env.plant.arrive(sitting.start, now, left)
        now = drive(env, sitting, now, log, lambda share, i=i: progress((i + share) / len(sittings)))  # type: ignore[misc]
        left = env.plant.left(now)
    assert instruments is not None
    film = Film(Trace.concatenate(log.film), stacked(log.film_observations, log.film), tuple(log.events))
    reading = stacked(log.observations, log.instants)
    return _Record(log, Trace.concatenate(log.instants), reading, instruments, film)


def _in_stretches(
    scenario: ScenarioBase, compiled: CompiledRobot, sittings: tuple[Sitting, ...], progress: Progress
) -> _Record:
    """Hand the plant long stretches: for sessions, which would take minutes otherwise."""
    log, now, every = Log(), 0.0, round(FILM_PERIOD / CONTROL_PERIOD)
    rng = None if scenario.perfect_instruments else np.random.default_rng(scenario.seed)
    instruments = Instruments(compiled, rng)
    film = []
    left: Left | None = None
    spec = bare_spec(compiled.robot)
    for i, sitting in enumerate(sittings):
        course = course_of(sitting)
        plant = Plant(compiled.robot, (*edits_of(scenario), *sitting.edits), spec=spec)
        now += sitting.pause_s if i else 0.0
        plant.arrive(course.start, now, left)
        kept = np.union1d(course.marked, np.arange(0, len(course), every))
        trace = follow(plant, course.path, 0, course.wrenches, kept, waits=course.waits)
        trace = replace(trace, time=now + course.ends[kept] - plant.timestep)
        log.instants.append(trace[np.searchsorted(kept, course.marked)])
        film.append(trace[np.flatnonzero(kept % every == 0)])
        log.steps += course.steps_at(plant.timestep)
        log.payload_kg += [sitting.payload_kg] * len(course.steps)
        log.events += [(now + time, words) for time, words in course.events]
        now += course.seconds
        left = plant.left(now)
        progress((i + 1) / len(sittings))
    instants, frames = Trace.concatenate(log.instants), Trace.concatenate(film)
    reading = read_steps(instruments, log.steps, instants)
    return _Record(log, instants, reading, instruments, Film(frames, instruments.read(frames), tuple(log.events)))
