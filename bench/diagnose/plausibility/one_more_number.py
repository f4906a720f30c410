"""One run among others, by all channels together: tracker, gauge, force, drives, angles and loads.

The nominal model with everything of the catalogue (`listed_causes.py`) is fitted to the whole campaign. One more number
that acts in one run alone (`faults_of_run.py`) is then told where it explains more of that run than chance, model
errors and the catalogue make of the same instrument in any other run, by far, and nothing like it is left of the run.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.plausibility.drive_picture import in_nm
from bench.diagnose.plausibility.faults_of_run import ANGLES, LOADS, Fault, faults_of, rates_of
from bench.diagnose.plausibility.late_channels import SURE
from bench.diagnose.plausibility.linear_fit import OWN, LinearFit, fitted
from bench.diagnose.plausibility.listed_causes import ListedCauses, listed_causes
from bench.diagnose.plausibility.one_run import EXPLAINED, FAR, OTHERS
from bench.diagnose.replay.quantities import Quantity, quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import Segment, run_of_each, segments_of
from bench.effects.recorded import recorded_in
from bench.record.campaign import Array, Campaign
from bench.record.finding import Finding
from bench.robot.compiled import CompiledRobot

BINS = 30  # effort: of one run at most; enough for one number
MOST_TRIED = 3  # effort: runs that are looked at more closely


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
        is_static = np.repeat([one.is_static for one in replay.segments], [len(one) for one in replay.segments])
        kinds = [np.where(is_static == kind, self.run_of, "") for kind in (True, False)]
        self.plain = fitted(causes.residual, causes.sensitivities, _errors(replay, is_static), kinds)

    def explained(self, fit: LinearFit) -> list[Explained]:
        """Return what each fault of each run would explain, beside a load of that run that was written down wrong."""
        predicted = self.causes.nominal + fit.explained
        rates = rates_of(self.replay.segments, predicted)
        found = []
        for run in dict.fromkeys(self.run_of.tolist()):
            own = self.run_of == run
            faults = list(faults_of(run, own, self.replay.quantities, predicted, rates, self.causes, self.angles))
            if not faults:
                continue
            scores, information = fit.products(own, np.concatenate([fault.columns for fault in faults], axis=2))
            edges = np.cumsum([0, *(fault.columns.shape[2] for fault in faults)])
            places = [np.arange(*edges[i : i + 2]) for i in range(len(faults))]
            loads = [k for fault, some in zip(faults, places, strict=True) if fault.subject[0] == LOADS for k in some]
            for fault, mine in zip(faults, places, strict=True):
                beside = np.array([] if fault.subject[0] == LOADS else loads, dtype=np.int64)
                values, gain = _gain(scores, information, mine, beside)
                found.append(Explained(fault, values, float(np.sqrt(max(gain, 0.0)))))
        return found

    def with_fault(self, fit: LinearFit, fault: Fault) -> LinearFit:
        """Return a fit in which a fault may be as large as it wants."""
        own = self.run_of == fault.run
        for k in range(fault.columns.shape[2]):
            column = np.zeros(self.causes.residual.shape)
            column[own] = fault.columns[:, :, k]
            fit = fit.with_more(column)
        return fit


def one_more_number(campaign: Campaign, compiled: CompiledRobot, told: frozenset[str]) -> Iterator[Finding]:
    """Yield a warning for each run in which one number more explains what a channel, an angle or a load is.

    Args:
        campaign: A checked campaign, with known payloads carried.
        compiled: Its robot, nominal.
        told: Runs of which something was told already.
    """
    quantities = tuple(q for q in quantities_of(campaign.runs, compiled) if q.kind != "gas_temperature")
    segments = segments_of(campaign, compiled, quantities, BINS)
    if len({segment.run for segment in segments}) <= OTHERS:
        return
    replay = Replay(compiled, _sliding(segments, quantities), quantities)
    causes = listed_causes(replay, recorded_in(campaign.runs, compiled.model.opt.gravity))
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
    fit, set_aside = among.plain, set(told)
    for _ in range(MOST_TRIED):
        every = among.explained(fit)
        likely = [one for one in every if one.fault.run not in set_aside and one.sigmas > FAR * SURE]
        if not likely:
            return
        worst = max(likely, key=lambda one: one.sigmas)
        set_aside.add(worst.fault.run)
        found = _judged(among, fit, every, worst)
        if found:
            yield found[0]
            fit = found[1]


def _judged(
    among: OneRunAmongOthers, fit: LinearFit, every: Sequence[Explained], worst: Explained
) -> tuple[Finding, LinearFit] | None:
    """Return what is told of the fault that explains most, with a fit in which it acts; None: it may be something else.

    Args:
        among: The campaign.
        fit: Without that fault.
        every: What each fault explains beside that fit.
        worst: The fault that explains most.
    """
    run, subject = worst.fault.run, worst.fault.subject
    if len({one.fault.run for one in every if one.fault.subject == subject}) <= OTHERS:
        return None
    with_it = among.with_fault(fit, worst.fault)
    after = among.explained(with_it)
    rest = max((one.sigmas for one in after if one.fault.subject == subject and one.fault.run != run), default=0.0)
    same = max((one.sigmas for one in after if one.fault.run == run), default=0.0)
    if worst.sigmas < FAR * rest or same**2 > (1 - EXPLAINED) * worst.sigmas**2:
        return None
    rivals = {
        before.fault.run
        for before, then in zip(every, after, strict=True)
        if before.fault.run != run and before.sigmas**2 > worst.sigmas**2 / 2 and then.sigmas < before.sigmas / 2
    }
    if len(rivals) > 1:
        return None
    equals = [
        one
        for one in every
        if one.fault.run == run and one.sigmas**2 >= worst.sigmas**2 - max(rest, same) ** 2
    ]
    plainest = min(equals, key=lambda one: len(one.values))
    where = f"in run {run!r}" + (f", or in run {next(iter(rivals))!r} the other way" if rivals else "")
    return _finding(plainest.fault, _values(among, fit, with_it, plainest.fault), where), with_it


def _values(among: OneRunAmongOthers, fit: LinearFit, with_it: LinearFit, fault: Fault) -> Array:
    """Return the numbers of a fault, by predictions that it did not spoil."""
    own = among.run_of == fault.run
    clean = among.causes.nominal + with_it.explained
    rates = rates_of(among.replay.segments, clean)
    again = faults_of(fault.run, own, among.replay.quantities, clean, rates, among.causes, among.angles)
    same = next(
        one
        for one in again
        if (one.subject, one.column, one.how, one.columns.shape)
        == (fault.subject, fault.column, fault.how, fault.columns.shape)
    )
    scores, information = fit.products(own, same.columns)
    return _gain(scores, information, np.arange(len(scores)), np.array([], dtype=np.int64))[0]


def _gain(
    scores: Array, information: Array, mine: NDArray[np.int64], beside: NDArray[np.int64]
) -> tuple[Array, float]:
    """Return the numbers of some columns, and twice the logarithm of what they gain, beside others that act as well."""
    both = np.concatenate([mine, beside])
    values, gain = _solved(scores[both], information[np.ix_(both, both)])
    return values[: len(mine)], gain - _solved(scores[beside], information[np.ix_(beside, beside)])[1]


def _solved(scores: Array, information: Array) -> tuple[Array, float]:
    if not len(scores):
        return scores, 0.0
    size = np.sqrt(np.maximum(np.diag(information), 0.0))
    there = size > OWN * np.max(size, initial=0.0)
    values = np.zeros(len(scores))
    if np.any(there):
        scale = size[there]
        values[there] = np.linalg.pinv(information[np.ix_(there, there)] / np.outer(scale, scale), rcond=OWN**0.5) @ (
            scores[there] / scale
        )
        values[there] /= scale
    return values, float(values @ scores)


def _finding(fault: Fault, values: Array, where: str) -> Finding:
    remedy = "look at how that run was recorded"
    if fault.subject[0] == LOADS:
        words = f"instruments show {1 + values[0]:.2f} times the load that is written down {where}"
        remedy = "look up what was hung on there; bench diagnose weighs it"
    elif fault.subject[0] == ANGLES:
        words = f"is {values[0]:+.3g} {fault.unit} beside where the joint stood, by all else, {where}"
    elif fault.how == "displaced":
        size = f"{values[0]:+.3g}" if len(values) == 1 else f"{np.linalg.norm(values):.3g}"
        words = f"is {size} {fault.unit} beside what all else makes of it {where}"
    elif fault.how == "late":
        words = f"is {abs(values[0]):.2g} s {'late' if values[0] > 0 else 'early'} {where}, and not in others"
    else:
        words = f"is {1 + values[0]:.3g} times what all else makes of it {where}"
    return Finding("warning", "all runs", None, fault.column, words, remedy)


def _errors(replay: Replay, is_static: NDArray[np.bool_]) -> Array:
    """Return standard errors of readings, shape (T, c); friction holds drives at rest anywhere up to its level."""
    compiled = replay.compiled
    errors = np.concatenate([segment.sigma for segment in replay.segments])
    level = compiled.motor_coulomb + compiled.link_coulomb
    for c, quantity in enumerate(replay.quantities):
        if quantity.is_drive:
            held = level[quantity.index] / in_nm(quantity, compiled)
            errors[is_static, c] = np.hypot(errors[is_static, c], held)
    return np.where(np.isfinite(errors), errors, 1.0)


def _sliding(segments: Sequence[Segment], quantities: Sequence[Quantity]) -> tuple[Segment, ...]:
    """Return segments without readings of drives that stand while others move: friction holds them anywhere."""
    found = []
    for segment in segments:
        observed = segment.observed.copy()
        for c, quantity in enumerate(quantities):
            if quantity.is_drive and segment.standing[quantity.index] and not segment.is_static:
                observed[:, c] = np.nan
        found.append(replace(segment, observed=observed))
    return tuple(found)
