"""A campaign of the second plant: what its instruments saw, run by run, and how warm it was."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.record.campaign import Campaign, Run
from bench.robot.figures import Figures as RobotFigures
from bench.second.course import Course, Sitting, course_of
from bench.second.effects import Values, changed
from bench.second.figures import Figures
from bench.second.instruments import Columns, Draws, columns_of
from bench.second.machine import Machine, imperfect, perfect
from bench.second.plant import Chance, State, follow
from bench.second.weather import THERMOMETERS, Weather
from bench.second.worlds import QUIET, World

TAILS = 4.0  # degrees of freedom of Student's t: some readings far off, as real ones have


@dataclass(frozen=True)
class Hiding:
    """An effect to hide: its name, the index of the drive or name of the body or instrument, and its values."""

    name: str
    place: int | str
    values: Values


@dataclass(frozen=True, eq=False)
class Second:
    """A campaign of the second plant with its truth.

    Attributes:
        campaign: What the instruments saw.
        figures: The arm as it was.
        course: The instants that were computed.
        state: What was true at them.
        world: How its friction and its servos were.
    """

    campaign: Campaign
    figures: Figures
    course: Course
    state: State
    world: World


def hide_in_second(
    robot: str,
    nominal: Figures,
    known: RobotFigures,
    sittings: Sequence[Sitting],
    hidings: Sequence[Hiding],
    rng: np.random.Generator,
    *,
    world: World = QUIET,
    quiet: bool = False,
    thermometers: Sequence[str] = THERMOMETERS,
    machine: Machine | None = None,
) -> Second:
    """Run a session on the second plant.

    Args:
        robot: By what the campaign names it.
        nominal: Its figures.
        known: The robot's own, for instruments and for what is uncertain.
        sittings: What to do.
        hidings: Effects that act.
        rng: Source of all errors and noise.
        world: How friction and servos are beside the effects.
        quiet: Nothing nominal is wrong, and the instruments are perfect.
        thermometers: Which there are.
        machine: What lasts if it is recorded again; None: all comes from `rng`, and nothing drifts.

    Raises:
        ConvergenceError: It finds no balance.
        InputError: It does not know an effect.
    """
    recorded = perfect(nominal) if quiet else imperfect(nominal, known, rng, machine)
    figures = world.of(recorded.figures)
    for one in hidings:
        figures = changed(figures, one.name, one.place, one.values)
    course = course_of(sittings)
    state = follow(figures, course, Chance.draw(course, world.on_motors, world.on_links, rng))
    constants = np.array([drive.torque_constant_nm_per_a for drive in known.drives])
    draws = Draws(rng, TAILS, quiet)
    columns = columns_of(state, course, figures, known.instruments, constants, recorded.errors, draws)
    columns |= Weather.draw(figures.n, rng).columns(course.time[course.read], thermometers, draws)
    return Second(Campaign(robot, _runs(course, columns)), figures, course, state, world)


def _runs(course: Course, columns: Columns) -> tuple[Run, ...]:
    names, found = np.array(course.runs), []
    time, payload = course.time[course.read], course.payload[course.read]
    carried = {"force", "moment"}  # the force sensor is at the hook, a payload is bolted to the arm
    for name in dict.fromkeys(course.runs):
        rows = np.flatnonzero(names == name)
        labels = [course.labels[row] for row in rows]
        own: Columns = {"time_s": time[rows] - time[rows[0]]}
        own |= {word: np.array([one[word] for one in labels]) for word in labels[0]}
        is_loaded = bool(np.any(payload[rows]))
        for column, values in columns.items():
            word, number = column.split("_")[:2]
            if (is_loaded and word in carried) or (word == "reflector" and number != "1"):
                continue  # nobody carries the reflector round the other nests
            own[column] = values[rows]
        if is_loaded:
            own["load_mass_kg"] = payload[rows]
        found.append(Run(name, "static" if labels[0] else "motion", float(time[rows[0]]), own))
    return tuple(found)
