"""Everything that the catalogue and the stated uncertainties allow to be wrong throughout, as a linear model.

One column for each nuisance and for each size of each effect at each place, as large as its prior is wide. What these
explain is no fault of a file. Loads that were written down wrong in one run stand apart: one is tried at a time.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bench.diagnose.replay.nuisances import nuisances_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.simulations import simulate_all
from bench.diagnose.replay.world import NOMINAL, World
from bench.effects.catalogue import BUILT_IN
from bench.effects.effect import Acting, Effect, Parameter, Place
from bench.effects.geometry import JointZero
from bench.effects.levels import places_of
from bench.effects.recorded import Recorded
from bench.effects.recording_log import BoltedLoad, HungLoad
from bench.errors import BenchError
from bench.record.campaign import Array

# effort: readings times columns; a session of 47 runs has a quarter of it and takes two seconds
MOST_NUMBERS = 40_000_000


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


def listed_causes(replay: Replay, recorded: Recorded) -> ListedCauses | None:
    """Return what may be wrong in a campaign; None where simulating it all would take too long.

    Args:
        replay: The campaign with the nominal robot.
        recorded: Its runs.

    Raises:
        ConvergenceError: The nominal model finds no balance.
    """
    compiled = replay.compiled
    nuisances = [one for one in nuisances_of(compiled, replay.quantities) if one.is_simulated]
    effects = [one for one in _sizes(replay, recorded) if not isinstance(one[0], HungLoad | BoltedLoad)]
    if (len(nuisances) + len(effects)) * float(np.prod(replay.shape)) > MOST_NUMBERS:
        return None
    nominal = replay.predict(NOMINAL)
    observed = replay.observed
    seen = np.isfinite(observed)

    def changes(worlds: list[World], times: list[float]) -> Iterator[Array | None]:
        for found, factor in zip(simulate_all(replay, worlds), times, strict=True):
            if isinstance(found, BenchError) or not np.all(np.isfinite(found[seen])):
                yield None
            else:
                yield np.where(seen, factor * (found - nominal), 0.0)

    worlds = [World({nuisance: nuisance.sigma}) for nuisance in nuisances]
    worlds += [_acting(effect, place, size) for effect, place, size in effects]
    times = [1.0] * len(nuisances) + [_deviation(size) / (size.typical - size.null) for *_, size in effects]
    columns = list(changes(worlds, times))
    zeros = {
        place.index: column / _deviation(size)
        for (effect, place, size), column in zip(effects, columns[len(nuisances) :], strict=True)
        if isinstance(effect, JointZero) and column is not None
    }
    loads: dict[str, dict[str, Array]] = {}
    for effect, name in ((HungLoad(), "load_z_n"), (BoltedLoad(), "load_mass_kg")):
        places = [place for place in effect.places_in(compiled, recorded) if len(place.runs) == 1]
        (size,) = effect.parameters
        found = changes([_acting(effect, place, size) for place in places], [1 / size.typical] * len(places))
        loads[name] = {place.runs[0]: column for place, column in zip(places, found, strict=True) if column is not None}
    shown = [column for column in columns if column is not None and np.any(column)]
    stacked = np.stack(shown, axis=2) if shown else np.zeros((*observed.shape, 0))
    return ListedCauses(np.where(seen, observed - nominal, np.nan), nominal, stacked, zeros, loads)


def _sizes(replay: Replay, recorded: Recorded) -> Iterator[tuple[Effect, Place, Parameter]]:
    """Yield every size of every effect at every place; shapes stay as they are assumed first."""
    for kind in BUILT_IN:
        effect = kind()
        for place in places_of(effect, replay.compiled, recorded):
            for parameter in effect.parameters_at(replay.compiled, place):
                if not parameter.is_shape:
                    yield effect, place, parameter


def _acting(effect: Effect, place: Place, size: Parameter) -> World:
    return World(acting=(Acting(effect, place, effect.complete({size.name: size.typical})),))


def _deviation(size: Parameter) -> float:
    """Return the standard deviation of a size as plausible: of an even distribution as wide."""
    return size.high / float(np.sqrt(3))
