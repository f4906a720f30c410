"""Rests and readings of a robot with one effect, for tests of sign and size."""

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bench.effects.catalogue import catalogue
from bench.effects.conditions import Conditions
from bench.effects.effect import Effect, Place
from bench.effects.recorded import Recorded, RecordedRun
from bench.robot.compiled import CompiledRobot, SpecEdit, compile_robot
from bench.robot.edits import friction_on
from bench.robot.folder import Robot
from bench.simulate.equilibrium import Equilibrium
from bench.simulate.instruments import Instruments, Reading
from bench.simulate.plant import Plant
from bench.simulate.trace import Trace

CATALOGUE = catalogue()
NO_WRENCH = np.zeros(6)
PERIOD = 4e-3  # [s]


class Rest(NamedTuple):
    """One rest: link angles, motor torques, reflectors, and the equilibrium itself."""

    theta: np.ndarray
    torque: np.ndarray
    reflectors: np.ndarray
    equilibrium: Equilibrium


def recorded_on(compiled: CompiledRobot) -> Recorded:
    """Four runs with every channel: a load hangs in the first, mass is bolted on in two, the last comes much later."""
    n = compiled.n_joints
    columns = {f"current_{j + 1}_a" for j in range(n)} | {
        f"{kind}_{axis}_n" for kind in ("force", "load") for axis in "xyz"
    }
    columns |= {f"reflector_1_{axis}_m" for axis in "xyz"} | {"gas_pressure_pa"}
    moving = frozenset(range(n))
    runs = [
        RecordedRun("hung", 0.0, 60.0, frozenset(columns), is_static=True, hangs=True, payload_kg=0.0),
        RecordedRun("up", 70.0, 80.0, frozenset(columns), is_static=False, hangs=False, payload_kg=20.0, moving=moving),
        RecordedRun(
            "down", 81.0, 90.0, frozenset(columns), is_static=False, hangs=False, payload_kg=20.0, moving=moving
        ),
        RecordedRun(
            "late", 3000.0, 3130.0, frozenset(columns), is_static=False, hangs=False, payload_kg=0.0, moving=moving
        ),
    ]
    return Recorded(tuple(runs))


def places_of(effect: Effect, compiled: CompiledRobot) -> tuple[Place, ...]:
    """Where an effect may act on a robot with every channel."""
    return effect.places_in(compiled, recorded_on(compiled))


def place_of(effect: Effect, compiled: CompiledRobot, which: int = 0) -> Place:
    return places_of(effect, compiled)[which]


def edit_of(
    name: str,
    compiled: CompiledRobot,
    values: Mapping[str, float],
    which: int = 0,
    conditions: Conditions | None = None,
) -> SpecEdit:
    effect = CATALOGUE[name]
    conditions = conditions or Conditions.reference(compiled.n_joints)
    edit = effect.edit(place_of(effect, compiled, which), effect.complete(values), conditions)
    assert edit is not None
    return edit


def rest(
    robot: Robot, edits: list[SpecEdit], q: np.ndarray, wrench: np.ndarray = NO_WRENCH, side: str = "none"
) -> Rest:
    compiled = compile_robot(robot, [friction_on(side), *edits])
    equilibrium = Equilibrium(compiled)
    theta = equilibrium.solve(q, wrench)
    reflectors = np.array(equilibrium.data.site_xpos[compiled.at.reflectors])
    return Rest(theta, equilibrium.motor_torque(), reflectors, equilibrium)


def sweep(robot: Robot, edits: list[SpecEdit], start: np.ndarray, speed: np.ndarray, periods: int = 500) -> Trace:
    """All joints at constant speed, shape (n,) [rad/s]; the truth over time."""
    plant = Plant(robot, edits)
    plant.reset(start)
    commands = start + speed * PERIOD * np.arange(1, periods + 1)[:, None]
    return plant.advance(commands, np.zeros((periods, 6)), PERIOD)


def typical(effect: Effect, compiled: CompiledRobot, place: Place) -> dict[str, float]:
    return {parameter.name: parameter.typical for parameter in effect.parameters_at(compiled, place)}


def perfect_reading(compiled: CompiledRobot, trace: Trace) -> Reading:
    return Instruments(compiled, None).read(trace)


def some_trace(robot: Robot, rng: np.random.Generator) -> tuple[Plant, Trace]:
    """Move a little, under a slanting load."""
    plant = Plant(robot)
    n = plant.compiled.n_joints
    plant.reset(np.full(n, 0.2))
    commands = 0.2 + 0.02 * np.sin(np.arange(40)[:, None] * 0.1 + np.arange(n))
    wrenches = np.tile([20.0, -10.0, -100.0, 1.0, 2.0, 3.0], (40, 1))
    trace = plant.advance(commands, wrenches, PERIOD)
    return plant, replace(trace, time=trace.time + 3600.0)
