"""Everything that was tried on a campaign, in the linear picture: evidence for each candidate and each free shape."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.diagnose.candidates import Candidate, Cause
from bench.diagnose.design import Design
from bench.diagnose.generic import Block
from bench.diagnose.marginal import Marginal, Nuisances
from bench.diagnose.threshold import family_threshold
from bench.record.campaign import Array

RICH_RIDGE = 1.0  # the richest model keeps the priors of its columns


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


@dataclass(frozen=True, eq=False)
class Screening:
    """What was tried, against one model.

    Attributes:
        marginal: Products of residuals and all columns.
        entries: By falling evidence.
        threshold: Log evidence that chance exceeds at the declared rate.
    """

    marginal: Marginal
    entries: tuple[Entry, ...]
    threshold: float

    @property
    def listed(self) -> tuple[Entry, ...]:
        """The best shape of every cause, by falling evidence."""
        best: dict[tuple[str, str], Entry] = {}
        for entry in self.entries:
            if entry.cause:
                best.setdefault(entry.cause.key, entry)
        return tuple(best.values())

    @property
    def free(self) -> tuple[Entry, ...]:
        """Blocks by falling evidence."""
        return tuple(entry for entry in self.entries if entry.cause is None)

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

    def given(self, entries: Sequence[Entry]) -> "Screening":
        """Return the same with some entries in the model already; those are not tried again."""
        columns = np.concatenate([entry.columns for entry in entries])
        prior = np.concatenate([entry.prior for entry in entries])
        marginal = self.marginal.given(columns, prior)
        taken = {entry.cause.key for entry in entries if entry.cause}
        rest = [e for e in self.entries if not any(e is other for other in entries)]
        rest = [e for e in rest if not (e.cause and e.cause.key in taken)]
        return Screening(marginal, _ranked(marginal, rest), self.threshold)


def screen(
    design: Design,
    candidates: Sequence[Candidate],
    blocks: Sequence[Block],
    rate: float,
    rng: np.random.Generator,
) -> Screening:
    """Return the evidence for everything against the nominal model.

    Args:
        design: The campaign.
        candidates: Listed causes.
        blocks: Free shapes.
        rate: Declared false-alarm rate of the whole.
        rng: For the threshold.
    """
    entries, start = [], 0
    tried: list[Candidate | Block] = [*candidates, *blocks]
    for what in tried:
        k = what.columns.shape[1]
        prior = what.prior if isinstance(what, Candidate) else np.full(k, what.prior)
        entries.append(Entry(what, np.arange(start, start + k), prior))
        start += k
    columns = np.concatenate([entry.what.columns for entry in entries], axis=1)
    marginal = Nuisances(design.slopes).products(design.white, columns)
    prior = np.concatenate([entry.prior for entry in entries])
    marginal = marginal.scaled(noise_scale(design, columns, prior))
    threshold = family_threshold(marginal, [(e.columns, e.prior) for e in entries], rate, rng)
    return Screening(marginal, _ranked(marginal, entries), threshold)


def rescreen(design: Design, base: Screening, white: Array, tangent: Array, sigma: Array) -> Screening:
    """Return the evidence for everything against a fitted extension.

    Args:
        design: The campaign.
        base: The screening of the nominal model.
        white: Shape (m,), residual of the extension with nuisances at zero.
        tangent: Shape (m, k), whitened slopes of its unknowns, which may move on.
        sigma: Shape (k,), their priors.
    """
    entries = sorted(base.entries, key=lambda entry: int(entry.columns[0]))
    columns = np.concatenate([entry.what.columns for entry in entries] + [tangent], axis=1)
    marginal = Nuisances(design.slopes).products(white, columns).scaled(base.marginal.scale)
    own = np.arange(columns.shape[1] - tangent.shape[1], columns.shape[1])
    marginal = marginal.given(own, sigma)
    return Screening(marginal, _ranked(marginal, entries), base.threshold)


def noise_scale(design: Design, columns: Array, prior: Array) -> float:
    """Return the variance of what not even the richest model explains, against what the instruments explain; 1 or more.

    Correlation from reading to reading counts: as many independent readings are lost.
    """
    rich = np.concatenate([design.slopes, columns * prior], axis=1)
    size = rich.shape[1]
    normal = rich.T @ rich + RICH_RIDGE * np.eye(size)
    explained = np.linalg.solve(normal, rich.T @ design.white)
    left = design.white - rich @ explained
    freedom = float(np.trace(np.linalg.solve(normal, rich.T @ rich)))
    scale = float(left @ left) / max(len(left) - freedom, 1.0)
    order = np.lexsort((np.arange(len(left)), design.column_of, design.run_of))
    sequence, run, column = left[order], design.run_of[order], design.column_of[order]
    same = (run[1:] == run[:-1]) & (column[1:] == column[:-1])
    pairs = float(np.sum(sequence[1:][same] * sequence[:-1][same]))
    power = float(np.sum(sequence[:-1][same] ** 2))
    correlation = float(np.clip(pairs / power if power > 0 else 0.0, 0.0, 0.95))
    return max(scale * (1 + correlation) / (1 - correlation), 1.0)


def _ranked(marginal: Marginal, entries: Sequence[Entry]) -> tuple[Entry, ...]:
    weighed = [replace(e, log_evidence=marginal.log_evidence(e.columns, e.prior)) for e in entries]
    return tuple(sorted(weighed, key=lambda entry: -entry.log_evidence))
