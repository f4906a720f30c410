"""What every drive paid in a campaign, beside what the nominal model needs for the same motion."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.replay.instants import at_each_instant
from bench.diagnose.replay.quantities import Quantity
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.world import NOMINAL, World
from bench.effects.effect import Acting
from bench.effects.gas import CounterbalanceGas
from bench.effects.masses import RotorInertia
from bench.effects.payloads import UnstatedPayload
from bench.effects.places import torque_limit
from bench.errors import ConvergenceError
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot

HELD = 0.1  # of a drive's torque limit, that friction may hold at rest; Coulomb levels are 1 to 6 % of it


@dataclass(frozen=True, eq=False)
class DrivePicture:
    """What drives did and what the model makes of it; T instants, n drives, e things that may be missing.

    Attributes:
        observed, model: Shape (T, n) [Nm]; observed is nan where a drive was not measured, and while it turns round.
        velocity: Shape (T, n) [rad/s].
        standing: Shape (T, n) bool, while a drive did not move.
        slack: Shape (n,) [Nm], what friction may hold at rest.
        level: Shape (n,) [Nm], friction of the nominal model at which drives slide.
        unit: Shape (n,), from what was read to Nm.
        missing: Shape (T, n, e) [Nm], torque of a payload and of gas that the nominal model leaves out, and of rotors
            that nobody knows; those are not in `model`.
        names: Columns of the drives; empty where there is none.
    """

    observed: Array
    model: Array
    velocity: Array
    standing: NDArray[np.bool_]
    slack: Array
    level: Array
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
    missing = []
    # a payload is presumed only where the robot's figures say that recordings leave it unstated; else a load in another
    # unit would pass for one
    leaves_payload = bool(replay.compiled.robot.figures.uncertainty.payload_kg)
    for effect in (UnstatedPayload(), CounterbalanceGas()) if leaves_payload else (CounterbalanceGas(),):
        for place in effect.places(replay.compiled):
            size = effect.parameters_at(replay.compiled, place)[0]
            world = World(acting=(Acting(effect, place, effect.complete({size.name: size.typical})),))
            missing.append(replay.predict(world) - nominal)
    rotors = _rotors(replay, nominal)
    missing, nominal = [*missing, *rotors], nominal - sum(rotors)
    shape = trace.q.shape
    seen = replay.observed
    standing = at_each_instant(replay.segments, [segment.standing for segment in replay.segments])
    observed, model = np.full(shape, np.nan), np.zeros(shape)
    extra, names, units = np.zeros((*shape, len(missing))), [""] * shape[1], np.ones(shape[1])
    for c, quantity in enumerate(replay.quantities):
        j, unit = quantity.index, _in_nm(quantity, replay.compiled)
        observed[:, j], units[j] = unit * seen[:, c], unit
        model[:, j] = unit * nominal[:, c]
        extra[:, j] = unit * np.stack([change[:, c] for change in missing], axis=1) if missing else extra[:, j]
        names[j] = quantity.column
    if not (np.all(np.isfinite(model)) and np.all(np.isfinite(extra))):
        raise ConvergenceError("its torques are not finite")
    slack = np.array([HELD * torque_limit(replay.compiled, j) for j in range(shape[1])])
    level = replay.compiled.motor_coulomb + replay.compiled.link_coulomb
    return DrivePicture(observed, model, trace.q_velocity, standing, slack, level, units, extra, tuple(names))


def _rotors(replay: Replay, nominal: Array) -> list[Array]:
    """Return what each rotor that nobody knows adds to the readings, shape (T, c) each."""
    effect, unknown = RotorInertia(), replay.compiled.robot.figures.drive_uncertainty.rotor_is_unknown
    places = [place for place in effect.places(replay.compiled) if unknown[place.index]]
    doubled = (Acting(effect, place, effect.complete({"change": 1.0})) for place in places)
    return [replay.predict(World(acting=(acting,))) - nominal for acting in doubled]


def _in_nm(quantity: Quantity, compiled: CompiledRobot) -> float:
    return float(compiled.torque_constant[quantity.index]) if quantity.kind == "current" else 1.0
