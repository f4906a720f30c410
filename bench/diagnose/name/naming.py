"""Name: from evidence to a cause, a set of causes, several causes, or the word that it is none that is listed.

A climb from the nominal model: at each step the causes that promise most are fitted by simulation, the best one is
added if its evidence passes the threshold and if it pays on what was held out, and all that was tried is weighed anew
against the model that has it. At the end every cause has to stand against its own rivals beside the others.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, Protocol

import numpy as np

from bench.diagnose.extend.fit import Fit, pseudo_residual
from bench.diagnose.extend.polish import polished
from bench.diagnose.extend.refit import refit, refitted
from bench.diagnose.measure.measure import HeldOut, held_out
from bench.diagnose.name.rivals import IN_SET, among_rivals, ranked
from bench.diagnose.name.trials import Hypothesis, Stage, one_more
from bench.diagnose.picture.candidates import Cause
from bench.diagnose.picture.design import Design, raised
from bench.diagnose.picture.generic import Block, blocks_of
from bench.diagnose.picture.lack_of_fit import is_adequate
from bench.diagnose.picture.screening import Entry, Screening, rescreen, tried_of
from bench.executor.contract import Executor
from bench.executor.serial import SERIAL
from bench.executor.watched import Stopped

Kind = Literal["nothing found", "cause", "several causes", "unlisted cause", "nothing found so far"]


class Renew(Protocol):
    """Returns the linear picture about a fit with everything that can be tried there, weighed anew."""

    def __call__(
        self, design: Design, fit: Fit, known: Screening, *, is_last: bool = False
    ) -> tuple[Design, Screening]:
        """Return design and screening; `is_last`: nothing will be added, what is missed now is noise."""


MOST_CAUSES = 30  # of an extension; that of the KR300 has 17
MOST_REFUSED = 8  # causes in turn that predict no better, before the climb ends
MOST_CHANGES = 2  # times that the end is weighed: once more where a rival takes the model's place
# What a fitted effect may leave unexplained of what it explains: effects are not simulated better than that.
UNEXPLAINED = 0.02
MAINLY = 0.8  # of the evidence for a free shape: what a single listed cause has is not called unlisted for its rest
CERTAIN = 4.6  # log evidence beyond the threshold (100 to 1) that is asked for a free shape alone


@dataclass(frozen=True, eq=False)
class Rung:
    """One step of the climb, taken or refused.

    Attributes:
        added: What was added to the model before.
        replaced: It took the place of the model before, which has other causes.
        fit: With it.
        log_evidence: By how much the logarithm of the evidence rose.
        held_out: What it is worth on what was held out.
        is_taken: Whether the model keeps it.
    """

    added: tuple[Cause, ...]
    replaced: bool
    fit: Fit
    log_evidence: float
    held_out: HeldOut
    is_taken: bool


@dataclass(frozen=True, eq=False)
class Naming:
    """What the data say.

    Attributes:
        kind: In a word.
        hypotheses: Fitted explanations by falling evidence; empty for nothing found.
        unlisted: The free shape that explains what no listed cause can, or None.
        null: Fit of the nominal model.
        screening: Everything that was tried against the nominal model.
        leftover: Everything that was tried against the best explanation.
        rungs: The climb.
        design: The linear picture about the best explanation.
        stopped: Why the climb ended early, and what was found was not held against all rivals; "" where it did not.
    """

    kind: Kind
    hypotheses: tuple[Hypothesis, ...]
    unlisted: Block | None
    null: Fit
    screening: Screening
    leftover: Screening
    rungs: tuple[Rung, ...]
    design: Design
    stopped: str = ""

    @property
    def alternatives(self) -> tuple[Hypothesis, ...]:
        """Explanations that these data cannot tell from the best, the best first."""
        if not self.hypotheses:
            return ()
        best = self.hypotheses[0].log_evidence
        return tuple(h for h in self.hypotheses if h.log_evidence > best - IN_SET)


def name_cause(
    design: Design,
    screening: Screening,
    renew: Renew,
    progress: Callable[[str], None] = lambda words: None,
    executor: Executor = SERIAL,
) -> Naming:
    """Name what is wrong with the nominal model, or what of it was found when the work was stopped.

    Args:
        design: The campaign.
        screening: Everything that was tried in the linear picture.
        renew: Weighs everything anew about an extended model.
        progress: Called with what is done next.
        executor: Where to fit.
    """
    so_far: list[Naming] = []
    try:
        return _named(design, screening, renew, progress, executor, so_far.append)
    except Stopped as stopped:
        return replace(so_far[-1], stopped=str(stopped))


def _named(
    design: Design,
    screening: Screening,
    renew: Renew,
    progress: Callable[[str], None],
    executor: Executor,
    keep: Callable[[Naming], None],
) -> Naming:
    """Return the naming; what is found on the way is kept, for it may be stopped."""
    null = refit(design, (), {})
    keep(Naming("nothing found so far", (), None, null, screening, screening, (), design))
    threshold = screening.threshold
    stage = Stage(design, screening, Hypothesis(null, 0.0))
    rungs: list[Rung] = []
    refused: set[tuple[str, str]] = set()
    while len(stage.best.causes) < MOST_CAUSES and len(refused) < MOST_REFUSED:
        limit = max(threshold, UNEXPLAINED * stage.best.log_evidence)
        if stage.screening.top <= limit:
            break
        count = len(stage.best.causes) + 1
        progress("single causes" if count == 1 else f"{count} causes")
        fits = one_more(stage, screening, refused, limit, executor)
        found = max(fits, key=lambda h: h.log_evidence, default=None)
        if found is None or found.log_evidence <= stage.best.log_evidence + limit:
            break
        before = stage.best.keys
        is_other = not before <= found.keys
        worth = held_out(stage.design, null if is_other else stage.fit, found.fit)
        added = tuple(cause for cause in found.causes if is_other or cause.key not in before)
        rise = found.log_evidence - (0.0 if is_other else stage.best.log_evidence)
        rungs.append(Rung(added, is_other, found.fit, rise, worth, worth.pays))
        if not worth.pays:
            refused |= {cause.key for cause in added if cause.key not in before}
            continue
        others = tuple(h for h in fits if h is not found and len(h.causes) == len(found.causes))
        keep(_so_far(replace(stage, best=found, tried=others), null, screening, tuple(rungs)))
        stage = _climbed(stage, found, others, renew, progress)
        keep(_so_far(stage, null, screening, tuple(rungs)))
        refused.clear()  # what did not pay before may pay beside this
        if len(stage.best.causes) > 1 and _explains_more(stage, design, screening):
            break
    for _ in range(MOST_CHANGES):
        block, is_alone = _unlisted(stage, design, screening)
        keep(_so_far(stage, null, screening, tuple(rungs), block, is_alone=is_alone))
        stage = _settled(stage, renew)
        hypotheses = among_rivals(stage, progress, executor) if stage.best.causes and not is_alone else ()
        if not hypotheses or hypotheses[0].keys == stage.best.keys:
            break
        stage = _changed(stage, hypotheses[0], renew)  # what the model before left may be no more
    if block is not None:
        return Naming("unlisted cause", hypotheses, block, null, screening, stage.screening, tuple(rungs), stage.design)
    if not hypotheses:  # what the linear picture promised, the simulation did not keep
        return Naming("nothing found", (), None, null, screening, screening, tuple(rungs), design)
    kind: Kind = "cause" if len(stage.best.causes) == 1 else "several causes"
    return Naming(kind, hypotheses, None, null, screening, stage.screening, tuple(rungs), stage.design)


def _so_far(
    stage: Stage,
    null: Fit,
    first: Screening,
    rungs: tuple[Rung, ...],
    block: Block | None = None,
    *,
    is_alone: bool = False,
) -> Naming:
    """Return what a climb has found where it stands."""
    hypotheses = ranked([stage.best, *stage.tried]) if stage.best.causes and not is_alone else ()
    kind: Kind = "cause" if len(stage.best.causes) == 1 else "several causes"
    if block is not None:
        kind = "unlisted cause"
    elif not hypotheses:
        kind = "nothing found so far"
    return Naming(kind, hypotheses, block, null, first, stage.screening, rungs, stage.design)


def _climbed(
    stage: Stage,
    found: Hypothesis,
    others: tuple[Hypothesis, ...],
    renew: Renew,
    progress: Callable[[str], None],
) -> Stage:
    """Return the stage with another model: derivatives about it, and everything weighed against it."""
    progress("what the extended model makes possible")
    design, fit = polished(stage.design, found.fit)
    kept = tuple(cause for cause in fit.causes if fit.acts(cause))
    if kept and len(kept) < len(fit.causes):  # what another cause took over
        fit = refit(design, kept, fit.start, fit.nuisances)
    value = found.log_evidence + fit.log_evidence - found.fit.log_evidence
    about, screening = renew(design, fit, stage.screening)
    if about is design:
        return _weighed(design, screening, Hypothesis(fit, value), others)
    return _weighed(about, screening, Hypothesis(refitted(about, fit), value))


def _settled(stage: Stage, renew: Renew) -> Stage:
    """Return the stage with all that its model misses taken for noise: intervals and sets are to be honest."""
    if not stage.best.causes:
        return stage
    design, screening = renew(stage.design, stage.fit, stage.screening, is_last=True)
    if design is stage.design:
        return stage
    fit = refitted(design, stage.fit)
    null = refit(design, (), {})
    return _weighed(design, screening, Hypothesis(fit, fit.log_evidence - null.log_evidence))


def _changed(stage: Stage, best: Hypothesis, renew: Renew) -> Stage:
    """Return the stage with a rival as its model; standard errors are what that one leaves."""
    design, screening = renew(stage.design, best.fit, stage.screening)
    fit = refitted(design, best.fit)
    return _weighed(design, screening, Hypothesis(fit, fit.log_evidence - refit(design, (), {}).log_evidence))


def _weighed(design: Design, screening: Screening, best: Hypothesis, tried: tuple[Hypothesis, ...] = ()) -> Stage:
    return Stage(design, _about(design, screening, best), best, tried)


def _about(design: Design, screening: Screening, best: Hypothesis) -> Screening:
    """Return everything of a screening, weighed against an explanation."""
    sigma = np.array([unknown.sigma for unknown in best.fit.unknowns])
    pseudo, slopes = pseudo_residual(design, best.fit), design.whiten(best.fit.slopes)
    return rescreen(design, screening, pseudo, slopes, sigma, best.keys)


def _explains_more(stage: Stage, nominal: Design, first: Screening) -> Entry | None:
    """Return the free shape that explains alone more than listed causes and the best shape beside them, or None.

    One that explains as much will do if listed causes are the smaller part, or if something at its place is needed
    beside several of them, none of which is the main cause.

    Both count with the same standard errors, the shape about the nominal model and its own derivatives: those about the
    extended one are of other friction and other stiffness.
    """
    design = raised(nominal, stage.design.excess / nominal.excess)
    null = Hypothesis(refit(design, (), {}), 0.0)
    everything = replace(stage.screening, tried=tried_of(blocks_of(design)), taken=frozenset())
    alone = _about(design, everything, null).free[:1]
    if not alone:
        return None
    listed = stage.fit.log_evidence - null.fit.log_evidence
    left = stage.screening.free[:1]
    beside = max([0.0, *(entry.log_evidence for entry in left)])
    margin = UNEXPLAINED * (listed + beside)
    more = alone[0].log_evidence - listed - beside
    surely = more > margin + first.threshold
    as_well = more > -margin and listed < beside
    is_needed = beside > first.threshold and _place(left[0]) == _place(alone[0])
    mainly = first.listed and first.listed[0].log_evidence > MAINLY * first.free[0].log_evidence
    simpler = more > 0 and is_needed and not mainly and len(stage.best.causes) > 1
    return alone[0] if surely or as_well or simpler else None


def _place(entry: Entry) -> str:
    assert isinstance(entry.what, Block)
    return entry.what.place


def _unlisted(stage: Stage, nominal: Design, first: Screening) -> tuple[Block | None, bool]:
    """Return the free shape that is needed, or None where listed causes are enough; and whether it stands alone.

    One that explains alone more than listed causes and the best shape beside them is preferred to them. Where no shape
    is needed by its evidence, but the model leaves far more than what nothing explains, the nearest to that is named.
    """
    left = stage.screening.free
    needed = left and left[0].log_evidence > max(first.threshold, UNEXPLAINED * stage.best.log_evidence)
    if not stage.best.causes:  # nothing but its evidence speaks for it: no rival that was ruled out, no held-out run
        needed = left and left[0].log_evidence > first.threshold + CERTAIN
    if not needed and not is_adequate(stage.design, pseudo_residual(stage.design, stage.fit)):
        needed, left = bool(left), _nearest(stage)
    if not needed and len(stage.best.causes) <= 1:
        return None, False
    alone = _explains_more(stage, nominal, first)
    if alone is None and not needed:
        return None, False
    what = alone.what if alone else left[0].what
    assert isinstance(what, Block)
    return what, alone is not None


def _nearest(stage: Stage) -> tuple[Entry, ...]:
    """Return the free shapes beside a model by what each explains, errors as small as what nothing explains."""
    design = raised(stage.design, stage.design.unexplained / stage.design.excess)
    everything = replace(stage.screening, tried=tried_of(blocks_of(design)))
    return _about(design, everything, stage.best).free
