"""Everything that was tried on a campaign, in the linear picture: evidence for each candidate and each free shape."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.diagnose.picture.candidates import Candidate, Cause
from bench.diagnose.picture.design import WHITENED_TOGETHER, Design
from bench.diagnose.picture.generic import Block
from bench.diagnose.picture.marginal import Columns, Marginal, Nuisances
from bench.diagnose.picture.threshold import family_threshold
from bench.record.campaign import Array

WIDTHS = (1.0, 3.0, 10.0)  # times the prior of a free shape


@dataclass(frozen=True, eq=False)
class Entry:
    """One thing that was tried.

    Attributes:
        what: A candidate (a cause with its shape fixed) or a block (a free shape).
        columns: Shape (k,), consecutive indices into the columns of all that was tried.
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
class Tried:
    """Everything that is tried on a model, whitened.

    Attributes:
        entries: Not weighed yet.
        columns: Of all entries.
    """

    entries: tuple[Entry, ...]
    columns: Columns

    @property
    def prior(self) -> Array:
        """Shape (q,), standard deviations of the columns' sizes."""
        return np.concatenate([entry.prior for entry in self.entries])


@dataclass(frozen=True, eq=False)
class Screening:
    """What was tried, against one model.

    Attributes:
        marginal: Products of residuals and all columns.
        entries: By falling evidence.
        threshold: Log evidence that chance exceeds at the declared rate.
        tried: The same entries as they are whitened now.
        taken: Causes that the model has already; they are not tried again.
    """

    marginal: Marginal
    entries: tuple[Entry, ...]
    threshold: float
    tried: Tried
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


def tried_of(what: Sequence[Candidate | Block]) -> Tried:
    """Return things to try with the places of their columns among those of all, in the order given."""
    edges = np.cumsum([0, *(one.columns.shape[1] for one in what)])
    matrix = np.empty((len(what[0].columns) if what else 0, int(edges[-1])))
    entries = []
    for one, start, end in zip(what, edges[:-1], edges[1:], strict=True):
        matrix[:, start:end] = one.columns
        prior = one.prior if isinstance(one, Candidate) else np.full(end - start, one.prior)
        entries.append(Entry(replace(one, columns=matrix[:, start:end]), np.arange(start, end), prior))
    return Tried(tuple(entries), Columns(matrix))


def screen(design: Design, white: Array, tried: Tried, rate: float, threshold: float | None = None) -> Screening:
    """Return the evidence for everything against a model.

    Args:
        design: The campaign, linear about the model.
        white: Shape (m,), residual of the model with nuisances at zero.
        tried: Listed causes and free shapes.
        rate: Declared false-alarm rate of the whole.
        threshold: Log evidence that chance exceeds at that rate; None: to be found.
    """
    marginal = Nuisances(design.slopes).products(white, tried.columns)
    if threshold is None:
        blocks = [(entry.columns, entry.prior) for entry in tried.entries]
        threshold = family_threshold(marginal, blocks, rate, np.random.default_rng(0))
    return Screening(marginal, _ranked(marginal, tried.entries), threshold, tried)


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
    marginal = Nuisances(design.slopes, tangent * sigma).products(white, base.tried.columns)
    return Screening(marginal, _ranked(marginal, base.tried.entries), base.threshold, base.tried, taken)


def rewhitened(base: Screening, before: Design, after: Design) -> Screening:
    """Return a screening with its columns as another design whitens them; evidence is not weighed anew."""
    if after is before:
        return base
    old = base.tried.columns.matrix
    matrix = np.empty_like(old)
    for start in range(0, old.shape[1], WHITENED_TOGETHER):
        part = slice(start, start + WHITENED_TOGETHER)
        matrix[:, part] = after.whiten(before.unwhiten(old[:, part]))
    entries = tuple(
        replace(entry, what=replace(entry.what, columns=matrix[:, entry.columns[0] : entry.columns[-1] + 1]))
        for entry in base.tried.entries
    )
    return replace(base, tried=Tried(entries, Columns(matrix)))


def _ranked(marginal: Marginal, entries: Sequence[Entry]) -> tuple[Entry, ...]:
    evidence = _log_evidences(marginal, entries)
    order = np.argsort(-evidence, kind="stable")
    return tuple(replace(entries[i], log_evidence=float(evidence[i])) for i in order)


def _log_evidences(marginal: Marginal, entries: Sequence[Entry]) -> Array:
    """Return the evidence for every entry, shape (E,); a single size with one sign is not credited with the other.

    Nobody knows how large an unlisted shape is plausible: several widths of its prior count, with equal shares.
    """
    found = np.empty(len(entries))
    kinds: dict[tuple[bool, int], list[int]] = {}
    for i, entry in enumerate(entries):
        kinds.setdefault((entry.cause is None, len(entry.columns)), []).append(i)
    for (is_free, _), which in kinds.items():
        columns = np.stack([entries[i].columns for i in which])
        prior = np.stack([entries[i].prior for i in which])
        if is_free:
            widths = [marginal.log_evidences(columns, width * prior) for width in WIDTHS]
            found[which] = np.max(widths, axis=0) - np.log(len(WIDTHS))
            continue
        found[which] = marginal.log_evidences(columns, prior)
        wrong = np.array([_has_wrong_sign(marginal, entries[i]) for i in which])
        if np.any(wrong):
            found[np.array(which)[wrong]] -= 0.5 * marginal.gains(columns[wrong], prior[wrong])
    return found


def _has_wrong_sign(marginal: Marginal, entry: Entry) -> bool:
    """Whether a cause of a single size, which has one sign only, fits best with the other sign."""
    cause = entry.cause
    if cause is None or len(cause.sizes) != 1 or cause.sizes[0].signed:
        return False
    assert isinstance(entry.what, Candidate)
    return bool(marginal.scores[entry.columns[0]] * np.sign(entry.what.step[0]) < 0)
