"""The world that a robot's figures hold as fitted, and deviations of a fit as such figures.

A robot folder that a diagnosis handed over predicts what the fit predicted: its model is in the MJCF, errors of
readings and of weights and effects outside of the model come from `fitted` of its figures. All worlds of a replay
act on top of that.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from pydantic import ValidationError

from bench.diagnose.replay.nuisances import PULL_DIRECTION, PULLED, Nuisance
from bench.diagnose.replay.world import World
from bench.effects.effect import Acting, Array, Place
from bench.effects.fitted import fitted_acting
from bench.effects.geometry import JointZero
from bench.errors import RobotError
from bench.record.units import HOUR
from bench.robot.compiled import CompiledRobot
from bench.robot.figures import Figures
from bench.robot.fitted import NO_READINGS, FittedReadings, FittedWeights
from bench.robot.turned_sites import TurnedSites
from bench.simulate.instruments import Reading, is_slanting, small_rotation
from bench.simulate.pulls import pulled

AXES = "xyz"
Put = Callable[[dict[str, Any], float], None]


def fitted_world(compiled: CompiledRobot) -> World:
    """Return the world that a robot's figures hold as fitted; without such figures, nothing acts in it.

    Raises:
        RobotError: An effect, place or parameter in the figures is unknown.
    """
    figures, known = compiled.robot.figures, compiled.robot.figures.fitted
    deviations: dict[Nuisance, float] = {}
    if known.readings != NO_READINGS:
        sites = TurnedSites.reflectors_of(compiled)
        deviations[Nuisance("readings as fitted", "", 0.0, on_reading=lambda x, r: _shown(figures, sites, r))] = 1.0
    if known.weights.hung:
        deviations[Nuisance("weights that hang, as fitted", "", 0.0, scales_wrench=True)] = known.weights.hung
    if known.weights.bolted:
        deviations[Nuisance("weights bolted on, as fitted", "", 0.0, scales_payload=True)] = known.weights.bolted
    if known.weights.pulled or any(known.weights.pull_turn_rad):
        deviations[Nuisance("loads pulled aside, as fitted", "", 0.0, on_wrench=partial(_pulled, known.weights))] = 1.0
    return World(deviations, fitted_acting(compiled))


def _pulled(known: FittedWeights, x: float, wrench: Array) -> Array:
    return pulled(wrench, x * known.pulled, x * np.array(known.pull_turn_rad))


def zeros_in(world: World, compiled: CompiledRobot) -> tuple[Acting, ...]:
    """Return the zeros of motor encoders that are off in a world, as the effect by which figures hold them."""
    effect = JointZero()
    return tuple(
        Acting(effect, Place("joint", j, compiled.robot.figures.drives[j].joint), {effect.parameters[0].name: value})
        for nuisance, value in world.deviations.items()
        if (j := nuisance.encoder) is not None and value
    )


def figures_with(
    compiled: CompiledRobot, deviations: Mapping[Nuisance, float]
) -> tuple[FittedReadings, FittedWeights, tuple[Nuisance, ...]]:
    """Return deviations of readings and weights on top of those that a robot has, as figures.

    Those that edit the model alone are not meant, nor zeros of motors (`zeros_in`).

    Returns:
        Errors of readings, errors of weights, and the deviations that have no place in them.

    Raises:
        RobotError: A gain that would turn a channel round, or the like.
    """
    figures = compiled.robot.figures
    readings, weights = figures.fitted.readings.model_dump(), figures.fitted.weights.model_dump()
    slots, left = _slots(figures), []
    for nuisance, value in deviations.items():
        if not value:
            continue
        if nuisance.scales_wrench:
            weights["hung"] = (1 + weights["hung"]) * (1 + value) - 1
        elif nuisance.scales_payload:
            weights["bolted"] += value
        elif nuisance.name == PULLED:
            weights["pulled"] = (1 + weights["pulled"]) * (1 + value) - 1
        elif nuisance.on_wrench:
            turned = weights["pull_turn_rad"]
            which = [nuisance.name == f"{PULL_DIRECTION}{axis}" for axis in AXES]
            weights["pull_turn_rad"] = tuple(angle + value * own for angle, own in zip(turned, which, strict=True))
        elif nuisance.on_reading:
            put = slots.get((nuisance.name, _changes_torque(compiled, nuisance)))
            if put:
                put(readings, value)
            else:
                left.append(nuisance)
    try:
        return FittedReadings.model_validate(readings), FittedWeights.model_validate(weights), tuple(left)
    except ValidationError as error:
        raise RobotError(
            f"no figure can hold what was fitted: {'.'.join(map(str, one['loc']))} is {one['input']:.3g}; the stated "
            "figures are too far from the recordings."
            for one in error.errors()
        ) from error


def torque_constant_of(compiled: CompiledRobot, nuisance: Nuisance) -> tuple[float, str] | None:
    """Return the torque constant that a deviation of readings is about, and its unit; nan where drives report torque.

    What a drive reports grows by x where its constant falls to 1 / (1 + x) of what is stated. None: it is about
    something else.
    """
    for drive, slides in zip(compiled.robot.figures.drives, compiled.is_slide, strict=True):
        if nuisance.name == f"torque constant of {drive.joint}":
            constant = np.nan if _changes_torque(compiled, nuisance) else drive.torque_constant_nm_per_a
            return constant, "N/A" if slides else "Nm/A"
    return None


def _changes_torque(compiled: CompiledRobot, nuisance: Nuisance) -> bool:
    """Return whether a deviation changes the torques that drives report; one of currents may have the same name."""
    n, r = compiled.n_joints, len(compiled.robot.figures.reflectors)
    shapes: dict[str, tuple[int, ...]] = {
        "time": (1,),
        "force": (1, 3),
        "moment": (1, 3),
        "reflectors": (1, r, 3),
        "gas_pressure": (1,),
        "gas_temperature": (1,),
    }
    names = ("time", "q_motor", "q_link", "current", "torque", "force", "moment", "reflectors", "gas_pressure")
    before = Reading(**{name: np.ones(shapes.get(name, (1, n))) for name in (*names, "gas_temperature")})
    assert nuisance.on_reading
    return bool(np.any(nuisance.on_reading(0.5, before).torque != before.torque))


def _slots(figures: Figures) -> dict[tuple[str, bool], Put]:
    """Return name of a deviation and whether it is one of torques -> how it is put on top of others."""
    slots: dict[tuple[str, bool], Put] = {}
    for drive in figures.drives:
        joint = drive.joint
        slots[f"torque constant of {joint}", False] = _gain("current_gain", "current_offset_a", joint)
        slots[f"torque constant of {joint}", True] = _gain("torque_gain", "torque_offset_nm", joint)
        slots[f"current offset of {joint}", False] = _added("current_offset_a", joint)
        slots[f"torque offset of {joint}", True] = _added("torque_offset_nm", joint)
    for j, drive in enumerate(figures.drives):
        slots[f"zero of link encoder {j + 1}", False] = _added("link_encoder_zero_rad", drive.joint)
    for i, axis in enumerate(AXES):
        slots[f"tracker frame, shift {axis}", False] = _along("tracker_shift_m", i)
        slots[f"tracker frame, turn {axis}", False] = _along("tracker_turn_rad", i)
        slots[f"tracker drift {axis}", False] = _along("tracker_drift_m_per_h", i)
        slots[f"tilt of the force sensor, {axis}", False] = _along("force_tilt_rad", i)
        for k, site in enumerate(figures.reflectors):
            slots[f"nest of reflector {k + 1}, {axis}", False] = _nest(site, i)

    def force_gain(readings: dict[str, Any], x: float) -> None:
        readings["force_gain"] = (1 + readings["force_gain"]) * (1 + x) - 1

    def thermometer(readings: dict[str, Any], x: float) -> None:
        readings["gas_thermometer_k"] += x

    slots["gain of the force sensor", False] = force_gain
    slots["thermometer of the gas", False] = thermometer
    return slots


def _gain(gain: str, offset: str, joint: str) -> Put:
    def put(readings: dict[str, Any], x: float) -> None:
        readings[gain][joint] = (1 + readings[gain].get(joint, 0.0)) * (1 + x) - 1
        if joint in readings[offset]:
            readings[offset][joint] *= 1 + x

    return put


def _added(field: str, joint: str) -> Put:
    def put(readings: dict[str, Any], x: float) -> None:
        readings[field][joint] = readings[field].get(joint, 0.0) + x

    return put


def _along(field: str, axis: int) -> Put:
    def put(readings: dict[str, Any], x: float) -> None:
        readings[field] = tuple(value + x * (i == axis) for i, value in enumerate(readings[field]))

    return put


def _nest(site: str, axis: int) -> Put:
    def put(readings: dict[str, Any], x: float) -> None:
        known = readings["nest_m"].get(site, (0.0, 0.0, 0.0))
        readings["nest_m"][site] = tuple(value + x * (i == axis) for i, value in enumerate(known))

    return put


def _shown(figures: Figures, sites: TurnedSites, reading: Reading) -> Reading:
    """Return what instruments show that err as fitted, in the order in which a fit applies its deviations."""
    known = figures.fitted.readings
    joints = [drive.joint for drive in figures.drives]

    def by_joint(given: dict[str, float]) -> Array:
        return np.array([given.get(joint, 0.0) for joint in joints])

    reflectors = reading.reflectors
    nests = np.array([known.nest_m.get(site, (0.0, 0.0, 0.0)) for site in figures.reflectors]).reshape(-1, 3)
    force, moment = reading.force * (1 + known.force_gain), reading.moment * (1 + known.force_gain)
    slanting = is_slanting(force)
    for i, direction in enumerate(np.eye(3)):
        turn = small_rotation(known.tracker_turn_rad[i] * direction)
        drift = known.tracker_drift_m_per_h[i] / HOUR * reading.time[:, None, None]
        reflectors = (reflectors + known.tracker_shift_m[i] * direction) @ turn.T
        reflectors = reflectors + drift * direction + sites.moved(reading.q_motor, nests * direction)
        tilt = small_rotation(known.force_tilt_rad[i] * direction).T
        force, moment = np.where(slanting, force @ tilt, force), np.where(slanting, moment @ tilt, moment)
    return replace(
        reading,
        current=reading.current * (1 + by_joint(known.current_gain)) + by_joint(known.current_offset_a),
        torque=reading.torque * (1 + by_joint(known.torque_gain)) + by_joint(known.torque_offset_nm),
        q_link=reading.q_link + by_joint(known.link_encoder_zero_rad),
        reflectors=reflectors,
        force=force,
        moment=moment,
        gas_temperature=reading.gas_temperature + known.gas_thermometer_k,
    )
