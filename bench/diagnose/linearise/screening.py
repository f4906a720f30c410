"""Everything that was tried on a campaign, in the linearised model: evidence for each candidate and each free shape."""

from collections import Counter
from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.linearise.candidates import Candidate, Cause
from bench.diagnose.linearise.generic import Block
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.marginal import Columns, Marginal, Nuisances
from bench.diagnose.linearise.threshold import family_threshold
from bench.record.campaign import Array

# effort: times the prior of a free shape: nobody knows how large what is not listed may be; beside a listed cause it
# is small
WIDTHS = (0.1, 0.3, 1.0, 3.0, 10.0)
# effort: from one standard deviation of a cause to the next that is tried. Between two of them evidence falls short by
# at most 0.2 nats for each size.
NARROWER = 10**-0.5
# effort: the least of these widths for a cause whose plausible sizes begin at zero
SMALL = 0.1


@dataclass(frozen=True, eq=False)
class Entry:
    """One thing that was tried.

    Attributes:
        what: A candidate (a cause with its shape fixed) or a block (a free shape), without columns of its own.
        columns: Shape (k,), consecutive indices into the columns of all that was tried.
        priors: Standard deviations of the columns' sizes, shape (k,) each, and the logarithm of the share that each has
            of the prior odds: a cause shares them among its shapes and widths, a free shape among its widths and
            numbers of nodes.
        log_evidence: Against the model so far, with that share.
    """

    what: Candidate | Block
    columns: Array
    priors: tuple[tuple[Array, float], ...]
    log_evidence: float = 0.0

    @property
    def cause(self) -> Cause | None:
        """The cause, if it is listed."""
        return self.what.cause if isinstance(self.what, Candidate) else None

    @property
    def drive(self) -> int:
        """Index of the drive at which it acts, or -1."""
        return self.what.drive if isinstance(self.what, Block) else self.what.cause.drive

    @property
    def sign(self) -> Array:
        """Shape (k,), sign of the columns whose size can have one sign only; 0: either."""
        if isinstance(self.what, Block):
            return np.zeros(len(self.columns))
        free = np.array([size.signed for size in self.what.cause.sizes])
        return np.where(free, 0.0, np.sign(self.what.step))


@dataclass(frozen=True, eq=False)
class Tried:
    """Everything that is tried on a model, whitened.

    Attributes:
        entries: Not weighed yet.
        columns: Of all entries.
        needs: Key of a cause -> keys of findings of the model, without any of which it has no place.
    """

    entries: tuple[Entry, ...]
    columns: Columns
    needs: Mapping[Hashable, frozenset[Hashable]] = field(default_factory=dict)

    @property
    def prior(self) -> Array:
        """Shape (q,), standard deviations of the columns' sizes."""
        return np.concatenate([entry.what.plausible for entry in self.entries])

    def columns_of(self, entry: Entry) -> Array:
        """Return the columns of one of the entries, shape (m, k)."""
        return self.columns.matrix[:, entry.columns]


@dataclass(frozen=True, eq=False)
class Screening:
    """What was tried, against one model.

    Attributes:
        marginal: Products of residuals and all columns. A diagnosis lets go of these, but for their squares.
        entries: By falling evidence.
        threshold: Log evidence that chance exceeds at the declared rate; less it, evidence is posterior odds.
        takes_most: Shape (q,), index of the nuisance that does most of what each column does.
    """

    marginal: Marginal
    entries: tuple[Entry, ...]
    threshold: float
    takes_most: NDArray[np.intp]


def tried_of(what: Iterable[Candidate | Block]) -> Tried:
    """Return things to try with the places of their columns among those of all, in the order given.

    Columns are moved one after the other: a caller that keeps none of them never has them twice.
    """
    waiting = list(what)
    counts = [one.columns.shape[1] for one in waiting]
    edges = np.cumsum([0, *counts])
    matrix = np.empty((len(waiting[0].columns) if waiting else 0, int(edges[-1])))
    found = []
    for start, end in zip(edges[-2::-1], edges[:0:-1], strict=True):
        one = waiting.pop()
        matrix[:, start:end] = one.columns
        found.append(replace(one, columns=np.empty((0, end - start))))
    every = found[::-1]
    shapes = Counter(one.cause.key if isinstance(one, Candidate) else str(one) for one in every)
    entries = []
    for one, start, end in zip(every, edges[:-1], edges[1:], strict=True):
        if isinstance(one, Candidate):
            widths, count = widths_of(one.cause), shapes[one.cause.key]
        else:
            widths, count = WIDTHS, shapes[str(one)]
        share = -float(np.log(count * len(widths)))
        priors = tuple((width * one.plausible, share) for width in widths)
        entries.append(Entry(one, np.arange(start, end), priors))
    return Tried(tuple(entries), Columns(matrix))


def widths_of(cause: Cause) -> tuple[float, ...]:
    """Return how wide the prior of a cause's sizes may be, in times what is plausible, falling from 1.

    A size is as likely to be at the lower end of its plausible range as at its upper one: its prior is uniform in the
    logarithm, here of normal ones equally far apart in it, from high/sqrt(3) to sqrt(3) low. With a single one, a
    torque of 4 % of its range lost 2 nats to an offset of a current of a third of its own. As small as one of several
    sizes is, all of them are: a tracker that was pushed by a tenth of what is plausible in all six ways would lose
    14 nats to a joint that slipped.
    """
    least = max((3 * size.low / size.high for size in cause.sizes if size.low > 0), default=SMALL)
    least = min(least, 1.0)
    count = 1 + round(float(np.log(least) / np.log(NARROWER)))
    return tuple(float(width) for width in np.geomspace(1.0, least, count))


def screen(linear: LinearisedModel, white: Array, tried: Tried, rate: float) -> Screening:
    """Return the evidence for everything against a model.

    Args:
        linear: The campaign, linear about the model.
        white: Shape (m,), residual of the model with nuisances at zero.
        tried: Listed causes and free shapes.
        rate: Declared false-alarm rate of the whole.
    """
    marginal = Nuisances(linear.jacobian).products(white, tried.columns)
    blocks = [(entry.columns, *prior) for entry in tried.entries for prior in entry.priors]
    threshold = family_threshold(marginal, blocks, rate, np.random.default_rng(0))
    return screening_of(linear, marginal, tried.entries, threshold)


def screening_of(linear: LinearisedModel, marginal: Marginal, entries: Sequence[Entry], threshold: float) -> Screening:
    """Return what was tried by falling evidence, and which nuisance does most of what each column does.

    Of a column x, the slope a of one nuisance takes (a^T x)^2 / a^T a.

    Args:
        linear: The campaign.
        marginal: Products of a residual and all columns.
        entries: Everything that was tried.
        threshold: Log evidence that chance exceeds at the declared rate.
    """
    slopes = linear.jacobian
    squares = np.einsum("ij,ij->j", slopes, slopes)
    taken = marginal.columns.with_slopes(slopes) ** 2 / np.where(squares > 0, squares, np.inf)[:, None]
    most = np.argmax(taken, axis=0) if len(taken) else np.zeros(taken.shape[1], dtype=np.intp)
    return Screening(marginal, ranked(marginal, entries), threshold, most)


def ranked(marginal: Marginal, entries: Sequence[Entry]) -> tuple[Entry, ...]:
    """Return what was tried with its evidence against a model, by falling evidence."""
    evidence = _log_evidences(marginal, entries)
    order = np.argsort(-evidence, kind="stable")
    return tuple(replace(entries[i], log_evidence=float(evidence[i])) for i in order)


def _log_evidences(marginal: Marginal, entries: Sequence[Entry]) -> Array:
    """Return the evidence for every entry with the best of its priors, shape (E,)."""
    found = np.full(len(entries), -np.inf)
    kinds: dict[tuple[int, int], list[int]] = {}
    for i, entry in enumerate(entries):
        for width in range(len(entry.priors)):
            kinds.setdefault((width, len(entry.columns)), []).append(i)
    for (width, _), which in kinds.items():
        columns = np.stack([entries[i].columns for i in which])
        prior = np.stack([entries[i].priors[width][0] for i in which])
        share = np.array([entries[i].priors[width][1] for i in which])
        sign = np.stack([entries[i].sign for i in which])
        found[which] = np.maximum(found[which], marginal.log_evidences(columns, prior, sign) + share)
    return found
