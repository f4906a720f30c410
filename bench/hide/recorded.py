"""What will be recorded in a session, before anything is simulated: where errors of the recording may sit."""

from collections.abc import Iterable

import numpy as np

from bench.effects.conditions import Conditions
from bench.effects.recorded import Recorded, recorded_in
from bench.hide.campaign import reduced, runs_of
from bench.hide.plan import plan, setup_of
from bench.hide.thermometers import temperatures
from bench.hide.warm_up import WarmUp
from bench.robot.folder import Robot
from bench.scenario.files import Experiment
from bench.simulate.instruments import Instruments
from bench.simulate.trace import Trace


def recorded_of(
    robot: Robot, session: Experiment, without: Iterable[str] = (), channels: Iterable[str] = ()
) -> Recorded:
    """Return the runs and columns that a session will have; arguments as of `hide_campaign`.

    Raises:
        InputError: As `hide_campaign`.
    """
    robot, session, thermometers = reduced(robot, session, tuple(without), tuple(channels))
    setup = setup_of(robot, session)
    n, r = robot.n_joints, len(robot.figures.reflectors)
    stays, log = plan(setup.legs, (), lambda nominal: nominal, WarmUp(np.zeros(n), np.zeros(n), 0.0))
    time = np.concatenate([stay.begin + stay.course.ends[stay.course.marked] - setup.before_end for stay in stays])
    shapes = {"reflectors": (r, 3), "load_point": (3,), "wrench": (6,)}
    shapes |= {"counterbalance_force": (), "gas_force": (), "counterbalance_length": ()}
    names = [name for name in Trace.__dataclass_fields__ if name != "time"]
    nothing = Trace(time=time, **{name: np.zeros((len(time), *shapes.get(name, (n,)))) for name in names})
    reading = Instruments(setup.compiled, None).read(nothing)
    kelvin = temperatures(Conditions.reference(n), len(time), thermometers, np.random.default_rng(0))
    runs = runs_of(setup.compiled, log, reading, kelvin)
    return recorded_in(runs, setup.compiled.model.opt.gravity)
