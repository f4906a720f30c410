"""A fitted extension: causes with values, what they leave, and how sure of them it is."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.linearised_model import LinearisedModel, relinearised
from bench.diagnose.replay.world import World
from bench.effects.effect import Parameter
from bench.record.campaign import Array

STEP = 0.05  # rounding: of a parameter's plausible size, for its derivative
# rounding: of a size's standard error, the same where that is known and less: what it does bends within its range, as
# where links slide does, and what figures do that act alike is taken over half of their standard deviation too
# (`STEP_OF_NUISANCE`). Else the difference between two ways to write the same friction tells which it is.
STEP_OF_ERROR = 0.5
# rounding: Of the distance to the next shape that is tried, for a shape that may lie anywhere over decades. Balances
# are found within a tolerance: with a hundredth of a softening's knee, that noise made its interval three times too
# narrow.
SHAPE_STEP = 0.125
# derived: times its largest plausible size, up to where a parameter is fitted: 99 % of its prior, which is normal and
# as wide as sizes that are evenly spread up to the largest one
BEYOND = 2.575829 / 3**0.5
AT_BOUND = 1e-3  # rounding: of the way to a bound, from where a fit has run into it

Key = tuple[str, str, str]  # effect, place, parameter


@dataclass(frozen=True, eq=False)
class Unknown:
    """One parameter of one cause."""

    cause: Cause
    parameter: Parameter

    @property
    def key(self) -> Key:
        """What tells it from others."""
        return (*self.cause.key, self.parameter.name)

    @property
    def words(self) -> str:
        """What it is, for people."""
        cause = self.cause
        is_everywhere = cause.place.kind == "robot" and cause.place.recording is None
        where = "" if is_everywhere else f" ({cause.place})"
        return f"{cause.effect.title}{where}: {self.parameter.name.replace('_', ' ')}"

    @property
    def sigma(self) -> float:
        """Standard deviation of its prior."""
        return self.parameter.sigma

    @property
    def bounds(self) -> tuple[float, float]:
        """Values beyond which it makes no sense: a little more than plausible, and no more than physics allows."""
        p = self.parameter
        if p.is_shape:
            low, high = p.low / 2 if p.low > 0 else p.low, 2 * p.high if p.high > 0 else p.high
        else:
            low, high = p.null - BEYOND * p.high if p.signed else p.null, p.null + BEYOND * p.high
        return max(low, p.least), min(high, p.most)

    @property
    def possible(self) -> tuple[float, float]:
        """Values that it can have at all, plausible or not; of a shape, those that make sense."""
        p = self.parameter
        if p.is_shape:
            return self.bounds
        return p.least if p.signed else max(p.null, p.least), p.most

    def step_from(self, value: float, error: float = np.inf) -> float:
        """Return a step within bounds, for its derivative; a shape may lie anywhere over decades, as a period does.

        Args:
            value: From where.
            error: Its standard error, as far as known.
        """
        p = self.parameter
        step = STEP * (p.high - p.low if p.is_shape else p.high)
        if not p.is_shape and error > 0:
            step = min(step, STEP_OF_ERROR * error)
        if p.is_shape and p.low > 0:
            step = SHAPE_STEP * (p.ratio - 1) * value
        return step if value + step <= self.bounds[1] else -step


@dataclass(frozen=True, eq=False)
class Fit:
    """A fitted extension; p nuisances, k unknowns, m whitened readings.

    Attributes:
        causes: What was added to the nominal model; empty: nothing.
        unknowns: Their parameters, in order.
        values: Shape (k,).
        covariance: Shape (k, k), nuisances integrated out.
        nuisances: Shape (p,), in standard deviations of their priors.
        objective: Chi-square plus penalties of the priors.
        log_evidence: Logarithm of the marginal likelihood, up to a constant that all fits of a campaign share.
        residual: Shape (T, c), measured less simulated; nan where not measured.
        jacobian: Shape (T, c, k), change of the readings with each unknown.
        play: Shape (n,) [rad] or [m], of the gears, within which links were taken to rest anywhere.
        renewed: Derivatives of nuisances that are not those of the design, each by its index, shape (T, c).
        is_settled: Whether derivatives that can be trusted lead no further.
    """

    causes: tuple[Cause, ...]
    unknowns: tuple[Unknown, ...]
    values: Array
    covariance: Array
    nuisances: Array
    objective: float
    log_evidence: float
    residual: Array
    jacobian: Array
    play: Array
    renewed: Mapping[int, Array] = field(default_factory=dict)
    is_settled: bool = True

    @property
    def sigma(self) -> Array:
        """Shape (k,), standard deviations of the values."""
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))

    @property
    def start(self) -> dict[Key, float]:
        """Its values, for another fit to start from."""
        return {unknown.key: float(value) for unknown, value in zip(self.unknowns, self.values, strict=True)}

    @property
    def off(self) -> Array:
        """Shape (k,), how far each value is from none."""
        return self.values - np.array([unknown.parameter.null for unknown in self.unknowns], dtype=np.float64)

    def with_causes(self, causes: tuple[Cause, ...]) -> "Fit":
        """Return the same numbers for other objects of the same causes; for none, so that it passes between processes.

        Causes may come from a user's file, which another process cannot read.
        """
        return replace(self, causes=causes, unknowns=unknowns_of(causes))

    def where(self, cause: Cause) -> list[int]:
        """Return where the sizes of a cause stand among the unknowns."""
        return [i for i, one in enumerate(self.unknowns) if one.cause is cause and not one.parameter.is_shape]

    def sizes_of(self, cause: Cause) -> tuple[list[int], Array]:
        """Return where the unknowns of a cause are, and how far each is from none, shape (k,); 0 for its shapes."""
        mine = [i for i, unknown in enumerate(self.unknowns) if unknown.cause is cause]
        return mine, np.where([self.unknowns[i].parameter.is_shape for i in mine], 0.0, self.off[mine])

    def design(self, linear: LinearisedModel) -> LinearisedModel:
        """Return a design with the derivatives of nuisances that this fit took anew."""
        if not self.renewed:
            return linear
        return relinearised(linear, list(self.renewed), np.stack(list(self.renewed.values()), axis=2))

    def change(self, linear: LinearisedModel, nuisances: Array, at: NDArray[np.bool_] | None = None) -> Array:
        """Return what nuisances change to first order, shape (T, c).

        Args:
            linear: The campaign.
            nuisances: Shape (p,), in standard deviations of their priors.
            at: Shape (instants,), the T of them that are asked for; None: all.
        """
        every = slice(None) if at is None else at
        sensitivities = linear.sensitivities[every]
        found: Array = sensitivities @ nuisances
        for i, renewed in self.renewed.items():
            found += (renewed[every] - sensitivities[:, :, i]) * nuisances[i]
        return found

    def slopes_of(self, unknowns: tuple[Unknown, ...]) -> dict[int, Array]:
        """Return its derivatives with those of some unknowns that it has, each by its index, shape (T, c)."""
        mine = {unknown.key: i for i, unknown in enumerate(self.unknowns)}
        places = {i: mine.get(unknown.key) for i, unknown in enumerate(unknowns)}
        return {i: self.jacobian[:, :, place] for i, place in places.items() if place is not None}

    def elsewhere(self, cause: Cause) -> "Fit":
        """Return it without derivatives with the unknowns of a cause, for a fit that begins with that elsewhere."""
        kept = [i for i, unknown in enumerate(self.unknowns) if unknown.cause.key != cause.key]
        return replace(self, unknowns=tuple(self.unknowns[i] for i in kept), jacobian=self.jacobian[:, :, kept])

    def sizes_against_none(self, cause: Cause) -> tuple[Array, Array]:
        """Return how far the sizes of a cause are from none, shape (k,), and their covariance with its shapes held.

        Without a size its shape means nothing, so how little is known of both together is no doubt about the size:
        links that grow by alpha w (T - T_0) may have a large alpha and a small w, or the reverse, and grow for sure.
        """
        sizes = self.where(cause)
        shapes = [i for i, one in enumerate(self.unknowns) if one.cause is cause and one.parameter.is_shape]
        shapes = [i for i in shapes if self.covariance[i, i] > 0]
        covariance = self.covariance[np.ix_(sizes, sizes)]
        if shapes:
            beside = self.covariance[np.ix_(sizes, shapes)]
            covariance = covariance - beside @ np.linalg.solve(self.covariance[np.ix_(shapes, shapes)], beside.T)
        return self.off[sizes], covariance

    def acts(self, cause: Cause) -> bool:
        """Whether any size of a cause is more than its standard deviation away from none, its shapes held."""
        off, covariance = self.sizes_against_none(cause)
        return bool(np.any(np.abs(off) > np.sqrt(np.maximum(np.diag(covariance), 0.0))))

    def allows(self, cause: Cause) -> bool:
        """Whether no size of a cause wants to be larger than plausible; else it is another cause, or a misreading."""
        return all(
            abs(value - unknown.parameter.null) <= (1 - AT_BOUND) * BEYOND * unknown.parameter.high
            for value, unknown in zip(self.values, self.unknowns, strict=True)
            if unknown.cause.key == cause.key and not unknown.parameter.is_shape
        )

    def world(self, linear: LinearisedModel) -> World:
        """Return the world that was fitted."""
        return world_of(linear, self.causes, self.unknowns, self.values, self.nuisances)

    def worlds_beside(self, linear: LinearisedModel) -> Iterator[tuple[World, float]]:
        """Yield for each unknown a world in which it is a step further, and that step."""
        for i, unknown in enumerate(self.unknowns):
            moved, step = self.values.copy(), unknown.step_from(float(self.values[i]))
            moved[i] += step
            yield world_of(linear, self.causes, self.unknowns, moved, self.nuisances), step


def world_of(
    linear: LinearisedModel, causes: tuple[Cause, ...], unknowns: tuple[Unknown, ...], values: Array, nuisances: Array
) -> World:
    """Return the world with these values."""
    deviations = {
        nuisance: float(x) * nuisance.sigma
        for nuisance, x in zip(linear.nuisances, nuisances, strict=True)
        if nuisance.is_simulated
    }
    acting = []
    for cause in causes:
        mine = {u.parameter.name: float(v) for u, v in zip(unknowns, values, strict=True) if u.cause is cause}
        acting.append(cause.acting(mine))
    return World(deviations, tuple(acting))


def unknowns_of(causes: tuple[Cause, ...]) -> tuple[Unknown, ...]:
    """Return the parameters that are fitted, sizes and shapes of each cause in turn."""
    return tuple(Unknown(cause, p) for cause in causes for p in (*cause.sizes, *cause.shapes))


def play_of(linear: LinearisedModel, causes: tuple[Cause, ...], unknowns: tuple[Unknown, ...], values: Array) -> Array:
    """Return the play of the gears in a model with these values, shape (n,) [rad] or [m]."""
    return linear.replay.play(world_of(linear, causes, unknowns, values, np.zeros(len(linear.nuisances))))


def fit_without(linear: LinearisedModel, fit: Fit, cause: Cause) -> Fit:
    """Return a fit with one of its causes taken away and nothing fitted anew.

    Raises:
        ConvergenceError, RobotError: What is left cannot be simulated.
    """
    kept = [i for i, unknown in enumerate(fit.unknowns) if unknown.cause is not cause]
    causes = tuple(other for other in fit.causes if other is not cause)
    unknowns, values = tuple(fit.unknowns[i] for i in kept), fit.values[kept]
    here = linear.replay.predict(fit.world(linear))
    without = linear.replay.predict(world_of(linear, causes, unknowns, values, fit.nuisances))
    return replace(
        fit,
        causes=causes,
        unknowns=unknowns,
        values=values,
        covariance=fit.covariance[np.ix_(kept, kept)],
        residual=fit.residual + here - without,
        jacobian=fit.jacobian[:, :, kept],
        play=play_of(linear, causes, unknowns, values),
    )


def pseudo_residual(linear: LinearisedModel, fit: Fit) -> Array:
    """Return the whitened residual of a fit as it would be with all nuisances at zero, shape (m,)."""
    return linear.whiten(fit.residual) + linear.whiten(fit.change(linear, fit.nuisances))
