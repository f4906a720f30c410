"""How large an effect must be to be seen: its detection limit in a session, from instruments and what may be off."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.diagnose.linearise.limits import smallest_found
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.marginal import Nuisances
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import Segment
from bench.diagnose.replay.world import NOMINAL, World
from bench.effects.effect import Acting, Effect, Parameter, Place
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot

TINY = 1e-9
WITHIN = 6  # steps within a bin
PRIOR = 1 / np.sqrt(3)  # standard deviation of a size, as a share of the largest plausible; that of the diagnosis


@dataclass(frozen=True)
class Way:
    """An effect at a place with everything fixed but how large it is.

    Attributes:
        effect: What.
        place: Where.
        direction: Size parameter -> its share of the size, -1 to 1.
        shape: Values of the parameters that only shape it.
    """

    effect: Effect
    place: Place
    direction: dict[str, float]
    shape: dict[str, float]

    @classmethod
    def draw(cls, effect: Effect, place: Place, compiled: CompiledRobot, rng: np.random.Generator) -> "Way":
        """Draw the signs of sizes, their proportions where there are several, and shapes over the plausible range.

        What is known by a quotient has that drawn: a light payload has a small first moment.
        """
        parameters = effect.parameters_at(compiled, place)
        sizes = [parameter for parameter in parameters if not parameter.is_shape]
        share = rng.uniform(-1, 1, len(sizes))
        drawn = {p.name: float(x) if p.signed else float(abs(x)) for p, x in zip(sizes, share, strict=True)}
        drawn |= {p.name: drawn[p.name] * drawn[p.quotient.by] for p in sizes if p.quotient}
        largest = max(abs(x) for x in drawn.values())
        direction = {name: x / largest for name, x in drawn.items()}
        shape = {p.name: _drawn(p, rng) for p in parameters if p.is_shape}
        return cls(effect, place, direction, shape)

    def at(self, size: float, compiled: CompiledRobot) -> Acting:
        """Return the effect at a size, as a share of the largest plausible one; no more than means anything."""
        values = dict(self.shape)
        for parameter in self.effect.parameters_at(compiled, self.place):
            if not parameter.is_shape:
                share = size * self.direction.get(parameter.name, 0.0)
                value = parameter.null + share * parameter.high
                values[parameter.name] = min(max(value, parameter.least), parameter.most)
        return Acting(self.effect, self.place, values)

    def smallest(self, compiled: CompiledRobot) -> float:
        """Return the least plausible size, as a share of the largest."""
        sizes = [p for p in self.effect.parameters_at(compiled, self.place) if not p.is_shape]
        return max(p.low / p.high for p in sizes)


class Blur:
    """A campaign replayed several times within each of its bins, so that what is narrower than a bin blurs as in data.

    Not for what is read late: that is told by the samples of a motion, not by its bins.

    Args:
        replay: A null campaign of the session.
    """

    def __init__(self, replay: Replay) -> None:
        self.replay = Replay(replay.compiled, tuple(_finer(segment) for segment in replay.segments), replay.quantities)
        self._counts = [1 if segment.is_static else WITHIN for segment in replay.segments for _ in range(len(segment))]
        self._nominal = self._means(NOMINAL)

    def change(self, world: World) -> Array:
        """Return what a world changes in the readings of the campaign, shape (T, c).

        Raises:
            ConvergenceError: The model finds no balance.
        """
        change: Array = self._means(world) - self._nominal
        return change

    def _means(self, world: World) -> Array:
        starts = np.concatenate([[0], np.cumsum(self._counts)[:-1]])
        sums: Array = np.add.reduceat(self.replay.predict(world), starts, axis=0)
        means: Array = sums / np.array(self._counts)[:, None]
        return means


def _finer(segment: Segment) -> Segment:
    """Return a segment in which each bin of motion is passed in several steps."""
    if segment.is_static:
        return segment
    motion = segment.motion
    width = float(np.median(np.diff(motion.time[motion.read]))) if len(segment) > 1 else 0.0
    steps = np.where(motion.read, WITHIN, 1)
    row = np.repeat(np.arange(len(motion)), steps)
    part = np.concatenate([(np.arange(n) + 0.5) / n - 0.5 for n in steps])[:, None] * width
    velocity = motion.velocity[row]  # the same all through a bin: no friction turns round in it
    finer = replace(
        motion,
        time=motion.time[row] + part[:, 0],
        q=motion.q[row] + part * velocity,
        velocity=velocity,
        acceleration=motion.acceleration[row],
        wrench=motion.wrench[row],
        read=motion.read[row],
    )
    return replace(segment, motion=finer, path=None, average_excess=None)  # which have the bins as they were


def detection_limit(
    way: Way, linear: LinearisedModel, blur: Blur, threshold: float, rivals: Sequence[Array] = ()
) -> float:
    """Return the size at which the expected evidence reaches a threshold, as a share of the largest plausible size.

    The effect is taken as linear below its typical size. Where a bin blurs it, the limit is that of the blurred effect.

    Args:
        way: The effect.
        linear: A null campaign of the session.
        blur: The same campaign.
        threshold: Log evidence.
        rivals: Whitened signatures of listed causes, shape (m, k) each; only what none of them can imitate counts.

    Raises:
        ConvergenceError: The model with the effect finds no balance.
    """
    compiled = linear.replay.compiled
    size = float(np.sqrt(way.smallest(compiled)))
    acting = way.at(size, compiled)
    world = World(acting=(acting,))
    plain = linear.replay.predict(world) - linear.replay.predict(NOMINAL)
    # what is in a channel no bin blurs, nor what is read late: it is averaged over the samples of a bin
    is_whole = way.effect.level == "recording" or acting.effect.lateness(acting.place, acting.values) is not None
    sensitivities = [plain] if is_whole else [plain, blur.change(world)]
    seen = [_information(linear, change / size, rivals) for change in sensitivities]
    return smallest_found(min(seen), PRIOR, threshold)


def _information(linear: LinearisedModel, change: Array, rivals: Sequence[Array]) -> float:
    """Return the information on a size, nuisances integrated out, that no rival can take away."""
    column = linear.whiten(change[:, :, None])
    columns = np.concatenate([column, *rivals], axis=1)
    products = Nuisances(linear.jacobian).products(linear.white, columns).information
    information, start = float(products[0, 0]), 1
    for rival in rivals:
        own = np.arange(start, start + rival.shape[1])
        start += rival.shape[1]
        cross = products[own, 0]
        square = products[np.ix_(own, own)] + TINY * np.eye(len(own))
        information = min(information, float(products[0, 0] - cross @ np.linalg.solve(square, cross)))
    return information


def _drawn(parameter: Parameter, rng: np.random.Generator) -> float:
    if parameter.low > 0:
        return float(np.exp(rng.uniform(np.log(parameter.low), np.log(parameter.high))))
    return float(rng.uniform(parameter.low, parameter.high))
