"""Select: from evidence to the findings that a model needs.

    linearise about the best model so far (at first the nominal one) -> search all subsets -> simulate the leaders
          ^                                                                                       |
          └──────────── until the best model repeats; then whatever it misses is noise ───────────┘

Every finding then has to pay on what was held out, or it is refused and the search goes on without it.
"""

from collections.abc import Callable, Hashable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol

from bench.diagnose.cross_validation.held_out import held_out
from bench.diagnose.cross_validation.jackknife import with_jackknife
from bench.diagnose.extend.fit import Fit
from bench.diagnose.extend.refit import refit
from bench.diagnose.extend.relinearise import relinearised_fit
from bench.diagnose.extend.size import is_clear_of_none
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.screening import Screening, Tried
from bench.diagnose.linearise.threshold import LEAST
from bench.diagnose.name.groups import IN_SET, AmbiguityGroup, groups_of
from bench.diagnose.name.leaders import grown, leaders_of, scattering
from bench.diagnose.name.models import Fitter, Model, reweighed, without_shape
from bench.diagnose.name.naming import Finding, Kind, Naming, posterior_of, with_probabilities
from bench.diagnose.name.repeated import repeats
from bench.diagnose.name.search import alternatives_of, exchanges, search
from bench.diagnose.name.search_space import search_space
from bench.diagnose.name.simulation_error import SimulationError, imitated, rise_of
from bench.errors import NOT_SIMULATED
from bench.executor.contract import Executor
from bench.executor.serial import SERIAL
from bench.executor.watched import Stopped


class Renew(Protocol):
    """Returns the campaign linearised about a model, with everything that can be tried there."""

    def __call__(
        self, linear: LinearisedModel, model: Model, *, is_last: bool = False
    ) -> tuple[LinearisedModel, Tried]:
        """Return the design and what can be tried; `is_last`: nothing will be added, what is missed now is noise."""


MOST_ROUNDS = 12  # effort: of linearising and searching; the KR300 takes 6
LEADERS = 6  # effort: alternatives of a search that are simulated; half of them while the best model still changes
MOST_REFUSED = 20  # effort: findings that do not predict better, before they are no more replaced


def name_cause(
    linear: LinearisedModel,
    screening: Screening,
    renew: Renew,
    progress: Callable[[str], None] = lambda words: None,
    executor: Executor = SERIAL,
) -> Naming:
    """Name what is wrong with the nominal model, or what of it was found when the work was stopped.

    Args:
        linear: The campaign.
        screening: Everything that was tried in the linearised model.
        renew: Weighs everything anew about an extended model.
        progress: Called with what is done next.
        executor: Where to fit.
    """
    selection, why = _Selection(linear, screening, renew, progress, executor), ""
    try:
        selection.run()
    except Stopped as stopped:
        why = str(stopped)
    naming = selection.naming(why)
    return replace(naming, models=tuple(_with_scatter(model, naming.linear) for model in naming.models))


def _with_scatter(model: Model, linear: LinearisedModel) -> Model:
    """Return a model with standard errors that count how much runs disagree on its sizes."""
    return replace(model, fit=with_jackknife(model.linear(linear), model.fit))


@dataclass(eq=False)
class _Selection:
    """Where the selection of a model stands."""

    linear: LinearisedModel
    screening: Screening
    renew: Renew
    progress: Callable[[str], None]
    executor: Executor
    models: tuple[Model, ...] = ()
    findings: dict[Hashable, Finding] = field(default_factory=dict)
    refused: dict[Hashable, Finding] = field(default_factory=dict)
    beside: dict[Hashable, frozenset[Hashable]] = field(default_factory=dict)
    refused_shapes: set[str] = field(default_factory=set)
    plays: set[frozenset[Hashable]] = field(default_factory=set)
    promising: tuple[Cause, ...] = ()
    causes: dict[Hashable, Cause] = field(default_factory=dict)
    posterior: dict[frozenset[Hashable], float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.nominal, self.tried = self.linear, self.screening.tried
        self.null = refit(self.linear, (), {})
        self.best = Model(self.null)

    def naming(self, stopped: str = "") -> Naming:
        """Return what was found."""
        models = tuple(model for model in self.models if model.keys)
        is_null = not self.best.keys
        kind: Kind = "cause" if len(self.best.causes) == 1 else "several causes"
        if self.best.shape:
            kind = "unlisted cause"
        elif is_null:
            kind = "nothing found so far" if stopped else "nothing found"
        taken = [self.findings[key] for key in self.best.keys if key in self.findings]
        ranked = sorted(taken, key=lambda finding: -finding.log_evidence)
        return Naming(
            kind=kind,
            models=() if is_null else models,
            null=self.null,
            screening=self.screening,
            findings=(*ranked, *(one for key, one in self.refused.items() if key not in self.best.keys)),
            linear=self.nominal if is_null else self.linear,
            groups=self._groups(ranked),
            promising=self.promising if stopped else (),
            stopped=stopped,
        )

    def _groups(self, ranked: Sequence[Finding]) -> tuple[AmbiguityGroup, ...]:
        """Return what could stand in the place of each listed finding of the best model, the surest finding first."""
        if self.best.keys not in self.posterior:
            return ()  # stopped before a search about it
        first = [finding.cause.key for finding in ranked]
        every = [*first, *(key for key in self.best.keys if key not in first)]
        return groups_of(every, self.posterior, self.causes)

    def run(self) -> None:
        """Search until the best model repeats, then with honest errors, and keep what pays on what was held out.

        What is listed comes first; what is not is looked for beside it, and in its place where it explains far more.
        """
        seen: set[frozenset[Hashable]] = set()
        is_last = False
        for _ in range(MOST_ROUNDS):
            before = self.best.keys
            self._search(is_last=is_last)
            if self.best.keys != before and self.best.keys not in seen:
                seen.add(before)
            elif not self.best.keys:
                return
            elif is_last and not self._refuse():
                self._repeat()
                return
            else:
                is_last, seen = True, set()  # what is missed now is noise: intervals and sets are to be honest
            self._relinearise(is_last=is_last)
        self._end()

    def _end(self) -> None:
        """Keep what pays of the best model where the rounds are used up, and add nothing any more."""
        self._relinearise(is_last=True)
        while self._refuse():
            self._relinearise(is_last=True)
        if self.best.keys:
            self._search(is_last=True, adds=False)
            self._repeat()

    def _search(self, *, is_last: bool = False, adds: bool = True) -> None:
        """Search about the best model, simulate the leaders, and take the most probable.

        Args:
            is_last: Everything that cannot be told from the best is to be known, not only the best.
            adds: False: the best model stays, and only what the search makes of it is of interest.
        """
        self.progress(f"searching beside {len(self.best.keys)} findings" if self.best.keys else "searching")
        threshold = self.screening.threshold
        about = search_space(self.linear, self.tried, threshold, self.best, self._barred() | self.refused_shapes)
        shape = about.present[-1:] if self.best.shape else ()
        visited = search(about.model, [about.present], shape)
        every = {one.terms: one for one in (*visited, *exchanges(about.model, visited[0], shape))}
        found = alternatives_of(about.model, every.values())
        causes = [about.cause(i) for i in found[0].best.terms]
        self.promising = tuple(cause for cause in causes if cause)
        self.causes = {cause.key: cause for cause in map(about.cause, range(len(about.what))) if cause}
        count = LEADERS if is_last else LEADERS // 2
        leading = leaders_of(found, count)
        leaders = [*(one.best.terms for one in leading), grown(about, leading)]
        known = self.best.fit if self.best.keys and not self.best.shape else None
        fitter = Fitter(self.linear, self.null, self.executor, known)
        present = fitter.knows(self.best, about.candidate_of(about.present))
        alone = [tuple(i for i in found[0].best.terms if i not in shape)] if shape else []
        others = [*leaders, *alone, about.instead(found[0].best.terms)]
        candidates = [present, *(about.candidate_of(terms) for terms in others if len(terms) and adds)]
        plays = scattering(about, found[0], self.plays) if is_last and adds else {}
        candidates += plays.values()
        self.progress(f"fitting {len(candidates) - 1} models")
        models = fitter.fitted(candidates)
        if adds and not shape and max(models, key=lambda model: model.log_posterior).keys == self.best.keys:
            beside = about.beside()
            models += fitter.fitted([beside] if beside else [])
        models = sorted([Model(self.null), *models], key=lambda model: -model.log_posterior)
        near = {model.keys for model in models if model.log_posterior > models[0].log_posterior - IN_SET}
        self.plays |= {there for there, one in plays.items() if one.keys not in near}
        # whatever was promised of those that could not be fitted, or did not need all of their causes
        fell = {keys for keys, model in fitter.models.items() if model is None or model.keys != keys}
        self.posterior = posterior_of(models, found, fell)
        self.models = with_probabilities(models, self.posterior)
        self.best = self.models[0]

    def _relinearise(self, *, is_last: bool = False) -> None:
        """Take the campaign about the best model: derivatives, standard errors, and everything weighed against it."""
        if not self.best.keys:
            return
        self.progress("what the extended model makes possible")
        linear, model = self.linear, self.best
        if not is_last:
            about, fit = relinearised_fit(model.linear(linear), model.fit)
            linear, model = without_shape(about, len(linear.nuisances)), replace(model, fit=fit)
        before = linear
        self.linear, self.tried = self.renew(linear, model, is_last=is_last)
        if self.linear is not before:
            self.null = refit(self.linear, (), {})
        self.best = reweighed(model, before, self.linear)

    def _refuse(self) -> bool:
        """Hold each finding against what was held out; refuse those that do not pay, and say whether there were any.

        The worst is refused first, and the others that did not pay are held against it anew without that one: of two
        findings of which either will do, one stays.
        """
        self.progress("gain of each finding on what was held out")
        if self.best.shape and not self._shape_pays():
            self.refused_shapes.add(str(self.best.shape))
            self.best = Model(self._without_shape(), log_posterior=self.best.log_posterior)
            return True
        held = self._held(self.best.causes)
        count = 0
        while (failed := [one for one in held.values() if not one.is_taken]) and len(self.refused) < MOST_REFUSED:
            worst = min(failed, key=lambda one: one.held_out.low)
            key = worst.cause.key
            self.best = replace(self.best, fit=self._without(worst.cause))
            self.beside[key] = frozenset() if key in self.refused else self.best.keys  # twice is for good
            self.refused[key] = held.pop(key)
            count += 1
            held |= self._held([one.cause for one in failed if one is not worst])
        self.findings = held
        return count > 0

    def _barred(self) -> frozenset[Hashable]:
        """Return the keys of what is not tried again: it did not pay beside findings that are all still there.

        Of several findings that do without each other, the one that is refused first may be the one that is needed,
        once the others are refused as well. It gets one more chance.
        """
        return frozenset(key for key, others in self.beside.items() if others <= self.best.keys)

    def _repeat(self) -> None:
        """Search again without each part of the runs, and note what is found again."""
        self.progress("searching without parts of the runs")
        about = search_space(self.linear, self.tried, self.screening.threshold, self.best, self._barred())
        shares = repeats(self.linear, self.tried, about, self.naming().alternatives)
        self.findings = {key: replace(one, repeats=shares[key]) for key, one in self.findings.items()}

    def _without_shape(self) -> Fit:
        """Return the best model fitted without what is not listed."""
        best = self.best.fit
        return refit(self.linear, best.causes, best.start, best.nuisances[: len(self.linear.nuisances)])

    def _shape_pays(self) -> bool:
        """Whether what is not listed predicts what was held out better, beside the causes."""
        best, without = self.best.fit, self._without_shape()
        least = self.screening.threshold + LEAST + imitated(self.linear, self.null, best, without)
        if best.log_evidence - without.log_evidence < least:
            return False
        return held_out(self.best.linear(self.linear), without, best, self.linear).is_gain

    def _held(self, causes: Iterable[Cause]) -> dict[Hashable, Finding]:
        """Return what causes of the best model are worth beside the others, if there is a balance without them."""
        best, found = self.best.fit, dict[Hashable, Finding]()
        error = SimulationError(self.linear, self.null, self.best)
        as_stated = _with_scatter(self.best, self.linear).fit
        for cause in causes:
            try:
                without = self._without(cause)
            except NOT_SIMULATED:
                continue
            gain = held_out(self.best.linear(self.linear), without, best)
            is_clear = is_clear_of_none(cause, as_stated)  # else runs disagree whether there is anything
            pays = gain.is_gain and is_clear and error.is_needed(without, self.screening.threshold)
            found[cause.key] = Finding(cause, best, rise_of(best, without), gain, pays)
        return found

    def _without(self, cause: Cause) -> Fit:
        """Return the best model fitted without one of its causes."""
        best = self.best.fit
        others = tuple(other for other in best.causes if other.key != cause.key)
        start = {key: value for key, value in best.start.items() if key[:2] != cause.key}
        return refit(self.best.linear(self.linear), others, start, best.nuisances, best)
