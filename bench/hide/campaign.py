"""Make a campaign in which effects are hidden, with the truth apart."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench import paths
from bench.effects.conditions import REFERENCE_K, Conditions
from bench.effects.effect import WHOLE, Acting
from bench.errors import InputError, unknown_names
from bench.hide.background import Background
from bench.hide.plan import Stay, plan, setup_of
from bench.hide.recordings import background_in, errors_in
from bench.hide.simulate import Plants, read, true_trace
from bench.hide.thermometers import CHANNELS, USUAL, temperatures
from bench.hide.warm_up import WarmUp
from bench.hide.written import written
from bench.record.campaign import Campaign, Run
from bench.record.truth import TrueValue, Truth
from bench.robot.compiled import CompiledRobot, compile_spec
from bench.robot.folder import Robot
from bench.robot.instruments import Instruments as InstrumentFigures
from bench.scenario.files import Experiment
from bench.scenario.session import PARTS, SessionScenario
from bench.simulate.drive import Log
from bench.simulate.instruments import Instruments, Reading, SystematicErrors
from bench.simulate.session import edits_of
from bench.simulate.tables import Joints, run_of, with_link_angles
from bench.simulate.trace import Array, Trace
from bench.simulate.truth import true_parameters

TAILS = 5.0  # degrees of freedom of the noise: it leaves four standard deviations 60 times as often as normal noise


@dataclass(frozen=True)
class Hidden:
    """A campaign with hidden effects, and everything that a scorer may ask for.

    Attributes:
        campaign: What the instruments saw.
        truth: Effects, true parameters, readings of ideal instruments.
        acting: The effects.
        background: What else was a little wrong.
        errors: Systematic errors of the instruments.
        conditions: Run name -> conditions at its first reading.
        instants: Run name -> the truth at its readings.
    """

    campaign: Campaign
    truth: Truth
    acting: tuple[Acting, ...]
    background: Background
    errors: SystematicErrors
    conditions: Mapping[str, Conditions]
    instants: Mapping[str, Trace]


def hide_campaign(
    robot: Robot,
    session: Experiment,
    acting: Sequence[Acting],
    rng: np.random.Generator,
    *,
    timestep: float | None = None,
    background: bool = True,
    tails: float | None = TAILS,
    without: Iterable[str] = (),
    channels: Iterable[str] = (),
    machine: np.random.Generator | None = None,
) -> Hidden:
    """Run a session on a robot in which effects act.

    Args:
        robot: The nominal robot.
        session: What to do; its `robot` and `seed` are not used.
        acting: Effects that act; none makes null data.
        rng: Source of all errors and noise.
        timestep: Integration step [s], which divides the MJCF's; None: half of it.
        background: Whether everything nominal is a little wrong: model, weights and instruments. Noise always stays.
        tails: Degrees of freedom of Student's t for the noise, None for normal noise.
        without: Instruments of the figures ("tracker", "force", ...), channels ("gear_temperature", ...) and parts of a
            session ("line", "dwell", ...) that the lab does not have.
        channels: Further channels that it has ("gas_temperature").
        machine: Source of what is wrong with the machine itself and with its lab: figures, calibrations, weights.
            Recordings whose generators have the same seed are of one machine; what drifts (torque constants, viscous
            friction, zeros of channels, gain of the force sensor) or is set up anew (tracker, reflectors, force sensor,
            payload) comes from `rng` as `effects/drifts.py` says. None: all of it comes from `rng`, and nothing drifts.

    Raises:
        InputError: The session does not fit the robot, an unknown name in `without` or `channels`, or nothing is left.
    """
    acting = tuple(replace(one, values=one.effect.complete(one.values)) for one in acting)
    robot, session, shown = reduced(robot, session, tuple(without), tuple(channels))
    setup = setup_of(robot, session)
    compiled, before_end = setup.compiled, setup.before_end  # it is read at one time, whatever the step here
    drawn = Background.draw(compiled, rng) if background else Background({})
    instruments = Instruments(compiled, rng, tails)
    if not background:
        instruments.errors = Instruments(compiled, None).errors
    if machine and background:
        drawn = background_in(compiled, Background.draw(compiled, machine), drawn, rng)
        instruments.errors = errors_in(compiled, Instruments(compiled, machine).errors, instruments.errors)
    day = WarmUp.draw(robot.n_joints, rng, REFERENCE_K + drawn.air_k)
    edits = (*edits_of(session), *drawn.edits(compiled))
    stays, log = plan(setup.legs, edits, drawn.loads, day)
    step = before_end / 2 if timestep is None else timestep
    plants = Plants(robot, setup.spec, acting, stays, step)
    seen = [_measure(plants, stay, acting, instruments, before_end, shown, rng) for stay in stays]
    instants = Trace.concatenate([one.trace for one in seen])
    thermometers = {name: np.concatenate([one.kelvin[name] for one in seen]) for name in seen[0].kelvin}
    reading = Reading.concatenate([one.reading for one in seen])
    runs = runs_of(compiled, log, reading, thermometers)
    conditions = [during for one in seen for during in one.conditions]
    perfect = Instruments(compiled, None).read(instants)
    ideal = [with_link_angles(run, log, instants) for run in runs_of(compiled, log, perfect, {})]
    cool = (one.effect.edit(one.place, one.values, Conditions.reference(robot.n_joints)) for one in acting)
    cool_edits = (edit for edit in cool if edit is not None)
    simulated = compile_spec(setup.spec.copy(), robot, (*edits, *cool_edits))
    return Hidden(
        campaign=Campaign(_name(robot), written(runs, acting, compiled.model.opt.gravity), notes=session.notes),
        truth=Truth(
            parameters=true_parameters(simulated, instruments.errors) | _values(compiled, acting, drawn),
            effects=tuple(name_of(one) for one in acting),
            runs={run.name: run.columns for run in ideal},
        ),
        acting=acting,
        background=drawn,
        errors=instruments.errors,
        conditions={name: conditions[log.rows(name)[0]] for name in log.run_names},
        instants={name: instants[np.array(log.rows(name))] for name in log.run_names},
    )


def name_of(acting: Acting) -> str:
    """Return the name under which the truth lists an effect: its own and, if that is a part of the robot, its place."""
    return acting.effect.name if acting.place == WHOLE else f"{acting.effect.name} {acting.place}"


def reduced(
    robot: Robot, session: Experiment, without: tuple[str, ...], channels: tuple[str, ...]
) -> tuple[Robot, Experiment, tuple[str, ...]]:
    """Return robot and session without what the lab does not have, and the thermometers that it has."""
    fitted = tuple(InstrumentFigures.model_fields)
    parts = PARTS if isinstance(session, SessionScenario) else ()
    known = (*fitted, *parts, *CHANNELS)
    if problems := (
        *unknown_names("instrument, channel or part", without, known),
        *unknown_names("channel", channels, CHANNELS),
    ):
        raise InputError(problems)
    if missing := [name for name in without if name in parts]:
        assert isinstance(session, SessionScenario)
        session = session.without(*missing)
    instruments = robot.figures.instruments.model_copy(update={name: None for name in without if name in fitted})
    robot = replace(robot, figures=robot.figures.model_copy(update={"instruments": instruments}))
    return robot, session, tuple(name for name in (*USUAL, *channels) if name not in without)


@dataclass(frozen=True)
class _Seen:
    """Truth, readings, thermometers' columns and conditions at the K instants of a sitting that are read."""

    trace: Trace
    reading: Reading
    kelvin: Mapping[str, Array]
    conditions: tuple[Conditions, ...]


def _measure(
    plants: Plants,
    stay: Stay,
    acting: Sequence[Acting],
    instruments: Instruments,
    before_end: float,
    thermometers: Sequence[str],
    rng: np.random.Generator,
) -> _Seen:
    """Simulate a sitting and read it, some time before the end of a control period [s]."""
    trace, late = true_trace(plants, stay, acting, before_end)
    readings, kelvin, conditions = [], [], []
    for during, rows in stay.read():
        if len(rows):
            here = slice(int(rows[0]), int(rows[-1]) + 1)
            reading = read(instruments, acting, stay.course.steps[here], trace[here], late[here], during)
            readings.append(reading)
            felt = replace(during, gas_k=float(reading.gas_temperature[0]))
            kelvin.append(temperatures(felt, len(rows), thermometers, rng))
            conditions += [during] * len(rows)
    columns = {name: np.concatenate([part[name] for part in kelvin]) for name in kelvin[0]}
    return _Seen(trace, Reading.concatenate(readings), columns, tuple(conditions))


def runs_of(compiled: CompiledRobot, log: Log, reading: Reading, extra: Mapping[str, Array]) -> tuple[Run, ...]:
    """Return the runs of a session.

    Args:
        compiled: The nominal robot.
        log: What happened.
        reading: At every step that was read.
        extra: Further columns, with a number for each of these.
    """
    gravity, joints = compiled.model.opt.gravity, Joints.of(compiled)
    carried = any(step.move_reflector for step in log.steps)
    runs = []
    for name in log.run_names:
        run, rows = run_of(name, log, reading, gravity, carried, joints), log.rows(name)
        columns = dict(run.columns) | {column: values[rows] for column, values in extra.items()}
        if "load_mass_kg" in columns:  # the force sensor is at the hook, a payload is bolted to the arm
            columns = {
                column: values for column, values in columns.items() if not column.startswith(("force", "moment"))
            }
        runs.append(replace(run, columns=columns))
    return tuple(runs)


def _values(compiled: CompiledRobot, acting: Iterable[Acting], background: Background) -> dict[str, TrueValue]:
    """Return the sizes of the effects and of the background errors by name."""
    values = {
        f"effect.{name_of(one)}.{parameter.name}": TrueValue(float(one.values[parameter.name]), parameter.unit)
        for one in acting
        for parameter in one.effect.parameters
    }
    values |= {f"background.{name}": TrueValue(size, "") for name, size in background.off_by(compiled).items()}
    values |= {"load.hung": TrueValue(background.hung, ""), "load.bolted": TrueValue(background.bolted, "")}
    return values | {"air.warmer": TrueValue(background.air_k, "K")}


def _name(robot: Robot) -> str:
    """Return by what a campaign names its robot: a robot that comes along by name, another one by its path."""
    return robot.name if robot.folder.parent == paths.models_dir() else str(robot.folder)
