"""One run among others, by all channels together: tracker, gauge, force, drives, angles and loads.

The nominal model with everything of the catalogue (`listed_causes.py`) is fitted to the whole campaign. One more number
that acts in one run alone (`faults_of_run.py`) is then told where it explains more of that run than chance, model
errors and the catalogue make of the same instrument in any other run, by far, and nothing like it is left of the run.
"""

from collections.abc import Iterator, Sequence, Set
from dataclasses import dataclass, replace

import numpy as np

from bench.diagnose.plausibility.faults_of_run import ANGLES, LOADS, Fault, faults_of
from bench.diagnose.plausibility.late_channels import SURE
from bench.diagnose.plausibility.linear_fit import LinearFit, fitted, gain_of
from bench.diagnose.plausibility.listed_causes import ListedCauses, listed_causes
from bench.diagnose.plausibility.one_run import EXPLAINED, FAR
from bench.diagnose.plausibility.rates import rates_of
from bench.diagnose.plausibility.repeated import Repeated
from bench.diagnose.plausibility.words_of_fault import HARDLY, in_words
from bench.diagnose.replay.instants import at_each_instant, run_of_each
from bench.diagnose.replay.quantities import Quantity
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import Segment, segments_of
from bench.effects.recorded import recorded_in
from bench.record.campaign import Array
from bench.record.finding import Finding
from bench.store.store import Store

BINS = 30  # effort: of one run at most; enough for one number
AGAIN = 3  # effort: times that a delay is found, each over the one before
OTHERS = 3  # declared: runs that an instrument saw, at least, beside the one that is held against them
CHANCE = 2.0  # declared: standard errors, up to which the largest of a few numbers comes by chance
MOST_NAMED = 2  # declared: what explains a run as well; more leave nobody the wiser
LOOK = "look at how that run was recorded"


@dataclass(frozen=True, eq=False)
class Explained:
    """What a fault would explain.

    Attributes:
        fault: Which.
        values: Its numbers, shape (p,).
        sigmas: Number of standard errors that they are off zero together.
    """

    fault: Fault
    values: Array
    sigmas: float


class OneRunAmongOthers:
    """A campaign in which one run after the other is held against the others.

    Args:
        replay: The campaign with the nominal robot.
        causes: What may be wrong throughout.
        angles: Index of a drive -> column of its angle.
    """

    def __init__(self, replay: Replay, causes: ListedCauses, angles: dict[int, str]) -> None:
        self.replay, self.causes, self.angles = replay, causes, angles
        self.run_of = run_of_each(replay.segments)
        self.time = np.concatenate([one.motion.time[one.motion.read] for one in replay.segments])
        is_static = at_each_instant(replay.segments, [one.is_static for one in replay.segments])
        kinds = [np.where(is_static == kind, self.run_of, "") for kind in (True, False)]
        errors = np.concatenate([segment.sigma for segment in replay.segments])
        spread = np.sqrt(np.mean(np.nan_to_num(causes.residual) ** 2, axis=0))
        errors = np.where(errors > 0, errors, np.where(spread > 0, spread, 1.0))  # of instruments without noise
        self.plain = fitted(causes.residual, causes.sensitivities, errors, kinds)

    def explained(self, fit: LinearFit, like: Fault | None = None) -> list[Explained]:
        """Return what each fault of each run would explain, beside a load of that run that was written down wrong.

        Args:
            fit: Of everything else.
            like: Only faults of its subject, and of its run; None: all.
        """
        predicted = self.causes.nominal + fit.explained
        rates = rates_of(self.replay.segments, predicted)
        found = []
        for run in dict.fromkeys(self.run_of.tolist()):
            faults = [
                one
                for one in self._faults(run, predicted, rates)
                if not like or like.run == run or one.subject == like.subject or one.subject[0] == LOADS
            ]
            if not faults:
                continue
            columns = np.concatenate([fault.columns for fault in faults], axis=2)
            scores, information = fit.products(self.run_of == run, columns)
            edges = np.cumsum([0, *(fault.columns.shape[2] for fault in faults)])
            places = [np.arange(*edges[i : i + 2]) for i in range(len(faults))]
            loads = [k for fault, some in zip(faults, places, strict=True) if fault.subject[0] == LOADS for k in some]
            for fault, mine in zip(faults, places, strict=True):
                beside = np.array([] if fault.subject[0] == LOADS else loads, dtype=np.int64)
                values, gain = gain_of(scores, information, mine, beside)
                found.append(Explained(fault, values, float(np.sqrt(max(gain, 0.0)))))
        return found

    def cleaned(self, fit: LinearFit, with_it: LinearFit, fault: Fault) -> tuple[Fault, Array]:
        """Return a fault by predictions that it did not spoil, and its numbers.

        Args:
            fit: Without the fault.
            with_it: In which it acts.
            fault: By predictions of the fit without it.
        """
        predicted = self.causes.nominal + with_it.explained
        key = fault.subject, fault.column, fault.how
        over, values = 0.0, np.zeros(0)
        for _ in range(AGAIN if fault.how == "late" else 1):
            every = self._faults(fault.run, predicted, rates_of(self.replay.segments, predicted, over))
            fault = next(one for one in every if (one.subject, one.column, one.how) == key)
            scores, information = fit.products(self.run_of == fault.run, fault.columns)
            values = gain_of(scores, information, np.arange(len(scores)), np.array([], dtype=np.int64))[0]
            over = float(values[0])
        return fault, values

    def _faults(self, run: str, predicted: Array, rates: Array) -> list[Fault]:
        own = self.run_of == run
        return list(faults_of(run, own, self.replay.quantities, predicted, rates, self.causes, self.angles))

    def with_fault(self, fit: LinearFit, fault: Fault) -> LinearFit:
        """Return a fit in which a fault may be as large as it wants."""
        own = self.run_of == fault.run
        for k in range(fault.columns.shape[2]):
            column = np.zeros(self.causes.residual.shape)
            column[own] = fault.columns[:, :, k]
            fit = fit.with_more(column)
        return fit


def one_more_number(repeated: Repeated, told: frozenset[str], store: Store | None = None) -> Iterator[Finding]:
    """Yield a warning for each run in which one number more explains what a channel, an angle or a load is.

    Args:
        repeated: The campaign.
        told: Runs of which something was told already.
        store: Where what was simulated is kept between processes; None: nowhere.
    """
    campaign, compiled = repeated.campaign, repeated.compiled
    if len(campaign.runs) <= OTHERS:
        return
    quantities = tuple(q for q in repeated.quantities if q.kind != "gas_temperature")
    segments = segments_of(campaign, compiled, quantities, BINS)
    if len({segment.run for segment in segments}) <= OTHERS:
        return
    replay = repeated.replay(_sliding(segments, quantities), quantities)
    causes = listed_causes(replay, recorded_in(campaign.runs, compiled.model.opt.gravity), store)
    if causes is None:
        return
    measured = {name for run in campaign.runs for name in run.columns}
    angles = {
        j: name
        for j in range(compiled.n_joints)
        for name in (f"q_motor_{j + 1}_m", f"q_motor_{j + 1}_rad")
        if name in measured
    }
    among = OneRunAmongOthers(replay, causes, angles)
    every = among.explained(among.plain)
    worst_of: dict[tuple[str, int], Explained] = {}
    for one in sorted(every, key=lambda one: -one.sigmas):
        if one.sigmas > FAR * CHANCE and one.fault.matters(one.values):
            worst_of.setdefault(one.fault.subject, one)
    judged = set(told)
    for worst in worst_of.values():
        if worst.fault.run not in judged:
            judged.add(worst.fault.run)
            yield from _judged(among, every, worst, told)


def _judged(
    among: OneRunAmongOthers, every: Sequence[Explained], worst: Explained, told: frozenset[str]
) -> Iterator[Finding]:
    """Yield a warning of the fault that explains most, unless it may be something else.

    Args:
        among: The campaign.
        every: What each fault explains.
        worst: The fault that explains most of its subject.
        told: Runs of which something was told already; what they may be the culprits of is not told again.
    """
    run, subject = worst.fault.run, worst.fault.subject
    if len({one.fault.run for one in every if one.fault.subject == subject}) <= OTHERS:
        return
    fit = among.plain
    with_it = among.with_fault(fit, worst.fault)
    with_it = among.with_fault(fit, among.cleaned(fit, with_it, worst.fault)[0])
    after = among.explained(with_it, worst.fault)
    rest = max(_elsewhere(after, subject, {run}), CHANCE)
    same = max((one.sigmas for one in after if one.fault.run == run), default=0.0)
    if worst.sigmas < FAR * rest:
        yield from _exchanged_loads(among, with_it, after, worst, told)
        return
    then = {(one.fault.run, one.fault.column, one.fault.how): one.sigmas for one in after}
    rivals = {
        one.fault.run
        for one in every
        if one.fault.run != run
        and one.fault.subject == subject
        and one.sigmas**2 > worst.sigmas**2 / 2
        and then[one.fault.run, one.fault.column, one.fault.how] < one.sigmas / 2
    }
    if rivals & told:
        return
    where = f"in run {run!r}" + (f" or, the other way round, in run {next(iter(rivals))!r}" if rivals else "")
    if same**2 > (1 - EXPLAINED) * worst.sigmas**2:
        if not rivals and subject[0] not in (LOADS, ANGLES):
            yield Finding("warning", "all runs", None, worst.fault.column, f"{HARDLY} {where}", LOOK)
        return
    nearly = worst.sigmas - max(rest, same)
    mine = [one for one in every if one.fault.run == run and one.sigmas >= nearly and one.fault.matters(one.values)]
    subjects = dict.fromkeys(one.fault.subject for one in sorted(mine, key=lambda one: -one.sigmas))
    if len(rivals) > 1 or len(subjects) > MOST_NAMED:
        return
    plainest = [_plainest([one for one in mine if one.fault.subject == subject]) for subject in subjects]
    lasts = float(np.ptp(among.time[among.run_of == run]))
    words = [in_words(fault, among.cleaned(fit, with_it, fault)[1], lasts) for fault in plainest]
    others = [f"{fault.column} {said}" for fault, said in zip(plainest[1:], words[1:], strict=True)]
    message = ", or ".join([words[0], *others]) + ("," if others else "") + f" {where}"
    remedy = "look up what was hung on there; bench diagnose weighs it" if subject[0] == LOADS else LOOK
    remedy = f"nothing tells which: {remedy.replace('that run was', 'both were')}" if rivals else remedy
    yield Finding("warning", "all runs", None, plainest[0].column, message, remedy)


def _exchanged_loads(
    among: OneRunAmongOthers, with_it: LinearFit, after: Sequence[Explained], worst: Explained, told: frozenset[str]
) -> Iterator[Finding]:
    """Yield a warning of two runs whose loads were written down wrong, where no third one is nearly as far off.

    Args:
        among: The campaign.
        with_it: In which the worst fault acts.
        after: What each fault explains beside that one.
        worst: The fault that explains most, of a load.
        told: Runs of which something was told already.
    """
    first, subject = worst.fault, worst.fault.subject
    rivals = [one for one in after if one.fault.subject == subject and one.fault.run != first.run]
    if subject[0] != LOADS or len({one.fault.run for one in rivals}) <= OTHERS:
        return
    second = max(rivals, key=lambda one: one.sigmas)
    pair = {first.run, second.fault.run}
    with_both = among.with_fault(with_it, second.fault)
    beside = among.explained(with_both, second.fault)
    rest = max(_elsewhere(beside, subject, pair), CHANCE)
    least = min(worst.sigmas, second.sigmas)
    same = max(one.sigmas for one in beside if one.fault.run in pair)
    if pair & told or least < FAR * rest or same**2 > (1 - EXPLAINED) * least**2:
        return
    each = (first, among.with_fault(among.plain, second.fault)), (second.fault, with_it)
    said = [in_words(one, among.cleaned(fit, with_both, one)[1], 0.0) for one, fit in each]
    message = f"{said[0]} in run {first.run!r}, and {said[1]} in run {second.fault.run!r}"
    remedy = "loads or tables of the two exchanged? look up what was hung on there"
    yield Finding("warning", "all runs", None, first.column, message, remedy)


def _plainest(alike: Sequence[Explained]) -> Fault:
    """Return the plainest fault of one subject, of those that explain as much but for chance."""
    most = max(one.sigmas for one in alike)
    return min((one for one in alike if one.sigmas >= most - SURE), key=lambda one: len(one.values)).fault


def _elsewhere(every: Sequence[Explained], subject: tuple[str, int], runs: Set[str]) -> float:
    """Return the most standard errors by which anything of a subject is off zero in other runs."""
    return max((one.sigmas for one in every if one.fault.subject == subject and one.fault.run not in runs), default=0.0)


def _sliding(segments: Sequence[Segment], quantities: Sequence[Quantity]) -> tuple[Segment, ...]:
    """Return segments without readings of drives that stand: friction holds them anywhere between its levels."""
    found = []
    for segment in segments:
        observed = segment.observed.copy()
        for c, quantity in enumerate(quantities):
            if quantity.is_drive and segment.standing[quantity.index]:
                observed[:, c] = np.nan
        found.append(replace(segment, observed=observed))
    return tuple(found)
