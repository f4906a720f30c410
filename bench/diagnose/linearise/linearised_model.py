"""The linearised model of a campaign: residuals of the nominal model and its derivatives, made comparable.

All in whitened space: what cannot be predicted (noise, friction at rest) is standard normal there, and every nuisance
is scaled to a prior of one. Effects are named in this picture first, for it is cheap; the last word is always a
simulation (`bench.diagnose.extend.refit`).
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.linearise.marginal import Nuisances
from bench.diagnose.linearise.noise_covariance import Scatter, Whitening
from bench.diagnose.linearise.repeated_rests import RepeatedRests, whitenings_of
from bench.diagnose.linearise.torque_response import TorqueResponse
from bench.diagnose.replay.instants import at_each_instant, instants_of
from bench.diagnose.replay.nuisances import Nuisance
from bench.diagnose.replay.quantities import Quantity
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import Segment
from bench.record.campaign import Array

WHITENED_TOGETHER = 64  # effort: columns at a time, where there are hundreds: memory stays small


@dataclass(frozen=True, eq=False)
class LinearisedModel:
    """A campaign in the linearised model; m whitened readings, p nuisances.

    Attributes:
        replay: The campaign with the nominal robot.
        nuisances: What may be a little wrong. One that changes neither model nor readings acts by its
            `sensitivities` alone.
        responses: Of every segment to torques.
        whitenings: Of every segment.
        repeated: What visits that repeat each other have in common after that.
        scatter: Of friction and play, which the whitenings know.
        weighed: The segments with the standard errors that count here.
        inflation: Shape (2, c), by what the standard errors were raised for lack of fit, at rest and in motion.
        unexplained: Shape (2, c), by what they had to be raised in any case: not even everything together explains it.
        sensitivities: Shape (T, c, p), change of every reading with one standard deviation of each nuisance.
        residual: Shape (T, c), measured less nominal; nan where not measured.
        jacobian: Shape (m, p), `sensitivities` whitened.
        white: Shape (m,), `residual` whitened.
        run_of: Shape (m,), index into `runs`.
        runs: Names of the runs.
        column_of: Shape (m,), index into the quantities; whitening mixes the quantities of an instant a little.
    """

    replay: Replay
    nuisances: tuple[Nuisance, ...]
    responses: tuple[TorqueResponse, ...]
    whitenings: tuple[Whitening, ...]
    repeated: tuple[RepeatedRests, ...]
    scatter: Scatter
    weighed: tuple[Segment, ...]
    inflation: Array
    unexplained: Array
    sensitivities: Array
    residual: Array
    jacobian: Array
    white: Array
    run_of: Array
    runs: tuple[str, ...]
    column_of: Array

    @property
    def quantities(self) -> tuple[Quantity, ...]:
        """What is compared."""
        return self.replay.quantities

    @property
    def segments(self) -> tuple[Segment, ...]:
        """What is replayed."""
        return self.replay.segments

    @property
    def observed(self) -> Array:
        """Shape (T, c), what was measured; nan where nothing was."""
        return self.replay.observed

    @cached_property
    def instant_of(self) -> NDArray[np.int64]:
        """Shape (m,), index of the instant of every whitened reading."""
        return self._stacked[1] // len(self.quantities)

    @cached_property
    def kind_of(self) -> NDArray[np.int64]:
        """Shape (m,), 0 for every whitened reading at rest, 1 in motion."""
        return at_each_instant(self.segments, [int(not segment.is_static) for segment in self.segments])[
            self.instant_of
        ]

    def whiten(self, values: Array) -> Array:
        """Return whitened values, shape (m, ...), of values of shape (T, c, ...); nan counts as not measured."""
        length, c, *more = values.shape
        k = math.prod(more)
        factors, rows = self._stacked
        white = (factors @ np.nan_to_num(values.reshape(length, c, k))).reshape(length * c, k)[rows]
        for whitening, start, end in zip(self.whitenings, self._edges[:-1], self._edges[1:], strict=True):
            whitening.settle(white[start:end])
        for rests in self.repeated:
            rests.settle(white)
        return white.reshape(len(white), *more)

    def unwhiten(self, whitened: Array) -> Array:
        """Return values, shape (T, c, k), of whitened ones, shape (m, k); 0 where not measured."""
        for rests in self.repeated:
            whitened = whitened.copy()
            rests.undo(whitened)
        parts = np.split(whitened, self._edges[1:-1])
        return np.concatenate([w.undone(part) for w, part in zip(self.whitenings, parts, strict=True)])

    @cached_property
    def log_determinants(self) -> Array:
        """Shape (m,); their sum is what the evidence of models that differ in what cannot be predicted has to count."""
        found = np.concatenate([whitening.log_determinants for whitening in self.whitenings])
        for rests in self.repeated:
            found[rests.rows] += float(np.sum(np.log(1 - rests.shrink))) / len(rests.rows)
        return found

    @cached_property
    def _edges(self) -> list[int]:
        """Whitened readings before each segment, and of all."""
        return [0, *np.cumsum([len(whitening.modes) for whitening in self.whitenings]).tolist()]

    @cached_property
    def _stacked(self) -> tuple[Array, NDArray[np.int64]]:
        """Factors, shape (T, c, c), and indices of what was measured, shape (m,), of all segments."""
        return (
            np.concatenate([whitening.factors for whitening in self.whitenings]),
            np.flatnonzero(np.concatenate([whitening.rows for whitening in self.whitenings])),
        )

    def tangent(self, beside: Array, renewed: Mapping[int, Array]) -> Array:
        """Return the changes of whitened readings with nuisances and other parameters, shape (m, p + k).

        Args:
            beside: Shape (T, c, k), changes of the readings with the others.
            renewed: Changes with nuisances that are not those of the model, each by its index, shape (T, c).
        """
        found = np.concatenate([self.jacobian, self.whiten(beside)], axis=1)
        if renewed:
            found[:, list(renewed)] = self.whiten(np.stack(list(renewed.values()), axis=2))
        return found

    def most_probable(self, white: Array) -> Array:
        """Return the nuisances that explain a whitened residual best under their priors, shape (p,), for (m,)."""
        return Nuisances(self.jacobian).most_probable(white)

    def split(self, values: Array) -> list[Array]:
        """Return values of shape (T, ...) segment by segment."""
        return [values[rows] for rows in instants_of(self.segments)]


def relinearised(linear: LinearisedModel, which: Sequence[int], sensitivities: Array) -> LinearisedModel:
    """Return the design with other `sensitivities` of some nuisances, as they are about another world.

    Args:
        linear: About the world so far.
        which: Indices of q nuisances.
        sensitivities: Shape (T, c, q), of theirs.
    """
    every, jacobian = linear.sensitivities.copy(), linear.jacobian.copy()
    every[:, :, which], jacobian[:, which] = sensitivities, linear.whiten(sensitivities)
    return replace(linear, sensitivities=every, jacobian=jacobian)


def assembled(
    replay: Replay,
    nuisances: tuple[Nuisance, ...],
    responses: tuple[TorqueResponse, ...],
    scatter: Scatter,
    segments: tuple[Segment, ...],
    sensitivities: Array,
    residual: Array,
) -> LinearisedModel:
    """Return a linearised model from its parts; see there."""
    whitenings, repeated = whitenings_of(replay.compiled, segments, responses, replay.quantities, scatter)
    runs = tuple(dict.fromkeys(segment.run for segment in segments))
    c = len(replay.quantities)
    run_of = np.concatenate(
        [np.full(int(w.rows.sum()), runs.index(segment.run)) for segment, w in zip(segments, whitenings, strict=True)]
    )
    column_of = np.concatenate(
        [np.tile(np.arange(c), len(segment))[w.rows] for segment, w in zip(segments, whitenings, strict=True)]
    )
    empty = np.empty(0)
    ones = np.ones((2, c))
    known = (replay, nuisances, responses, whitenings, repeated, scatter, segments, ones, ones, sensitivities, residual)
    draft = LinearisedModel(*known, empty, empty, run_of, runs, column_of)
    both = draft.whiten(np.concatenate([sensitivities, residual[:, :, None]], axis=2))
    return replace(draft, jacobian=both[:, :-1], white=both[:, -1])
