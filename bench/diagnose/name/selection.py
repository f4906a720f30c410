"""Select: from evidence to the findings that a model needs.

    linearise about the best model so far (at first the nominal one) -> search all subsets -> simulate the leaders
          ^                                                                                       |
          └──────────── until the best model repeats; then whatever it misses is noise ───────────┘

Every finding then has to pay on what was held out, or it is refused and the search goes on without it.
"""

from collections.abc import Callable, Collection, Hashable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import partial
from math import inf

from bench.diagnose.extend.fit import Fit
from bench.diagnose.extend.refit import refit
from bench.diagnose.extend.relinearise import relinearised_fit
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.other_noise import raised
from bench.diagnose.linearise.screening import Screening, Tried
from bench.diagnose.name.beginning import with_what_drawings_leave_out
from bench.diagnose.name.groups import IN_SET, AmbiguityGroup, groups_of
from bench.diagnose.name.instead_of_play import is_needed_in_motion
from bench.diagnose.name.leaders import proposed, scattering, with_other_names
from bench.diagnose.name.models import Fitter, Model, likeliest, reweighed, without_shape
from bench.diagnose.name.naming import Finding, Kind, Naming, log_odds_of_subsets, with_probabilities
from bench.diagnose.name.neighbourhood import Needs, Neighbourhood
from bench.diagnose.name.paying import fit_without_shape, held_findings, shape_pays, with_jackknife_errors
from bench.diagnose.name.refusals import Refusals
from bench.diagnose.name.repeated import repeats
from bench.diagnose.name.search import alternatives_of, exchanges, search
from bench.diagnose.name.search_space import SearchSpace, search_space
from bench.diagnose.name.simulation_error import rise_of
from bench.errors import NOT_SIMULATED
from bench.executor.contract import Executor
from bench.executor.serial import SERIAL
from bench.executor.watched import Stopped
from bench.record.campaign import Array

LEFT_OPEN = 30.0  # effort: evidence of all that is refused, from where something else is looked for in its place
MOST_ROUNDS = 12  # effort: of linearising and searching; recording B of the KR300 takes 8
LEADERS = 6  # effort: alternatives of a search that are simulated; half of them while the best model still changes


def name_cause(
    linear: LinearisedModel,
    screening: Screening,
    around: Neighbourhood,
    progress: Callable[[str], None] = lambda words: None,
    executor: Executor = SERIAL,
    earlier: Sequence[Fit] = (),
    told: Collection[tuple[str, int]] = (),
    *,
    learns: bool = True,
) -> Naming:
    """Name what is wrong with the nominal model, or what of it was found when the work was stopped.

    Args:
        linear: The campaign.
        screening: Everything that was tried in the linearised model.
        around: Weighs everything anew about an extended model.
        progress: Called with what is done next.
        executor: Where to fit.
        earlier: Fits of the campaign with other priors, to begin from.
        told: What a first pass has: names of effects, each with the index of its drive.
        learns: False: where something stays unlisted, nothing else is asked. The rounds end once the last search has
            tried what is listed in its place.
    """
    selection, why = _Selection(linear, screening, around, progress, executor, earlier, told, learns), ""
    try:
        selection.begin()
        selection.run()
    except Stopped as stopped:
        why = str(stopped)
    naming = selection.naming(why)
    return replace(naming, models=tuple(with_jackknife_errors(model, naming.linear) for model in naming.models))


@dataclass(eq=False)
class _Selection:
    """Where the selection of a model stands.

    Attributes:
        linear: The campaign about the best model, or about the one before that found a balance.
        screening, around, progress, executor, earlier, told, learns: As of `name_cause`.
        needs: What has a place beside findings of the best model alone.
        models: Those that the last search simulated, the most probable first.
        findings: Of the best model, each held against what was held out.
        refusals: What did not pay.
        plays_behind: What acted at one joint with a play in models that fell behind.
        plays_beyond: Plays that a fit wanted to be larger than plausible.
        promising: Listed causes of the subset that the last search found most probable.
        causes: Everything listed that the last search might have taken, by key.
        posterior: Of the last search, subset of keys -> logarithm of its posterior odds.
        is_open: Whether what was refused explained much, so that something else may explain it.
        before: Shape (2, c), what standard errors were raised by before they counted all that a model misses; None:
            they do not.
    """

    linear: LinearisedModel
    screening: Screening
    around: Neighbourhood
    progress: Callable[[str], None]
    executor: Executor
    earlier: Sequence[Fit] = ()
    told: Collection[tuple[str, int]] = ()
    learns: bool = True
    needs: Needs = field(default_factory=dict)
    models: tuple[Model, ...] = ()
    findings: dict[Hashable, Finding] = field(default_factory=dict)
    refusals: Refusals = field(default_factory=Refusals)
    plays_behind: set[frozenset[Hashable]] = field(default_factory=set)
    plays_beyond: set[Hashable] = field(default_factory=set)
    promising: tuple[Cause, ...] = ()
    causes: dict[Hashable, Cause] = field(default_factory=dict)
    posterior: dict[frozenset[Hashable], float] = field(default_factory=dict)
    is_open: bool = False
    before: Array | None = None

    def __post_init__(self) -> None:
        self.nominal = self.linear
        self.null = refit(self.linear, (), {})
        self.best = Model(self.null)

    @property
    def tried(self) -> Tried:
        """Everything that can be tried on the best model."""
        return replace(self.around.everything(self.linear), needs=self.needs)

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
            findings=(*ranked, *self.refusals.beside(self.best.keys)),
            linear=self.nominal if is_null else self.linear,
            groups=self._groups(ranked),
            promising=self.promising if stopped else (),
            stopped=stopped,
            tried=self.around.everything(self.nominal if is_null else self.linear),
            plays_beyond=frozenset(self.plays_beyond),
        )

    def _groups(self, ranked: Sequence[Finding]) -> tuple[AmbiguityGroup, ...]:
        """Return what could stand in the place of each listed finding of the best model, the surest finding first."""
        if self.best.keys not in self.posterior:
            return ()  # stopped before a search about it
        first = [finding.cause.key for finding in ranked]
        every = [*first, *(key for key in self.best.keys if key not in first)]
        return groups_of(every, self.posterior, self.causes, {model.keys for model in self.models})

    def begin(self) -> None:
        """Take what drawings leave out of a robot all at once."""
        self.best = with_what_drawings_leave_out(
            self.linear, self.tried, self.screening.threshold, self.best, self.executor, self.told
        )
        self._relinearise()

    def run(self) -> None:
        """Search until the best model repeats, then with honest errors, and keep what pays on what was held out.

        What is listed comes first; what is not is looked for beside it, and in its place where it explains far more.
        """
        seen: set[frozenset[Hashable]] = set()
        is_last = False
        for count in range(1, MOST_ROUNDS + 1):
            before = self.best.keys
            self._search(is_last=is_last)
            if is_last and self.best.shape and not self.learns:
                return
            if self.best.keys != before and self.best.keys not in seen:
                seen.add(before)
            elif not self.best.keys:
                return
            elif is_last and not self._refuse():
                self._repeat()
                return
            else:
                # what is missed at last is noise, so that intervals and sets are honest; but what a refused cause
                # explained for sure is not, as long as something else may explain it
                is_last, seen = not self.is_open, set()
                self.is_open = False
            self._relinearise(is_last=is_last or count == MOST_ROUNDS)
        self._end()

    def _end(self) -> None:
        """Keep what pays of the best model where the rounds are used up, and have no more findings than that."""
        held: dict[frozenset[Hashable], dict[Hashable, Finding]] = {}
        while self.best.keys not in held:  # a search may lose a finding, or call it by another name
            while self._refuse():
                self._relinearise(is_last=True)
            if not (before := self.best.keys):
                return
            held[before] = self.findings
            self._search(is_last=True, adds=False)
            if self.best.keys != before:
                self._relinearise(is_last=True)
        self.findings = held[self.best.keys]
        self._repeat()

    def _search(self, *, is_last: bool = False, adds: bool = True) -> None:
        """Search about the best model, simulate the leaders, and take the most probable.

        Args:
            is_last: Everything that cannot be told from the best is to be known, not only the best.
            adds: False: models with more findings than the best has are left out, for what is found now is held against
                nothing any more.
        """
        self.progress(f"searching beside {len(self.best.keys)} findings" if self.best.keys else "searching")
        refused = self.refusals.barred(self.best.keys) | self.refusals.shapes
        about = search_space(self.linear, self.tried, self.screening.threshold, self.best, refused)
        largest, most = None if adds else len(about.present), 2 if is_last else 1
        visited = search(about.model, [about.present], about.shape, most=largest)
        subsets = {one.terms: one for one in (*visited, *exchanges(about.model, visited[0], about.shape, most))}
        found = alternatives_of(about.model, subsets.values())
        self.promising = tuple(cause for i in found[0].best.terms if (cause := about.cause(i)))
        self.causes = {cause.key: cause for cause in map(about.cause, range(len(about.what))) if cause}
        known = self.best.fit if self.best.keys else None
        fitter = Fitter(self.linear, self.null, self.executor, known, settles=is_last, earlier=self.earlier)
        present = fitter.knows(self.best, about.candidate_of(about.present))
        others = proposed(about, found, LEADERS if is_last else LEADERS // 2, adds=adds, is_last=is_last)
        needed = partial(is_needed_in_motion, self.linear, about)
        plays = scattering(about, found[0], self.plays_behind, needed) if is_last else {}
        candidates = [present, *map(about.candidate_of, others), *plays.values()]
        self.progress(f"fitting {len(candidates) - 1} models")
        models = fitter.fitted(candidates) or [Model(self.null)]
        self.plays_beyond |= {cause.key for cause in self.causes.values() if cause.effect.scatters} & fitter.too_large
        if is_last:
            models = with_other_names(about, subsets, fitter, models)
        first = likeliest(models)
        if adds and not about.shape and first.keys == self.best.keys:
            models += self._with_shape(about, fitter, first.log_posterior, is_last=is_last)

        kept = [one for one in (Model(self.null), *models) if adds or len(one.keys) <= len(self.best.keys)]
        models = sorted(kept, key=lambda one: -one.log_posterior)
        near = {model.keys for model in models if model.log_posterior > models[0].log_posterior - IN_SET}
        self.plays_behind |= {there for there, play in plays.items() if play.keys not in near}
        found = [one for one in alternatives_of(about.model, subsets.values()) if not one.keys & self.refusals.shapes]
        most_unseen = inf if adds else models[0].log_posterior
        self.posterior = log_odds_of_subsets(models, found, fitter.fell_short(self.best), most_unseen)
        self.models = with_probabilities(models, self.posterior)
        self.best = self.models[0]

    def _with_shape(self, about: SearchSpace, fitter: Fitter, least: float, *, is_last: bool) -> list[Model]:
        """Return the best model with the free shape that is needed most, if any; at last, with the first that pays.

        Args:
            about: The best model.
            fitter: Of models about it.
            least: Logarithm of the posterior odds of the best model, which a shape has to surpass.
            is_last: As of a search.
        """
        while candidate := about.beside(self.refusals.shapes):
            models = fitter.fitted([candidate])
            surpasses = bool(models) and models[0].log_posterior > least
            if not (is_last and surpasses) or self._shape_pays(models[0]):
                return models
            self.refusals.shapes.add(str(candidate.shape))
        return []

    def _shape_pays(self, model: Model) -> bool:
        return shape_pays(self.linear, self.null, model, self.screening.threshold)

    def _relinearise(self, *, is_last: bool = False) -> None:
        """Take the campaign about the best model: derivatives, standard errors, and everything weighed against it.

        What it misses counts once, and as it is fitted before that counts: with larger standard errors figures would be
        free to leave more, and so on with every finding that is refused.
        """
        if not self.best.keys:
            return
        self.progress("what the extended model makes possible")
        linear, model = self.linear, self.best
        with suppress(*NOT_SIMULATED):  # no balance beside the model: the campaign stays about the one before
            if self.before is not None:
                linear = raised(linear, self.before / linear.inflation)
                model = _fitted_to(linear, self.linear, model)
            before = linear.inflation if is_last else None
            if not is_last:
                about, fit = relinearised_fit(model.linear(linear), model.fit)
                linear, model = without_shape(about, len(linear.nuisances)), replace(model, fit=fit)
            new, needs = self.around.about(linear, model, is_last=is_last)
            # evidence against it is the same for all, so it need not settle
            null = self.null if new is self.linear else refit(new, (), {}, settles=False)
            best = _fitted_to(new, linear, model)
            self.linear, self.needs, self.null, self.before = best.fit.design(new), needs, null, before
            self.best = replace(best, fit=replace(best.fit, renewed={}))

    def _refuse(self) -> bool:
        """Hold each finding against what was held out; refuse those that do not pay, and say whether there were any.

        The worst is refused first, and the others that did not pay are held against it anew without that one: of two
        findings of which either will do, one stays.
        """
        self.progress("gain of each finding on what was held out")
        if self.best.shape and not self._shape_pays(self.best):
            self.refusals.shapes.add(str(self.best.shape))
            self.best = Model(fit_without_shape(self.linear, self.best), log_posterior=self.best.log_posterior)
            return True
        before = self.best.fit
        held = self._held(self.best.causes)
        count = 0
        while (failed := [one for one in held.values() if not one.is_taken]) and self.refusals.allow_more:
            worst = min(failed, key=lambda one: one.held_out.low)
            assert worst.without
            self.best = replace(self.best, fit=worst.without)
            self.refusals.add(replace(held.pop(worst.cause.key), without=None), self.best.keys)
            count += 1
            held |= self._held([one.cause for one in failed if one is not worst])
        self.findings = held
        self.is_open = rise_of(before, self.best.fit) > LEFT_OPEN
        return count > 0

    def _held(self, causes: Sequence[Cause]) -> dict[Hashable, Finding]:
        """Return what causes of the best model are worth beside the others."""
        return held_findings(self.linear, self.null, self.best, causes, self.screening.threshold, self.executor)

    def _repeat(self) -> None:
        """Search again without each part of the runs, and note what is found again."""
        self.progress("searching without parts of the runs")
        refused = self.refusals.barred(self.best.keys)
        about = search_space(self.linear, self.tried, self.screening.threshold, self.best, refused)
        shares = repeats(self.linear, self.tried, about, self.naming().alternatives)
        self.findings = {key: replace(one, repeats=shares[key]) for key, one in self.findings.items()}


def _fitted_to(linear: LinearisedModel, before: LinearisedModel, model: Model) -> Model:
    """Return a model fitted again to a design, which has the derivatives that its fit took anew."""
    return reweighed(replace(model, fit=replace(model.fit, renewed={})), before, linear)
