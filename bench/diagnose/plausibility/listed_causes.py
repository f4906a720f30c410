"""Everything that the catalogue and the stated uncertainties allow to be wrong throughout, as a linear model.

One column for each nuisance and for each size of each effect at each place, as large as its prior is wide. What these
explain is no fault of a file. Loads that were written down wrong in one run stand apart: one is tried at a time.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bench.diagnose.linearise.changes import changes_of
from bench.diagnose.linearise.plan import Plan
from bench.diagnose.replay.nuisances import nuisances_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.world import NOMINAL
from bench.effects.catalogue import BUILT_IN
from bench.effects.effect import Acting, Effect, Parameter, Place
from bench.effects.geometry import JointZero
from bench.effects.levels import places_of
from bench.effects.recorded import Recorded
from bench.effects.recording_log import BoltedLoad, HungLoad
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot
from bench.store.store import Store

# effort: readings times columns; a session of 47 runs has a quarter of it and takes two seconds
MOST_NUMBERS = 40_000_000
# of one run -> the column where it is written down
LOADS: dict[type[Effect], str] = {HungLoad: "load_z_n", BoltedLoad: "load_mass_kg"}


@dataclass(frozen=True, eq=False)
class ListedCauses:
    """What may be wrong, and what it changes; T instants, c quantities.

    Attributes:
        residual: Shape (T, c), observed less nominal; nan where nothing was measured.
        nominal: Shape (T, c).
        sensitivities: Shape (T, c, k), of one standard deviation of each; 0 where nothing was measured.
        zeros: Index of a drive -> shape (T, c), what a radian or a metre of its joint's zero changes.
        loads: Column of a load -> run -> shape (T, c), what that load written down half as large as it was changes.
    """

    residual: Array
    nominal: Array
    sensitivities: Array
    zeros: dict[int, Array]
    loads: dict[str, dict[str, Array]]


def listed_causes(replay: Replay, recorded: Recorded, store: Store | None = None) -> ListedCauses | None:
    """Return what may be wrong in a campaign; None where simulating it all would take too long.

    Args:
        replay: The campaign with the nominal robot.
        recorded: Its runs.
        store: Where what was simulated is kept between processes; None: nowhere.

    Raises:
        ConvergenceError: The nominal model finds no balance.
    """
    compiled = replay.compiled
    nuisances = tuple(one for one in nuisances_of(compiled, replay.quantities) if one.is_simulated)
    effects = [one for one in _sizes(replay, recorded) if not isinstance(one[0], HungLoad | BoltedLoad)]
    if (len(nuisances) + len(effects)) * float(np.prod(replay.shape)) > MOST_NUMBERS:
        return None
    wrong = [one for effect in LOADS for one in _in_one_run(effect(), compiled, recorded)]
    acting = [_acting(*one) for one in (*effects, *wrong)]
    plan = Plan(compiled, replay.quantities, nuisances, tuple(acting), is_strict=False, simulates_torques=True)
    nominal, observed = replay.predict(NOMINAL), replay.observed
    seen = np.isfinite(observed)
    changes = changes_of(plan, replay.segments, store).astype(np.float64)
    changes[~seen] = 0.0
    changes[:, :, len(nuisances) :] /= [size.typical - size.null for *_, size in (*effects, *wrong)]
    balances = np.all(np.isfinite(changes), axis=(0, 1))
    count = len(nuisances) + len(effects)
    zeros = {
        place.index: changes[:, :, i]
        for i, (effect, place, _) in enumerate(effects, len(nuisances))
        if isinstance(effect, JointZero) and balances[i]
    }
    loads: dict[str, dict[str, Array]] = {column: {} for column in LOADS.values()}
    for i, (effect, place, _) in enumerate(wrong, count):
        if balances[i]:
            loads[LOADS[type(effect)]][place.runs[0]] = changes[:, :, i]
    deviations = np.array([1.0] * len(nuisances) + [size.sigma for *_, size in effects])
    shown = changes[:, :, :count] * deviations
    shown = shown[:, :, balances[:count] & np.any(shown, axis=(0, 1))]
    return ListedCauses(np.where(seen, observed - nominal, np.nan), nominal, shown, zeros, loads)


def _in_one_run(
    effect: Effect, compiled: CompiledRobot, recorded: Recorded
) -> Iterator[tuple[Effect, Place, Parameter]]:
    """Yield the size of an effect of runs in each of them."""
    (size,) = effect.parameters
    for place in effect.places_in(compiled, recorded):
        if len(place.runs) == 1:
            yield effect, place, size


def _sizes(replay: Replay, recorded: Recorded) -> Iterator[tuple[Effect, Place, Parameter]]:
    """Yield every size of every effect at every place; shapes stay as they are assumed first."""
    for kind in BUILT_IN:
        effect = kind()
        for place in places_of(effect, replay.compiled, recorded):
            for parameter in effect.parameters_at(replay.compiled, place):
                if not parameter.is_shape:
                    yield effect, place, parameter


def _acting(effect: Effect, place: Place, size: Parameter) -> Acting:
    return Acting(effect, place, effect.complete({size.name: size.typical}))
