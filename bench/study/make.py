"""Make the campaign of a trial: draw where an effect acts, how large it is and how it is shaped, then hide it."""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from bench.effects.effect import Acting, Effect, Place
from bench.errors import BenchError, ConvergenceError
from bench.hide.campaign import Hidden
from bench.record.campaign import Campaign
from bench.robot.compiled import CompiledRobot
from bench.study.labs import Lab, Setup, machine_components
from bench.study.limits import Way, detection_limit
from bench.study.plan import Trial
from bench.study.worlds import OF_SECOND, surroundings_of, travel_of, unlisted_in

LIMITS = 3.0  # times its detection limit, at which an effect is to be found
CLEARLY = 10.0  # times its detection limit: clearly visible
TRIES = 6  # places and shapes that are drawn until the size is plausible


@dataclass(frozen=True, eq=False)
class Sized:
    """An effect that acts.

    Attributes:
        acting: The effect with its values.
        size: As a share of the largest plausible.
        limit: Detection limit, the same way; inf if there is none or it was not asked for.
    """

    acting: Acting
    size: float
    limit: float


@dataclass(frozen=True, eq=False)
class Made:
    """A campaign of a study with its truth.

    Attributes:
        campaign: What the diagnosis is given.
        effects: What was hidden.
        others: What else of the catalogue acts.
        hidden: The first plant's truth; None of the second plant.
    """

    campaign: Campaign
    effects: tuple[Sized, ...]
    others: tuple[Sized, ...] = ()
    hidden: Hidden | None = None


def make(trial: Trial, setup: Setup, seed: int) -> Made:
    """Return the campaign of a trial; where a robot with what was drawn finds no rest, it is drawn again.

    Args:
        trial: What to hide.
        setup: Of the ordinary lab, for detection limits.
        seed: Of the study.

    Raises:
        ConvergenceError: None of several draws finds a rest.
    """
    rng, lab = trial.rng(seed), lab_of(trial, setup)
    for _ in range(TRIES - 1):
        with suppress(ConvergenceError):
            return _made(trial, setup, lab, rng)
    return _made(trial, setup, lab, rng)


def _made(trial: Trial, setup: Setup, lab: Lab, rng: np.random.Generator) -> Made:
    effects = tuple(_drawn(trial, setup, rng))
    acting = tuple(one.acting for one in effects)
    if trial.world in OF_SECOND:
        return Made(lab.hide_in_second(acting, rng, rests=trial.world == "resting"), effects)
    known = machine_components(setup.catalogue, setup.lab, setup.compiled)
    others = surroundings_of(trial.world, acting, tuple(known), setup.compiled, rng)
    everything = (*acting, *(one for one, _ in others), *travel_of(trial.world, rng))
    hidden = lab.hide(everything, rng, gives=trial.world == "servo")
    beside = tuple(Sized(one, size, float("inf")) for one, size in others)
    return Made(hidden.campaign, effects, beside, hidden)


def lab_of(trial: Trial, setup: Setup) -> Lab:
    """Return the lab of a trial."""
    if trial.twin is None:
        return setup.lab
    return trial.twin.extra if trial.is_split else trial.twin.ordinary


def _drawn(trial: Trial, setup: Setup, rng: np.random.Generator) -> Iterator[Sized]:
    if trial.twin is not None:
        name, place = trial.twin.hidden
        effect = setup.catalogue[name]
        first = effect.parameters[0].name
        way = Way(effect, _named(effect, place, setup.compiled), {first: 1.0}, {})
        yield Sized(way.at(trial.twin.size, setup.compiled), trial.twin.size, float("inf"))
        return
    known = unlisted_in(trial.world) if trial.kind == "unlisted" else setup.catalogue
    for name in trial.effects:
        yield sized(known[name], trial, setup, rng)


def sized(effect: Effect, trial: Trial, setup: Setup, rng: np.random.Generator) -> Sized:
    """Return an effect at the next place where it shows at a plausible size, and as large as the trial asks.

    Where it shows nowhere, it is taken where it comes nearest to that, at the largest plausible size.
    """
    places = setup.lab.places(effect, setup.compiled)
    rivals = setup.listed if trial.kind == "unlisted" else ()
    drawn: list[tuple[float, Way]] = []
    for i in range(TRIES):
        way = Way.draw(effect, places[(trial.number + i) % len(places)], setup.compiled, rng)
        try:
            limit = detection_limit(way, setup.linear, setup.blur, setup.threshold, rivals)
        except BenchError:
            limit = float("inf")
        drawn.append((limit, way))
        if LIMITS * limit <= 1:
            break
    limit, way = min(drawn, key=lambda one: one[0])
    limit = float(f"{limit:.2g}")  # balances are found within a tolerance; a study that is repeated shall be the same
    size = _size(trial, way, limit, setup.compiled, rng)
    return Sized(way.at(size, setup.compiled), size, limit)


def _size(trial: Trial, way: Way, limit: float, compiled: CompiledRobot, rng: np.random.Generator) -> float:
    match trial.size:
        case "three limits":  # but no smaller than it is plausibly: an offset below that is another cause's
            return min(max(LIMITS * limit, way.smallest(compiled)), 1.0)
        case "clear" if limit == float("inf"):  # the first plant cannot say how large it has to be
            return 1.0
        case "clear":  # what is not listed has no range that binds it
            return min(CLEARLY * limit, max(1.0, LIMITS * limit) if trial.kind == "unlisted" else 1.0)
        case "plausible":
            return float(np.exp(rng.uniform(np.log(way.smallest(compiled)), 0.0)))


def _named(effect: Effect, words: str, compiled: CompiledRobot) -> Place:
    return next(place for place in effect.places(compiled) if str(place) == words)
