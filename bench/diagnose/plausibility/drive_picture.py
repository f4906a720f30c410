"""What every drive paid in a campaign, beside what the nominal model needs for the same motion."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.replay.instants import at_each_instant
from bench.diagnose.replay.quantities import Quantity
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.world import NOMINAL, World
from bench.effects.effect import Acting, Effect, Place, Values
from bench.effects.gas import CounterbalanceGas
from bench.effects.payloads import UnstatedPayload, rated_lever
from bench.effects.places import torque_limit
from bench.errors import ConvergenceError
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot

FAR = 3.0  # declared: standard deviations of stated friction, by which there may be less
HELD = 0.1  # assumed: of a drive's torque limit, that friction may hold at rest; Coulomb levels are up to 9 % of it
LEAST = 30  # declared: readings of a drive in motion, below which nothing is said of its channel


@dataclass(frozen=True, eq=False)
class DrivePicture:
    """What drives did and what the model makes of it; T instants, n drives, e things that may be missing.

    Attributes:
        observed, model: Shape (T, n) [Nm]; observed is nan where a drive was not measured, and while it turns round.
        velocity: Shape (T, n) [rad/s].
        standing: Shape (T, n) bool, while a drive did not move.
        slack: Shape (n,) [Nm], what friction may hold at rest.
        level: Shape (n,) [Nm], friction of the nominal model at which drives slide.
        spare: Shape (2, n) [Nm], [Nm s/rad], how much less that level and viscous friction may be.
        unit: Shape (n,), from what was read to Nm.
        missing: Shape (T, n, e) [Nm], torque of payloads at several places and of gas that the nominal model leaves
            out, and of rotors that nobody knows; those are not in `model`. There may be zero or more of each.
        names: Columns of the drives; empty where there is none.
    """

    observed: Array
    model: Array
    velocity: Array
    standing: NDArray[np.bool_]
    slack: Array
    level: Array
    spare: Array
    unit: Array
    missing: Array
    names: tuple[str, ...]

    def columns(self, j: int) -> Array:
        """Return what the torque of drive j is made of: model, Coulomb, viscous, offset, missing; shape (T, 4 + e)."""
        v = self.velocity[:, j]
        plain = np.stack([self.model[:, j], np.sign(v), v, np.ones(len(v))], axis=1)
        return np.concatenate([plain, self.missing[:, j]], axis=1)

    def of(self, rows: NDArray[np.bool_]) -> "DrivePicture":
        """Return the picture of some instants, shape (T,) bool."""
        parts = {name: getattr(self, name)[rows] for name in ("observed", "model", "velocity", "standing", "missing")}
        return replace(self, **parts)


def drive_picture(replay: Replay) -> DrivePicture:
    """Return what drives did in a campaign, and what its nominal model makes of it.

    Raises:
        ConvergenceError: The model's torques are not finite.
    """
    trace = replay.trace(NOMINAL)
    nominal = replay.predict(NOMINAL)
    rotors = _rotors(replay)
    missing = [*_payloads(replay, nominal), *_gas(replay, nominal), *rotors]
    shape = trace.q.shape
    seen = replay.observed
    standing = at_each_instant(replay.segments, [segment.standing for segment in replay.segments])
    observed = np.full(shape, np.nan)
    extra, names, units = np.zeros((*shape, len(missing))), [""] * shape[1], np.ones(shape[1])
    for c, quantity in enumerate(replay.quantities):
        j, unit = quantity.index, _in_nm(quantity, replay.compiled)
        observed[:, j], units[j] = unit * seen[:, c], unit
        extra[:, j] = unit * np.stack([change[:, c] for change in missing], axis=1) if missing else extra[:, j]
        names[j] = quantity.column
    model = _of_joints(replay, nominal - sum(rotors))
    if not np.all(np.isfinite(extra)):
        raise ConvergenceError("its torques are not finite")
    compiled = replay.compiled
    level = compiled.motor_coulomb + compiled.link_coulomb
    viscous = compiled.model.dof_damping[compiled.at.q_dof] + compiled.model.dof_damping[compiled.at.theta_dof]
    return DrivePicture(
        observed=observed,
        model=model,
        velocity=trace.q_velocity,
        standing=standing,
        slack=np.array([HELD * torque_limit(compiled, j) for j in range(shape[1])]),
        level=level,
        spare=np.minimum(FAR * compiled.robot.figures.drive_uncertainty.friction, 1.0) * np.stack([level, viscous]),
        unit=units,
        missing=extra,
        names=tuple(names),
    )


def needed_torque(replay: Replay) -> Array:
    """Return `DrivePicture.model` of a campaign alone, shape (T, n) [Nm].

    Raises:
        ConvergenceError: The model's torques are not finite.
    """
    nominal = replay.predict(NOMINAL)
    return _of_joints(replay, nominal - sum(_rotors(replay)))


def _of_joints(replay: Replay, nominal: Array) -> Array:
    """Return what drives read by the model, shape (T, c), as torques of joints, shape (T, n) [Nm]; 0 where none is.

    Raises:
        ConvergenceError: They are not finite.
    """
    model = np.zeros((len(nominal), replay.compiled.n_joints))
    for c, quantity in enumerate(replay.quantities):
        model[:, quantity.index] = _in_nm(quantity, replay.compiled) * nominal[:, c]
    if not np.all(np.isfinite(model)):
        raise ConvergenceError("its torques are not finite")
    return model


def _payloads(replay: Replay, nominal: Array) -> list[Array]:
    """Return what payloads add to the readings, shape (T, c) each: at the load point, and as far beside it as is rated.

    Their sum is a payload with its centre anywhere between. One is presumed only where the robot's figures say that
    recordings leave it unstated; else a load in another unit would pass for one.
    """
    if not replay.compiled.robot.figures.uncertainty.payload_kg:
        return []
    effect = UnstatedPayload()
    at: list[tuple[Place, Values]] = []
    for place in effect.places(replay.compiled):
        mass, *others = effect.parameters_at(replay.compiled, place)
        at += [(place, {mass.name: mass.typical})]
        for moment in (p.name for p in others if p.quotient):
            lever = mass.typical * rated_lever(replay.compiled)
            at += [(place, {mass.name: mass.typical, moment: way * lever}) for way in (1, -1)]
    return _added(replay, nominal, effect, at)


def payload_products(replay: Replay) -> Array:
    """Return what payloads beside two axes at once add to each drive's torque, shape (T, n, e) [Nm].

    With `missing` they make a payload with any mass, centre and moments of inertia, products of inertia too. Of a robot
    whose figures leave no payload unstated there are none.
    """
    effect, compiled = UnstatedPayload(), replay.compiled
    at: list[tuple[Place, Values]] = []
    for place in effect.places(compiled) if compiled.robot.figures.uncertainty.payload_kg else ():
        mass, *others = effect.parameters_at(compiled, place)
        lever = mass.typical * rated_lever(compiled)
        pairs = combinations([p.name for p in others if p.quotient], 2)
        at += [(place, {mass.name: mass.typical, one: lever, other: lever}) for one, other in pairs]
    added = _added(replay, replay.predict(NOMINAL), effect, at) if at else []
    found = np.zeros((len(replay.observed), compiled.n_joints, len(added)))
    for c, quantity in enumerate(replay.quantities):
        for k, change in enumerate(added):
            found[:, quantity.index, k] = _in_nm(quantity, compiled) * change[:, c]
    return found


def _gas(replay: Replay, nominal: Array) -> list[Array]:
    """Return what gas of a counterbalance adds to the readings, shape (T, c) each."""
    effect = CounterbalanceGas()
    (size,) = effect.parameters
    at = [(place, {size.name: size.typical}) for place in effect.places(replay.compiled)]
    return _added(replay, nominal, effect, at)


def _rotors(replay: Replay) -> list[Array]:
    """Return what each rotor that nobody knows adds to the readings, shape (T, c) each; its torque is linear in it."""
    compiled = replay.compiled
    unknown = np.flatnonzero(compiled.robot.figures.drive_uncertainty.rotor_is_unknown)
    trace, nominal = replay.trace(NOMINAL), replay.predict(NOMINAL)
    paid = np.zeros_like(trace.motor_torque)
    for course, along in replay.followed(NOMINAL) if len(unknown) else ():
        paid[course.rows] = along.compiled.model.dof_armature[along.compiled.at.q_dof] * along.acceleration
    more = (trace.motor_torque + paid * (np.arange(compiled.n_joints) == j) for j in unknown)
    return [replay.read(NOMINAL, replace(trace, motor_torque=torque)) - nominal for torque in more]


def _added(replay: Replay, nominal: Array, effect: Effect, at: Sequence[tuple[Place, Values]]) -> list[Array]:
    """Return what an effect adds to the readings at each place with its values, shape (T, c) each."""
    acting = (Acting(effect, place, effect.complete(values)) for place, values in at)
    return [replay.predict(World(acting=(one,))) - nominal for one in acting]


def _in_nm(quantity: Quantity, compiled: CompiledRobot) -> float:
    return float(compiled.torque_constant[quantity.index]) if quantity.kind == "current" else 1.0
