"""A linearised model with other noise: standard errors raised, other play, friction at rest as in another world."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.linearise.held_friction import held_friction, levels_of
from bench.diagnose.linearise.linearised_model import LinearisedModel, assembled, relinearised
from bench.diagnose.linearise.loose_places import most_placed
from bench.diagnose.linearise.noise_covariance import Scatter, scatters_alike
from bench.diagnose.linearise.roughness import with_roughness
from bench.diagnose.replay.segments import Segment
from bench.diagnose.replay.world import World
from bench.record.campaign import Array


def raised(linear: LinearisedModel, factors: Array) -> LinearisedModel:
    """Return the design with larger standard errors.

    Args:
        linear: The campaign.
        factors: Shape (2, c), for every quantity at rest and in motion.
    """
    if np.all(factors == 1):
        return linear
    segments = tuple(
        replace(segment, sigma=segment.sigma * factors[0 if segment.is_static else 1]) for segment in linear.weighed
    )
    return replace(_reassembled(linear, segments, linear.scatter), inflation=linear.inflation * factors)


def with_play(linear: LinearisedModel, play: Array) -> LinearisedModel:
    """Return the design with gears that have play, shape (n,) [rad] or [m]: links may rest anywhere within it."""
    same = scatters_alike(play, linear.scatter.play)
    return linear if same else with_scatter(linear, replace(linear.scatter, play=play))


def with_scatter(linear: LinearisedModel, scatter: Scatter) -> LinearisedModel:
    """Return the design with another scatter of friction and play."""
    return _reassembled(linear, linear.weighed, scatter)


def with_repeats(linear: LinearisedModel, share: float) -> LinearisedModel:
    """Return the design in which a share of the variance of friction at rest repeats with a visit."""
    same = share == linear.scatter.repeats
    return linear if same else with_scatter(linear, replace(linear.scatter, repeats=share))


def with_places(linear: LinearisedModel, left: Array) -> LinearisedModel:
    """Return the design in which loose links of standing joints lie no farther apart than a residual shows.

    What a model misses otherwise looks like links that lie elsewhere in each run, so this is asked again about a better
    one; no place is less sure for that. It matters to models with play alone.

    Args:
        linear: The campaign.
        left: Shape (T, c), residual of a model.
    """
    sound = with_play(linear, linear.replay.compiled.play)
    known = (linear.replay.compiled, linear.weighed, linear.responses, linear.quantities, sound.whitenings)
    most = most_placed(*known, sound.jacobian, sound.whiten(left))
    placed = most if linear.scatter.placed is None else np.minimum(most, linear.scatter.placed)
    scatter = replace(linear.scatter, placed=placed)
    return with_scatter(linear, scatter) if np.any(scatter.play > 0) else replace(linear, scatter=scatter)


def roughened(
    linear: LinearisedModel, left: Array, where: Sequence[NDArray[np.bool_]] | None = None
) -> LinearisedModel:
    """Return the design with larger standard errors in motion where a residual is rough: what is not resolved is noise.

    Args:
        linear: The campaign.
        left: Shape (T, c), residual of a model.
        where: Of every segment, shape (T of the segment,), instants to look at; None: all.
    """
    chosen = where or [np.ones(len(segment), dtype=bool) for segment in linear.weighed]
    segments = tuple(
        segment
        if segment.is_static
        else replace(segment, sigma=np.where(rows[:, None], with_roughness(part, segment.sigma), segment.sigma))
        for segment, part, rows in zip(linear.weighed, linear.split(left), chosen, strict=True)
    )
    return _reassembled(linear, segments, linear.scatter)


def with_ringing(linear: LinearisedModel, left: Array) -> LinearisedModel:
    """Return the design in which no more is noise soon after a jerk than what is rough in a residual.

    What rings is not simulated; what a model misses otherwise is rough there too. So this is asked again about a better
    one; no reading is less sure for that.

    Args:
        linear: The campaign.
        left: Shape (T, c), residual of a model.
    """
    segments = list(linear.weighed)
    for i, (segment, stated, part) in enumerate(zip(segments, linear.segments, linear.split(left), strict=True)):
        if not segment.is_static and np.any(segment.rings):
            rough = with_roughness(part, stated.sigma) * linear.inflation[1]
            sigma = np.where(segment.rings[:, None], np.fmin(segment.sigma, rough), segment.sigma)
            if not np.array_equal(sigma, segment.sigma, equal_nan=True):
                segments[i] = replace(segment, sigma=sigma)
    if all(new is old for new, old in zip(segments, linear.weighed, strict=True)):
        return linear
    return _reassembled(linear, tuple(segments), linear.scatter)


def with_friction_of(linear: LinearisedModel, world: World, play: Array) -> LinearisedModel:
    """Return the design with the friction and the play of a world: what it holds at rest, and how that scatters.

    Args:
        linear: The campaign.
        world: In which the sensitivities to friction held at rest are taken.
        play: Shape (n,) [rad] or [m], of the gears.

    Raises:
        ConvergenceError, RobotError: The world cannot be simulated.
    """
    traces = linear.replay.traces(world)
    levels = levels_of(linear.replay.robot(world), traces, world.acting)
    held, changes = held_friction(linear.replay, traces, linear.responses, levels)
    names = [str(nuisance) for nuisance in linear.nuisances]
    new = relinearised(linear, [names.index(str(nuisance)) for nuisance in held], changes)
    if scatters_alike(play, linear.scatter.play) and scatters_alike(levels, linear.scatter.levels):
        return new
    return with_scatter(new, replace(linear.scatter, play=play, levels=levels))


def _reassembled(linear: LinearisedModel, segments: tuple[Segment, ...], scatter: Scatter) -> LinearisedModel:
    known = (linear.replay, linear.nuisances, linear.responses)
    new = assembled(*known, scatter, segments, linear.sensitivities, linear.residual)
    return replace(new, inflation=linear.inflation, unexplained=linear.unexplained)
