"""Signatures of a few effects of the two-joint robot, along five instants of a sweep."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.signatures import Sensitivities, Signatures
from bench.diagnose.replay.nuisances import nuisances_of
from bench.diagnose.replay.quantities import Quantity
from bench.diagnose.replay.segments import Segment
from bench.effects.catalogue import catalogue
from bench.effects.conditions import Conditions
from bench.effects.effect import Effect
from bench.robot.compiled import CompiledRobot
from bench.simulate.prescribed import Motion
from bench.store.store import Store

QUANTITIES = (Quantity("current_1_a", "current", "A"), Quantity("current_2_a", "current", "A", 1))
CATALOGUE = catalogue()
NAMES = ("coulomb_level", "friction_temperature", "torque_constant_temperature", "joint_compliance")


def sweep(speed: float = 0.4, warm: float = 300.0, payload: float = 0.0) -> Segment:
    """Return five instants of a sweep of the first joint."""
    time = np.arange(6.0)
    zeros = np.zeros((6, 2))
    q, velocity, acceleration = zeros.copy(), zeros.copy(), zeros.copy()
    q[:, 0], velocity[:, 0], acceleration[:, 0] = 0.1 + speed * (time - 1) / 5, speed, 0.01
    wrench = np.zeros((6, 6))
    wrench[:, 2] = -100.0
    motion = Motion(time, q, velocity, acceleration, wrench, np.arange(6) > 0)
    conditions = Conditions(np.full(2, warm), np.full(2, warm), payload_kg=payload)
    nothing = np.zeros((5, 2))
    return Segment(
        "sweep", "sweep", False, motion, conditions, nothing, nothing + 1, nothing[0] > 0, nothing, nothing[:, 0] > 0
    )


def causes_of(compiled: CompiledRobot, effects: Sequence[Effect]) -> tuple[Cause, ...]:
    return tuple(
        Cause(effect, place, tuple(p for p in effect.parameters_at(compiled, place) if not p.is_shape), ())
        for effect in effects
        for place in effect.places(compiled)
    )


def learned(
    compiled: CompiledRobot, store: Store | None, segment: Segment, effects: Sequence[Effect] = (), **other: Any
) -> Sensitivities:
    causes = causes_of(compiled, effects or [CATALOGUE[name] for name in NAMES])
    given = {"quantities": QUANTITIES, "nuisances": nuisances_of(compiled, QUANTITIES), "causes": causes} | other
    return Signatures(compiled, **given, store=store).sensitivities((segment,))


def same(one: Sensitivities, other: Sensitivities) -> bool:
    return np.array_equal(one.nuisances, other.nuisances) and all(
        np.array_equal(a, b) for a, b in zip(one.causes, other.causes, strict=True) if a is not None and b is not None
    )
