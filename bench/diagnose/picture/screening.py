"""Everything that was tried on a campaign, in the linear picture: evidence for each candidate and each free shape."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.diagnose.picture.candidates import Candidate, Cause
from bench.diagnose.picture.design import Design
from bench.diagnose.picture.generic import Block
from bench.diagnose.picture.marginal import Marginal, Nuisances
from bench.diagnose.picture.threshold import family_threshold
from bench.record.campaign import Array

WIDTHS = (1.0, 3.0, 10.0)  # times the prior of a free shape


@dataclass(frozen=True, eq=False)
class Entry:
    """One thing that was tried.

    Attributes:
        what: A candidate (a cause with its shape fixed) or a block (a free shape).
        columns: Indices into the products.
        prior: Shape (k,), of the columns.
        log_evidence: Against the model so far.
    """

    what: Candidate | Block
    columns: Array
    prior: Array
    log_evidence: float = 0.0

    @property
    def cause(self) -> Cause | None:
        """The cause, if it is listed."""
        return self.what.cause if isinstance(self.what, Candidate) else None

    @property
    def drive(self) -> int:
        """Index of the drive at which it acts, or -1."""
        if isinstance(self.what, Block):
            return self.what.drive
        place = self.what.cause.place
        return place.index if place.kind == "joint" else -1


@dataclass(frozen=True, eq=False)
class Screening:
    """What was tried, against one model.

    Attributes:
        marginal: Products of residuals and all columns.
        entries: By falling evidence.
        threshold: Log evidence that chance exceeds at the declared rate.
        taken: Causes that the model has already; they are not tried again.
    """

    marginal: Marginal
    entries: tuple[Entry, ...]
    threshold: float
    taken: frozenset[tuple[str, str]] = frozenset()

    @property
    def listed(self) -> tuple[Entry, ...]:
        """The best shape of every cause that is not taken, by falling evidence."""
        best: dict[tuple[str, str], Entry] = {}
        for entry in self.entries:
            if entry.cause and entry.cause.key not in self.taken:
                best.setdefault(entry.cause.key, entry)
        return tuple(best.values())

    @property
    def free(self) -> tuple[Entry, ...]:
        """Blocks by falling evidence."""
        return tuple(entry for entry in self.entries if entry.cause is None)

    @property
    def top(self) -> float:
        """The largest evidence of all that could be added."""
        return max([entry.log_evidence for entry in (*self.listed[:1], *self.free[:1])], default=0.0)

    def sizes_of(self, entry: Entry) -> dict[tuple[str, str, str], float]:
        """Return the best values of a candidate's parameters, as a start for a refit."""
        assert isinstance(entry.what, Candidate)
        candidate = entry.what
        steps, _ = self.marginal.sizes(entry.columns, entry.prior)
        key = candidate.cause.key
        values = {
            (*key, size.name): size.null + float(x * step)
            for size, x, step in zip(candidate.cause.sizes, steps, candidate.step, strict=True)
        }
        return values | {(*key, name): value for name, value in candidate.shape.items()}


def screen(
    design: Design,
    white: Array,
    candidates: Sequence[Candidate],
    blocks: Sequence[Block],
    rate: float,
    threshold: float | None = None,
) -> Screening:
    """Return the evidence for everything against a model.

    Args:
        design: The campaign, linear about the model.
        white: Shape (m,), residual of the model with nuisances at zero.
        candidates: Listed causes.
        blocks: Free shapes.
        rate: Declared false-alarm rate of the whole.
        threshold: Log evidence that chance exceeds at that rate; None: to be found.
    """
    entries = entries_of([*candidates, *blocks])
    columns = np.concatenate([entry.what.columns for entry in entries], axis=1)
    marginal = Nuisances(design.slopes).products(white, columns)
    if threshold is None:
        threshold = family_threshold(marginal, [(e.columns, e.prior) for e in entries], rate, np.random.default_rng(0))
    return Screening(marginal, _ranked(marginal, entries), threshold)


def entries_of(tried: Sequence[Candidate | Block]) -> tuple[Entry, ...]:
    """Return things to try with the places of their columns among those of all, in the order given."""
    entries, start = [], 0
    for what in tried:
        k = what.columns.shape[1]
        prior = what.prior if isinstance(what, Candidate) else np.full(k, what.prior)
        entries.append(Entry(what, np.arange(start, start + k), prior))
        start += k
    return tuple(entries)


def rescreen(
    design: Design,
    base: Screening,
    white: Array,
    tangent: Array,
    sigma: Array,
    taken: frozenset[tuple[str, str]] = frozenset(),
) -> Screening:
    """Return the evidence for everything against a fitted extension.

    Args:
        design: The campaign.
        base: Everything that can be tried.
        white: Shape (m,), residual of the extension with nuisances at zero.
        tangent: Shape (m, k), whitened slopes of its unknowns, which may move on.
        sigma: Shape (k,), their priors.
        taken: Causes that the extension has.
    """
    entries = sorted(base.entries, key=lambda entry: int(entry.columns[0]))
    columns = np.concatenate([entry.what.columns for entry in entries] + [tangent], axis=1)
    marginal = Nuisances(design.slopes).products(white, columns)
    own = np.arange(columns.shape[1] - tangent.shape[1], columns.shape[1])
    marginal = marginal.given(own, sigma)
    return Screening(marginal, _ranked(marginal, entries), base.threshold, taken)


def rewhitened(base: Screening, before: Design, after: Design) -> Screening:
    """Return a screening with its columns as another design whitens them; evidence is not weighed anew."""
    if after is before:
        return base
    entries = sorted(base.entries, key=lambda entry: int(entry.columns[0]))
    columns = after.whiten(before.unwhiten(np.concatenate([entry.what.columns for entry in entries], axis=1)))
    moved = tuple(replace(entry, what=replace(entry.what, columns=columns[:, entry.columns])) for entry in entries)
    return replace(base, entries=moved)


def _ranked(marginal: Marginal, entries: Sequence[Entry]) -> tuple[Entry, ...]:
    weighed = [replace(entry, log_evidence=_log_evidence(marginal, entry)) for entry in entries]
    return tuple(sorted(weighed, key=lambda entry: -entry.log_evidence))


def _log_evidence(marginal: Marginal, entry: Entry) -> float:
    """Return the evidence for an entry; a single size that has only one sign is not credited with the other.

    Nobody knows how large an unlisted shape is plausible: several widths of its prior count, with equal shares.
    """
    cause = entry.cause
    if cause is None:
        widths = [marginal.log_evidence(entry.columns, width * entry.prior) for width in WIDTHS]
        return max(widths) - float(np.log(len(WIDTHS)))
    if len(cause.sizes) == 1 and not cause.sizes[0].signed:
        assert isinstance(entry.what, Candidate)
        if marginal.scores[entry.columns[0]] * np.sign(entry.what.step[0]) < 0:
            return marginal.log_evidence(entry.columns, entry.prior) - 0.5 * marginal.gain(entry.columns, entry.prior)
    return marginal.log_evidence(entry.columns, entry.prior)
