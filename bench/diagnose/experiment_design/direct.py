"""Direct measurements: one number that a thermometer or a scale gives, beside any run."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from bench.diagnose.cross_validation.leave_out import tangent_of
from bench.diagnose.experiment_design.preposterior import Expectation
from bench.diagnose.extend.fit import Fit
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.replay.instants import recordings_of
from bench.diagnose.replay.levels import world_in
from bench.diagnose.replay.nuisances import THERMOMETER_K
from bench.diagnose.replay.perfect_instruments import ideal_reading
from bench.diagnose.replay.world import NOMINAL, World, edits_in
from bench.effects.conditions import REFERENCE_K, Conditions
from bench.robot.compiled import compile_robot
from bench.simulate.trace import Trace

# derived: relative, of a scale in a workshop: OIML R 76 allows one of class III with 3000 divisions 1.5 of them at its
# largest load when it is new, and twice as many in service
LEAST_SCALE = 2 * 1.5 / 3000


@dataclass(frozen=True, eq=False)
class Direct:
    """One number.

    Attributes:
        words: What to do.
        family: What it is like.
        expectations: Of each explanation, with the parameters of `preposterior.Preposterior`, but without those that a
            new instrument brings.
    """

    words: str
    family: str
    expectations: tuple[Expectation, ...]


def direct_measurements(linear: LinearisedModel, fits: Sequence[Fit], trace: Trace) -> tuple[Direct, ...]:
    """Return what a gas thermometer and a scale would show; each only where there is something to measure.

    Of several recordings the last is meant: the machine is as it was then.

    Args:
        linear: Today's campaign.
        fits: Explanations.
        trace: Any motion of the nominal robot; its first instant is read.
    """
    compiled, last = linear.replay.compiled, recordings_of(linear.segments)[-1]
    found = []
    conditions = [segment.conditions for segment in linear.segments]
    if compiled.counterbalance is not None and all(c.gas_k == REFERENCE_K for c in conditions):
        thermometer = ideal_reading(compiled, trace[:1])

        def gas_k(world: World) -> float:
            shown = thermometer
            for acting in world_in(world, last).acting:
                shown = acting.effect.distort(acting.place, acting.values, shown, trace[:1], conditions[0])
            return float(shown.gas_temperature[0])

        expectations = _expectations(linear, fits, gas_k, THERMOMETER_K)
        found.append(Direct("a thermometer on the gas of the counterbalance", "gas thermometer", expectations))
    payload = max(c.payload_kg for c in conditions)
    if payload > 0:
        at = Conditions.reference(compiled.n_joints, payload)

        def mass_kg(world: World) -> float:
            model = compile_robot(compiled.robot, edits_in(world_in(linear.replay.whole(world), last), at)).model
            return float(model.body_subtreemass[compiled.at.load_body])

        sigma = payload * max(compiled.robot.figures.uncertainty.load, LEAST_SCALE)
        expectations = _expectations(linear, fits, mass_kg, sigma)
        found.append(Direct(f"the payload of {payload:g} kg on a scale", "scale", expectations))
    return tuple(found)


def _expectations(
    linear: LinearisedModel, fits: Sequence[Fit], read: Callable[[World], float], sigma: float
) -> tuple[Expectation, ...]:
    """Return what each fit expects of one number, in standard deviations of its reading.

    Args:
        linear: Today's campaign.
        fits: Explanations.
        read: The number in a world.
        sigma: Standard deviation of its reading.
    """
    nominal = read(NOMINAL)
    sensitivities = np.array(
        [read(World({n: n.sigma})) - nominal if n.scales_payload else 0.0 for n in linear.nuisances]
    )
    found = []
    for fit in fits:
        mean = read(fit.world(linear))
        own = [(read(world) - mean) / step for world, step in fit.worlds_beside(linear)]
        jacobian = np.concatenate([sensitivities, own]) / sigma
        covariance = np.asarray(np.linalg.inv(tangent_of(linear, fit).precision), dtype=np.float64)
        found.append(Expectation(np.array([mean / sigma]), jacobian[None], covariance))
    return tuple(found)
