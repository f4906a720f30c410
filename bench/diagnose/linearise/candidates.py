"""Which effects could act on a robot, where, and what a campaign would show of each: signatures, by simulation."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.linearise.linearised_model import WHITENED_TOGETHER, LinearisedModel
from bench.effects.effect import Acting, Effect, Parameter, Place
from bench.effects.levels import places_of
from bench.effects.recorded import NOTHING_RECORDED, Recorded
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot

FEWEST_SHAPES = 3  # effort: values of a shape parameter that are tried at first
# rounding: norm of a whitened signature at its largest plausible size, below which nobody can see an effect
INVISIBLE = 1e-3
# declared: times what is plausible, that causes are looked for where nothing plausible explains a campaign
LARGER = 4.0


@dataclass(frozen=True)
class Cause:
    """An effect at a place.

    Attributes:
        effect: What.
        place: Where.
        sizes: Its parameters that are sizes there.
        shapes: Its parameters that only shape it.
        reach: Times what is plausible, that its sizes are looked for up to.
    """

    effect: Effect
    place: Place
    sizes: tuple[Parameter, ...]
    shapes: tuple[Parameter, ...]
    reach: float = 1.0

    @property
    def key(self) -> tuple[str, str]:
        """Name of the effect and place, in words."""
        return self.effect.name, str(self.place)

    @property
    def drive(self) -> int:
        """Index of the drive at which it acts, or -1."""
        return self.place.index if self.place.kind == "joint" else -1

    def __str__(self) -> str:
        if self.place.kind == "robot":
            return f"{self.effect.title} {str(self.place).removeprefix('robot').strip()}".strip()
        return f"{self.effect.title} ({self.place})"

    def farther(self, reach: float) -> "Cause":
        """Return the cause with sizes that go so many times as far."""
        sizes = tuple(replace(size, high=reach * size.high) for size in self.sizes)
        return replace(self, sizes=sizes, reach=reach * self.reach)

    def acting(self, values: Mapping[str, float]) -> Acting:
        """Return the cause with some of its parameters given."""
        return Acting(self.effect, self.place, self.effect.complete(values))

    def typical(self, size: Parameter) -> float:
        """Return the value of one of its sizes at which it is simulated: a plausible one, however far the cause goes.

        What a size changes to first order does not depend on how far it may go.
        """
        return replace(size, high=size.high / self.reach).typical

    def beside(self, size: Parameter) -> dict[str, float]:
        """Return what acts as well where one of the sizes is simulated alone: the other size that it needs, if any."""
        if size.quotient is None:
            return {}
        others = (other for other in self.sizes if other.name == size.quotient.by)
        return {other.name: other.null + other.high / self.reach for other in others}


@dataclass(frozen=True, eq=False)
class Candidate:
    """A cause with its shape fixed, in the linearised model; m whitened readings, k sizes.

    Attributes:
        cause: Effect and place.
        shape: Values of the shape parameters.
        step: Shape (k,), size - null at which the columns were simulated.
        prior: Shape (k,), standard deviation of the sizes as plausible, in steps.
        columns: Shape (m, k), whitened change of the readings with one step of each size.
    """

    cause: Cause
    shape: Mapping[str, float]
    step: Array
    prior: Array
    columns: Array

    @property
    def plausible(self) -> Array:
        """Shape (k,), standard deviations of the sizes, in steps."""
        return self.prior


def causes_of(
    catalogue: Iterable[Effect],
    compiled: CompiledRobot,
    measured: frozenset[str],
    recorded: Recorded = NOTHING_RECORDED,
    reach: float = 1.0,
    stated: CompiledRobot | None = None,
    told: Collection[tuple[str, int]] = (),
) -> tuple[Cause, ...]:
    """Return every effect at every place where it may act on this robot, as far as these channels could show it.

    Args:
        catalogue: Effects.
        compiled: The robot.
        measured: Quantities that the campaign has.
        recorded: Its runs and columns; without them errors of the recording have no place.
        reach: Times what is plausible, that sizes are looked for up to.
        stated: The nominal robot, which says what is plausible; None: the robot itself.
        told: What a first pass has: names of effects, each with the index of its drive.
    """
    found = []
    for effect in catalogue:
        if any(need not in measured for need in effect.needs):
            continue
        for place in places_of(effect, compiled, recorded):
            if effect.only_if_told and (effect.name, place.index) not in told:
                continue
            parameters = effect.parameters_at(stated or compiled, place)
            sizes, shapes = (tuple(one for one in parameters if one.is_shape is shapes) for shapes in (False, True))
            found.append(Cause(effect, place, sizes, shapes).farther(reach))
    return tuple(found)


def as_far_as_told(causes: Sequence[Cause], told: Mapping[tuple[str, int], float], most: float) -> tuple[Cause, ...]:
    """Return causes, with those that go `most` times as far which a first pass has larger than is plausible.

    What is plausible is scaled from a heavy robot's drive; a cable is as stiff on a small wrist.

    Args:
        causes: What is looked for.
        told: Name of an effect and index of a drive -> its size.
        most: Times what is plausible.
    """

    def is_larger(cause: Cause) -> bool:
        size = told.get((cause.effect.name, cause.drive), 0.0)
        return cause.reach == 1.0 and bool(cause.sizes) and size > cause.sizes[0].high

    return tuple(cause.farther(most) if is_larger(cause) else cause for cause in causes)


def unseen_of(catalogue: Iterable[Effect], measured: frozenset[str]) -> dict[str, tuple[str, ...]]:
    """Return the effects that need channels which the campaign has not: name -> those channels."""
    missing = {effect.name: tuple(need for need in effect.needs if need not in measured) for effect in catalogue}
    return {name: needs for name, needs in missing.items() if needs}


def shape_grid(cause: Cause) -> list[dict[str, float]]:
    """Return the shapes that are tried at first: a few values of each shape parameter, on a logarithmic scale."""
    axes = []
    for parameter in cause.shapes:
        low, high, count = parameter.low, parameter.high, FEWEST_SHAPES
        if low > 0:
            count = max(count, 1 + int(np.ceil(np.log(high / low) / np.log(parameter.ratio))))
        values = (np.geomspace if low > 0 else np.linspace)(low, high, count)
        axes.append([(parameter.name, float(value)) for value in values])
    return [dict(point) for point in product(*axes)]


def candidates_of(
    linear: LinearisedModel, causes: Sequence[Cause], sensitivities: Sequence[NDArray[np.floating] | None]
) -> tuple[Candidate, ...]:
    """Return the visible candidates of a campaign: every cause at every shape that leaves a trace in it.

    Args:
        linear: The campaign.
        causes: What to try.
        sensitivities: Of the readings, shape (T, c) each, with one size of one shape of one cause at its typical
            value, in the order of `plan_of`; None where the model found no balance.
    """
    seen = [i for i, change in enumerate(sensitivities) if change is not None]
    if not seen:
        return ()
    white = np.empty((len(linear.white), len(seen)))
    for start in range(0, len(seen), WHITENED_TOGETHER):
        there = (sensitivities[i] for i in seen[start : start + WHITENED_TOGETHER])
        some = np.stack([change for change in there if change is not None], axis=2)
        white[:, start : start + WHITENED_TOGETHER] = linear.whiten(some)
    norms = np.sqrt(np.einsum("ij,ij->j", white, white))
    column_of = {i: column for column, i in enumerate(seen)}
    found = []
    i = 0
    for cause, shape in plan_of(causes):
        kept = [(size, column_of[i + k]) for k, size in enumerate(cause.sizes) if i + k in column_of]
        i += len(cause.sizes)
        if not kept:
            continue
        step = np.array([cause.typical(size) - size.null for size, _ in kept])
        prior = np.array([size.sigma for size, _ in kept]) / np.abs(step)
        columns = np.array([column for _, column in kept])
        visible = norms[columns] * prior > INVISIBLE
        if np.any(visible):
            sizes = tuple(size for (size, _), is_visible in zip(kept, visible, strict=True) if is_visible)
            shown = replace(cause, sizes=sizes)
            found.append(Candidate(shown, shape, step[visible], prior[visible], _view(white, columns[visible])))
    return tuple(found)


def _view(white: Array, columns: Array) -> Array:
    """Return some columns, without a copy where they are neighbours."""
    first, count = int(columns[0]), len(columns)
    if int(columns[-1]) - first == count - 1:
        return white[:, first : first + count]
    some: Array = white[:, columns]
    return some


def plan_of(causes: Sequence[Cause]) -> list[tuple[Cause, dict[str, float]]]:
    """Return every cause with each of its shapes."""
    return [(cause, shape) for cause in causes for shape in shape_grid(cause)]
