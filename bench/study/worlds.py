"""Worlds of the study: how a campaign is beside what is hidden in it. A verdict has to hold in all of them.

plain       the first plant, everything nominal a little wrong
messy       10 to 60 other components of the catalogue act as well, each at 1 to 5 % of its plausible range
presliding  friction builds up over 0.5 to 3 times the nominal travel, another for each drive and side
servo       servos have no integral action and give by torque / kp
second      the second plant: other friction laws, friction of motors at rest anywhere, servos that may give
resting     the second plant, and links rest anywhere that their friction holds them
"""

from collections.abc import Mapping, Sequence
from typing import Literal, get_args

import mujoco
import numpy as np

from bench.effects.conditions import Conditions
from bench.effects.effect import WHOLE, Acting, Effect, Parameter, Place, Values
from bench.effects.unlisted import unlisted
from bench.errors import InputError
from bench.hide.second_unlisted import second_unlisted
from bench.robot.compiled import CompiledRobot, SpecEdit
from bench.robot.folder import Robot
from bench.robot.plugins import configure, number_of
from bench.second.effects import CHANGES
from bench.study.limits import Way

World = Literal["plain", "messy", "presliding", "servo", "second", "resting"]
WORLDS: tuple[World, ...] = get_args(World)
OF_SECOND: tuple[World, ...] = ("second", "resting")  # worlds of the second plant
MachineWorld = Literal["messy", "second", "resting"]
OF_MACHINES: tuple[MachineWorld, ...] = get_args(MachineWorld)  # in which a machine can be recorded several times

FEWEST, MOST = 10, 60  # other components of a messy arm, issue 15
SMALLEST, LARGEST = 0.01, 0.05  # of their plausible range, issue 15
SHORTEST, LONGEST = 0.5, 3.0  # presliding travel against the nominal one, issue 15


class PreslidingTravel(Effect):
    """Friction elements of all drives hold over another travel; of no catalogue, for it is no cause but a world."""

    name = "presliding_travel"
    family = "own"
    title = "presliding travel of every friction element"
    physics = "Each element reaches its level after t times the travel of the model; `seed` says which t each has."
    source = "range: issue 15"
    parameters = (Parameter("seed", "", 0.0, 0.0, 1e9, "of the travels, log-uniform from 0.5 to 3"),)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        """Return the change; it is the same whenever it is applied."""

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            rng = np.random.default_rng(int(values["seed"]))
            for drive in robot.figures.drives:
                for element in (drive.motor_friction, drive.link_friction):
                    travel = float(np.exp(rng.uniform(np.log(SHORTEST), np.log(LONGEST))))
                    stiffness = number_of(spec, element, "presliding_stiffness")
                    configure(spec, element, presliding_stiffness=stiffness / travel)

        return change if values["seed"] else None


def surroundings_of(
    world: World,
    hidden: tuple[Acting, ...],
    known: Sequence[tuple[Effect, Place]],
    compiled: CompiledRobot,
    rng: np.random.Generator,
) -> tuple[tuple[Acting, float], ...]:
    """Return what else of the catalogue acts in a world, each with its size as a share of the largest plausible.

    Args:
        world: Which.
        hidden: What the trial hides; the same effect at the same place is not drawn again.
        known: Effects at places, out of which others are drawn.
        compiled: The robot.
        rng: Random numbers.
    """
    if world != "messy":
        return ()
    taken = {(one.effect.name, str(one.place)) for one in hidden}
    free = [(effect, place) for effect, place in known if (effect.name, str(place)) not in taken]
    count = min(int(rng.integers(FEWEST, MOST + 1)), len(free))
    found = []
    for i in rng.choice(len(free), count, replace=False):
        way = Way.draw(*free[int(i)], compiled, rng)
        size = float(rng.uniform(SMALLEST, LARGEST))
        found.append((way.at(size, compiled), size))
    return tuple(found)


def travel_of(world: World, rng: np.random.Generator) -> tuple[Acting, ...]:
    """Return the change of friction in a world of other presliding, nothing in the others."""
    if world != "presliding":
        return ()
    return (Acting(PreslidingTravel(), WHOLE, {"seed": float(rng.integers(1, 2**31))}),)


def listed_in(world: World, names: tuple[str, ...]) -> tuple[str, ...]:
    """Return those effects that can be hidden in a world."""
    return tuple(name for name in names if name in CHANGES) if world in OF_SECOND else names


def catalogue_in(world: World, known: Mapping[str, Effect]) -> dict[str, Effect]:
    """Return those entries of a catalogue that can act in a world."""
    return {name: known[name] for name in listed_in(world, tuple(known))}


def world_of_machines(asked: Sequence[World]) -> MachineWorld:
    """Return the world of machines that are recorded several times: the one that was asked for, messy if none was.

    Raises:
        InputError: There are several, or machines cannot be recorded several times in it.
    """
    known: dict[World, MachineWorld] = {world: world for world in OF_MACHINES}
    match asked:
        case []:
            return "messy"
        case [world] if world in known:
            return known[world]
        case _:
            raise InputError(
                f"--world {' '.join(asked)}: machines are recorded several times in one world, out of "
                f"{', '.join(OF_MACHINES)}; all are messy, in the last two of the second plant."
            )


def unlisted_in(world: World) -> Mapping[str, Effect]:
    """Return the effects that no catalogue holds and that can be hidden in a world."""
    known = unlisted()
    if world not in OF_SECOND:
        return known
    return {name: effect for name, effect in known.items() if name in CHANGES} | second_unlisted()
